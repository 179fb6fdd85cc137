"""Weights: equals share by theirs, and each segment of a chain moves as freely as its own says, on every body."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.constraints.base import SINGLE, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.normalized.normalize import normalize_capture
from studio.core.quality.metrics import contact_quality
from studio.core.rotations import angle_between, from_matrix
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_skeleton
from tests.core.grounding import adapt_again
from tests.core.motions import local_rotations, target, walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
TRUNK, ALL = Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
MET = 2e-4


def _still() -> Any:
    """A body with its arms held out, its left the mirror of its right."""
    skeleton = make_skeleton()
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (2, skeleton.joint_count, 1))
    poses = PoseSequence(turns, np.tile(skeleton.offsets, (2, 1, 1)))
    return normalize_capture(make_capture("still", 2, skeleton=skeleton, poses=poses))[0]


STILL = _still()


def _walking(body: Morphology, *constraints: PositionConstraint) -> AdaptedMotion:
    return adapt_again(AdaptRequest(WALK, body, CONTACTS, constraints), 30, 30)


def _reach(body: Morphology, chain: Chain, **changes: Any) -> PositionConstraint:
    """The left wrist on a place that it can reach with the help of the trunk."""
    wrist = _walking(body).positions[0, body.layout.wrist_point(0)]
    return target("left_forearm", wrist + np.array([0.2, 0.14, 0.2]) * body.stature, chain, **changes)


def _angle(first: np.ndarray, second: np.ndarray) -> float:
    return float(angle_between(from_matrix(first), from_matrix(second)))


def _misses(body: Morphology, chain: Chain, left: float, right: float, apart: float = 0.3) -> np.ndarray:
    """(2,) metres by which both wrists, pulled apart by ``apart`` beyond their reach, are missed."""
    wrists = adapt_again(AdaptRequest(STILL, body), 0, 0).positions[
        0, [body.layout.wrist_point(0), body.layout.wrist_point(1)]
    ]
    wishes = [
        target(f"{side}_forearm", wrist + np.array([0.3, sign * apart, -0.1]), chain, weight=weight)
        for side, wrist, sign, weight in zip(("left", "right"), wrists, (1.0, -1.0), (left, right), strict=True)
    ]
    return adapt_again(AdaptRequest(STILL, body, (), tuple(wishes)), 0, 0).residuals[:, 0]


@pytest.mark.parametrize("chain", [TRUNK, ALL], ids=["trunk", "all"])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@given(weight=st.floats(0.1, 10.0), ratio=st.floats(1.05, 20.0), apart=st.floats(0.2, 0.5))
@settings(max_examples=15)
def test_of_two_equals_that_cannot_both_be_met_the_heavier_is_missed_less_and_swapped_weights_swap_the_misses(
    body: Morphology, chain: Chain, weight: float, ratio: float, apart: float
) -> None:
    heavy, light = _misses(body, chain, weight * ratio, weight, apart)
    even = _misses(body, chain, weight, weight, apart)
    assert heavy < even[0] < light
    # Joints are eliminated left before right, and a search that far out of reach ends after six steps.
    assert even[0] == pytest.approx(even[1], abs=1e-3)
    assert _misses(body, chain, weight, weight * ratio, apart) == pytest.approx([light, heavy], abs=2e-3)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_the_heavier_the_less_it_is_missed_and_only_the_ratio_counts(body: Morphology) -> None:
    heavier = [_misses(body, ALL, weight, 1.0) for weight in (1.0, 1.5, 2.0, 3.0)]
    assert (np.diff([left for left, _ in heavier]) < 0.0).all()
    assert (np.diff([right for _, right in heavier]) > 0.0).all()
    assert np.array_equal(_misses(body, ALL, 2.0, 1.0), _misses(body, ALL, 1.0, 0.5))


@pytest.mark.parametrize("weight", [1e-300, 0.01, 7.0, 1e6])
def test_the_weight_of_one_alone_changes_nothing_and_none_is_too_large(weight: float) -> None:
    body = BODIES["adult_woman"]
    asked = _reach(body, ALL)
    assert np.array_equal(_walking(body, replace(asked, weight=weight)).positions, _walking(body, asked).positions)
    assert np.isfinite(_misses(body, ALL, weight, 1.0)).all()


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_equals_that_can_both_be_met_are_met_whatever_their_weights(body: Morphology) -> None:
    wrists = _walking(body).positions[0, [body.layout.wrist_point(0), body.layout.wrist_point(1)]]
    wishes = [
        target(f"{side}_forearm", wrist + np.array([0.1, 0.0, 0.1]), ALL, weight=weight)
        for side, wrist, weight in zip(("left", "right"), wrists, (1.0, 30.0), strict=True)
    ]
    assert _walking(body, *wishes).residuals.max() < MET


@pytest.mark.parametrize("locked", [BodyPart.ABDOMEN, BodyPart.THORAX, BodyPart.LEFT_CLAVICLE], ids=str)
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_locked_segment_keeps_its_rotation_in_the_one_that_carries_it(body: Morphology, locked: BodyPart) -> None:
    segments = [
        segment for segment in range(body.layout.segment_count) if body.layout.part_of_segment(segment) == locked
    ]
    free, kept = _reach(body, ALL), _reach(body, replace(ALL, segments=((locked, 0.0),)))
    before = local_rotations(_walking(body))[0, segments]
    assert np.abs(local_rotations(_walking(body, free))[0, segments] - before).max() > 1e-3
    assert np.abs(local_rotations(_walking(body, kept))[0, segments] - before).max() < 1e-6
    assert _walking(body, kept).residuals.max() < MET


@pytest.mark.parametrize("stiff", [Chain(trunk=0.2, root=1.0), replace(ALL, segments=((BodyPart.ABDOMEN, 0.2),))])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_stiffer_trunk_turns_less_for_the_same_target(body: Morphology, stiff: Chain) -> None:
    abdomen = body.layout.segment_of_part(BodyPart.ABDOMEN)
    before = local_rotations(_walking(body))[0, abdomen]
    turns = [_angle(local_rotations(_walking(body, _reach(body, chain)))[0, abdomen], before) for chain in (ALL, stiff)]
    assert turns[1] < 0.6 * turns[0]


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_pelvis_with_a_weight_turns_and_the_feet_stay(body: Morphology) -> None:
    freed = replace(ALL, segments=((BodyPart.PELVIS, 1.0),))
    before, usual, turned = _walking(body), _walking(body, _reach(body, ALL)), _walking(body, _reach(body, freed))
    assert usual.rotations[0, 0] == pytest.approx(before.rotations[0, 0], abs=1e-12)
    assert _angle(turned.rotations[0, 0], before.rotations[0, 0]) > 0.02
    assert turned.residuals.max() < MET
    for chain in (freed, replace(freed, root=0.0)):
        walked = adapt_again(AdaptRequest(WALK, body, CONTACTS, (_reach(body, chain),)))
        assert contact_quality(walked, CONTACTS, Ground()).slide < 1.2e-3


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_segments_with_the_weights_of_their_groups_are_as_none_to_the_bit(body: Morphology) -> None:
    chain = Chain(clavicle=0.5, trunk=0.7, root=1.0)
    asked = _reach(body, chain)
    same = replace(asked, chain=replace(chain, segments=tuple((part, chain.weight(part)) for part in SINGLE)))
    assert np.array_equal(_walking(body, same).rotations, _walking(body, asked).rotations)


@pytest.mark.parametrize("weight", [0.0, -1.0, np.nan, np.inf])
def test_a_weight_that_means_nothing_is_refused_under_the_name_of_its_constraint(weight: float) -> None:
    with pytest.raises(ValueError, match="'Left forearm': a weight is a finite number above 0"):
        target("left_forearm", (0, 0, 0), weight=weight)


@pytest.mark.parametrize(
    ("segments", "sentence"),
    [
        ((("thorax", 1.5),), "A chain's weight lies between 0 and 1: thorax is 1.5."),
        ((("thorax", float("nan")),), "thorax is nan"),
        ((("left_foot", 0.5),), "The left foot has no weight of its own: use end_segment."),
        ((("thorax", 0.5), ("thorax", 0.6)), "two weights"),
    ],
)
def test_weights_of_segments_that_mean_nothing_are_refused(segments: Any, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        Chain(segments=segments)
    with pytest.raises(ValueError, match="without any free part"):
        Chain(0.0, 0.0, 0.0, 0.0, 0.0, (("thorax", 0.0),))
