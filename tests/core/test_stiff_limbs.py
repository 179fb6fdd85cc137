"""Stiff segments of limbs: each takes its part of what it would do, the rest of the chain what is left."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.objections import objection
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.asking.tracks import Track
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.stand import stand
from studio.io.project.character_file import bundled_characters
from tests.core.motions import ALWAYS, RATE, local_rotations, target, walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(90)
STANDING = {name: stand(WALK, body, CONTACTS, Ground()) for name, body in BODIES.items()}
IN_AIR = {name: stand(WALK, body, (), Ground()) for name, body in BODIES.items()}
FRAME = 30
ALONE, TRUNK, ALL = Chain(clavicle=0.0), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
ARM, LEG = ("upper_arm", "forearm"), ("thigh", "shank")
MET, LOCKED = 2e-4, 1e-9
WEIGHTS = np.linspace(0.0, 1.0, 9)
OFFSETS = ([0.1, 0.05, 0.1], [0.12, -0.04, 0.1], [0.05, 0.1, 0.15])


def _chain(chain: Chain, upper: float, lower: float, limb: str = "left_arm") -> Chain:
    bones = ("left_upper_arm", "left_forearm") if limb == "left_arm" else ("left_thigh", "left_shank")
    return replace(chain, segments=((BodyPart(bones[0]), upper), (BodyPart(bones[1]), lower)))


def _reach(name: str, chain: Chain, offset: Any = OFFSETS[0], **changes: Any) -> PositionConstraint:
    """The left wrist somewhat aside."""
    body = BODIES[name]
    wrist = STANDING[name].positions[FRAME, body.layout.wrist_point(0)]
    return target("left_forearm", wrist + np.array(offset) * body.stature / 1.7, chain, **changes)


def _step(name: str, chain: Chain) -> PositionConstraint:
    """The left ankle somewhat aside, in a walk over nothing."""
    body = BODIES[name]
    ankle = IN_AIR[name].positions[FRAME, body.layout.ankle_point(0)]
    return target("left_shank", ankle + np.array([0.03, 0.03, 0.04]) * body.stature / 1.7, chain)


def _at(standing: Any, *constraints: Any) -> AdaptedMotion:
    return solve_constraints(standing, constraints, FRAME, FRAME)


def _turns(body: Morphology, solved: AdaptedMotion, before: AdaptedMotion, first: BodyPart) -> tuple[float, float]:
    """Radians by which a limb's upper and lower segment have turned, each in what carries it."""
    segment = body.layout.segment_of_part(first)
    traces = [
        np.trace(local_rotations(before)[0, each].T @ local_rotations(solved)[0, each])
        for each in (segment, segment + 1)
    ]
    upper, lower = np.arccos(np.clip((np.array(traces) - 1.0) / 2.0, -1.0, 1.0))
    return float(upper), float(lower)


@pytest.mark.parametrize("chain", [ALONE, TRUNK, ALL], ids=["alone", "trunk", "all"])
@pytest.mark.parametrize("name", BODIES)
def test_a_locked_segment_of_an_arm_keeps_its_rotation_in_what_carries_it(name: str, chain: Chain) -> None:
    layout = BODIES[name].layout
    before = local_rotations(_at(STANDING[name]))[0]
    for offset in OFFSETS:
        for upper, lower in ((0.0, 1.0), (1.0, 0.0), (0.0, 0.4)):
            after = local_rotations(_at(STANDING[name], _reach(name, _chain(chain, upper, lower), offset)))[0]
            moved = [np.abs(after - before)[layout.segment_of_part(BodyPart(f"left_{bone}"))].max() for bone in ARM]
            assert (moved[0] < LOCKED) == (upper == 0.0)
            assert (moved[1] < LOCKED) == (lower == 0.0)


@pytest.mark.parametrize("name", BODIES)
def test_a_locked_segment_of_a_leg_keeps_its_rotation_and_the_root_brings_the_foot(name: str) -> None:
    layout, standing = BODIES[name].layout, IN_AIR[name]
    before = local_rotations(_at(standing))[0]
    for weights in ((0.0, 1.0), (1.0, 0.0), (0.5, 0.0)):
        solved = _at(standing, _step(name, _chain(Chain(clavicle=0.0, root=1.0), *weights, "left_leg")))
        after = local_rotations(solved)[0]
        for weight, bone in zip(weights, LEG, strict=True):
            moved = np.abs(after - before)[layout.segment_of_part(BodyPart(f"left_{bone}"))].max()
            assert (moved < LOCKED) == (weight == 0.0)
        assert solved.residuals[0, 0] < MET


@pytest.mark.parametrize("offset", OFFSETS, ids=str)
@pytest.mark.parametrize("name", BODIES)
def test_stiffer_turns_less_and_alone_takes_just_its_part(name: str, offset: list[float]) -> None:
    body, before = BODIES[name], _at(STANDING[name])
    arm = BodyPart.LEFT_UPPER_ARM
    full = _turns(body, _at(STANDING[name], _reach(name, ALONE, offset)), before, arm)
    for chain in (ALONE, ALL):
        upper, lower = [], []
        for weight in WEIGHTS:
            stiff = _at(STANDING[name], _reach(name, _chain(chain, weight, 1.0), offset))
            upper.append(_turns(body, stiff, before, arm)[0])
            stiff = _at(STANDING[name], _reach(name, _chain(chain, 1.0, weight), offset))
            lower.append(_turns(body, stiff, before, arm)[1])
        assert (np.diff(upper) > -1e-6).all()
        assert (np.diff(lower) > -1e-6).all()
        assert upper[4] == pytest.approx(0.5 * full[0], abs=1e-3)


