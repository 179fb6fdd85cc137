"""Fingers of a capture on a character that has fingers of its own: each joint turns as it was captured."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from studio.core.body.canonical import BodyPart
from studio.core.body.finger_joints import Digit, FingerJoint, find_fingers
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import Proportions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.constraints.base import BodyPoint
from studio.core.mesh.hand_shapes import grip_round
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.driven_fingers import bound_hands
from studio.core.rigs.played_fingers import fingers_of_capture, on_captured_joints
from studio.core.rigs.zero_pose import with_zero_pose
from studio.core.rotations import (
    angle_between,
    from_matrix,
    from_rotation_vector,
    inverse,
    multiply,
    normalized,
    to_matrix,
)
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from studio.core.stage.prop import InHand, Prop
from studio.engine.posed_performer import posed_performers
from studio.io.export import Take, skin_of, take_of_adapted, take_of_standing, write_take
from studio.io.export_options import ExportOptions
from studio.io.importing import load_capture, load_character
from studio.io.joint_names import joint_namings
from studio.io.project.character_file import bundled_characters
from studio.io.staged_export import take_of_performer
from studio.jobs.performances import prepared_capture, stage_performances
from studio.live.playing_stage import LiveStage
from tests.builders import BODY_MAP, make_capture, make_poses, make_project, make_skeleton
from tests.io.blender import opened_in_blender
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
        for index, digit in enumerate(DIGITS):
            for joint in range(3):
                names.append(f"{letter}Hand{digit}{joint + 1}")
                parents.append(-1 - side if joint == 0 else lowest + len(parents) - 1)
                offsets.append([0.04 - 0.02 * index, 0.09 * way, 0.0] if joint == 0 else [0.0, 0.03 * way, 0.0])
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
    for index in range(count):
        way = 1.0 if index < count // 2 else -1.0
        vectors = np.zeros((frames, 3))
        vectors[:, 0] = -way * CURL[index % 3] * share ** (1 + index // 3 % 5)
        fingers[:, index] = from_rotation_vector(vectors)
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
        hands = bound_hands(plain, character.build, body)
        fingers = fingers_of_capture(capture, adapted.first_frame + frame, 1)
        posed = plain, character.build, body, adapted.positions[frame], adapted.rotations[frame]
        (shown, _), (stiff, _) = (
            skin_vertices(*posed, shaped=partial(hands.shaped, poses=fingers)),
            skin_vertices(*posed),
        )
        written = carried(skin_of(exported), positions[frame], rotations[frame])
        apart = np.linalg.norm(shown - written, axis=1)[hands.rows]
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


@pytest.fixture(scope="module")
def hero(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """The character with fingers, which plays the closing hands."""
    path = tmp_path_factory.mktemp("hero") / "hero.glb"
    write_fingered_character(path)
    return replace(
        make_project(characters=1, constraints=0, contacts=0),
        captures={"capture": fist_capture(60)}, characters={"character 0": load_character(path).character},
    )  # fmt: skip


def playing(hero: Project, *clips: Clip) -> Project:
    """The hero with another row of clips."""
    return hero.with_entity("performers", "performer 0", replace(hero.performers["performer 0"], clips=clips))


ROWS = {
    "cut": (Clip("motion", 20, 50, id="a"),),
    "mirrored": (Clip("motion", 0, 59, id="a", mirrored=True),),
    "twice as fast": (Clip("motion", 0, 59, id="a", speed=2.0),),
    "joined": (Clip("motion", 30, 59, id="a"), Clip("motion", 0, 40, 1.0, id="b")),
    "fists": (Clip("motion", 0, 59, id="a", grip=1.0),),
    "from fists to captured": (Clip("motion", 0, 30, id="a", grip=1.0), Clip("motion", 0, 40, 1.0, id="b")),
}


@pytest.mark.parametrize("row", ROWS)
def test_the_stage_shows_the_fingers_that_are_exported_in_every_row_of_clips(hero: Project, row: str) -> None:
    project = playing(hero, *ROWS[row])
    [(key, performance)] = stage_performances(project).performances.items()
    take = take_of_performer(project, key, performance, along=True)
    character, adapted = take.character, performance.adapted_on_stage
    exported = ExportOptions(at_origin=True).applied_to(take, Path("out.glb"))
    positions, rotations = joint_world(exported.skeleton, exported.poses)
    plain, body = replace(character.skin, centres=character.skin.vertices), character.morphology
    hands, bends = bound_hands(plain, character.build, body), []
    for frame in np.linspace(0, adapted.frame_count - 1, 5).astype(int).tolist():
        time = performance.composite.timing.stage_time(adapted.first_frame + frame)
        [posed] = posed_performers(project, lambda _: performance.adapted, time).values()
        args = plain, character.build, body, adapted.positions[frame], adapted.rotations[frame]
        stiff, shown = skin_vertices(*args)[0], skin_vertices(*args)[0]
        if posed.fingers is not None:
            shown, _ = skin_vertices(*args, shaped=partial(hands.shaped, poses=posed.fingers))
        written = carried(skin_of(exported), positions[frame], rotations[frame])
        apart = np.linalg.norm(shown - written, axis=1)[hands.rows]
        assert np.quantile(apart, 0.9) < 1e-4
        assert apart.max() < 5e-3
        bends.append(float(np.linalg.norm(shown - stiff, axis=1).max()))
    assert max(bends) > 0.02


@pytest.mark.parametrize("suffix", [".bvh", ".fbx", ".glb", ".usda", ".vrma"])
def test_a_mirrored_clip_bends_the_fingers_of_the_other_hand_in_every_kind_of_file(
    hero: Project, tmp_path: Path, suffix: str
) -> None:
    one_hand = fist_capture(60)
    rotations = np.array(one_hand.poses.local_rotations)
    fingers = find_fingers(one_hand.skeleton, one_hand.body_map)
    rotations[:, [joint for each, joint in fingers.items() if each.side == 1]] = [0.0, 0.0, 0.0, 1.0]
    one_hand = replace(one_hand, poses=replace(one_hand.poses, local_rotations=rotations))
    project = playing(hero, *ROWS["mirrored"]).with_entity("captures", "capture", one_hand)
    [(key, performance)] = stage_performances(project).performances.items()
    path = tmp_path / f"out{suffix}"
    write_take(ExportOptions().applied_to(take_of_performer(project, key, performance, along=True), path), path)
    back = load_capture(path)
    own = find_fingers(back.skeleton, back.body_map)
    assert len(own) == 30
    for finger, joint in own.items():
        turned = turned_from_rest(back, joint, back.poses.local_rotations[0, joint])
        like = fingers[finger._replace(side=0)]
        expected = turned_from_rest(one_hand, like, np.array([0.0, 0.0, 0.0, 1.0]))
        assert np.abs(turned - (expected if finger.side == 1 else 0.0)).max() < 1.0, finger


def test_mirrored_fingers_drop_on_the_original_in_blender(hero: Project, tmp_path: Path) -> None:
    original, path = tmp_path / "hero.glb", tmp_path / "out.glb"
    write_fingered_character(original)
    project = playing(hero, *ROWS["mirrored"])
    [(key, performance)] = stage_performances(project).performances.items()
    take = ExportOptions().applied_to(take_of_performer(project, key, performance, along=True), path)
    take = replace(take, capture=replace(take.capture, frame_rate=30.0))
    write_take(take, path)
    frames = take.poses.frame_count
    found = opened_in_blender(original, frames=frames, rate=30.0, action_of=path)
    mesh = max(found["meshes"].values(), key=lambda each: each["vertices"].shape[1])  # another draws Blender's bones
    positions, rotations = joint_world(take.skeleton, take.poses)
    expected = [carried(skin_of(take), positions[frame], rotations[frame]) for frame in range(frames)]
    assert np.abs(mesh["vertices"] - np.array(expected)).max() < 1e-5


def tips_and_knuckles(hero: Project, grip: float) -> tuple[np.ndarray, np.ndarray]:
    """Degrees from the direction of the hand to that of the middle bone of each finger but the thumb, and metres from
    its last joint to the wrist over those of its first, in the exported rig of the hero with a grip.
    """
    project = playing(hero, Clip("motion", 0, 59, id="a", grip=grip))
    [(key, performance)] = stage_performances(project).performances.items()
    take = ExportOptions().applied_to(take_of_performer(project, key, performance, along=True), Path("out.glb"))
    places, body = joint_world(take.skeleton, take.poses)[0][0], take.capture.body_map
    fingers, angles, reach = find_fingers(take.skeleton, body), [], []
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        for digit in list(Digit)[1:]:
            first, middle, last = (places[fingers[FingerJoint(side, digit, index)]] for index in range(3))
            row = [places[fingers[FingerJoint(side, each, 0)]] for each in list(Digit)[1:]]
            ahead, bone = np.mean(row, axis=0) - places[body[part]], last - middle
            angles.append(np.degrees(np.arccos(ahead @ bone / np.linalg.norm(ahead) / np.linalg.norm(bone))))
            reach.append(np.linalg.norm(last - places[body[part]]) / np.linalg.norm(first - places[body[part]]))
    return np.array(angles), np.array(reach)


@pytest.mark.parametrize(("grip", "bend", "nearer"), [(-1.0, 0.0, False), (0.0, 40.0, False), (1.0, 170.0, True)])
def test_a_grip_of_a_clip_opens_or_closes_the_fingers_of_a_dropped_character(hero, grip, bend, nearer) -> None:
    angles, reach = tips_and_knuckles(hero, grip)
    assert angles == pytest.approx(np.full(8, bend), abs=8.0)  # fingers are splayed
    assert (reach < 1.1).all() == nearer


def test_a_held_stick_closes_the_hands_of_a_dropped_character(hero: Project) -> None:
    stick = Prop("Stick", (0.03, 0.03, 1.0), held=InHand("performer 0", BodyPoint(BodyPart.RIGHT_HAND), begin=0.5))
    project = playing(hero, Clip("motion", 0, 59, id="a")).with_entity("props", "stick", stick)
    [(key, performance)] = stage_performances(project).performances.items()
    fingers = take_of_performer(project, key, performance, along=True).fingers
    held = np.arange(60) / performance.adapted.frame_rate - 0.5
    assert (fingers.asked[held > 0.0] == 1.0).all()
    assert (fingers.asked[held < -0.2] == 0.0).all()
    assert fingers.grips[-1] == pytest.approx(grip_round(0.03))


def test_a_live_takeover_moves_fingers_evenly(hero: Project) -> None:
    stage = LiveStage(playing(hero, Clip("motion", 0, 59, id="a", grip=1.0)), prepared_capture)
    character = hero.characters["character 0"]
    hands, turns = bound_hands(character.skin, character.build, character.morphology), []
    grips: list[float] = []
    for step in range(40):
        if step == 15:
            stage.start("performer 0", Clip("motion", 30, 59, id="b", grip=-1.0))
        stage.step(1.0 / 60.0)
        [posed] = posed_performers(stage.staged, stage.results.get, stage.seconds).values()
        turned = hands.drive.rotations(posed.fingers)
        turns.append(from_matrix(np.array([turned[joint][0] for joint in hands.drive.rest.joints.values()])))
        grips.append(posed.grip(0.0))
    middle = np.array(turns)[:, list(hands.drive.rest.joints).index(FingerJoint(0, Digit.INDEX, 0))]
    steps, bent = (np.degrees(angle_between(*each)) for each in ((middle[1:], middle[:-1]), (middle, middle[-1:])))
    assert bent[0] == pytest.approx(90.0, abs=1.0)
    assert (np.diff(bent) < 1e-3).all()  # they open, and bend no other way
    assert steps[:12].max() < 1e-3
    assert steps[-8:].max() < 1e-3
    assert steps.max() < 20.0
    assert (grips[0], grips[-1]) == (1.0, -1.0)
    assert np.abs(np.diff(grips)).max() < 0.4


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


BODY_ROWS = {name: clips for name, clips in ROWS.items() if name != "mirrored"} | {
    "plain": (Clip("motion", 0, 59, id="a"),),
    "mirrored": ROWS["mirrored"],
}


@pytest.mark.parametrize("row", BODY_ROWS)
def test_the_studios_own_skeleton_has_the_fingers_of_every_row_of_clips(hero: Project, row: str) -> None:
    """Each finger joint turns in its parent as that of the character's own rig."""
    project = playing(hero, *BODY_ROWS[row])
    [(key, performance)] = stage_performances(project).performances.items()
    take = take_of_performer(project, key, performance, along=True)
    turns = []
    for options in (ExportOptions(joint_names="unreal"), ExportOptions()):
        written = options.applied_to(take, Path("out.glb")).capture
        fingers = find_fingers(written.skeleton, written.body_map)
        assert len(fingers) == 30
        world = joint_world(written.skeleton, written.poses)[1]
        hands = [written.body_map[part] for part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)]
        in_hand = {
            finger: np.swapaxes(world[:, hands[finger.side]], 1, 2) @ world[:, joint]
            for finger, joint in fingers.items()
        }
        turns.append({key: each @ np.swapaxes(each[:1], 1, 2) for key, each in in_hand.items()})
    assert {"index_01_l", "thumb_03_r"} <= set(
        ExportOptions(joint_names="unreal").applied_to(take, Path("out.fbx")).skeleton.names
    )
    for finger in turns[0]:
        angles = [
            np.degrees(np.arccos(np.clip((np.trace(each[finger], axis1=1, axis2=2) - 1) / 2, -1, 1))) for each in turns
        ]
        assert np.abs(angles[0] - angles[1]).max() < 2.0, finger


def test_fingers_of_a_capture_on_its_own_joints_are_those_that_were_captured() -> None:
    capture = fist_capture(60)
    again = on_captured_joints(capture, fingers_of_capture(capture, 0, 60))
    for joint in find_fingers(capture.skeleton, capture.body_map).values():
        apart = angle_between(again.local_rotations[:, joint], capture.poses.local_rotations[:, joint])
        assert np.degrees(apart).max() < 1e-3


@pytest.mark.parametrize("names", ["humanik", "mixamo", "unreal", "unity", "biped", "blender"])
def test_exported_fingers_have_the_names_of_the_other_program_and_are_found_again(
    hero: Project, tmp_path: Path, names: str
) -> None:
    project = playing(hero, *ROWS["joined"])
    [(key, performance)] = stage_performances(project).performances.items()
    path = tmp_path / "out.fbx"
    options = ExportOptions(joint_names=names)
    write_take(options.applied_to(take_of_performer(project, key, performance, along=True), path), path)
    back = load_capture(path)
    assert set(joint_namings()[names].fingers.values()) <= set(back.skeleton.names)
    assert len(find_fingers(back.skeleton, back.body_map)) == 30
