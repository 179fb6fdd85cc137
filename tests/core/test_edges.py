"""Edges of constraints, at which what is solved is blended: every joint is on its way, and what holds, holds."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import ALWAYS, RATE, local_rotations, target, walk
from tests.core.twins.rotation import from_vector, to_vector

WOMAN = bundled_characters()["adult_woman"].morphology
WALK, CONTACTS = walk(90)
EDGES = ActivationCurve(0.4, 0.6, 0.9, 1.1)
EARLIER = ActivationCurve(0.2, 0.55, 0.8, 1.15)
LATER = ActivationCurve(0.5, 0.7, 1.0, 1.2)
TRUNK, WHOLE = Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)
UPPER = WOMAN.layout.spine_count + 10
"""Segments of trunk, neck, head and arms; legs are on their ankles."""


def _solved(*constraints: Constraint) -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, WOMAN, CONTACTS, constraints, limited=False))


BEFORE = _solved()
SHOULDER = np.median(BEFORE.positions[30:60, WOMAN.layout.collar_point(1) + 1], axis=0)
BEHIND, FAR = SHOULDER + np.array([-0.2, 0.1, 0.3]), SHOULDER + np.array([1.5, -0.3, 0.2])


def _along(first: AdaptedMotion, second: AdaptedMotion, shares: np.ndarray) -> np.ndarray:
    """Local rotations that are ``shares`` of the way from the first to the second, (F, S, 3, 3)."""
    begin, end = local_rotations(first)[:, :UPPER], local_rotations(second)[:, :UPPER]
    ways = np.array(
        [[to_vector(b.T @ e) for b, e in zip(*frame, strict=True)] for frame in zip(begin, end, strict=True)]
    )
    turns = [[from_vector(share * way) for way in frame] for share, frame in zip(shares, ways, strict=True)]
    return begin @ np.array(turns)


@pytest.mark.parametrize("chain", [Chain(), TRUNK], ids=["arm and clavicle", "and trunk"])
@pytest.mark.parametrize("place", [BEHIND, FAR], ids=["past the shoulder", "out of reach"])
def test_every_joint_goes_the_part_of_its_way_that_its_activation_says(place: np.ndarray, chain: Chain) -> None:
    wish = target(BodyPart.RIGHT_FOREARM, place, chain)
    eased = local_rotations(_solved(replace(wish, activation=EDGES)))[:, :UPPER]
    on_the_way = _along(BEFORE, _solved(wish), EDGES.at(np.arange(WALK.frame_count) / RATE))
    limbs = [WOMAN.layout.spine_count + 3 + bone for bone in (0, 1, 4, 5)]  # what turns twice goes nearly so
    assert np.abs(eased - on_the_way)[:, limbs].max() < 1e-6
    assert np.abs(eased - on_the_way).max() < 0.02


@pytest.mark.parametrize("priority", [1, 2], ids=["beside", "below"])
def test_what_is_wholly_active_holds_while_others_come_and_go(priority: int) -> None:
    wrist = np.median(body_point_positions(BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), BEFORE)[20:70], axis=0)
    balance = BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), 0, ALWAYS)
    near = target(BodyPart.LEFT_FOREARM, wrist + np.array([0.0, 0.0, 0.1]), WHOLE, 1)
    far = target(BodyPart.RIGHT_FOREARM, FAR, WHOLE, priority, activation=EDGES)
    elbow = target(BodyPart.LEFT_UPPER_ARM, wrist + np.array([0.1, 0.3, 0.3]), Chain(), 2, activation=LATER)
    held = _solved(balance, near).residuals[:, 33:63]
    both = _solved(balance, near, far, elbow).residuals[:, 33:63]
    assert np.all(both[0] < held[0] + 2e-4)
    if priority > 1:
        assert np.all(both[1] < held[1] + 2e-4)


@pytest.mark.parametrize("limited", [True, False])
@pytest.mark.parametrize("acts", ["while it acts", "while what is above it comes and goes"])
def test_what_is_out_of_reach_stays_as_far_off_whatever_acts_below(acts: str, limited: bool) -> None:
    """By the pose itself, of points that are wanted up to half a metre from where they were."""
    times = np.arange(90) / RATE
    first_acts, most = (ALWAYS, 3e-4) if acts == "while it acts" else (EARLIER, 4e-4)

    def solved(*constraints: Constraint) -> AdaptedMotion:
        return adapt(AdaptRequest(WALK, WOMAN, CONTACTS, constraints, limited=limited))

    for seed in range(12):
        random, wishes = np.random.default_rng(seed), list[Constraint]()
        for priority, number in enumerate(random.permutation(4).tolist()):
            part = (BodyPart.RIGHT_FOREARM, BodyPart.LEFT_FOREARM, BodyPart.HEAD, BodyPart.RIGHT_UPPER_ARM)[number]
            way = random.normal(size=3)
            place = body_point_positions(BodyPoint(part, at_end=True), BEFORE)[45] + 0.5 * way / np.linalg.norm(way)
            wishes.append(target(part, place, (Chain(), TRUNK, WHOLE)[random.integers(3)], priority))
            wishes[-1] = replace(wishes[-1], activation=(first_acts, ALWAYS, EDGES, LATER)[priority])
        above = solved(*wishes[:2])
        for count in (3, 4):
            for wish in wishes[:2]:
                first, second = (
                    np.linalg.norm(body_point_positions(wish.point, each) - np.array(wish.target), axis=1)
                    for each in (above, solved(*wishes[:count]))
                )
                whole = wish.activation.at(times) >= 1.0
                assert np.abs(second - first)[whole].max() < most, (seed, count, wish.name)


def test_a_moment_more_of_an_edge_changes_little() -> None:
    """Frames in which an edge begins or ends, and in which two change places as to which acts more."""
    left = target(BodyPart.LEFT_FOREARM, FAR + np.array([0.0, 0.6, 0.0]), WHOLE, 1, activation=EDGES)
    for begin in (EDGES, LATER):
        right = target(BodyPart.RIGHT_FOREARM, FAR, WHOLE, 0, activation=begin)
        moved = replace(right, activation=begin.moved(1e-6))
        first, second = _solved(left, right), _solved(left, moved)
        assert np.abs(first.positions - second.positions).max() < 1e-3


def test_a_miss_grows_with_the_activation() -> None:
    wish = target(BodyPart.RIGHT_FOREARM, FAR, Chain())
    always, eased = (_solved(each).residuals[0] for each in (wish, replace(wish, activation=EDGES)))
    shares = EDGES.at(np.arange(WALK.frame_count) / RATE)
    assert np.array_equal(np.isnan(eased), shares == 0.0)
    assert np.allclose(eased[shares > 0.0], (shares * always)[shares > 0.0], atol=1e-9)
