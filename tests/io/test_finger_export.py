"""Fingers of a capture on a character that has fingers of its own: each joint turns as it was captured."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from studio.core.body.canonical import BodyPart
from studio.core.body.finger_joints import Digit, find_fingers
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import Proportions
from studio.core.body.pose import PoseSequence
from studio.core.body.rest_pose import rest_pose
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.driven_fingers import hand_pose
from studio.core.rigs.zero_pose import with_zero_pose
from studio.core.rotations import angle_between, from_rotation_vector, inverse, multiply, normalized, to_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.engine.performance import posed_performers
from studio.io.export import Take, skin_of, take_of_adapted, take_of_standing, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import load_capture, load_character
from studio.io.project.character_file import bundled_characters
from tests.builders import BODY_MAP, make_capture, make_poses, make_project, make_skeleton
from tests.io.test_fbx_take import carried

DIGITS = ("Thumb", "Index", "Middle", "Ring", "Pinky")
CURL = np.radians([35.0, 60.0, 40.0])
"""Greatest turns of the three joints of each finger."""


def finger_chains(lowest: int) -> tuple[list[str], list[int], list[list[float]]]:
    """Names, parents and offsets of five fingers on the hands at ``lowest`` and ``lowest + 1`` of a list of carriers.

    In a T-pose with palms down: fingers on along the arm, thumbs in front.
    """
    names, parents, offsets = [], [], []
    for side, (letter, way) in enumerate((("Left", 1.0), ("Right", -1.0))):
        for place, digit in enumerate(DIGITS):
            for joint in range(3):
                names.append(f"{letter}Hand{digit}{joint + 1}")
                parents.append(-1 - side if joint == 0 else lowest + len(parents) - 1)
                offsets.append([0.04 - 0.02 * place, 0.09 * way, 0.0] if joint == 0 else [0.0, 0.03 * way, 0.0])
    return names, parents, offsets


def with_fingers(skeleton: Skeleton) -> Skeleton:
    """The skeleton with five fingers on each hand."""
    names, parents, offsets = finger_chains(skeleton.joint_count)
    hands = [skeleton.index("LeftHand"), skeleton.index("RightHand")]
    parents = [hands[-1 - parent] if parent < 0 else parent for parent in parents]
    return Skeleton(
        (*skeleton.names, *names), np.concatenate([skeleton.parents, parents]),
        np.concatenate([skeleton.offsets, offsets]),
        np.concatenate([skeleton.end_sites, np.zeros(len(names), bool)]),
    )  # fmt: skip


def fist_capture(frames: int = 30) -> Capture:
    """A capture whose fingers close one after the other, about an axis across the hand."""
    skeleton = with_fingers(make_skeleton())
    body = make_poses(make_skeleton(), frames)
    count = len(DIGITS) * 6
    fingers = np.zeros((frames, count, 4))
    share = np.linspace(0.0, 1.0, frames)
    for place in range(count):
        way = 1.0 if place < count // 2 else -1.0
        vectors = np.zeros((frames, 3))
        vectors[:, 0] = -way * CURL[place % 3] * share ** (1 + place // 3 % 5)
        fingers[:, place] = from_rotation_vector(vectors)
    poses = PoseSequence(
        np.concatenate([body.local_rotations, fingers], axis=1),
        np.concatenate([body.local_translations, np.tile(skeleton.offsets[-count:], (frames, 1, 1))], axis=1),
    )
    return make_capture(
        skeleton=skeleton, poses=poses, body_map=BodyMap.from_json(skeleton, BODY_MAP),
        reference_rotations=np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.joint_count, 1)),
    )  # fmt: skip


def write_fingered_character(path: Path) -> None:
    """The file of a character with five fingers on each hand, the axes of all joints odd."""
    take = take_of_standing(bundled_characters()["adult_woman"])
    skeleton, skin = with_fingers(take.skeleton), skin_of(take)
    added = skeleton.joint_count - take.skeleton.joint_count
    poses = PoseSequence(
        np.concatenate([take.poses.local_rotations, np.tile([0.0, 0.0, 0.0, 1.0], (1, added, 1))], axis=1),
        np.concatenate([take.poses.local_translations, skeleton.offsets[None, -added:]], axis=1),
    )
    capture = replace(
        take.capture, skeleton=skeleton, poses=poses,
        reference_rotations=np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.joint_count, 1)),
    )  # fmt: skip
    odd = to_matrix(normalized(np.random.default_rng(3).normal(size=(skeleton.joint_count, 4))))
    capture = with_zero_pose(capture, odd)
    places, turns = joint_world(capture.skeleton, capture.poses)
    joints, weights = np.array(skin.joints), np.array(skin.weights)
    for side in ("Left", "Right"):  # hands hang from the nearest joints of their fingers
        fingers = [
            joint for joint, name in enumerate(skeleton.names) if name.startswith(f"{side}Hand") and name[-1] in "123"
        ]
        of_hand = np.flatnonzero((joints[:, 0] == skeleton.index(f"{side}Hand")) & (weights[:, 0] > 0.99))
        nearest = cKDTree(places[0, fingers]).query(skin.vertices[of_hand])[1]
        joints[of_hand, 0], joints[of_hand, 1:] = np.array(fingers)[nearest], 0
        weights[of_hand] = [1.0, 0.0, 0.0, 0.0]
    skin = replace(skin, joints=joints, weights=weights, bind_positions=places[0], bind_rotations=turns[0])
    write_take(replace(take, capture=capture, bound=skin, rest_rotations=capture.poses.local_rotations[0]), path)


@pytest.fixture(scope="module")
def take(tmp_path_factory: pytest.TempPathFactory) -> Take:
    """The closing hands on the character with fingers, which carries the capture's along."""
    path = tmp_path_factory.mktemp("fingers") / "hero.glb"
    write_fingered_character(path)
    character = load_character(path).character
    capture = fist_capture()
    motion, actor = normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology, actor=actor.morphology)
    adapted = adapt(request, capture.first_frame)
    return take_of_adapted(character.name, adapted, character, request, (capture, actor))


