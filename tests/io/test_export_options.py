"""Names of joints and rest poses of files that are written: the motion is the same in all of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.read_back import places_in
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.captures.annotations import Annotations, Label
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.joint_skin import character_skin
from studio.core.rigs.zero_pose import t_pose, with_zero_pose
from studio.core.rotations import multiply
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.stage.placement import Placement
from studio.io.export import skin_of, take_of_adapted, take_of_capture, write_take
from studio.io.export_choices import HIPS_ONLY_SUFFIXES
from studio.io.export_options import ExportOptions
from studio.io.importing import load_capture
from studio.io.joint_names import joint_namings, with_joint_names
from studio.io.project.character_file import bundled_characters
from studio.io.registry import OWN_FORMATS
from tests.builders import make_capture, make_character

NO_TURN = np.array([0.0, 0.0, 0.0, 1.0])


def world(capture):
    return joint_world(capture.skeleton, capture.poses)[0]


def zero_places(capture):
    """(J, 3) where the joints are when every angle is zero."""
    still = rest_poses(capture.skeleton, np.tile(NO_TURN, (capture.skeleton.joint_count, 1)))
    return joint_world(capture.skeleton, still)[0][0]


def take_on(character, capture):
    request = AdaptRequest(normalize_capture(capture)[0], character.morphology)
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
    with pytest.raises(Exception, match="has no rest pose to choose"):
        ExportOptions(rest_pose="t").applied_to(take, tmp_path / "out.csv")


def test_names_need_a_body_map():
    with pytest.raises(Exception, match="has no body map"):
        with_joint_names(make_capture(body_map=None), "unreal")


def carried(take, frame):
    """(V, 3) where linear blending takes the skin of a take in one frame."""
    skin = skin_of(take)
    positions, rotations = (each[frame] for each in joint_world(take.skeleton, take.poses))
    turned = rotations @ np.swapaxes(skin.bind_rotations, 1, 2)
    shifts = positions - np.einsum("jik,jk->ji", turned, skin.bind_positions)
    moved = np.einsum("vwij,vj->vwi", turned[skin.joints], skin.vertices) + shifts[skin.joints]
    return np.einsum("vw,vwi->vi", skin.weights, moved)


@pytest.mark.parametrize(
    "options",
    [ExportOptions(rest_pose="own"), ExportOptions(root="floor"), ExportOptions(rest_pose="own", root="floor")],
)
def test_the_skin_goes_where_it_went_whatever_joints_carry_it(tmp_path, options):
    take = take_on(bundled_characters()["child"], make_capture())
    chosen = options.applied_to(take, tmp_path / "out.glb")
    assert np.abs(carried(chosen, 17) - carried(take, 17)).max() < 1e-9


def heading_away(capture, turns):
    """The capture with its root turned about Z by ``turns`` (F,) radians, moving along a circle."""
    about = np.zeros((capture.frame_count, 4))
    about[:, 2], about[:, 3] = np.sin(turns / 2), np.cos(turns / 2)
    rotations, translations = np.array(capture.poses.local_rotations), np.array(capture.poses.local_translations)
    rotations[:, 0] = multiply(about, rotations[:, 0])
    translations[:, 0, 0], translations[:, 0, 1] = np.sin(turns), 1.0 - np.cos(turns)
    return replace(capture, poses=PoseSequence(rotations, translations))


@pytest.mark.parametrize("suffix", [".bvh", ".fbx", ".glb", ".usd"])
def test_a_root_joint_stands_on_the_floor_and_heads_as_the_hips_do_and_nothing_else_moves(tmp_path, suffix):
    turns = np.linspace(0.0, 3.0, 90)
    take = take_on(make_character(), heading_away(make_capture(frames=90), turns))
    chosen = ExportOptions(root="floor").applied_to(take, tmp_path / f"out{suffix}")
    write_take(chosen, tmp_path / f"out{suffix}")
    names = list(chosen.skeleton.names)
    assert names[0] == "root"
    places, rotations = joint_world(chosen.skeleton, chosen.poses)
    assert np.abs(places[:, 1:] - world(take.capture)).max() < 1e-9
    assert np.abs(places[:, 0, 2]).max() == 0.0
    assert np.abs(places[:, 0, :2] - places[:, names.index("Hips"), :2]).max() < 1e-9
    headings = np.unwrap(np.arctan2(rotations[:, 0, 1, 0], rotations[:, 0, 0, 0]))
    inner = slice(15, -15)
    assert np.abs(headings[inner] - turns[inner] - (headings[45] - turns[45])).max() < 0.06
    back = places_in(tmp_path / f"out{suffix}")
    for joint, name in enumerate(names):
        if name in back and not chosen.skeleton.end_sites[joint]:
            assert np.abs(back[name] - places[:, joint]).max() < 1e-4


def test_in_place_the_hips_stay_where_they_begin_and_nothing_else_changes():
    take = take_on(make_character(), heading_away(make_capture(frames=60), np.linspace(0.0, 3.0, 60)))
    chosen = ExportOptions(root="in-place").applied_to(take, Path("out.fbx"))
    before, after = world(take.capture), world(chosen.capture)
    assert np.ptp(before[:, 0, :2], axis=0).max() > 0.5
    assert np.ptp(after[:, 0, :2], axis=0).max() < 1e-12
    assert np.abs(after - after[:, :1] - (before - before[:, :1])).max() < 1e-9
    assert np.abs(after[:, 0, 2] - before[:, 0, 2]).max() == 0.0


MOTION_SUFFIXES = [suffix for each in OWN_FORMATS if each.motion_writer for suffix in each.suffixes]
"""Every kind of file that the studio itself writes a motion to."""


@pytest.mark.parametrize("suffix", MOTION_SUFFIXES)
def test_a_range_is_written_frame_by_frame_as_it_was(tmp_path, suffix):
    take = take_on(make_character(), make_capture(frames=60))
    options = ExportOptions(begin=0.25, end=0.5)
    chosen = options.applied_to(take, tmp_path / f"out{suffix}")
    write_take(chosen, tmp_path / f"out{suffix}")
    assert np.abs(world(chosen.capture) - world(take.capture)[15:31]).max() == 0.0
    assert chosen.begin == pytest.approx(0.25)
    back = places_in(tmp_path / f"out{suffix}")
    assert len(back["Hips"]) == 16


OPTIONS = {
    "another rate": ExportOptions(frame_rate=24.0),
    "a range at another rate": ExportOptions(begin=0.25, end=0.75, frame_rate=90.0),
    "in place": ExportOptions(root="in-place"),
    "a root on the floor": ExportOptions(root="floor"),
    "everything": ExportOptions(root="floor", begin=0.2, end=0.8, frame_rate=48.0),
}


@pytest.mark.parametrize("options", OPTIONS)
@pytest.mark.parametrize("suffix", MOTION_SUFFIXES)
def test_every_writer_has_every_option(tmp_path, suffix, options):
    if suffix.startswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")
    take = take_on(make_character(), heading_away(make_capture(frames=60), np.linspace(0.0, 3.0, 60)))
    path, chosen = tmp_path / f"out{suffix}", OPTIONS[options]
    if chosen.root == "floor" and suffix in HIPS_ONLY_SUFFIXES:
        with pytest.raises(StudioError, match="its hips travel"):
            chosen.applied_to(take, path)
        return
    shaped = chosen.applied_to(take, path)
    write_take(shaped, path)
    back, expected = places_in(path), world(shaped.capture)
    assert len(back["Hips"]) == shaped.poses.frame_count
    names, ends = shaped.skeleton.names, shaped.skeleton.end_sites
    moving = [name for name, is_end in zip(names, ends, strict=True) if not is_end]
    assert len(set(moving) & set(back)) == len(moving)
    for joint, name in enumerate(names):
        if name in back:
            assert np.abs(back[name] - expected[:, joint]).max() < 1e-4, name
    if chosen.root == "in-place":
        assert np.ptp(back["Hips"][:, :2], axis=0).max() < 1e-4
    if chosen.root == "floor":
        assert np.abs(back["root"][:, :2] - back["Hips"][:, :2]).max() < 1e-4


@pytest.mark.parametrize(("rate", "count"), [(30.0, 30), (25.0, 25), (120.0, 119), (59.94, 59)])
def test_at_another_rate_every_moment_is_where_it_was(rate, count):
    take = take_on(make_character(), make_capture(frames=60))
    chosen = ExportOptions(frame_rate=rate).applied_to(take, Path("out.bvh"))
    assert (chosen.frame_rate, chosen.poses.frame_count) == (rate, count)
    before, after = world(take.capture), world(chosen.capture)
    moments = np.arange(count) / rate * 60.0
    for joint in range(after.shape[1]):
        for axis in range(3):
            expected = np.interp(moments, np.arange(60.0), before[:, joint, axis])
            assert np.abs(after[:, joint, axis] - expected).max() < 1e-3


def test_contacts_and_labels_stand_at_their_moments_in_a_range_at_another_rate():
    take = take_on(make_character(), make_capture(frames=60))
    spans = (ContactInterval("m", ContactPoint.LEFT_HEEL, 10, 40), ContactInterval("m", ContactPoint.LEFT_TOE, 0, 12))
    take = replace(take, annotations=Annotations(spans, (), (Label("step", 20, 24),)))
    chosen = ExportOptions(begin=0.25, end=0.75, frame_rate=120.0).applied_to(take, Path("out.c3d"))
    assert [(each.first, each.last) for each in chosen.annotations.contacts] == [(0, 50)]
    assert [(each.first, each.last) for each in chosen.annotations.labels] == [(10, 18)]


def test_a_range_in_which_nothing_plays_is_refused(tmp_path):
    take = take_on(make_character(), make_capture(frames=60))
    with pytest.raises(Exception, match=r"plays from second 0\.00 to 0\.98: none of it lies in the range"):
        ExportOptions(begin=2.0).applied_to(take, tmp_path / "out.bvh")
    with pytest.raises(Exception, match="from a second to a later one"):
        ExportOptions(begin=2.0, end=1.0).applied_to(take, tmp_path / "out.bvh")


def test_who_stands_on_a_stage_goes_out_where_it_stands_or_at_its_own_origin():
    take = replace(take_on(make_character(), make_capture()), place=Placement((2.0, -1.0), np.pi / 2))
    before = world(take.capture)
    there = world(ExportOptions().applied_to(take, Path("out.fbx")).capture)
    assert np.abs(there - (before[..., [1, 0, 2]] * [-1.0, 1.0, 1.0] + [2.0, -1.0, 0.0])).max() < 1e-9
    assert np.abs(world(ExportOptions(at_origin=True).applied_to(take, Path("out.fbx")).capture) - before).max() == 0.0


@pytest.mark.parametrize(
    "options",
    [{"frame_rate": rate} for rate in (0.0, -1.0, float("nan"), float("inf"), 1e9)]
    + [{name: value} for name in ("begin", "end") for value in (float("nan"), float("inf"))]
    + [{"begin": 2.0, "end": 1.0}, {"begin": 99.0}, {"frame_rate": 1e5, "end": 1e3}],
)
def test_frame_rates_and_ranges_that_make_no_file_are_refused_in_a_sentence(options, monkeypatch):
    monkeypatch.setattr("studio.io.export_options.MOST_EXPORTED_FRAMES", 10_000)
    take = take_on(bundled_characters()["adult_woman"], make_capture())
    with pytest.raises(StudioError, match=r"\.$"):
        ExportOptions(**options).applied_to(take, Path("out.fbx"))
