"""Values that change in time: by keys, by tangents and by rules."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import (
    MIRROR_TRANSFORM,
    ClipTransform,
    constraint_on_clip,
    mirrored_constraint,
)
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace, NoisePlace, PendulumPlace, ProceduralPlace
from studio.core.curves.activation import ActivationCurve, EaseShape, ease
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, unit_quaternion
from studio.core.curves.tangents import Beyond, Tangent, TangentMode, Tangents, tangents_of
from studio.core.rotations import angle_between, from_matrix, to_matrix
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.prop_tracks import stage_track
from studio.core.stage.prop import Prop
from tests.builders import make_constraint
from tests.core.motions import RATE, from_vectors
from tests.core.test_targets import BODIES, solved

# Keyed values pass through their keys, are smooth everywhere, and hold still where keys are equal.


STEP = 1e-3
numbers = st.floats(-2.0, 2.0)
gaps = st.lists(st.floats(0.1, 1.0), min_size=1, max_size=5)


@st.composite
def keyed_places(draw: st.DrawFn) -> KeyedPlace:
    times = np.cumsum([draw(numbers), *draw(gaps)])
    return KeyedPlace(tuple(times), tuple(draw(st.tuples(numbers, numbers, numbers)) for _ in times))


@st.composite
def keyed_turns(draw: st.DrawFn) -> KeyedTurn:
    times = np.cumsum([draw(numbers), *draw(gaps)])
    vectors = np.array([draw(st.tuples(numbers, numbers, numbers)) for _ in times]) / 2.5
    return KeyedTurn(tuple(times), tuple(map(tuple, from_vectors(vectors))))


def around(keyed: KeyedPlace | KeyedTurn, step: float) -> np.ndarray:
    """Times over the keys and a little beyond, ``step`` apart, every key among them."""
    count = round((keyed.times[-1] - keyed.times[0] + 0.4) / step)
    return np.sort(np.concatenate([keyed.times, keyed.times[0] - 0.2 + step * np.arange(count)]))


@given(keyed_places())
def test_places_pass_through_their_keys_and_rest_beyond(keyed: KeyedPlace) -> None:
    assert keyed.at(keyed.times) == pytest.approx(np.array(keyed.values), abs=1e-9)
    assert keyed.at([keyed.times[0] - 5.0, keyed.times[-1] + 5.0]) == pytest.approx(
        np.array([keyed.values[0], keyed.values[-1]])
    )


@given(keyed_places())
def test_places_have_two_continuous_derivatives(keyed: KeyedPlace) -> None:
    """Over a key the second difference changes by no more than a bounded third derivative lets it."""
    shortest = min(np.diff(keyed.times))
    steepest = max(np.ptp(np.array(keyed.values), axis=0).max(), 1e-3) / shortest**3
    for key in keyed.times:
        places = keyed.at(key + STEP * np.arange(-3, 4))
        bends = np.diff(places, n=2, axis=0) / STEP**2
        assert np.abs(np.diff(bends, axis=0)).max() < 1000.0 * steepest * STEP + 1e-3


@given(keyed_places(), st.floats(-3.0, 3.0))
def test_turning_the_world_turns_the_path(keyed: KeyedPlace, angle: float) -> None:
    turn = to_matrix(from_vectors(angle * np.array([0.6, 0.0, 0.8])))
    turned = KeyedPlace(keyed.times, tuple(map(tuple, np.array(keyed.values) @ turn.T)))
    times = around(keyed, 0.05)
    assert turned.at(times) == pytest.approx(keyed.at(times) @ turn.T, abs=1e-9)


@given(st.lists(numbers, min_size=2, max_size=6))
def test_numbers_never_go_beyond_the_keys_around_them_and_equal_keys_hold(values: list[float]) -> None:
    values = [*values, values[-1]]
    keyed = KeyedNumber(tuple(map(float, range(len(values)))), tuple(values))
    for k, (a, b) in enumerate(pairwise(values)):
        between = keyed.at(k + np.linspace(0.0, 1.0, 21))
        assert between.min() >= min(a, b) - 1e-12
        assert between.max() <= max(a, b) + 1e-12


def test_two_keys_are_the_quintic_ease_and_even_steps_an_even_line() -> None:
    times = np.linspace(0.0, 1.0, 11)
    two = KeyedNumber((0.0, 1.0), (0.0, 1.0))
    assert two.at(times)[:, 0] == pytest.approx(ease(times, EaseShape.QUINTIC))
    four = KeyedNumber((0.0, 1.0, 2.0, 3.0), (0.0, 1.0, 2.0, 3.0))
    assert four.at(1.0 + times)[:, 0] == pytest.approx(1.0 + times)


@given(keyed_turns())
def test_turns_pass_through_their_keys_smoothly(keyed: KeyedTurn) -> None:
    reached = from_matrix(keyed.at(keyed.times))
    assert angle_between(reached, np.array(keyed.values)) == pytest.approx(0.0, abs=1e-7)
    times = around(keyed, 0.01)
    rotations = keyed.at(times)
    steps = angle_between(from_matrix(rotations[:-1]), from_matrix(rotations[1:]))
    assert steps.max() < 0.01 * 8.0 * np.pi / min(np.diff(keyed.times))


@given(keyed_turns())
def test_turns_have_two_continuous_derivatives(keyed: KeyedTurn) -> None:
    steepest = np.pi / min(np.diff(keyed.times)) ** 3
    for key in keyed.times:
        rotations = keyed.at(key + STEP * np.arange(-3, 4))
        bends = np.diff(rotations, n=2, axis=0) / STEP**2
        assert np.abs(np.diff(bends, axis=0)).max() < 1000.0 * steepest * STEP + 1e-3


def test_a_key_is_put_replaced_and_taken_away() -> None:
    keyed = KeyedPlace((1.0,), ((0.0, 0.0, 1.0),))
    two = keyed.with_key(0.5, (1, 0, 0))
    assert two.times == (0.5, 1.0)
    assert two.with_key(0.50005, (2, 0, 0)).values[0] == (2.0, 0.0, 0.0)
    assert two.key_at(0.5) == 0
    assert two.key_at(0.6) is None
    assert two.without_key(0) == keyed
    assert two.moved(1.0).times == (1.5, 2.0)
    with pytest.raises(ValueError, match="at least one"):
        keyed.without_key(0)


def test_a_rotation_that_is_read_back_is_the_same_to_the_bit() -> None:
    random = np.random.default_rng(0)
    for numbers in random.normal(size=(5000, 4)):
        once = unit_quaternion(numbers)
        assert np.linalg.norm(once) == pytest.approx(1.0, abs=1e-15)
        assert unit_quaternion(once) == once


# Tangents: a curve passes its keys, bends only where it was told to, and never flips a rotation.


SMALL = 1e-5
UNBROKEN = (TangentMode.AUTO, TangentMode.SMOOTH, TangentMode.FLAT, TangentMode.FREE)
weights = st.floats(0.2, 5.0)


def free(rate, weight=1.0):
    side = Tangent(TangentMode.FREE, tuple(rate), weight)
    return Tangents(side, side)


@st.composite
def bent(draw, keys, modes=UNBROKEN):
    """The keys with tangents of their own at each."""
    keyed = draw(keys)
    rates = st.tuples(*[st.floats(-6.0, 6.0)] * (3 if keyed.size > 1 else 1))
    tangents = []
    for _ in keyed.times:
        mode, pair = draw(st.sampled_from(modes)), (draw(weights), draw(weights))
        if mode is TangentMode.FREE:
            rate = draw(rates)
            tangents.append(Tangents(*(Tangent(mode, rate, weight) for weight in pair)))
        else:
            tangents.append(tangents_of(mode, pair))
    return replace(keyed, tangents=tuple(tangents))


def rotation_vectors(matrices):
    """(N - 1, 3) from each rotation to the next."""
    turns = Rotation.from_matrix(matrices)
    return (turns[:-1].inv() * turns[1:]).as_rotvec()


def plain(keyed, times):
    """Values of keys without tangents, as they were computed before there were any."""
    values, keys = keyed.points, np.array(keyed.times)
    rates = np.zeros_like(values)
    if len(keys) > 2:
        slopes = np.diff(values, axis=0) / np.diff(keys)[:, None]
        speeds = np.linalg.norm(slopes, axis=1)
        a, b, both = slopes[:-1], slopes[1:], slopes[:-1] + slopes[1:]
        cosine = np.sum(a * b, axis=1) / np.maximum(speeds[:-1] * speeds[1:], 1e-30)
        speed = np.minimum(speeds[:-1], speeds[1:]) * np.clip(cosine, 0.0, 1.0)
        rates[1:-1] = (speed / np.maximum(np.linalg.norm(both, axis=1), 1e-30))[:, None] * both
    t = np.clip(times, keys[0], keys[-1])
    before = np.clip(np.searchsorted(keys, t, "right") - 1, 0, max(len(keys) - 2, 0))
    after = np.minimum(before + 1, len(keys) - 1)
    share = ease((t - keys[before]) / np.maximum(keys[after] - keys[before], 1e-4), EaseShape.QUINTIC)
    begin = values[before] + (t - keys[before])[:, None] * rates[before]
    end = values[after] + (t - keys[after])[:, None] * rates[after]
    return begin + share[:, None] * (end - begin)


@given(keyed_places())
def test_keys_without_tangents_are_to_the_bit_what_they_always_were(keyed):
    times = np.linspace(keyed.times[0] - 0.5, keyed.times[-1] + 0.5, 200)
    assert np.array_equal(keyed.at(times), plain(keyed, times))


@given(bent(keyed_places(), tuple(TangentMode)[:5]))
def test_every_key_is_passed_whatever_its_tangents(keyed):
    assert keyed.at(keyed.times) == pytest.approx(np.array(keyed.values), abs=1e-9)


@given(bent(keyed_turns()))
def test_every_rotation_key_is_passed_whatever_its_tangents(keyed):
    assert keyed.at(keyed.times) == pytest.approx(to_matrix(np.array(keyed.values)), abs=1e-9)


@given(bent(keyed_places()))
def test_places_pass_a_key_at_one_rate_where_its_tangents_are_not_broken(keyed):
    arriving, leaving = keyed.rates()
    assert arriving == pytest.approx(leaving)
    for time, rate in zip(keyed.times[1:-1], leaving[1:-1], strict=True):
        before, at, after = keyed.at([time - SMALL, time, time + SMALL])
        assert (at - before) / SMALL == pytest.approx(rate, abs=0.02)
        assert (after - at) / SMALL == pytest.approx(rate, abs=0.02)


@given(bent(keyed_turns()))
def test_rotations_pass_a_key_at_one_rate_where_its_tangents_are_not_broken(keyed):
    _, leaving = keyed.rates()
    for time, rate in zip(keyed.times[1:-1], leaving[1:-1], strict=True):
        steps = rotation_vectors(keyed.at([time - SMALL, time, time + SMALL])) / SMALL
        assert steps[0] == pytest.approx(rate, abs=0.02)
        assert steps[1] == pytest.approx(rate, abs=0.02)


@given(bent(keyed_turns()))
def test_rotations_never_flip(keyed):
    """However steep the tangents are, a short time is a small rotation."""
    _, leaving = keyed.rates()
    steepest = np.linalg.norm(leaving, axis=1).max() + np.pi / min(np.diff(keyed.times))
    times = np.linspace(keyed.times[0], keyed.times[-1], 4000)
    angles = np.linalg.norm(rotation_vectors(keyed.at(times)), axis=1)
    assert angles.max() < 60.0 * steepest * (times[1] - times[0])


def test_a_rotation_whose_tangents_lead_past_half_a_turn_does_not_flip():
    quarter = (0.0, 0.0, np.sin(np.pi / 4), np.cos(np.pi / 4))
    rate = Tangent(TangentMode.FREE, (0.0, 0.0, 12.0))
    keyed = KeyedTurn(
        (0.0, 1.0), ((0.0, 0.0, 0.0, 1.0), quarter), tangents=(Tangents(rate, rate), Tangents(rate, rate))
    )
    angles = np.linalg.norm(rotation_vectors(keyed.at(np.linspace(0.0, 1.0, 1001))), axis=1)
    assert angles.max() < 0.05


@given(keyed_places())
def test_linear_tangents_are_straight_lines(keyed):
    straight = replace(keyed, tangents=(tangents_of(TangentMode.LINEAR),) * len(keyed.times))
    times = np.linspace(keyed.times[0], keyed.times[-1], 50)
    expected = np.stack([np.interp(times, keyed.times, column) for column in keyed.points.T], axis=1)
    assert straight.at(times) == pytest.approx(expected, abs=1e-9)


def test_stepped_keys_hold_until_the_next_one():
    keyed = KeyedNumber((0.0, 1.0, 2.0), (1.0, 2.0, 3.0), tangents=(tangents_of(TangentMode.STEPPED),) * 3)
    assert keyed.at([0.0, 0.999, 1.0, 1.999, 2.0, 3.0])[:, 0].tolist() == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]


@given(bent(keyed_places()), st.floats(0.3, 3.0))
def test_keys_that_are_scaled_in_time_keep_their_curve(keyed, factor):
    times = {index: time * factor for index, time in enumerate(keyed.times)}
    scaled = keyed.with_times(times, 1.0 / factor)
    at = np.linspace(keyed.times[0], keyed.times[-1], 60)
    assert scaled.at(at * factor) == pytest.approx(keyed.at(at), abs=1e-6)


def test_a_heavier_tangent_is_followed_for_longer():
    light = KeyedNumber((0.0, 1.0), (0.0, 1.0), tangents=(free((1.0,)), free((1.0,))))
    heavy = replace(light, tangents=(free((-2.0,), 4.0), None))
    usual = replace(light, tangents=(free((-2.0,)), None))
    assert heavy.at([0.4])[0, 0] < usual.at([0.4])[0, 0]


def test_curves_hold_loop_or_continue_beyond_their_ends():
    keyed = KeyedNumber((1.0, 2.0, 3.0), (0.0, 4.0, 0.0))
    loop = replace(keyed, before=Beyond.LOOP, after=Beyond.LOOP)
    times = np.linspace(1.0, 2.999, 37)
    for shift in (-4.0, -2.0, 2.0, 6.0):
        assert loop.at(times + shift) == pytest.approx(loop.at(times), abs=1e-9)
    on = KeyedNumber((0.0, 1.0), (0.0, 2.0), before=Beyond.CONTINUE, after=Beyond.CONTINUE)
    assert on.at([-1.0, 2.0, 3.0])[:, 0] == pytest.approx([-2.0, 4.0, 6.0])
    assert keyed.at([0.0, 9.0])[:, 0].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("beyond", [Beyond.LOOP, Beyond.CONTINUE])
def test_a_curve_goes_on_beyond_its_ends_without_a_corner(beyond):
    keyed = KeyedNumber((0.0, 0.7, 1.5, 2.0), (0.0, 1.0, 3.0, 0.0 if beyond is Beyond.LOOP else 4.0), after=beyond)
    before, at, after = keyed.at([2.0 - SMALL, 2.0, 2.0 + SMALL])[:, 0]
    assert (at - before) / SMALL == pytest.approx((after - at) / SMALL, abs=0.01)


def test_rotations_continue_about_their_axis():
    half = (0.0, 0.0, np.sin(0.25), np.cos(0.25))
    keyed = KeyedTurn((0.0, 1.0), ((0.0, 0.0, 0.0, 1.0), half), after=Beyond.CONTINUE)
    assert rotation_vectors(keyed.at([0.0, 3.0]))[0] == pytest.approx([0.0, 0.0, 1.5])


@given(st.lists(weights, min_size=4, max_size=4), st.sampled_from(EaseShape), gaps)
def test_a_weighted_activation_stays_in_its_range_and_rises_once(four, shape, lengths):
    start, full, full_end, end = np.cumsum([0.0, *(lengths * 3)[:3]]).tolist()
    curve = ActivationCurve(start, full, full_end, end, shape, weights=tuple(four))
    values = curve.at(np.linspace(start - 0.2, end + 0.2, 2001))
    assert values.min() == 0.0
    assert values.max() == 1.0
    changes = np.sign(np.round(np.diff(values), 12))
    assert (np.diff(changes[changes != 0]) != 0).sum() <= 1
    assert curve.at([start - 1e-9, end + 1e-9]).max() < 1e-6
    if shape is not EaseShape.LINEAR:
        slopes = np.diff(curve.at(np.array([start, full, full_end, end])[:, None] + [[-SMALL, 0.0, SMALL]]), axis=1)
        assert np.abs(slopes / SMALL).max() < 0.1


def test_an_activation_without_weights_is_to_the_bit_what_it_was():
    curve = ActivationCurve(0.1, 0.35, 0.7, 1.3)
    times = np.linspace(0.0, 1.5, 1000)
    rise, fall = (times - 0.1) / (0.35 - 0.1), (-times - -1.3) / (-0.7 - -1.3)
    assert np.array_equal(curve.at(times), ease(np.minimum(rise, fall), EaseShape.QUINTIC))


@given(bent(keyed_turns()))
def test_a_mirrored_rotation_curve_is_the_mirror_image_and_twice_the_curve_itself(keyed):
    base = make_constraint()
    constraint = OrientationConstraint(base.motion_id, "Hand", base.point, base.chain, 0, base.activation, target=keyed)
    once = mirrored_constraint(constraint)
    times = np.linspace(keyed.times[0], keyed.times[-1], 25)
    mirrored = MIRROR_TRANSFORM.rotations(Rotation.from_matrix(keyed.at(times)).as_quat(), base.point.part)
    assert once.target.at(times) == pytest.approx(to_matrix(mirrored), abs=1e-6)
    assert mirrored_constraint(once).target.at(times) == pytest.approx(keyed.at(times), abs=1e-9)


@given(bent(keyed_places()), numbers)
def test_moving_adding_and_deleting_keys_keeps_the_tangents_of_the_others(keyed, seconds):
    assert keyed.moved(seconds).tangents == keyed.tangents
    more = keyed.with_key(keyed.times[-1] + 1.0, (0.0, 0.0, 0.0))
    assert more.without_key(len(keyed.times)) == keyed
    again = keyed.with_key(keyed.times[0], (0.5, 0.0, 0.0))
    assert again.tangents == keyed.tangents


def test_a_key_that_is_moved_onto_another_takes_its_place_and_others_are_passed_by():
    keyed = KeyedNumber((0.0, 1.0, 2.0), (10.0, 11.0, 12.0))
    assert keyed.with_times({0: 1.0}) == KeyedNumber((1.0, 2.0), (10.0, 12.0))
    assert keyed.with_times({0: 1.5}) == KeyedNumber((1.0, 1.5, 2.0), (11.0, 10.0, 12.0))
    assert keyed.with_times({0: 2.0, 1: 3.0}) == KeyedNumber((2.0, 3.0), (10.0, 11.0))


def test_growth_with_tangents_stays_between_its_keys():
    keyed = KeyedProportions(
        (0.0, 1.0), (Proportions(), Proportions(stature=1.4)), tangents=(tangents_of(TangentMode.LINEAR),) * 2
    )
    assert keyed.proportions_at(0.5).stature == pytest.approx(1.2)


def test_a_project_without_tangents_is_written_as_ever_and_one_with_them_says_so():
    from studio.io.project.entity_json import entity_of, entity_record

    plain_keys = make_constraint(target=KeyedPlace((0.0, 1.0), ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0))))
    record = entity_record("constraints", "a", plain_keys, {})
    assert record["schema"] == 3
    assert set(record["target"]) == {"kind", "times", "values"}
    assert set(record["activation"]) == {"start", "full", "full_end", "end", "shape"}
    target = plain_keys.target.with_tangents(1, free((0.0, 1.0, 0.0), 2.0))
    activation = replace(plain_keys.activation, weights=(1.0, 2.0, 1.0, 1.0))
    curved = replace(plain_keys, target=replace(target, after=Beyond.LOOP), activation=activation)
    record = entity_record("constraints", "a", curved, {})
    assert record["schema"] == 4
    assert entity_of("constraints", record, lambda _name: None) == curved


# Places that move by a rule: the same at a time whenever it is asked, and where a clip plays as in its motion.


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
