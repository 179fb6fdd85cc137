"""The body in a skeleton: what names propose, topology, bones and symmetry decide."""

from collections.abc import Mapping

import numpy as np
import pytest

from studio.core.body.body_matching import BodySearch
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from tests.builders import BODY_MAP, make_skeleton


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
    with pytest.raises(StudioError, match=r"No joint plays left foot\. Choose one in the inspector, under Body map\."):
        BodyMap.from_json(skeleton, {part: joint for part, joint in BODY_MAP.items() if part != "left_foot"})


def test_unknown_parts_and_joints_are_answered_with_those_there_are() -> None:
    skeleton = make_skeleton()
    with pytest.raises(StudioError, match="'tail' is not a part of a body"):
        BodyMap.from_json(skeleton, BODY_MAP | {"tail": "Hips"})
    with pytest.raises(StudioError, match=r"No joint is called 'LeftFot'\. Nearest names: LeftFoot"):
        BodyMap.from_json(skeleton, BODY_MAP | {"left_foot": "LeftFot"})
