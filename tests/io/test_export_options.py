"""Names of joints and rest poses of files that are written: the motion is the same in all of them."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.zero_pose import t_pose, with_zero_pose
from studio.core.mesh.joint_skin import character_skin
from studio.core.normalized.normalize import normalize
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_adapted, take_of_capture, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import load_capture
from studio.io.joint_names import joint_namings, with_joint_names
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture

NO_TURN = np.array([0.0, 0.0, 0.0, 1.0])


def world(capture):
    return joint_world(capture.skeleton, capture.poses)[0]


def zero_places(capture):
    """(J, 3) where the joints are when every angle is zero."""
    still = rest_poses(capture.skeleton, np.tile(NO_TURN, (capture.skeleton.joint_count, 1)))
    return joint_world(capture.skeleton, still)[0][0]


def take_on(character, capture):
    request = AdaptRequest(normalize(capture)[0], character.morphology)
    return take_of_adapted(character.name, adapt(request), character, request)


@pytest.mark.parametrize("key", joint_namings())
def test_every_table_of_names_gives_a_body_that_is_found_again_by_its_names(tmp_path, key):
    take = take_on(bundled_characters()["adult_woman"], make_capture())
    path = tmp_path / "out.bvh"
    write_take(ExportOptions(joint_names=key).applied_to(take, path), path)
    back = load_capture(path)
    assert back.body_map is not None
    named = take.capture.body_map.to_json(with_joint_names(take.capture, key).skeleton)
    assert back.body_map.to_json(back.skeleton) == named


def test_a_long_spine_gets_a_name_for_every_vertebra():
    naming = joint_namings()["unity"]
    assert [naming.vertebra(place) for place in (1, 2, 3, 4, 5)] == [
        "Spine", "Chest", "UpperChest", "UpperChest3", "UpperChest4",
    ]  # fmt: skip
    assert joint_namings()["unreal"].vertebra(2) == "spine_02"


def test_joints_that_play_no_part_keep_their_names_unless_one_is_taken():
    capture = make_capture()
    names = tuple("neck_01" if name == "HeadEnd" else name for name in capture.skeleton.names)
    capture = replace(capture, skeleton=replace(capture.skeleton, names=names))
    renamed = with_joint_names(capture, "unreal").skeleton.names
    assert renamed[capture.body_map[BodyPart.NECK]] == "neck_01"
    assert renamed[names.index("neck_01")] == "neck_01_"
    assert "LeftToeEnd" in renamed


@pytest.mark.parametrize("rest", ["t", "own"])
def test_a_character_moves_the_same_from_any_rest_pose(tmp_path, rest):
    character = bundled_characters()["giant"]
    take = take_on(character, make_capture())
    path = tmp_path / "out.bvh"
    chosen = ExportOptions(rest_pose=rest).applied_to(take, path)
    write_take(chosen, path)
    back = load_capture(path)
    assert np.abs(world(back) - world(take.capture)).max() < 1e-5
    own = character_skin(character).bind_positions
    stands_bound = np.abs(zero_places(back) - own - (zero_places(back)[0] - own[0])).max() < 1e-5
    assert stands_bound == (rest == "own")


@pytest.mark.parametrize("clip", ["accad_male2_E1_JabLeft", "pybvh_test3_fingers", "mass_kick", "fair_dab_zup"])
def test_a_real_capture_gets_a_t_pose_as_its_zero(captures, clip):
    [source] = (captures / "bvh").rglob(f"{clip}.bvh")
    capture = load_capture(source)
    level = with_zero_pose(capture, t_pose(capture))
    assert np.abs(world(level) - world(capture)).max() < 1e-9
    places, body = zero_places(level), capture.body_map
    for side, way in (("left", 1.0), ("right", -1.0)):
        arm = [places[body[BodyPart(f"{side}_{part}")]] for part in ("upper_arm", "forearm", "hand")]
        leg = [places[body[BodyPart(f"{side}_{part}")]] for part in ("thigh", "shank", "foot")]
        for bone in np.diff(arm, axis=0):
            assert bone / np.linalg.norm(bone) == pytest.approx([0.0, way, 0.0], abs=0.03)
        for bone in np.diff(leg, axis=0):
            assert bone / np.linalg.norm(bone) == pytest.approx([0.0, 0.0, -1.0], abs=0.03)


def test_a_rest_pose_is_refused_where_there_is_none_to_choose(tmp_path):
    take = take_of_capture(make_capture())
    with pytest.raises(Exception, match="only BVH has a rest pose to choose"):
        ExportOptions(rest_pose="t").applied_to(take, tmp_path / "out.glb")


def test_names_need_a_body_map():
    with pytest.raises(Exception, match="has no body map"):
        with_joint_names(make_capture(body_map=None), "unreal")