def turned_from_rest(capture: Capture, joint: int, rest: np.ndarray) -> np.ndarray:
    """(F,) degrees by which a joint has turned in its parent from its local rotation ``rest``."""
    away = multiply(inverse(rest), capture.poses.local_rotations[:, joint])
    return np.degrees(angle_between(away, np.array([0.0, 0.0, 0.0, 1.0])))


@pytest.mark.parametrize("suffix", [".bvh", ".fbx", ".glb", ".gltf", ".usda"])
def test_each_joint_of_each_finger_turns_as_captured_in_every_kind_of_file(take: Take, tmp_path: Path, suffix) -> None:
    source, path = fist_capture(), tmp_path / f"out{suffix}"
    chosen = ExportOptions().applied_to(take, path)
    write_take(chosen, path)
    back = load_capture(path)
    assert back.poses.frame_count == source.frame_count
    theirs, own = (find_fingers(each.skeleton, each.body_map) for each in (source, back))
    assert len(own) == len(theirs) == 30
    for finger, joint in own.items():
        expected = turned_from_rest(source, theirs[finger], np.array([0.0, 0.0, 0.0, 1.0]))
        turned = turned_from_rest(back, joint, back.poses.local_rotations[0, joint])  # the first frame is open
        assert np.abs(turned - expected).max() < 1.0, finger


def test_fingers_close_on_the_palm(take: Take) -> None:
    capture = ExportOptions().applied_to(take, Path("out.glb")).capture
    places = joint_world(capture.skeleton, capture.poses)[0]
    source = fist_capture()
    expected = joint_world(source.skeleton, source.poses)[0]
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        bends = []
        for each, at in ((capture, places), (source, expected)):
            fingers = find_fingers(each.skeleton, each.body_map)
            row = {finger: joint for finger, joint in fingers.items() if finger.side == side}
            base = {digit: at[:, joint] for (_, digit, place), joint in row.items() if place == 0}
            tip = {digit: at[:, joint] for (_, digit, place), joint in row.items() if place == 2}
            across = base[Digit.INDEX] - base[Digit.LITTLE]
            along = base[Digit.MIDDLE] - at[:, each.body_map[part]]
            out = np.cross(along, across)
            bent = tip[Digit.MIDDLE] - base[Digit.MIDDLE]
            bends.append(np.sum(bent * out, axis=1) / np.linalg.norm(out, axis=1) / np.linalg.norm(bent, axis=1))
        assert np.abs(bends[0] - bends[1]).max() < 0.02
        assert np.abs(bends[1]).max() > 0.5


