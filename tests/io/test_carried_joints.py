"""Fingers, eyes, twist bones and props of a capture, carried along by any character into the files of its motion."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.read_back import gltf_motion
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.mesh.character import Character
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.carried_joints import carried_joints
from studio.core.rigs.character_skeleton import joint_segments, t_pose_rotations
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import Take, take_of_adapted, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import load_capture
from studio.io.project.character_file import actor_character, bundled_characters
from tests.builders import BODY_MAP, make_capture
from tests.io.bvh_exports import EXTRAS, body, with_extras
from tests.io.khronos import issues_of

FILE_TO_WORLD = [2, 0, 1]


def take_on(character: Character, capture: Capture) -> tuple[Take, SourceRig]:
    """The capture on a character that carries all of it along."""
    motion, actor = normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology, actor=actor.morphology)
    adapted = adapt(request, capture.first_frame)
    return take_of_adapted(character.name, adapted, character, request, (capture, actor)), actor


def captured(capture: Capture, take: Take) -> PoseSequence:
    """The frames that were adapted."""
    assert take.adapted is not None
    return capture.poses.frames(take.adapted.first_frame, take.adapted.first_frame + take.adapted.frame_count - 1)


def check_fingers(capture: Capture, take: Take, actor: SourceRig, back: Capture) -> None:
    """In the file every carried joint is turned, in the axes of the segment that carries it, as it was captured."""
    assert take.adapted is not None
    body = take.adapted.morphology
    segment_of = dict(enumerate(joint_segments(body.layout)))
    assert capture.body_map is not None
    carried = carried_joints(capture.skeleton, capture.body_map)
    turns: dict[int, np.ndarray] = {}
    own = len(segment_of)
    poses = captured(capture, take)
    for index, joint in enumerate(carried, own):
        parent = int(take.skeleton.parents[index])
        if parent < own:
            source = int(capture.skeleton.parents[joint])
            segment = actor.segment_joints.tolist().index(source)
            turns[index] = t_pose_rotations(body)[segment_of[parent]] @ actor.alignments[segment].T
        else:
            turns[index] = turns[parent]
        if take.skeleton.end_sites[index]:
            continue
        written = back.poses.local_rotations[:, back.skeleton.index(take.skeleton.names[index])].copy()
        written[:, :3] = written[:, :3] @ turns[index]  # C^T from the left of every vector
        off = np.degrees(angle_between(written, poses.local_rotations[:, joint]))
        assert off.max() < 1e-4, take.skeleton.names[index]


@pytest.mark.parametrize("name", ["child", "giant"])
def test_on_another_body_they_turn_as_they_were_captured(tmp_path: Path, name: str) -> None:
    capture = with_extras()
    take, actor = take_on(bundled_characters()[name], capture)
    write_take(take, tmp_path / "out.bvh")
    back = load_capture(tmp_path / "out.bvh")
    assert set(EXTRAS) < set(back.skeleton.names)
    check_fingers(capture, take, actor, back)
    arms = take.adapted.morphology.arm.sum(axis=1) / actor.morphology.arm.sum(axis=1)
    for extra, ratio in (("Thumb1", arms[0]), ("Thumb2", arms[0]), ("Sword", arms[1])):
        lengths = [np.linalg.norm(each.skeleton.offsets[each.skeleton.index(extra)]) for each in (back, capture)]
        assert lengths[0] == pytest.approx(ratio * lengths[1], rel=1e-6)


def test_on_the_actors_own_body_they_are_where_they_were(tmp_path: Path) -> None:
    capture = with_extras()
    take, actor = take_on(actor_character("Actor", normalize_capture(capture)[1].morphology), capture)
    write_take(take, tmp_path / "out.bvh")
    back = load_capture(tmp_path / "out.bvh")
    places, expected = (joint_world(each.skeleton, each.poses)[0] for each in (back, capture))
    for extra in EXTRAS:
        off = places[:, back.skeleton.index(extra)] - expected[:, capture.skeleton.index(extra)] + actor.origin
        assert np.linalg.norm(off, axis=1).max() < 1e-5, extra


@pytest.mark.parametrize("stem", ["pybvh_test3_fingers", "rokoko_jesse_dance", "cmu_135_04"])
def test_fingers_of_real_captures_travel_to_a_giant_and_to_their_own_actor(
    captures: Path, tmp_path: Path, stem: str
) -> None:
    [path] = (captures / "bvh").rglob(f"{stem}.bvh")
    capture = load_capture(path)
    capture = replace(capture, poses=capture.poses.frames(0, min(capture.frame_count, 120) - 1))
    take, actor = take_on(bundled_characters()["giant"], capture)
    write_take(take, tmp_path / "giant.bvh")
    back = load_capture(tmp_path / "giant.bvh")
    check_fingers(capture, take, actor, back)
    assert back.body_map is not None
    assert take.capture.body_map is not None
    assert back.body_map.to_json(back.skeleton) == take.capture.body_map.to_json(take.skeleton)
    own, actor = take_on(actor_character("Actor", actor.morphology), capture)
    write_take(own, tmp_path / "own.bvh")
    back = load_capture(tmp_path / "own.bvh")
    places, rotations = joint_world(back.skeleton, back.poses)
    expected, turned = joint_world(capture.skeleton, captured(capture, own))
    fingers = [name for name in capture.skeleton.names if name in back.skeleton.names and "umb" in name]
    assert fingers
    for name in fingers:
        mine, theirs = back.skeleton.index(name), capture.skeleton.index(name)
        off = places[:, mine] - expected[:, theirs] + actor.origin
        assert np.linalg.norm(off, axis=1).max() < 1e-4, name
        between = from_matrix(np.swapaxes(turned[:, theirs], 1, 2) @ rotations[:, mine])
        assert np.degrees(angle_between(between, between[:1])).max() < 0.01, name


def test_what_hangs_from_nothing_of_the_body_stays_where_it_was_recorded() -> None:
    skeleton, poses = body()
    names = ("World", *skeleton.names, "Box", "Lid", "LeftArm_Box")
    parents = np.array([-1, *(skeleton.parents + 1), 0, len(names) - 3, 0])
    parents[1] = 0
    boxes = np.array([[1.0, 0.5, 0.0], [0.0, 0.0, 0.3], [2.0, 0.0, 0.0]])
    whole = Skeleton(
        names, parents, np.concatenate([np.zeros((1, 3)), skeleton.offsets, boxes]),
        np.array([False, *skeleton.end_sites, False, False, False]),
    )  # fmt: skip
    frames = poses.frame_count
    still = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 1, 1))
    turning = np.stack([np.sin(np.linspace(0.0, 1.0, frames)), *np.zeros((2, frames)), np.ones(frames)], axis=1)
    turning /= np.linalg.norm(turning, axis=1, keepdims=True)
    capture = make_capture(
        skeleton=whole,
        poses=PoseSequence(
            np.concatenate([still, poses.local_rotations, turning[:, None], still, still], axis=1),
            np.concatenate(
                [np.zeros((frames, 1, 3)), poses.local_translations, np.tile(boxes, (frames, 1, 1))], axis=1
            ),
        ),
        body_map=BodyMap.from_json(whole, BODY_MAP),
        reference_rotations=np.tile([0.0, 0.0, 0.0, 1.0], (len(names), 1)),
    )
    take, actor = take_on(bundled_characters()["child"], capture)
    assert "World" not in take.skeleton.names
    places, expected = joint_world(take.skeleton, take.poses)[0], joint_world(whole, capture.poses)[0]
    for name in ("Box", "Lid", "LeftArm_Box"):
        off = places[:, take.skeleton.index(name)] - expected[:, whole.index(name)] + actor.origin
        assert np.linalg.norm(off, axis=1).max() < 1e-9, name


def test_names_that_the_character_has_itself_get_a_mark() -> None:
    capture = with_extras()
    names = tuple("LeftHandEnd" if name == "Sword" else f"{name}_" if name.endswith("End") else name
                  for name in capture.skeleton.names)  # fmt: skip
    capture = replace(capture, skeleton=replace(capture.skeleton, names=names))
    take, _ = take_on(bundled_characters()["child"], capture)
    assert "LeftHandEnd_" in take.skeleton.names


def test_glb_and_usd_have_them_with_the_skin(tmp_path: Path) -> None:
    take, _ = take_on(bundled_characters()["child"], with_extras())
    write_take(take, tmp_path / "out.glb")
    issues = issues_of(tmp_path / "out.glb")
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"][:5]
    skeleton, poses = gltf_motion(tmp_path / "out.glb")
    assert skeleton.names == take.skeleton.names
    off = joint_world(skeleton, poses)[0][..., FILE_TO_WORLD] - joint_world(take.skeleton, take.poses)[0]
    assert np.linalg.norm(off, axis=2).max() < 1e-4
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdSkel

    write_take(take, tmp_path / "out.usdc")
    stage = Usd.Stage.Open(str(tmp_path / "out.usdc"))
    [joints] = [UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton)]
    assert tuple(joints.GetJointNamesAttr().Get()) == take.skeleton.names


@pytest.mark.parametrize("options", [ExportOptions(rest_pose="own"), ExportOptions(joint_names="unreal")])
def test_rest_poses_and_names_of_joints_hold_for_them_too(tmp_path: Path, options: ExportOptions) -> None:
    take, _ = take_on(bundled_characters()["giant"], with_extras())
    path = tmp_path / "out.bvh"
    written = options.applied_to(take, path)
    write_take(written, path)
    back = load_capture(path)
    places, expected = (joint_world(each.skeleton, each.poses)[0] for each in (back, take.capture))
    for extra in EXTRAS:
        joint = take.skeleton.index(extra)
        renamed = written.skeleton.names[joint]  # joints of fingers have names in the convention too
        off = places[:, back.skeleton.index(renamed)] - expected[:, joint]
        assert np.linalg.norm(off, axis=1).max() < 1e-5, extra


def test_skeletons_carry_them_unless_they_are_left_out_and_tables_never() -> None:
    assert all(ExportOptions().carries(Path(f"kick{suffix}")) for suffix in (".bvh", ".GLB", ".usd"))
    assert not ExportOptions(body_only=True).carries(Path("kick.bvh"))
    assert not ExportOptions().carries(Path("kick.csv"))
