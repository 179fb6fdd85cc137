"""Packed tuples: what kernels hand on as one address is the tuple it was made from."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from studio.core.kernels.compiling import kernel, pack


@kernel
def spread(packed, out_numbers):
    """Write what a packed tuple holds, by index, from its end and taken apart."""
    inner, factor, flag = packed
    (first, second), weights = inner
    out_numbers[0] = factor * first[0] + second[1, 2]
    out_numbers[1] = packed[1] * weights[-1]
    out_numbers[2] = packed[2] + flag
    first[1] = 7.0


@kernel
def spread_packed(values, again, out_numbers):
    """Pack a tuple with a packed tuple in it, as often as is asked, and hand it on."""
    for _ in range(again):
        (arrays, weights), factor, flag = values
        spread(pack((pack((arrays, weights)), factor, flag)), out_numbers)


def make_values():
    first, second = np.array([2.0, 3.0]), np.arange(6.0).reshape(2, 3)
    return ((first, second[:, :]), np.array([0.5, 4.0])), 10.0, 3


def test_a_packed_tuple_reads_as_the_tuple_it_was_made_from() -> None:
    plain, packed = np.zeros(3), np.zeros(3)
    spread(make_values(), plain)
    spread_packed(make_values(), 3, packed)
    assert plain.tolist() == packed.tolist() == [25.0, 40.0, 6.0]


def test_arrays_of_a_packed_tuple_are_those_of_its_maker() -> None:
    values = make_values()
    spread_packed(values, 1, np.zeros(3))
    assert values[0][0][0].tolist() == [2.0, 7.0]


class Place(NamedTuple):
    point: Any
    weight: float


class Pair(NamedTuple):
    here: Place
    there: Place


@kernel
def between(pair, out_point):
    """Point between two places, by their weights; by names."""
    whole = pair.here.weight + pair.there.weight
    for axis in range(3):
        share = pair.here.weight * pair.here.point[axis] + pair.there.weight * pair.there.point[axis]
        out_point[axis] = share / whole


@kernel
def between_packed(pair, out_point):
    """The same of a record that is packed, with packed records in it."""
    between(pack(Pair(pack(pair.here), pack(pair.there))), out_point)


def test_a_packed_record_reads_by_its_names_as_the_record_it_was_made_from() -> None:
    pair = Pair(Place(np.array([0.0, 3.0, 1.0]), 1.0), Place(np.array([3.0, 0.0, 1.0]), 2.0))
    plain, packed = np.zeros(3), np.zeros(3)
    between(pair, plain)
    between_packed(pair, packed)
    assert plain.tolist() == packed.tolist() == pytest.approx([2.0, 1.0, 1.0])
