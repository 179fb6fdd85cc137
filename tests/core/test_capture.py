"""Reading of captures: what they are, their numbers, and the body in their skeletons."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

from studio.core.body.body_matching import BodySearch
from studio.core.body.finger_joints import Digit, FingerJoint, find_fingers
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.windows import bell_average, sliding_maximum, sliding_minimum
from studio.io.importing import ImportOptions, load_capture
from tests.builders import BODY_MAP, make_capture, make_skeleton
from tests.io.bvh_text import bvh_text

# A capture agrees with itself, and what the user overrules is no longer a guess.


def test_what_the_user_overrules_is_no_longer_a_guess() -> None:
    guesses = (Guess("floor", "0 m", "near zero"), Guess("unit", "cm", "legs"))
    capture = replace(make_capture(), guesses=guesses).with_floor(-0.2)
    assert capture.floor == -0.2
    assert [guess.subject for guess in capture.guesses] == ["unit"]


def test_body_map_rate_and_start_can_be_overruled() -> None:
    capture = make_capture()
    changed = capture.with_body_map(BODY_MAP | {"head": "Neck", "neck": "Neck"})
    assert changed.body_map is not None
    assert capture.skeleton.names[changed.body_map[BodyPart.HEAD]] == "Neck"
    assert capture.with_frame_rate(24.0).frame_rate == 24.0
    assert capture.with_first_frame(1).duration == pytest.approx((capture.frame_count - 2) / capture.frame_rate)


def test_whole_numbers_become_those_that_kernels_are_compiled_for() -> None:
    capture = make_capture().with_frame_rate(24).with_floor(0)
    assert [type(each) for each in (capture.frame_rate, capture.floor)] == [float, float]
    motion, _ = normalize_capture(capture)
    assert type(replace(motion, frame_rate=30).frame_rate) is float


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"frame_rate": 0.0}, "frame rate or the floor"),
        ({"floor": np.nan}, "frame rate or the floor"),
        ({"first_frame": 10_000}, "has no frame 10000"),
        ({"reference_rotations": np.zeros((2, 4))}, "do not fit"),
    ],
)
def test_a_capture_that_contradicts_itself_is_refused(changes: dict[str, object], sentence: str) -> None:
    capture: Capture = make_capture()
    with pytest.raises(StudioError, match=sentence):
        replace(capture, **changes)  # type: ignore[arg-type]


# Impossible physical numbers are refused wherever they come in.


@pytest.mark.parametrize("unit", ["300", "1e3"])
def test_a_capture_of_bones_of_kilometres_is_refused_in_a_sentence(tmp_path: Path, unit: str) -> None:
    (tmp_path / "far.bvh").write_text(bvh_text())
    with pytest.raises(StudioError, match=r"far\.bvh: A (bone|root position) of .* is out of range"):
        load_capture(tmp_path / "far.bvh", ImportOptions(unit=unit))


# Windows that slide over tracks are those of SciPy, which the reading of captures does without.


@pytest.mark.parametrize("frames", [1, 2, 7, 300])
@pytest.mark.parametrize("sigma", [0.0, 0.4, 3.0, 60.0])
def test_a_track_is_smoothed_as_scipy_does_with_its_ends_held(frames: int, sigma: float) -> None:
    track = np.random.default_rng(frames).normal(size=(frames, 3))
    expected = ndimage.gaussian_filter1d(track, sigma, axis=0, mode="nearest") if sigma else track
    np.testing.assert_allclose(bell_average(track, sigma), expected, atol=1e-14)
    np.testing.assert_allclose(bell_average(track[:, 0], sigma), expected[:, 0], atol=1e-14)


@pytest.mark.parametrize("frames", [1, 5, 200])
@pytest.mark.parametrize("reach", [0, 1, 30])
def test_the_highest_and_the_lowest_of_a_window_are_scipys(frames: int, reach: int) -> None:
    track = np.random.default_rng(reach).normal(size=frames)
    np.testing.assert_array_equal(
        sliding_maximum(track, reach), ndimage.maximum_filter1d(track, 2 * reach + 1, mode="nearest")
    )
    np.testing.assert_array_equal(
        sliding_minimum(track, reach), ndimage.minimum_filter1d(track, 2 * reach + 1, mode="nearest")
    )
    assert sliding_maximum(track > 0.0, reach).dtype == bool


# Fingers are found below the hands by their names in every program's spelling.


def with_chains(*chains: tuple[str, ...]) -> Skeleton:
    """``make_skeleton`` with chains of joints below the left hand."""
    plain = make_skeleton()
    names, parents = list(plain.names), plain.parents.tolist()
    for chain in chains:
        above = names.index("LeftHand")
        for name in chain:
            parents.append(above)
            above = len(names)
            names.append(name)
    offsets = np.concatenate([plain.offsets, np.full((len(names) - plain.joint_count, 3), 0.02)])
    ends = np.concatenate([plain.end_sites, np.zeros(len(names) - plain.joint_count, bool)])
    return Skeleton(tuple(names), np.array(parents), offsets, ends)


SPELLINGS = {
    "HumanIK": ("LeftHandThumb1 LeftHandThumb2 LeftHandThumb3", "LeftHandRing1 LeftHandRing2 LeftHandRing3"),
    "Mixamo with tips": ("L_Thumb1 L_Thumb2 L_Thumb3 L_Thumb4", "L_Ring1 L_Ring2 L_Ring3 L_Ring4"),
    "Perception Neuron": ("LThumb1 LThumb2 LThumb3", "LeftInHandRing LeftHandRing1 LeftHandRing2 LeftHandRing3"),
    "Unreal": ("thumb_01_l thumb_02_l thumb_03_l", "ring_metacarpal_l ring_01_l ring_02_l ring_03_l"),
    "Biped": ("LFinger0 LFinger01 LFinger02", "LFinger3 LFinger31 LFinger32"),
    "MakeHuman": ("finger1-1.L finger1-2.L finger1-3.L", "finger4-1.L finger4-2.L finger4-3.L"),
    "H-Anim": ("l_thumb1 l_thumb2 l_thumb3", "l_ring_proximal l_ring_middle l_ring_distal"),
    "VRM 1": ("leftThumbMetacarpal leftThumbProximal leftThumbDistal", "leftRingProximal leftRingMid leftRingDistal"),
    "H-Anim 4": (
        "l_carpometacarpal_1 l_metacarpophalangeal_1 l_carpal_interphalangeal_1",
        "l_carpometacarpal_4 l_metacarpophalangeal_4 l_carpal_proximal_interphalangeal_4"
        " l_carpal_distal_interphalangeal_4",
    ),
    "MMD": ("左親指０ 左親指１ 左親指２", "左薬指１ 左薬指２ 左薬指３"),
    "palm without a number": ("LThumb1 LThumb2 LThumb3", "LHandRing LHandRing1 LHandRing2 LHandRing3"),
}
IN_PALM = {"LeftInHandRing", "ring_metacarpal_l", "LHandRing", "l_carpometacarpal_4"}


@pytest.mark.parametrize("program", SPELLINGS)
def test_thumb_and_ring_finger_are_found_joint_by_joint(program):
    thumb, ring = (names.split() for names in SPELLINGS[program])
    skeleton = with_chains(tuple(thumb), tuple(ring))
    found = find_fingers(skeleton, BodyMap.from_json(skeleton, BODY_MAP))
    named = {joint: skeleton.names[place] for joint, place in found.items()}
    outside = [name for name in ring if name not in IN_PALM]
    assert named == {FingerJoint(0, Digit.THUMB, place): thumb[place] for place in range(3)} | {
        FingerJoint(0, Digit.RING, place): outside[place] for place in range(3)
    }


def test_props_in_a_hand_are_no_fingers():
    skeleton = with_chains(("BowString", "Spring"), ("Sword",))
    assert find_fingers(skeleton, BodyMap.from_json(skeleton, BODY_MAP)) == {}


@pytest.mark.parametrize(
    ("stem", "count"), [("pybvh_test3_fingers", 30), ("rokoko_jesse_dance", 30), ("geno_bind_6ch", 30)]
)
def test_real_captures_have_three_joints_in_every_finger(captures, stem, count):
    [path] = (captures / "bvh").rglob(f"{stem}.bvh")
    capture = load_capture(path)
    assert len(find_fingers(capture.skeleton, capture.body_map)) == 30


# The body in a skeleton: what names propose, topology, bones and symmetry decide.


def _standing(skeleton: Skeleton, frames: int = 5) -> np.ndarray:
    positions = np.array(skeleton.offsets)
    for joint, parent in enumerate(skeleton.parents):
        positions[joint] += positions[parent] if parent >= 0 else 0.0
    return np.tile(positions, (frames, 1, 1))


def _candidates(skeleton: Skeleton, more: Mapping[str, list[str]] | None = None) -> dict[BodyPart, list[int]]:
    names = {part: [joint] for part, joint in BODY_MAP.items() if not part.startswith("spine")}
    for part, extra in (more or {}).items():
        names[part] = extra + names[part]
    return {BodyPart(part): [skeleton.index(joint) for joint in joints] for part, joints in names.items()}


def test_a_plain_body_is_found_whole() -> None:
    skeleton = make_skeleton()
    match = BodySearch(skeleton, _standing(skeleton)).best_match(_candidates(skeleton))
    assert match.body_map is not None
    assert match.body_map.to_json(skeleton) == BODY_MAP


def test_a_joint_in_the_shoulder_itself_is_no_clavicle() -> None:
    """Robots turn their shoulders about one axis after the other, at one place."""
    skeleton = make_skeleton()
    offsets = np.array(skeleton.offsets)
    offsets[skeleton.index("RightArm")] *= 1e-6
    one_place = Skeleton(skeleton.names, skeleton.parents, offsets, skeleton.end_sites)
    match = BodySearch(one_place, _standing(one_place)).best_match(_candidates(one_place))
    assert match.body_map is not None
    assert BodyPart.RIGHT_CLAVICLE not in match.body_map.parts
    assert BodyPart.LEFT_CLAVICLE in match.body_map.parts


def test_a_body_map_survives_json() -> None:
    skeleton = make_skeleton()
    body_map = BodyMap.from_json(skeleton, BODY_MAP)
    assert body_map.to_json(skeleton) == BODY_MAP
    assert body_map.spine == tuple(skeleton.index(name) for name in ("Hips", "Spine", "Chest"))


def test_a_joint_above_the_one_it_should_hang_from_is_not_taken() -> None:
    skeleton = make_skeleton()
    wrong = _candidates(skeleton, {"left_foot": ["LeftUpLeg"], "left_hand": ["LeftShoulder"]})
    match = BodySearch(skeleton, _standing(skeleton)).best_match(wrong)
    assert match.body_map is not None
    assert match.body_map.to_json(skeleton) == BODY_MAP


def test_a_candidate_whose_bone_changes_length_is_not_taken() -> None:
    skeleton = make_skeleton()
    positions = _standing(skeleton)
    positions[:, skeleton.index("LeftToeBase")] *= np.linspace(1.0, 1.3, len(positions))[:, None]
    match = BodySearch(skeleton, positions).best_match(_candidates(skeleton, {"left_foot": ["LeftToeBase"]}))
    assert match.body_map is not None
    assert skeleton.names[match.body_map[BodyPart.LEFT_FOOT]] == "LeftFoot"


def test_a_candidate_unlike_the_other_side_is_not_taken() -> None:
    skeleton = make_skeleton()
    uneven = _candidates(skeleton, {"right_hand": ["RightHandEnd"]})
    match = BodySearch(skeleton, _standing(skeleton)).best_match(uneven)
    assert match.body_map is not None
    assert skeleton.names[match.body_map[BodyPart.RIGHT_HAND]] == "RightHand"


def test_a_missing_limb_is_named() -> None:
    skeleton = make_skeleton()
    candidates = _candidates(skeleton) | {BodyPart.LEFT_SHANK: []}
    match = BodySearch(skeleton, _standing(skeleton)).best_match(candidates)
    assert match.body_map is None
    assert "left leg" in match.missing


def test_a_body_map_without_a_limb_is_refused_with_the_parts() -> None:
    skeleton = make_skeleton()
    with pytest.raises(
        StudioError, match=r"No joint is mapped to left foot\. Choose one in the inspector, under Body map\."
    ):
        BodyMap.from_json(skeleton, {part: joint for part, joint in BODY_MAP.items() if part != "left_foot"})


def test_unknown_parts_and_joints_are_answered_with_those_there_are() -> None:
    skeleton = make_skeleton()
    with pytest.raises(StudioError, match="'tail' is not a part of a body"):
        BodyMap.from_json(skeleton, BODY_MAP | {"tail": "Hips"})
    with pytest.raises(StudioError, match=r"No joint is called 'LeftFot'\. Nearest names: LeftFoot"):
        BodyMap.from_json(skeleton, BODY_MAP | {"left_foot": "LeftFot"})
