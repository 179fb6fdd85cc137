"""Priorities are strict: what stands lower changes nothing of what stands higher, for better or worse."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.stand import stand
from studio.io.project.character_file import bundled_characters
from tests.core.grounding import adapt_again
from tests.core.motions import ALWAYS, target, walk
from tests.core.reachable import reachable_target
from tests.core.scenes import KINDS, Scene

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
LIMB, ARM, BACK, ALL = Chain(clavicle=0.0), Chain(), Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
LEAK = 2e-4
"""Metres or radians by which a miss may change."""
BENT = 0.114
"""Metres from an elbow to the line from shoulder to wrist from which on a swivel is exact."""


def _solved(body: Morphology, *constraints: Constraint) -> AdaptedMotion:
    return adapt_again(AdaptRequest(WALK, body, CONTACTS, constraints), 30, 30)


def _higher(body: Morphology, chain: Chain, random: np.random.Generator) -> PositionConstraint:
    """The left wrist at a place within reach or, as often, somewhat beyond."""
    place = reachable_target(_solved(body), 0, WRIST, chain, random)
    beyond = random.choice([0.0, 0.15]) * body.stature * np.array([0.9, 0.4, 0.0])
    return target(BodyPart.LEFT_FOREARM, place + beyond, chain, 0)


@pytest.mark.parametrize("chain", [LIMB, ARM, BACK, ALL], ids=["limb", "arm", "back", "all"])
@pytest.mark.parametrize("lower", ["left_upper_arm", "right_forearm", "head", "thorax"])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_lower_constraint_does_not_change_what_a_higher_misses(body: Morphology, lower: str, chain: Chain) -> None:
    random = np.random.default_rng(3)
    part = BodyPart(lower)
    own = Chain(0.0, 0.0, 0.0, 1.0, chain.root) if part is BodyPart.THORAX else chain
    for _ in range(4):
        higher = _higher(body, chain, random)
        before = body_point_positions(BodyPoint(part, at_end=True), _solved(body))[0]
        wish = target(part, before + random.normal(size=3) * random.choice([0.05, 0.4]), own, 1)
        alone, both = _solved(body, higher), _solved(body, higher, wish)
        assert abs(both.residuals[0, 0] - alone.residuals[0, 0]) <= LEAK


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_wrist_before_its_elbow_meets_both_where_the_elbow_before_it_does(body: Morphology) -> None:
    """Frames in which the arm is bent enough for its swivel to be exact, METHOD (17)."""
    before, tried = _solved(body), 0
    elbow, wrist = (
        body_point_positions(point, before)[0] for point in (BodyPoint(BodyPart.LEFT_UPPER_ARM, at_end=True), WRIST)
    )
    for seed in range(24):
        random, chain = np.random.default_rng(seed), (ARM, BACK, ALL)[seed % 3]
        way = (wrist - elbow) / np.linalg.norm(wrist - elbow) + random.uniform(0.5, 1.5) * np.array([0.9, 0.0, 0.5])
        first = elbow + 0.04 * random.normal(size=3)
        second = first + np.linalg.norm(wrist - elbow) * way / np.linalg.norm(way)
        parts = (BodyPart.LEFT_UPPER_ARM, first), (BodyPart.LEFT_FOREARM, second)
        swapped, ordered = (
            _solved(body, *(target(part, place, chain, priority) for priority, (part, place) in enumerate(wishes)))
            for wishes in (parts, parts[::-1])
        )
        shoulder = swapped.positions[0, body.layout.collar_point(0) + 1]
        aside = np.linalg.norm(np.cross(first - shoulder, second - shoulder)) / np.linalg.norm(second - shoulder)
        if swapped.residuals.max() < LEAK and aside > BENT:
            tried += 1
            assert ordered.residuals.max() < LEAK, seed
    assert tried > 5


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_priorities_count_and_not_the_order_in_which_constraints_stand(body: Morphology) -> None:
    random = np.random.default_rng(4)
    for chain in (LIMB, ARM, ALL):
        wrist = _higher(body, chain, random)
        elbow = target(BodyPart.LEFT_UPPER_ARM, wrist.target + random.normal(size=3) * 0.2, chain, 1)
        head = target(BodyPart.HEAD, (1.0, 0.2, 1.2), Chain(1.0, 1.0, 0.0, 1.0, 0.0), 2)
        in_order, mixed = _solved(body, wrist, elbow, head), _solved(body, head, wrist, elbow)
        assert np.allclose(mixed.positions, in_order.positions, atol=1e-9)
        assert np.allclose(mixed.residuals[[1, 2, 0]], in_order.residuals, atol=1e-9)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_only_the_order_of_priorities_counts_and_not_their_numbers(body: Morphology) -> None:
    random = np.random.default_rng(5)
    wrist = _higher(body, ALL, random)
    found = [
        _solved(
            body,
            target(BodyPart.LEFT_FOREARM, wrist.target, ALL, first),
            target(BodyPart.HEAD, (1.0, 0.2, 1.2), Chain(1.0, 1.0, 0.0, 1.0, 0.0), second),
        ).positions
        for first, second in ((0, 1), (3, 40))
    ]
    assert np.array_equal(*found)


TRUNKS = Chain(trunk=1.0), ALL, LIMB, Chain(trunk=0.5, clavicle=1.0)
PARTS = (
    BodyPart.LEFT_FOREARM,
    BodyPart.RIGHT_FOREARM,
    BodyPart.LEFT_UPPER_ARM,
    BodyPart.RIGHT_UPPER_ARM,
    BodyPart.HEAD,
    BodyPart.THORAX,
    BodyPart.PELVIS,
)


def _random_set(body: Morphology, away: float, random: np.random.Generator) -> list[Constraint]:
    """Two to eight wishes in order of priority: places ``away`` metres from where things are, a balance perhaps."""
    before, wishes = _solved(body), list[Constraint]()
    for rank in range(random.integers(2, 9)):
        if random.random() < 0.2 and not any(isinstance(each, BalanceConstraint) for each in wishes):
            pelvis = BodyPoint(BodyPart.PELVIS)
            wishes.append(BalanceConstraint("walk", f"{rank}", pelvis, Chain(0.0, 0.0, 0.0, 1.0, 1.0), rank, ALWAYS))
            continue
        part = PARTS[random.integers(len(PARTS))]
        point = BodyPoint(part, at_end=part is not BodyPart.PELVIS)
        chain = Chain(root=1.0) if part is BodyPart.PELVIS else TRUNKS[random.integers(len(TRUNKS))]
        place = tuple((body_point_positions(point, before)[0] + away * random.normal(size=3)).tolist())
        wishes.append(PositionConstraint("walk", f"{rank}", point, chain, rank, ALWAYS, target=place))
    return wishes


@pytest.mark.parametrize("away", [0.02, 0.05, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_whatever_is_added_below_changes_nothing_of_sets_of_wishes_in_any_order(body: Morphology, away: float) -> None:
    standing = stand(WALK, body, CONTACTS, Ground())
    for seed in range(40):
        random = np.random.default_rng(seed)
        wishes = _random_set(body, away, random)
        before = np.zeros(0)
        for count in range(1, len(wishes) + 1):
            order = random.permutation(count)
            after = np.empty(count)
            after[order] = solve_constraints(standing, [wishes[place] for place in order], 30, 30).residuals[:, 0]
            assert (abs(after[:-1] - before) <= LEAK).all(), (seed, count)
            before = after


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_whatever_is_added_below_changes_nothing_of_wishes_of_any_kind(body: Morphology) -> None:
    motion, contacts = walk(60)
    standing = stand(motion, body, contacts, Ground())
    before = solve_constraints(standing, ())
    for seed in range(150):
        random = np.random.default_rng(seed)
        scene = Scene(before, seed, random.choice([*KINDS, "clear", "position"], size=random.integers(2, 9)).tolist())
        levels = np.cumsum(random.random(len(scene.constraints)) < 0.7)
        wishes = [replace(each, priority=int(level)) for each, level in zip(scene.constraints, levels, strict=True)]
        above = np.zeros(0)
        for level in np.unique(levels):
            order = random.permutation(np.sum(levels <= level))
            after = np.empty(len(order))
            after[order] = solve_constraints(
                standing, [wishes[place] for place in order], 40, 40, scene.tracks
            ).residuals[:, 0]
            assert (abs(after[: len(above)] - above) <= LEAK).all(), (seed, level)
            above = after


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("eased", [False, True])
def test_what_does_not_act_changes_nothing(eased: bool, body: Morphology) -> None:
    """Any constraint, of any chain, weight and priority, be it over or, eased, still to come."""
    motion, contacts = walk(60)
    standing = stand(motion, body, contacts, Ground())
    past = ActivationCurve(5.0, 5.0, 6.0, 6.0) if eased else ActivationCurve(0.0, 0.0, 0.1, 0.2)
    before = solve_constraints(standing, ())
    for seed in range(20):
        random = np.random.default_rng(seed)
        scene = Scene(before, seed, random.choice([*KINDS, "position"], size=random.integers(1, 5)).tolist())
        idle: Constraint = target(PARTS[random.integers(len(PARTS))], (2.0, 1.0, 2.0), Chain(1.0, 1.0, 1.0, 1.0, 1.0))
        if seed % 2:
            chain = Chain(0.0, 0.0, 0.0, 1.0, 1.0, free_arms=1.0, free_legs=1.0)
            idle = BalanceConstraint("walk", "idle", BodyPoint(BodyPart.PELVIS), chain, 0, past)
        idle = replace(idle, priority=int(random.integers(4)), activation=past, weight=20.0)
        window = (40, 59) if eased else (40, 40)
        alone = solve_constraints(standing, scene.constraints, *window, scene.tracks, eased=eased)
        beside = solve_constraints(standing, (*scene.constraints, idle), *window, scene.tracks, eased=eased)
        assert abs(beside.positions - alone.positions).max() < 1e-7, seed
