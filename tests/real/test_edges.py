"""Edges of 0.2 s on real captures add at most twice the source's own peak acceleration, whatever is asked."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import ALWAYS
from tests.real.taken import contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
RAMP = 0.2
TRUNK, WHOLE = Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
WRISTS = BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM


@lru_cache(maxsize=1)
def _standing(stem: str, name: str, limited: bool) -> tuple[GroundedMotion, AdaptedMotion]:
    capture, motion, _ = taken(named(stem))
    standing = ground_motion(motion, BODIES[name], contacts_of(capture), Ground(), limited=limited)
    return standing, solve_constraints(standing, (), capture.first_frame, capture.first_frame + 599)


def _sets(before: AdaptedMotion, times: ActivationCurve) -> Iterator[tuple[Constraint, ...]]:
    """Near and far, past the shoulder, for the trunk, two at once; where the body is halfway through."""
    layout, frame = before.morphology.layout, int(0.45 * before.frame_count)
    forward, arm = before.rotations[frame, 0], before.morphology.arm[1].sum()
    shoulders = [before.positions[frame, layout.collar_point(side) + 1] for side in range(2)]
    wrist = before.positions[frame, layout.wrist_point(1)]

    def place(origin: np.ndarray, *way: float) -> tuple[float, ...]:
        return tuple((origin + forward @ np.array(way)).tolist())

    def made(kind: type[Constraint], point: BodyPoint, chain: Chain, priority: int = 0, **own: object) -> Constraint:
        return kind("motion", f"{kind.kind} {point.part}", point, chain, priority, times, **own)

    def reach(side: int, goal: tuple[float, ...], chain: Chain, priority: int = 0) -> Constraint:
        return made(PositionConstraint, BodyPoint(WRISTS[side], at_end=True), chain, priority, target=goal)

    far = [place(shoulders[side], 1.5 * arm, (0.4, -0.4)[side] * arm, 0.2 * arm) for side in range(2)]
    head, pelvis, hand = (BodyPoint(part) for part in (BodyPart.HEAD, BodyPart.PELVIS, BodyPart.RIGHT_HAND))
    for chain in (Chain(), TRUNK, WHOLE):
        yield (reach(1, far[1], chain),)
        yield (reach(1, place(wrist, 0.2, 0.0, 0.3), chain),)
    balance = BalanceConstraint("motion", "Balance", pelvis, Chain(0, 0, 0, 1, 1), 0, ALWAYS)
    yield balance, reach(0, far[0], WHOLE, 1), reach(1, far[1], WHOLE, 1)
    elbow = made(PositionConstraint, BodyPoint(BodyPart.RIGHT_UPPER_ARM, at_end=True), TRUNK, 1, target=far[0])
    yield reach(1, place(shoulders[1], 0.5 * arm, -0.3 * arm, 0.1 * arm), TRUNK), elbow
    yield (made(PositionConstraint, head, Chain(0, 0, 1, 1, 0), target=place(shoulders[1], 0.3, 0.2, 0.2)),)
    yield (made(BalanceConstraint, pelvis, WHOLE, place=place(before.positions[frame, 0], 0.08, 0.04, 0.0)[:2]),)
    yield (made(OrientationConstraint, hand, Chain(), target=(0.5, 0.5, 0.5, 0.5)),)
    yield (made(LookAtConstraint, EYES_POINT, Chain(0, 0, 1, 1), target=place(shoulders[1], 1.5, 1.0, 0.0)),)
    left = BodyPoint(WRISTS[0], at_end=True)
    yield (made(DistanceConstraint, BodyPoint(WRISTS[1], at_end=True), TRUNK, other=left, distance=0.05),)
    shape = {"shape": AreaShape.SPHERE, "centre": tuple(wrist.tolist()), "size": (0.3, 0.3, 0.3)}
    yield (made(AreaConstraint, BodyPoint(WRISTS[1], at_end=True), TRUNK, **shape),)


@pytest.mark.parametrize("limited", [True, False])
@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("walk", "child"),
        ("punch", "adult_woman"),
        *outside(
            ("accad_male2_A6_BoxLift", "adult_woman"),
            ("accad_male2_A6_BoxLift", "child"),
            ("accad_female1_B03_Walk1", "child"),
            ("accad_female1_B03_Walk1", "giant"),
            ("accad_male2_E1_JabLeft", "adult_woman"),
        ),
    ],
)
def test_edges_add_at_most_twice_the_peak_of_the_source(stem: str, name: str, limited: bool) -> None:
    standing, before = _standing(stem, name, limited)
    rate, first, last = before.frame_rate, before.first_frame, before.first_frame + before.frame_count - 1
    seconds = first / rate + np.array([0.3, 0.6]) * before.frame_count / rate
    times = ActivationCurve(seconds[0], seconds[0] + RAMP, seconds[1], seconds[1] + RAMP)
    source = angular_acceleration(before.rotations, rate).max()
    for wishes in _sets(before, times):
        solved = solve_constraints(standing, wishes, first, last, eased=True)
        peaks = angular_acceleration(solved.rotations, rate).max(axis=1)
        for begin in seconds - first / rate:
            edge = peaks[int(begin * rate) - 1 : int((begin + RAMP) * rate) + 1]
            assert edge.max() < 3.5 * source, wishes
