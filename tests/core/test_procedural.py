"""Places that move by a rule: the same at a time whenever it is asked, and where a clip plays as in its motion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace, NoisePlace, PendulumPlace, ProceduralPlace
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.prop_tracks import stage_track
from studio.core.stage.prop import Prop
from tests.core.motions import RATE
from tests.core.test_targets import BODIES, solved

TIMES = np.linspace(-3.0, 7.0, 101)
CENTRE = (0.3, -0.2, 1.1)
RULES: tuple[ProceduralPlace, ...] = (
    CirclePlace(centre=CENTRE, heading=0.4, radius=0.3, tilt=0.7, since=0.2),
    PendulumPlace(centre=CENTRE, heading=-0.9, length=0.8, angle=0.6, seconds=1.7),
    NoisePlace(centre=CENTRE, heading=0.5, reach=(0.2, 0.1, 0.05), seed=7, seconds=0.8),
)
every_rule = pytest.mark.parametrize("rule", RULES, ids=lambda each: each.kind)


@every_rule
def test_a_moment_is_the_same_alone_and_among_others_in_any_order(rule: ProceduralPlace) -> None:
    whole, order = rule.at(TIMES), np.random.default_rng(0).permutation(len(TIMES))
    assert np.array_equal(rule.at(TIMES[order]), whole[order])
    assert np.array_equal(np.concatenate([rule.at([time]) for time in TIMES]), whole)


def test_a_circle_keeps_its_radius_a_pendulum_its_length_and_noise_its_reach() -> None:
    circle, pendulum, _ = RULES
    assert np.linalg.norm(circle.at(TIMES) - CENTRE, axis=1) == pytest.approx(np.full(len(TIMES), 0.3))
    hung = pendulum.at(TIMES) - CENTRE - [0.0, 0.0, 0.8]
    assert np.linalg.norm(hung, axis=1) == pytest.approx(np.full(len(TIMES), 0.8))
    assert pendulum.at(TIMES)[:, 2].min() >= CENTRE[2] - 1e-12
    straight = NoisePlace(centre=CENTRE, reach=(0.2, 0.1, 0.05), seed=7).at(TIMES) - CENTRE
    assert (np.abs(straight) <= [0.2, 0.1, 0.05]).all()
    assert (np.abs(straight).max(axis=0) > [0.08, 0.04, 0.02]).all()


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1))
def test_a_seed_says_how_noise_wanders(first: int, second: int) -> None:
    one, other = (NoisePlace(seed=seed).at(TIMES) for seed in (first, second))
    assert np.array_equal(one, other) == (first == second)


@every_rule
def test_a_clip_that_is_mirrored_turned_moved_and_faster_has_the_same_way(rule: ProceduralPlace) -> None:
    carry = ClipTransform(1.5, 1.25, 0.8, (0.4, -1.0), True, 0.0, 10.0)
    asked = PositionConstraint(
        "motion", "Reach", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, ActivationCurve(0.0, 0.1, 2.0, 2.1), target=rule
    )
    carried = constraint_on_clip(asked, carry)
    assert isinstance(carried, PositionConstraint)
    assert isinstance(carried.target, type(rule))
    assert carried.target.at(carry.stage_times(TIMES)) == pytest.approx(carry.positions(rule.at(TIMES)), abs=1e-9)


@every_rule
def test_it_passes_where_it_is_dragged_to(rule: ProceduralPlace) -> None:
    assert rule.passing((1.0, 2.0, 3.0), 0.7).at([0.7])[0] == pytest.approx([1.0, 2.0, 3.0])


def test_a_wrist_goes_along_on_every_body() -> None:
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    reach = Chain(trunk=1.0, root=1.0)
    for body in BODIES.values():
        rule = CirclePlace(centre=(0.35 * body.leg_length, -0.2, 1.3 * body.leg_length), radius=0.06, seconds=0.8)
        asked = PositionConstraint(
            "motion", "Circle", wrist, reach, 0, ActivationCurve(-1.0, 0.0, 9.0, 10.0), target=rule
        )
        stirred = solved(body, asked)
        frames = np.arange(20, 40)
        away = np.linalg.norm(body_point_positions(wrist, stirred)[frames] - rule.at(frames / RATE), axis=1)
        assert np.median(away) < 1e-3


@every_rule
def test_a_prop_moves_by_it_in_the_time_of_the_stage(rule: ProceduralPlace) -> None:
    assert np.array_equal(stage_track(Prop("Ball", position=rule), TIMES).positions, rule.at(TIMES))


@pytest.mark.parametrize(
    "wrong", [{"seconds": 0.0}, {"radius": float("nan")}, {"centre": (0.0, 0.0, float("inf"))}], ids=str
)
def test_what_is_no_way_is_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match=r"finite|more than 0"):
        CirclePlace(**wrong)
