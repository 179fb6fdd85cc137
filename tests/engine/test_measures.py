"""Lengths and angles are told in their own units, and judged by their own limits."""

import math

import pytest

from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.engine.residual_measures import ANGLE_MEASURE, LENGTH_MEASURE, measure_of
from tests.builders import make_constraint


@pytest.mark.parametrize(
    ("measure", "amount", "words"),
    [
        (LENGTH_MEASURE, 0.0004, "0.4 mm"),
        (LENGTH_MEASURE, 0.042, "42 mm"),
        (LENGTH_MEASURE, 1.2, "1.20 m"),
        (ANGLE_MEASURE, math.radians(0.4), "0.4°"),
        (ANGLE_MEASURE, math.radians(9.97), "10°"),
        (ANGLE_MEASURE, math.radians(42.0), "42°"),
    ],
)
def test_an_amount_is_told_with_its_unit(measure, amount, words):
    assert measure.text_of(amount) == words


def test_turning_kinds_are_missed_by_an_angle_and_the_others_by_a_length():
    common = {key: value for key, value in vars(make_constraint()).items() if key != "target"}
    assert measure_of(OrientationConstraint(**common)) is ANGLE_MEASURE
    assert measure_of(LookAtConstraint(**common)) is ANGLE_MEASURE
    assert measure_of(BalanceConstraint(**common)) is LENGTH_MEASURE
    assert measure_of(make_constraint()) is LENGTH_MEASURE


def test_half_a_degree_and_five_are_the_limits_of_what_is_seen_and_forgiven():
    assert math.degrees(ANGLE_MEASURE.held_below) == pytest.approx(0.5)
    assert math.degrees(ANGLE_MEASURE.partly_below) == pytest.approx(5.0)
    assert ANGLE_MEASURE.weight(math.radians(10.0)) == pytest.approx(LENGTH_MEASURE.weight(0.040))
