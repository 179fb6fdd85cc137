"""Timecode: laws that hold at every rate, and the numbers that the standard skips."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.timeline.timecode import frame_of_timecode, timecode

NTSC_30, NTSC_60 = 30000 / 1001, 60000 / 1001
RATES = (24.0, 25.0, 30.0, 50.0, 60.0, 24000 / 1001, NTSC_30, NTSC_60, 29.97, 59.94, 100.0, 120.0, 240.0, 0.2)
rates, frames = st.sampled_from(RATES), st.integers(0, 9_999_999)


@given(frames, rates)
def test_a_timecode_is_read_back_as_its_frame(frame, rate):
    assert frame_of_timecode(timecode(frame, rate), rate) == frame


@given(frames, rates)
def test_timecodes_are_in_the_order_of_frames(frame, rate):
    first, second = (list(map(int, timecode(each, rate).replace(";", ":").split(":"))) for each in (frame, frame + 1))
    assert first < second


@given(st.integers(0, 99), st.integers(0, 59), st.integers(0, 59), st.data(), st.sampled_from(RATES[:5]))
def test_at_whole_rates_a_timecode_is_the_time_on_the_clock(hours, minutes, seconds, data, rate):
    frame = data.draw(st.integers(0, int(rate) - 1))
    text = f"{hours:02}:{minutes:02}:{seconds:02}:{frame:02}"
    number = (3600 * hours + 60 * minutes + seconds) * int(rate) + frame
    assert frame_of_timecode(text, rate) == number
    assert timecode(number, rate) == text


@given(frames, st.sampled_from((NTSC_30, NTSC_60)))
def test_drop_frame_keeps_step_with_the_clock(frame, rate):
    """Never further than the numbers skipped at once, and a millisecond in every hour of the standard's own."""
    hours, minutes, seconds, rest = map(int, timecode(frame, rate).replace(";", ":").split(":"))
    shown = 3600 * hours + 60 * minutes + seconds + rest / round(rate)
    assert abs(shown - frame / rate) < 0.07 + 0.004 * (1 + hours)


@pytest.mark.parametrize(
    ("frame", "rate", "text"),
    [
        (0, 24, "00:00:00:00"),
        (1799, NTSC_30, "00:00:59;29"),
        (1800, NTSC_30, "00:01:00;02"),
        (17981, NTSC_30, "00:09:59;29"),
        (17982, NTSC_30, "00:10:00;00"),
        (3600, NTSC_60, "00:01:00;04"),
        (107892, NTSC_30, "01:00:00;00"),
        (239, 240, "00:00:00:239"),
    ],
)
def test_a_frame_has_the_timecode_that_it_has_in_broadcasting(frame, rate, text):
    assert timecode(frame, rate) == text


@pytest.mark.parametrize(("text", "frame"), [("7", 7), ("2:07", 67), ("1:02:07", 1867), ("90:00", 2700)])
def test_parts_may_be_left_out_on_the_left(text, frame):
    assert frame_of_timecode(text, 30) == frame


@pytest.mark.parametrize("text", ["", ":", "1:", "a", "-1", "1:2:3:4:5", "1 2"])
def test_other_text_is_no_timecode(text):
    with pytest.raises(ValueError, match="no timecode"):
        frame_of_timecode(text, 25)
