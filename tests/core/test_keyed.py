"""Keyed values pass through their keys, are smooth everywhere, and hold still where keys are equal."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.curves.activation import EaseShape, ease
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, unit_quaternion
from studio.core.rotations import angle_between, from_matrix, to_matrix
from tests.core.motions import from_vectors

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


@pytest.mark.parametrize(
    ("times", "values", "sentence"),
    [
        ((0.0, 1.0), ((0, 0, 0),), "as many"),
        ((1.0, 0.5), ((0, 0, 0), (0, 0, 0)), "0.500 s comes after 1.000 s"),
        ((0.0, np.nan), ((0, 0, 0), (0, 0, 0)), "finite"),
        ((0.0,), ((0, np.nan, 0),), "3 finite numbers"),
        ((0.0,), ((0, 0),), "3 finite numbers"),
    ],
)
def test_keys_that_make_no_sense_are_refused(times: tuple, values: tuple, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        KeyedPlace(times, values)


def test_a_rotation_that_is_read_back_is_the_same_to_the_bit() -> None:
    random = np.random.default_rng(0)
    for numbers in random.normal(size=(5000, 4)):
        once = unit_quaternion(numbers)
        assert np.linalg.norm(once) == pytest.approx(1.0, abs=1e-15)
        assert unit_quaternion(once) == once
