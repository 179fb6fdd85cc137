import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.curves.activation import ActivationCurve
from studio.timeline.axis import TimeAxis
from studio.timeline.curves import foot_speed
from studio.timeline.gestures.activation import time_of, with_time
from studio.timeline.shown import HANDLE_PARTS, ItemPart
from studio.timeline.snapping import Snapped, snapped_time
from tests.builders import make_project
from tests.timeline.fakes import make_result

CURVE = ActivationCurve(1.0, 2.0, 3.0, 4.0)


@given(st.sampled_from(HANDLE_PARTS), st.floats(0, 5))
def test_a_handle_goes_where_it_is_put_and_pushes_only_what_is_in_its_way(part, time):
    moved = with_time(CURVE, part, time)
    assert time_of(moved, part) == time
    for other in HANDLE_PARTS:
        before = time_of(CURVE, other)
        assert time_of(moved, other) in (before, time)
        if min(time, time_of(CURVE, part)) > before or max(time, time_of(CURVE, part)) < before:
            assert time_of(moved, other) == before


def test_full_dragged_past_the_end_takes_the_end_along():
    assert with_time(CURVE, ItemPart.FULL, 4.5) == ActivationCurve(1.0, 4.5, 4.5, 4.5)


def make_axis():
    axis = TimeAxis()
    axis.set_position(0.0, 1020.0)
    axis.set_extent(0.0, 10.0, 10.0)
    return axis  # 100 pixels a second, 10 a frame


@pytest.mark.parametrize(
    ("time", "free", "result"),
    [
        (1.234, False, Snapped(1.2)),
        (1.234, True, Snapped(1.234)),
        (2.00, False, Snapped(2.05, 2.05)),
        (1.98, False, Snapped(2.0)),
        (2.00, True, Snapped(2.0)),
    ],
)
def test_times_catch_on_magnets_within_six_pixels_and_else_on_frames(time, free, result):
    assert snapped_time(make_axis(), time, (2.05, 7.0), free) == result


def test_foot_speed_is_that_of_the_faster_foot():
    result = make_result(make_project(), {})
    assert foot_speed(result) == pytest.approx(np.full(30, 2.0))
    assert foot_speed(result, (1,)) == pytest.approx(np.zeros(30))
