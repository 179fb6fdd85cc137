"""Clips of a performer that a strike takes over from."""

import itertools

import pytest

from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clips_until
from studio.core.stage.project import Performer

RATE = 60.0


@pytest.mark.parametrize("time", [0.5, 1.0, 1.4, 2.0, 2.7])
def test_a_looped_clip_plays_on_until_the_strike_in_the_middle_of_a_loop(time: float) -> None:
    walk = Clip("walk", 0, 60, repeats=3, id="walk", turn=0.3)
    kept = clips_until(Performer("Woman", "woman", (walk,)), time, {"walk": RATE})
    assert kept[0].id == "walk"
    assert len({each.id for each in kept}) == len(kept)
    assert kept[0].start == 0.0
    for one, after in itertools.pairwise(kept):
        assert after.start == pytest.approx(one.start + one.length(RATE))
        assert after.joined
    assert kept[-1].start + kept[-1].length(RATE) == pytest.approx(time, abs=0.5 / RATE)
