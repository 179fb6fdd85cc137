"""Drawing of thousands of contacts and frames: as much as a pixel can tell, and none of it wrong."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QApplication

from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion
from studio.timeline.axis import TimeAxis
from studio.timeline.curves import Curve, displayed_curve
from studio.timeline.shown import RowContext
from studio.timeline.subject import ActiveMotion
from studio.timeline.tracks.brush import font
from studio.timeline.tracks.clip import elided_text
from studio.timeline.tracks.contacts import MIN_CONTACT_BAR_PX, seen_bars

RATE = 60.0
WORDS = "front_leg_low · 67 frames at 60 fps · mirrored"


def make_shown(frames: int, width: float = 1000.0) -> RowContext:
    axis = TimeAxis()
    axis.set_position(200.0, width)
    axis.set_extent(0.0, frames / RATE, RATE)
    subject = ActiveMotion("", Clip("motion", 0, frames), Motion("", ""), RATE, frames + 1, ())
    return RowContext(None, None, axis, subject)  # type: ignore[arg-type]


def make_curve(values: np.ndarray) -> Curve:
    return Curve("body", "#ffffff", np.arange(len(values)) / RATE, values, float(values.max()))


def spans_of(gaps: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Contacts in time: so many frames after the last one, so many long."""
    found, frame = [], 0
    for gap, length in gaps:
        found.append((frame + gap, frame + gap + length))
        frame += gap + length
    return found


gaps = st.lists(st.tuples(st.integers(1, 400), st.integers(0, 400)), min_size=1, max_size=40)


@given(gaps)
def test_bars_cover_every_contact_and_none_lies_on_another(gaps: list[tuple[int, int]]) -> None:
    spans = spans_of(gaps)
    shown = make_shown(spans[-1][1] + 100, 300.0)
    bars = seen_bars(shown, spans)
    assert all(before[1] <= after[0] for before, after in itertools.pairwise(bars))
    for first, last in spans:
        left, right = shown.x_of_frame(first), shown.x_of_frame(last)
        assert any(begin <= left + 1e-9 and end >= right - 1e-9 for begin, end in bars)


@given(gaps)
def test_bars_that_lie_apart_are_drawn_one_by_one(gaps: list[tuple[int, int]]) -> None:
    spans = spans_of(gaps)
    shown = make_shown(spans[-1][1] + 100)
    shown.axis.zoom(1e6, 200.0)  # as near as can be, the first frames in sight
    seen = [(shown.x_of_frame(first), shown.x_of_frame(last)) for first, last in spans]
    seen = [pair for pair in seen if pair[0] <= shown.axis.right]
    wide = [((left + right - MIN_CONTACT_BAR_PX) / 2, (left + right + MIN_CONTACT_BAR_PX) / 2) for left, right in seen]
    expected = [max(pair, bar, key=lambda each: each[1] - each[0]) for pair, bar in zip(seen, wide, strict=True)]
    assert seen_bars(shown, spans) == [pytest.approx(bar) for bar in expected]


def test_an_hour_of_contacts_is_as_many_bars_as_fit() -> None:
    spans = spans_of([(20, 20)] * 5000)
    assert len(seen_bars(make_shown(spans[-1][1]), spans)) <= 1000 / MIN_CONTACT_BAR_PX


@given(st.integers(2, 900), st.integers(0, 2**32 - 1))
def test_a_short_curve_is_drawn_frame_by_frame(frames: int, seed: int) -> None:
    curve = make_curve(np.random.default_rng(seed).random(frames))
    times, values = displayed_curve(curve, make_shown(frames).axis)
    assert np.array_equal(times, curve.times)
    assert np.array_equal(values, curve.values)


@given(st.integers(5_000, 60_000), st.integers(0, 2**32 - 1), st.floats(1.0, 30.0), st.floats(0.0, 1.0))
def test_of_a_long_curve_every_peak_in_sight_is_drawn(frames: int, seed: int, zoom: float, place: float) -> None:
    curve = make_curve(np.random.default_rng(seed).random(frames))
    axis = make_shown(frames).axis
    axis.zoom(zoom, axis.left + place * axis.width)
    times, values = displayed_curve(curve, axis)
    seen = (curve.times >= axis.time_at(axis.left)) & (curve.times <= axis.time_at(axis.right))
    assert len(values) < 4 * axis.width + 10
    assert (np.diff(times) >= 0.0).all()
    assert values.max() >= curve.values[seen].max()
    assert values.min() <= curve.values[seen].min()
    assert set(values) <= set(curve.values)


@pytest.mark.parametrize(
    ("room", "seen"), [(400, WORDS), (230, "front_leg_low · 67 frames at 60 fps"), (110, "front_leg_low")]
)
def test_a_bar_says_as_many_of_its_words_as_it_has_room_for_whole(qapp: QApplication, room: int, seen: str) -> None:
    assert elided_text(WORDS, QFontMetrics(font()), room) == seen


def test_a_name_too_long_for_its_bar_ends_in_dots(qapp: QApplication) -> None:
    assert elided_text(WORDS, QFontMetrics(font()), 60).startswith("front")
    assert elided_text(WORDS, QFontMetrics(font()), 60).endswith("…")
