"""Clips of one to three frames, repeated and at any speed, play on the timeline and live."""

import pytest

from tests.live.short_clips import play


@pytest.mark.parametrize("seed", range(16))
def test_rows_of_clips_of_hardly_a_frame_play(seed: int) -> None:
    assert play(seed, live=seed % 4 == 0) > 0
