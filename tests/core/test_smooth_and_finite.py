"""Smooth targets have smooth answers, and every finite target is answered by a body.

These scenes ask for more than anybody can do at once. The bounds are what the solver of the day keeps, with a margin;
they are to fall, never to rise. METHOD's own figure is the law of ``test_smooth_law``.
"""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.plausible import PLACE_RANGE, TURN_RANGE
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import ALWAYS, RATE, local_rotations, walk
from tests.core.scenes import Scene

BODIES = tuple(character.morphology for character in bundled_characters().values())
WALK, CONTACTS = walk(90)
BEFORE = tuple(adapt(AdaptRequest(WALK, body, CONTACTS)) for body in BODIES)
ALONE = {
    "position": (250.0, 1400.0), "orientation": (30.0, 60.0), "look_at": (25.0, 50.0), "distance": (60.0, 1000.0),
    "balance": (25.0, 50.0), "area": (600.0, 4500.0), "clear": (25.0, 50.0),
}  # fmt: skip
"""Radians a second squared: the median and the worst peak of any joint of trunk and arms, one wish of a kind alone."""
TOGETHER = (1400.0, 22_000.0)
"""The same for sets of one to five wishes."""
LARGEST = PLACE_RANGE.most
"""Metres: the farthest that a place may be."""


def _peak(seed: int, *kinds: str) -> float:
    before = BEFORE[seed % len(BODIES)]
    scene = Scene(before, seed, kinds)
    asked = AdaptRequest(WALK, before.morphology, CONTACTS, scene.constraints, tracks=scene.tracks)
    legs = before.morphology.layout.spine_count + 10
    return float(angular_acceleration(local_rotations(adapt(asked))[:, :legs], RATE).max())


@pytest.mark.parametrize("kind", ALONE)
def test_one_wish_that_moves_smoothly_moves_no_joint_with_a_jerk(kind: str) -> None:
    peaks = [_peak(seed, kind) for seed in range(12)]
    median, worst = ALONE[kind]
    assert np.median(peaks) < median
    assert max(peaks) < worst


def test_sets_of_wishes_that_move_smoothly_move_no_joint_with_a_jerk() -> None:
    peaks = [_peak(seed) for seed in range(30)]
    median, worst = TOGETHER
    assert np.median(peaks) < median
    assert max(peaks) < worst


sizes = st.sampled_from([0.0, 1e-300, 1e-12, 1e-9, 1e-3, 0.3, 1.0, 7.0, 1e3, LARGEST])
numbers = st.builds(lambda size, sign: sign * size, sizes, st.sampled_from([-1.0, 1.0]))
places = st.one_of(
    st.tuples(numbers, numbers, numbers),
    st.integers(0, BEFORE[0].positions.shape[1] - 1).map(lambda joint: tuple(BEFORE[0].positions[10, joint].tolist())),
)
"""Anywhere, and exactly on a joint of the body."""
parts = st.sampled_from(list(BodyPart))
points = st.builds(BodyPoint, parts, st.one_of(st.just((0.0, 0.0, 0.0)), places), st.booleans())
weights = st.sampled_from([0.0, 1e-9, 0.5, 1.0])
chains = st.tuples(weights, weights, weights, weights, weights).filter(any).map(lambda each: Chain(*each))


def _made(kind: type[Constraint], point: BodyPoint, chain: Chain, priority: int, **own: object) -> Constraint | None:
    try:
        return kind("motion", "Wild", point, chain, priority, ALWAYS, **own)
    except ValueError:  # refused when made, as it should be
        return None


def _wild(kind: type[Constraint], **own: st.SearchStrategy[object]) -> st.SearchStrategy[Constraint | None]:
    build: Callable[..., Constraint | None] = _made
    return st.builds(build, st.just(kind), points, chains, st.integers(0, 2), **own)


positive = sizes.filter(bool)
anything = st.one_of(
    _wild(PositionConstraint, target=places),
    _wild(OrientationConstraint, target=st.tuples(numbers, numbers, numbers, numbers)),
    _wild(LookAtConstraint, target=places),
    _wild(DistanceConstraint, other=st.one_of(places, points), distance=sizes),
    _wild(ClearConstraint, margin=st.sampled_from([0.0, 1e-12, 0.1, 0.5])),
    _wild(BalanceConstraint, place=st.one_of(st.none(), places.map(lambda place: place[:2]))),
    _wild(
        AreaConstraint,
        shape=st.sampled_from(list(AreaShape)),
        centre=places,
        size=st.tuples(positive, positive, positive),
        heading=numbers.filter(lambda turn: abs(turn) <= TURN_RANGE.most),
        inside=st.booleans(),
    ),
)


def _is_a_body(adapted: AdaptedMotion, before: AdaptedMotion) -> bool:
    turns = np.swapaxes(adapted.rotations, -1, -2) @ adapted.rotations
    return bool(
        np.isfinite(adapted.positions).all()
        and np.abs(turns - np.eye(3)).max() < 1e-9
        and not np.isinf(adapted.residuals).any()
        and adapted.positions.shape == before.positions[10:12].shape
    )


@given(st.lists(anything, min_size=1, max_size=5), st.sampled_from(range(len(BODIES))), st.booleans())
@settings(max_examples=150)
def test_whatever_finite_is_asked_the_answer_is_a_body(asked: list[Constraint | None], body: int, stands: bool) -> None:
    constraints = tuple(each for each in asked if each is not None)
    request = AdaptRequest(WALK, BODIES[body], CONTACTS if stands else (), constraints)
    assert _is_a_body(adapt(request, 10, 11), BEFORE[body])


@given(anything, st.sampled_from(range(len(BODIES))))
@settings(max_examples=40)
def test_the_same_asked_twice_or_at_two_priorities_is_no_trouble(asked: Constraint | None, body: int) -> None:
    if asked is None:
        return
    again = type(asked)(**{**vars(asked), "priority": asked.priority + 1})
    request = AdaptRequest(WALK, BODIES[body], CONTACTS, (asked, asked, again))
    assert _is_a_body(adapt(request, 10, 11), BEFORE[body])
