"""Remarks on motion that no body makes, with its frames; none on motion that bodies make."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.captures.remarks import Remark, body_remarks, remarks_on
from studio.core.normalized.normalize import normalize_capture
from studio.core.rotations import normalized
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder


@pytest.fixture(scope="module")
def walk() -> Capture:
    return load_capture(example_captures_folder() / "walk_turn.bvh")


def _moved(capture: Capture, joint: int, frames: slice, by: float) -> Capture:
    """With a joint put elsewhere in its parent, in some frames."""
    translations = capture.poses.local_translations.copy()
    translations[frames, joint, 0] += by
    return replace(capture, poses=PoseSequence(capture.poses.local_rotations, translations))


@pytest.mark.parametrize("stem", ["walk_turn", "front_kick", "straight_punch"])
def test_nothing_is_odd_about_a_walk_a_kick_or_a_punch(stem: str) -> None:
    assert remarks_on(load_capture(example_captures_folder() / f"{stem}.bvh")) == ()


def test_hips_that_jump_are_told_with_their_frames(walk: Capture) -> None:
    [remark] = remarks_on(_moved(walk, 0, slice(50, None), 0.5))
    assert remark.spans == ((50, 50),)
    assert "hips jump by up to 5" in remark.sentence


def test_a_jump_of_a_hand_s_breadth_is_told_of_slow_hips_too(walk: Capture) -> None:
    for by, frames in ((0.11, slice(50, None)), (0.11, slice(50, 51))):
        [remark] = remarks_on(_moved(walk, 0, frames, by))
        assert remark.spans[0][0] == 50


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (BodyPart.LEFT_FOOT, "left lower leg changes its length by 21 mm"),
        (BodyPart.RIGHT_TOE, "right foot changes its length by"),
        (BodyPart.LEFT_THIGH, "way to the left thigh changes its length by"),
        (BodyPart.RIGHT_UPPER_ARM, "right clavicle changes its length by"),
        (BodyPart.HEAD, "neck changes its length by"),
        (None, "trunk changes its length by"),
    ],
    ids=["shank", "foot", "hip", "clavicle", "neck", "trunk"],
)
def test_a_bone_that_changes_its_length_is_told(walk: Capture, joint: BodyPart | None, words: str) -> None:
    assert walk.body_map is not None
    end = walk.body_map.spine[-1] if joint is None else walk.body_map[joint]
    moves = walk.poses.local_translations.copy()
    moves[::3, end] *= 1.05 if joint is BodyPart.LEFT_FOOT else 1.2
    stretched = replace(walk, poses=PoseSequence(walk.poses.local_rotations, moves))
    assert any(words in remark.sentence for remark in remarks_on(stretched))


def test_a_body_whose_angles_are_radians_is_told(walk: Capture) -> None:
    turns = Rotation.from_quat(walk.poses.local_rotations.reshape(-1, 4)).as_rotvec() / np.degrees(1.0)
    rotations = Rotation.from_rotvec(turns).as_quat().reshape(walk.poses.local_rotations.shape)
    rotations[:, 0] = walk.poses.local_rotations[:, 0]
    stiff = replace(walk, poses=PoseSequence(rotations, walk.poses.local_translations))
    assert any("may be radians" in remark.words for remark in remarks_on(stiff))


def test_a_foot_that_is_somewhere_else_for_a_frame_is_told(walk: Capture) -> None:
    assert walk.body_map is not None
    odd = remarks_on(_moved(walk, walk.body_map[BodyPart.LEFT_FOOT], slice(50, 51), 0.7))
    assert [remark.spans for remark in odd] == [((50, 51),)]
    assert odd[0].sentence.startswith("The left foot moves at up to 4")


def test_feet_that_point_backwards_are_told(walk: Capture) -> None:
    assert walk.body_map is not None
    sides = {
        part: BodyPart(part.value.replace("left", "rig_ht").replace("right", "left").replace("rig_ht", "right"))
        for part in walk.body_map.parts
    }
    swapped = BodyMap({sides[part]: joint for part, joint in walk.body_map.parts.items()}, walk.body_map.spine)
    [remark] = remarks_on(replace(walk, body_map=swapped))
    assert remark.words == "The feet point backwards: left and right may be swapped."


def test_feet_in_line_with_their_shanks_point_nowhere(walk: Capture) -> None:
    body, offsets, translations = walk.body_map, walk.skeleton.offsets.copy(), walk.poses.local_translations.copy()
    assert body is not None
    for part in (BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT):
        for joint in walk.skeleton.descendants(body[part]):
            translations[:, joint] = offsets[joint] = 0.05 * normalized(offsets[body[part]]) + [-1e-3, 0.0, 0.0]
    straight = replace(walk.skeleton, offsets=offsets)
    poses = PoseSequence(walk.poses.local_rotations, translations)
    assert not any("backwards" in each.words for each in remarks_on(replace(walk, skeleton=straight, poses=poses)))


def _run(speeds: np.ndarray, walk: Capture) -> Capture:
    """The walk carried along so that its hips go at ``speeds`` (F,) metres a second."""
    translations = walk.poses.local_translations[: len(speeds)].copy()
    translations[:, 0, :2] = translations[0, 0, :2]
    translations[:, 0, 0] += np.cumsum(speeds) / walk.frame_rate
    return replace(walk, poses=PoseSequence(walk.poses.local_rotations[: len(speeds)], translations))


def _jumps_in(capture: Capture) -> bool:
    return any("hips jump" in each.words for each in remarks_on(capture))


def test_a_sprint_from_rest_does_not_jump(walk: Capture) -> None:
    frames = np.arange(int(3.0 * walk.frame_rate))
    sprint = 11.0 * (1.0 - np.exp(-np.maximum(frames / walk.frame_rate - 1.5, 0.0) / 0.9))
    assert not _jumps_in(_run(sprint, walk))
    assert _jumps_in(_run(2.0 * sprint, walk))


def test_a_jump_over_three_frames_is_told(walk: Capture) -> None:
    speeds = np.full(90, 1.0)
    speeds[40:43] = 0.3 * walk.frame_rate
    assert _jumps_in(_run(speeds, walk))


def test_a_hand_that_ends_far_from_its_wrist_is_told_and_is_of_usual_length_all_the_same(walk: Capture) -> None:
    assert walk.body_map is not None
    far = walk
    for end in walk.skeleton.children[walk.body_map[BodyPart.RIGHT_HAND]]:
        far = _moved(far, end, slice(None), 1.6)
    [remark] = remarks_on(far)
    assert remark.words.startswith("The right hand ends 1")
    hands = np.linalg.norm(normalize_capture(far)[1].morphology.hand, axis=1)
    assert hands[1] == pytest.approx(0.4 * normalize_capture(walk)[1].morphology.arm[1, 1])
    assert hands[0] == np.linalg.norm(normalize_capture(walk)[1].morphology.hand[0])


def test_a_take_that_hovers_is_told(walk: Capture) -> None:
    assert [remark.spans for remark in remarks_on(walk.with_floor(walk.floor - 0.3))] == [()]


@pytest.mark.parametrize("scale", [0.35, 1.5])
def test_a_dwarf_and_a_giant_are_told(walk: Capture, scale: float) -> None:
    skeleton, poses = walk.skeleton, walk.poses
    other = replace(
        walk,
        skeleton=Skeleton(skeleton.names, skeleton.parents, scale * skeleton.offsets, skeleton.end_sites),
        poses=PoseSequence(poses.local_rotations, scale * poses.local_translations),
    )
    assert any("m tall. Check the unit" in remark.words for remark in remarks_on(other))


def test_limbs_that_are_no_pair_are_told(walk: Capture) -> None:
    assert walk.body_map is not None
    odd = _moved(walk, walk.body_map[BodyPart.LEFT_FOREARM], slice(None), 0.3)
    assert any("swapped" in remark.words for remark in remarks_on(odd))


def test_a_sentence_names_four_spans_at_most() -> None:
    assert Remark("Odd.", tuple((k, k) for k in range(6))).sentence == "Odd. Frames 0, 1, 2, 3 and 2 more."


@pytest.mark.parametrize("name", bundled_characters())
def test_nothing_is_odd_about_bundled_bodies(name: str) -> None:
    assert body_remarks(bundled_characters()[name].build) == ()


@pytest.mark.parametrize(
    ("measure", "value", "words"),
    [
        ("head", 0.9, "m tall"),
        ("arm", [[0.3, 0.25], [0.3, 0.15]], "arms are not a pair"),
        ("leg", [[0.6, 0.2], [0.6, 0.2]], "legs are not in order"),
        ("hip_offset", [[0.0, 0.4, 0.9], [0.0, -0.4, 0.9]], "legs are not in order"),
    ],
)
def test_how_no_body_is_built_is_told(measure: str, value: object, words: str) -> None:
    body = replace(bundled_characters()["adult_woman"].build, **{measure: value})
    assert any(words in remark.sentence for remark in body_remarks(body))


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("frames", [slice(None), slice(40, 41)])
def test_a_bone_of_more_than_a_hundred_metres_is_told_of_any_capture(walk: Capture, known: bool, frames: slice) -> None:
    capture = _moved(walk, 3, frames, 150.0)
    capture = capture if known else replace(capture, body_map=None)
    name = walk.skeleton.names[3]
    assert any(f"{name} is 150 m away from its parent" in each.sentence for each in remarks_on(capture))


def test_a_character_with_a_bone_of_more_than_a_hundred_metres_is_told() -> None:
    body = bundled_characters()["child"].build
    foot = body.foot.copy()
    foot[0, 0] = 150.0
    assert any("150 m long" in each.sentence for each in body_remarks(replace(body, foot=foot)))
