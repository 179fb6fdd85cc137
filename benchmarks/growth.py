"""Growth of the cost with the number of constraints and of characters: measured, and fitted by a straight line."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studio.cli.bench_cases import LIMB_AND_TRUNK_CHAIN, LIMB_CHAIN, ROOT_CHAIN, WHOLE_CASE_ACTIVATION, make_tasks
from studio.cli.bench_timing import BenchJob, time_jobs
from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.mesh.character import Character
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import from_matrix
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.jobs.adaptation import ADAPTED_MOTION_ID

MOST_CONSTRAINTS = 16
ORDERS, SEED = 8, 0
"""Orders in which constraints are added, and of the one that is drawn; what is added early decides what others cost."""
CHARACTERS = 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000
SHORT = 120
"""Frames for which a thousand characters are solved."""
ASIDE = 0.05
"""Metres from where a point is to where it is wanted."""

_POINTS = (
    (BodyPart.RIGHT_FOREARM, LIMB_AND_TRUNK_CHAIN), (BodyPart.LEFT_FOREARM, LIMB_AND_TRUNK_CHAIN),
    (BodyPart.HEAD, LIMB_AND_TRUNK_CHAIN),
    (BodyPart.RIGHT_UPPER_ARM, LIMB_CHAIN), (BodyPart.LEFT_UPPER_ARM, LIMB_CHAIN),
    (BodyPart.THORAX, LIMB_AND_TRUNK_CHAIN),
    (BodyPart.RIGHT_SHANK, LIMB_CHAIN), (BodyPart.LEFT_SHANK, LIMB_CHAIN), (BodyPart.RIGHT_CLAVICLE, Chain(trunk=0.5)),
    (BodyPart.LEFT_CLAVICLE, Chain(trunk=0.5)), (BodyPart.PELVIS, ROOT_CHAIN),
)  # fmt: skip


@dataclass(frozen=True)
class Growth:
    """Costs (microseconds) against counts, and the line nearest to them: a fixed part, a slope, how well it fits."""

    counts: list[int]
    costs: list[float]
    least: list[float]
    most: list[float]
    """Number of orders; the costs are their means."""
    fixed: float
    slope: float
    fit: float
    """R squared."""


def with_constraints(
    motion: NormalizedMotion, contacts: tuple[ContactInterval, ...], character: Character, rounds: int
) -> Growth:
    """Microseconds a frame with 1 to 16 wishes of every kind, added in several orders, on one character."""
    request = AdaptRequest(motion, character.morphology, contacts)
    wishes, counts = many_wishes(adapt(request)), list(range(1, MOST_CONSTRAINTS + 1))
    sets = [[wishes[place] for place in order[:count]] for order in orders() for count in counts]
    requests = [replace(request, constraints=tuple(each)) for each in sets]
    jobs = [BenchJob(str(len(each.constraints)), partial(adapt, each), motion.frame_count) for each in requests]
    return fitted(counts, np.reshape([timing.median for timing in time_jobs(jobs, rounds)], (ORDERS, -1)))


def orders() -> list[NDArray[np.int64]]:
    """Orders of all wishes: one that is drawn, begun at every second of it, so that each is early as often as late."""
    drawn = np.random.default_rng(SEED).permutation(MOST_CONSTRAINTS)
    return [np.roll(drawn, -first) for first in range(0, MOST_CONSTRAINTS, MOST_CONSTRAINTS // ORDERS)]


def with_characters(
    motion: NormalizedMotion, contacts: tuple[ContactInterval, ...], characters: Sequence[Character]
) -> Growth:
    """Microseconds for one frame of 1 to 1,000 characters of the worst kind, the given ones in turn, one core."""
    requests = [make_tasks(motion, contacts, each.morphology)[-1].request for each in characters]
    for request in requests:
        adapt(request)
    costs, spent = [], 0.0
    for number in range(1, CHARACTERS[-1] + 1):
        start = time.process_time()
        adapt(requests[number % len(requests)])
        spent += time.process_time() - start
        if number in CHARACTERS:
            costs.append(1e6 * spent / motion.frame_count)
    return fitted(list(CHARACTERS), np.array([costs]))


def many_wishes(adapted: AdaptedMotion) -> tuple[Constraint, ...]:
    """Sixteen wishes of different kinds and priorities, each a little aside from where the body has it anyway."""
    wishes: list[Constraint] = []
    for number, (part, chain) in enumerate(_POINTS):
        point = BodyPoint(part, at_end=True)
        place = np.median(body_point_positions(point, adapted), axis=0) + ASIDE * np.roll([1.0, 0.0, 0.0], number)
        wishes.append(
            PositionConstraint(
                ADAPTED_MOTION_ID, part.label, point, chain, number % 4, WHOLE_CASE_ACTIVATION, target=tuple(place)
            )
        )
    for side, part in enumerate((BodyPart.RIGHT_HAND, BodyPart.LEFT_HAND)):
        turn = from_matrix(adapted.rotations[:1, adapted.morphology.layout.segment_of_part(part)])[0]
        wishes.insert(
            2 + side,
            OrientationConstraint(
                ADAPTED_MOTION_ID, part.label, BodyPoint(part), LIMB_CHAIN, 1, WHOLE_CASE_ACTIVATION, target=tuple(turn)
            ),
        )
    eyes = np.median(body_point_positions(EYES_POINT, adapted), axis=0)
    wishes.insert(
        4,
        LookAtConstraint(
            ADAPTED_MOTION_ID,
            "Look",
            EYES_POINT,
            LIMB_CHAIN,
            2,
            WHOLE_CASE_ACTIVATION,
            target=(eyes[0] + 3.0, eyes[1], 1.0),
        ),
    )
    wishes.insert(
        5,
        BalanceConstraint(
            ADAPTED_MOTION_ID, "Balance", BodyPoint(BodyPart.PELVIS), ROOT_CHAIN, 0, WHOLE_CASE_ACTIVATION
        ),
    )
    abdomen = BodyPoint(BodyPart.ABDOMEN)
    bend = from_matrix(adapted.rotations[:1, adapted.morphology.layout.segment_of_part(BodyPart.ABDOMEN)])[0]
    wishes.append(
        OrientationConstraint(
            ADAPTED_MOTION_ID, "Abdomen", abdomen, LIMB_AND_TRUNK_CHAIN, 3, WHOLE_CASE_ACTIVATION, target=tuple(bend)
        )
    )
    return tuple(wishes)


def fitted(counts: list[int], each: NDArray[np.float64]) -> Growth:
    """The line nearest to the means of costs (orders, counts), which are in microseconds."""
    costs = each.mean(axis=0)
    slope, fixed = np.polyfit(counts, costs, 1)
    left = costs - (fixed + slope * np.array(counts))
    least, most = each.min(axis=0).tolist(), each.max(axis=0).tolist()
    fit = float(1.0 - left.var() / np.var(costs))
    return Growth(counts, costs.tolist(), least, most, float(fixed), float(slope), fit)
