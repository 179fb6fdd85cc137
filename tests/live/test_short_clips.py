"""Clips of one to three frames, repeated and at any speed, play on the timeline and live."""

import pytest

from tests.live import clip_commands
from tests.live.short_clips import play


@pytest.mark.parametrize("seed", range(16))
def test_rows_of_clips_of_hardly_a_frame_play(seed: int) -> None:
    assert play(seed, live=seed % 4 == 0) > 0


@pytest.mark.parametrize("seed", range(8))
def test_commands_on_such_rows_play_and_are_undone_and_redone_to_the_byte(seed: int) -> None:
    assert clip_commands.play(seed, live=seed % 4 == 0) > 0