@given(
    st.sampled_from(sorted(BODIES)), st.sampled_from(OFFSETS), st.floats(0.0, 1.0), st.floats(0.0, 1.0)
)  # fmt: skip
@settings(max_examples=60)
def test_what_a_stiff_arm_leaves_the_rest_of_the_chain_does(
    name: str, offset: list[float], upper: float, lower: float
) -> None:
    if upper == lower == 0.0:
        upper = 0.1
    assert _at(STANDING[name], _reach(name, _chain(ALL, upper, lower), offset)).residuals[0, 0] < MET


@pytest.mark.parametrize("name", BODIES)
def test_alone_what_is_left_is_a_miss_and_told(name: str) -> None:
    body, asked = BODIES[name], _reach(name, _chain(ALONE, 0.5, 1.0))
    solved = _at(STANDING[name], asked)
    apart = np.linalg.norm(solved.positions[0, body.layout.wrist_point(0)] - asked.target)
    assert solved.residuals[0, 0] == pytest.approx(apart)
    assert apart > 0.01


@pytest.mark.parametrize("chain", [ALONE, ALL], ids=["alone", "all"])
@pytest.mark.parametrize("name", BODIES)
def test_a_little_more_weight_is_a_little_more_movement(name: str, chain: Chain) -> None:
    for place in (0, 1):
        poses = []
        for weight in (0.0, 1e-4, 0.5, 0.5001, 0.9999, 1.0):
            weights = (weight, 1.0) if place == 0 else (1.0, weight)
            poses.append(_at(STANDING[name], _reach(name, _chain(chain, *weights))).positions)
        for first in (0, 2, 4):
            assert np.abs(poses[first] - poses[first + 1]).max() < 1e-3


@pytest.mark.parametrize("weights", [(0.5, 1.0), (1.0, 0.3), (0.4, 0.4), (0.0, 1.0)], ids=str)
@pytest.mark.parametrize("name", BODIES)
def test_stiff_arms_follow_what_moves_smoothly_without_pops(name: str, weights: tuple[float, float]) -> None:
    standing, layout = STANDING[name], BODIES[name].layout
    times = np.linspace(0.0, 1.0, 90)[:, None]
    aside = np.hstack([0.08 + 0.05 * np.sin(4 * times), 0.04 * np.cos(5 * times), 0.1 + 0.05 * np.sin(3 * times)])
    track = Track(standing.positions[:, layout.wrist_point(0)] + aside, np.eye(3)[None])
    wrist, follow = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), FollowTracked("hand")
    for chain in (ALONE, ALL):
        asked = PositionConstraint("motion", "Wrist", wrist, _chain(chain, *weights), 0, ALWAYS, target=follow)
        solved = solve_constraints(standing, (asked,), tracks={follow: track})
        assert chain is ALONE or np.nanmax(solved.residuals) < MET
        arms_and_trunk = local_rotations(solved)[:, : layout.spine_count + 10]
        assert angular_acceleration(arms_and_trunk, RATE).max() < 300.0  # half of what a walking leg has


@pytest.mark.parametrize("name", BODIES)
def test_a_lower_wish_does_not_take_from_a_stiff_higher_one(name: str) -> None:
    higher = _reach(name, _chain(ALL, 0.4, 0.6))
    right = STANDING[name].positions[FRAME, BODIES[name].layout.wrist_point(1)] + np.array([0.5, -0.3, 0.2])
    lower = target("right_forearm", right, ALL, 1)
    alone, both = _at(STANDING[name], higher), _at(STANDING[name], higher, lower)
    assert both.residuals[0, 0] <= alone.residuals[0, 0] + MET


@pytest.mark.parametrize("name", BODIES)
def test_the_swivel_for_a_second_wish_is_as_stiff_as_its_chain(name: str) -> None:
    body = BODIES[name]
    wrist = _reach(name, ALONE)
    before = _at(STANDING[name], wrist)
    elbow = before.positions[0, body.layout.wrist_point(0) - 1] + np.array([0.0, 0.1, 0.05])
    turned = []
    for weight in (0.0, 0.5, 1.0):
        second = target("left_upper_arm", elbow, _chain(ALONE, max(weight, 0.0), 1.0), 1)
        turned.append(_turns(body, _at(STANDING[name], wrist, second), before, BodyPart.LEFT_UPPER_ARM)[0])
    assert turned[0] < 1e-6
    assert turned[1] == pytest.approx(0.5 * turned[2], rel=0.05)


def test_hands_apart_are_brought_together_by_the_arm_that_is_not_stiff() -> None:
    standing, body = STANDING["adult_woman"], BODIES["adult_woman"]
    hands = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND)
    apart = float(
        np.linalg.norm(
            np.diff(standing.positions[FRAME, [body.layout.wrist_point(0), body.layout.wrist_point(1)]], axis=0)
        )
    )
    chain = _chain(ALONE, 0.0, 0.0)
    asked = DistanceConstraint("motion", "Hands", hands[0], chain, 0, ALWAYS, other=hands[1], distance=0.9 * apart)
    solved = _at(standing, asked)
    assert solved.residuals[0, 0] < MET
    assert solved.positions[0, body.layout.wrist_point(0)] == pytest.approx(
        standing.positions[FRAME, body.layout.wrist_point(0)], abs=1e-9
    )


def test_what_its_own_weights_free_can_move_a_point_and_nothing_else() -> None:
    bend = Chain(0.0, 0.0, 0.0, 0.0, 0.0, ((BodyPart.LEFT_FOREARM, 1.0),))
    assert objection(target("left_forearm", (1, 0, 1), bend), ()) is None
    for part in ("left_upper_arm", "right_forearm"):
        assert "nothing that its chain frees" in str(objection(target(part, (1, 0, 1), bend), ()))
