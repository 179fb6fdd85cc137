"""Exports equal the adapted motion: read back by our own reader, joint by joint."""

import numpy as np
import pytest

from studio.core.body.humanoid import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.captures.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.rigs.character_skeleton import joint_points
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.bvh.reader import read_bvh
from studio.io.export import take_of_actor, take_of_adapted, write_capture, write_take
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_morphology

HUNDREDTH_OF_A_MILLIMETRE = 1e-5
CLIPS = ("strikes/accad_male2_G4_SpinningBackKick", "varied/accad_female1_D6_CartWheel", "varied/mass_backflip")


def adapted_to(body, capture):
    motion, _actor = normalize_capture(capture)
    spans = capture_contacts(capture)
    contacts = tuple(ContactInterval("m", point, *span) for point, many in spans.items() for span in many)
    return adapt(AdaptRequest(motion, body, contacts), capture.first_frame)


def world_positions(path):
    """(F, J, 3) metres in world axes: the file has Y up and centimetres."""
    file = read_bvh(path)
    return joint_world(file.skeleton, file.poses())[0][..., [2, 0, 1]] / 100.0


@pytest.mark.parametrize("clip", CLIPS)
@pytest.mark.parametrize("name", ["adult_woman", "child", "giant"])
def test_an_exported_file_read_back_gives_the_same_joint_positions(captures, tmp_path, clip, name):
    body = bundled_characters()[name].morphology
    adapted = adapted_to(body, load_capture(captures / "bvh" / f"{clip}.bvh"))
    write_take(take_of_adapted(name, adapted), tmp_path / "out.bvh")
    back = world_positions(tmp_path / "out.bvh")
    expected = adapted.positions[:, list(joint_points(body.layout))]
    assert back.shape == expected.shape
    assert np.linalg.norm(back - expected, axis=2).max() < HUNDREDTH_OF_A_MILLIMETRE


def test_an_exported_file_is_itself_a_capture_with_a_body(tmp_path):
    adapted = adapted_to(make_morphology(), make_capture())
    write_take(take_of_adapted("Body", adapted), tmp_path / "out.bvh")
    capture = load_capture(tmp_path / "out.bvh")
    assert capture.body_map is not None
    assert (capture.unit, capture.up_axis, capture.frame_rate) == ("cm", "Y", 60.0)
    assert capture.repairs == ()


def test_a_motion_without_finite_numbers_is_refused_by_the_characters_name(tmp_path):
    adapted = adapted_to(make_morphology(), make_capture())
    broken = AdaptedMotion(
        adapted.morphology, 60.0, 0, adapted.positions * np.nan, adapted.rotations, adapted.residuals
    )
    with pytest.raises(StudioError, match="The motion of Woman cannot be exported"):
        write_take(take_of_adapted("Woman", broken), tmp_path / "out.bvh")
    assert list(tmp_path.iterdir()) == []


def test_an_export_that_cannot_be_written_leaves_the_folder_as_it_was(tmp_path):
    (tmp_path / "out.bvh").mkdir()
    with pytest.raises(StudioError, match="could not be written"):
        write_take(take_of_adapted("Woman", adapted_to(make_morphology(), make_capture())), tmp_path / "out.bvh")
    assert [path.name for path in tmp_path.iterdir()] == ["out.bvh"]


def test_a_capture_keeps_its_joints_poses_and_rate(tmp_path):
    capture = make_capture()
    assert write_capture(capture, tmp_path / "out.bvh").name == "BVH"
    back = load_capture(tmp_path / "out.bvh")
    assert back.skeleton.joint_count == capture.skeleton.joint_count
    assert back.frame_rate == capture.frame_rate
    before, after = (joint_world(each.skeleton, each.poses)[0] for each in (capture, back))
    moving = np.flatnonzero(~capture.skeleton.end_sites)
    same = [back.skeleton.index(capture.skeleton.names[joint]) for joint in moving]
    assert np.abs(after[:, same] - before[:, moving]).max() < HUNDREDTH_OF_A_MILLIMETRE


def test_a_suffix_that_no_writer_knows_is_refused_with_those_there_are(tmp_path):
    with pytest.raises(StudioError, match=r"End its name with \.bvh"):
        write_capture(make_capture(), tmp_path / "out.vrm")


def test_the_actors_own_joints_carry_fingers_untouched_and_wrists_to_where_they_were_adapted(captures, tmp_path):
    capture = load_capture(captures / "bvh" / "conventions" / "pybvh_test3_fingers.bvh")
    motion, actor = normalize_capture(capture)
    request = AdaptRequest(motion, actor.morphology, (), ())
    adapted = adapt(request, capture.first_frame)
    write_take(take_of_actor(adapted, actor, capture, request), tmp_path / "out.bvh")
    back = load_capture(tmp_path / "out.bvh")
    assert back.skeleton.names == capture.skeleton.names
    assert capture.body_map is not None
    frames = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    mapped = {*capture.body_map.parts.values(), *capture.body_map.spine}
    free = [joint for joint in range(capture.skeleton.joint_count) if joint not in mapped]
    assert any("Thumb" in capture.skeleton.names[joint] for joint in free)
    before = capture.poses.local_rotations[frames][:, free]
    assert np.abs(np.abs(np.sum(back.poses.local_rotations[:, free] * before, axis=2)) - 1.0).max() < 1e-9
    places = joint_world(back.skeleton, back.poses)[0] - actor.origin
    layout = actor.morphology.layout
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        wrist = adapted.positions[:, layout.collar_point(side) + 3]
        assert np.linalg.norm(places[:, capture.body_map[part]] - wrist, axis=1).max() < 0.002
