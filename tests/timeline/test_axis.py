import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.timeline.axis import AXIS_MARGIN, TimeAxis


def make_axis(seconds=10.0, frame_rate=30.0):
    axis = TimeAxis()
    axis.set_position(196.0, 1000.0)
    axis.set_extent(0.0, seconds, frame_rate)
    return axis


def test_all_of_time_is_shown_at_first_with_a_margin_on_both_sides():
    axis = make_axis()
    assert axis.x_of_frame(0) == pytest.approx(196 + AXIS_MARGIN)
    assert axis.x_of_frame(300) == pytest.approx(1196 - AXIS_MARGIN)


@given(st.floats(-500, 3000), st.floats(0.5, 4.0), st.floats(200, 1190))
def test_a_pixel_and_its_frame_name_each_other(x, factor, about):
    axis = make_axis()
    axis.zoom(factor, about)
    assert axis.x_of_frame(axis.frame_at(x)) == pytest.approx(x, abs=1e-6)


@given(st.floats(300, 1100), st.floats(1.2, 5.0))
def test_zooming_in_keeps_the_moment_under_the_mouse(x, factor):
    axis = make_axis()
    before = axis.time_at(x)
    axis.zoom(factor, x)
    assert axis.time_at(x) == pytest.approx(before)
    assert axis.scale == pytest.approx(factor * 98.0)


def test_zooming_out_ends_where_all_is_shown():
    axis = make_axis()
    axis.zoom(4.0, 500.0)
    axis.zoom(0.01, 900.0)
    assert axis.x_of_frame(0) == pytest.approx(196 + AXIS_MARGIN)
    assert axis.x_of_frame(300) == pytest.approx(1196 - AXIS_MARGIN)


def test_what_shows_everything_goes_on_to_when_the_widget_grows_or_the_clip_does():
    axis = make_axis()
    axis.set_position(196.0, 500.0)
    assert axis.x_of_frame(300) == pytest.approx(696 - AXIS_MARGIN)
    axis.set_extent(0.0, 20.0, 30.0)
    assert axis.x_of_frame(600) == pytest.approx(696 - AXIS_MARGIN)


def test_scrolling_stops_at_the_ends():
    axis = make_axis()
    axis.zoom(4.0, 500.0)
    axis.scroll(1e6)
    assert axis.x_of_frame(300) == pytest.approx(1196 - AXIS_MARGIN)
    axis.scroll(-1e6)
    assert axis.x_of_frame(0) == pytest.approx(196 + AXIS_MARGIN)


def test_a_moment_that_left_the_view_turns_the_page():
    axis = make_axis()
    axis.zoom(4.0, 196.0)
    axis.reveal(5.0)
    assert axis.x_of_time(5.0) == pytest.approx(196 + AXIS_MARGIN)
    start = axis.start
    axis.reveal(6.0)
    assert axis.start == start


@given(st.floats(-1e6, 1e6), st.floats(1e-9, 1e9))
def test_any_time_at_any_zoom_has_a_pixel_that_can_be_painted(seconds, factor):
    axis = make_axis(seconds=1e5)
    axis.zoom(factor, 700.0)
    x = axis.x_of_time(seconds)
    assert abs(x) < 2**30
    assert (axis.left <= x <= axis.right) == (axis.time_at(axis.left) <= seconds <= axis.time_at(axis.right)) or (
        min(abs(x - axis.left), abs(x - axis.right)) < 1e-3
    )


def test_a_trim_leaves_everything_where_it_is_and_fitting_shows_all_again():
    axis = make_axis()
    before = axis.x_of_frame(90)
    axis.set_extent(0.0, 6.0, 30.0, keeps_scale=True)
    assert (axis.x_of_frame(90), axis.scale) == pytest.approx((before, 98.0))
    axis.set_extent(0.0, 10.0, 30.0, keeps_scale=True)
    assert (axis.x_of_frame(90), axis.scale) == pytest.approx((before, 98.0))
    axis.set_extent(0.0, 6.0, 30.0, keeps_scale=True)
    axis.fit()
    assert axis.x_of_frame(180) == pytest.approx(1196 - AXIS_MARGIN)


def test_a_fitted_view_shows_another_motion_whole_be_it_longer_or_shorter():
    axis = make_axis()
    for seconds in (6.0, 20.0, 3.0):
        axis.set_extent(0.0, seconds, 30.0)
        assert axis.x_of_time(seconds) == pytest.approx(1196 - AXIS_MARGIN)