def assert_shown_as_exported(take: Take, capture: Capture, frames: tuple[int, ...]) -> float:
    """The fingers on the stage are where those of the file are; metres by which they bend at most."""
    character, adapted = take.character, take.adapted
    exported = ExportOptions(at_origin=True).applied_to(take, Path("out.glb"))
    positions, rotations = joint_world(exported.skeleton, exported.poses)
    plain, body, bends = replace(character.skin, centres=character.skin.vertices), character.morphology, 0.0
    for frame in frames:
        pose = hand_pose(plain, character.build, body, capture, adapted.first_frame + frame)
        posed = plain, character.build, body, adapted.positions[frame], adapted.rotations[frame]
        (shown, _), (stiff, _) = skin_vertices(*posed, shaped=pose.shaped), skin_vertices(*posed)
        written = carried(skin_of(exported), positions[frame], rotations[frame])
        apart = np.linalg.norm(shown - written, axis=1)[pose.rows]
        assert np.quantile(apart, 0.9) < 1e-4  # the studio keeps four influences of a vertex
        assert apart.max() < 5e-3
        bends = max(bends, float(np.linalg.norm(shown - stiff, axis=1).max()))
    return bends


@pytest.mark.parametrize("scaled", [{}, {"hands": 1.4, "stature": 0.8}])
def test_the_stage_shows_the_fingers_that_are_exported(take: Take, scaled: dict[str, float]) -> None:
    character, capture = replace(take.character, proportions=Proportions(**scaled)), fist_capture()
    motion, actor = normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology, actor=actor.morphology)
    adapted = adapt(request, capture.first_frame)
    moving = take_of_adapted("hero", adapted, character, request, (capture, actor))
    assert assert_shown_as_exported(moving, capture, (0, 15, 29)) > 0.02


def test_fingers_are_shown_where_a_clip_plays_unchanged() -> None:
    project = make_project(characters=1)
    [(performer_id, performer)] = project.performers.items()
    [clip] = performer.clips
    [capture_id] = project.captures
    project = project.with_entity("captures", capture_id, fist_capture())
    motion = AdaptedMotion(
        project.characters[performer.character_id].morphology, 30.0, 0,
        *(each[None] for each in rest_pose(project.characters[performer.character_id].morphology)), np.empty((0, 1)),
    )  # fmt: skip
    [posed] = posed_performers(project, lambda _: motion, 0.0).values()
    assert posed.capture is project.captures[capture_id]
    mirrored = replace(performer, clips=(replace(clip, mirrored=True),))
    project = project.with_entity("performers", performer_id, mirrored)
    [posed] = posed_performers(project, lambda _: motion, 0.0).values()
    assert posed.capture is None


def test_without_captured_fingers_hands_keep_their_shape(take: Take) -> None:
    plain = make_capture()
    request = AdaptRequest(normalize_capture(plain)[0], take.character.morphology)
    still = take_of_adapted("hero", adapt(request, plain.first_frame), take.character, request)
    chosen = ExportOptions().applied_to(still, Path("out.glb"))
    for joint in find_fingers(chosen.skeleton, chosen.capture.body_map).values():
        assert turned_from_rest(chosen.capture, joint, chosen.rest_rotations[joint]).max() < 1e-3


def test_at_another_rate_the_own_rig_moves_evenly_between_frames(take: Take) -> None:
    own = ExportOptions().applied_to(take, Path("out.glb"))
    chosen = ExportOptions(frame_rate=4.0 * own.frame_rate).applied_to(take, Path("out.glb"))
    places, between = (joint_world(each.skeleton, each.poses)[0] for each in (own, chosen))
    hips = own.capture.body_map[BodyPart.PELVIS]
    assert np.abs(between[::4] - places).max() < 1e-9
    middle = (places[1:] + places[:-1]) / 2
    assert np.abs(between[2::4][: len(middle), hips] - middle[:, hips]).max() < 1e-9


def test_fingers_of_a_real_capture_turn_on_a_real_character(captures: Path) -> None:
    character = load_character(captures / "characters" / "joe_hanim_kick.x3dv").character
    [path] = (captures / "bvh").rglob("pybvh_test3_fingers.bvh")
    capture = load_capture(path)
    motion, actor = normalize_capture(capture)
    request = AdaptRequest(motion, character.morphology, actor=actor.morphology)
    adapted = adapt(request, capture.first_frame)
    moving = take_of_adapted("joe", adapted, character, request, (capture, actor))
    assert assert_shown_as_exported(moving, capture, (0, 40, 99)) > 0.005
    chosen = ExportOptions().applied_to(moving, Path("out.fbx"))
    theirs, own = (find_fingers(each.skeleton, each.body_map) for each in (capture, chosen.capture))
    assert set(theirs) == set(own)
    for finger, joint in own.items():
        source = turned_from_rest(capture, theirs[finger], capture.poses.local_rotations[0, theirs[finger]])
        turned = turned_from_rest(chosen.capture, joint, chosen.poses.local_rotations[0, joint])
        if finger.place:  # the first joint turns in the bones of the palm too
            assert np.abs(turned - source).max() < 1.0, finger
