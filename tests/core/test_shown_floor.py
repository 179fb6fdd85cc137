"""The floor that a motion's own footprints show, and heels that leave it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.captures.contacts import contact_mask
from studio.core.captures.rising_heels import rising_heels
from studio.core.normalized.realize import realize_motion
from studio.core.solver.standing.shown_floor import shown_floor
from tests.builders import make_morphology
from tests.core.motions import walk

BODY = make_morphology(leg_scale=1.1)
WALK, CONTACTS = walk(240)
POSITIONS = realize_motion(WALK, BODY)[0]


@given(st.floats(-0.02, 0.02), st.floats(-0.05, 0.05))
def test_a_floor_that_drifts_is_found_as_far_as_it_drifts(slope: float, height: float) -> None:
    """A body raised by a floor that climbs through time is lowered by it again."""
    seconds = WALK.times
    floor = height + slope * seconds
    raised = POSITIONS.copy()
    raised[:, :, 2] += floor[:, None]
    usual = shown_floor(CONTACTS, POSITIONS, BODY, WALK.frame_rate)
    found = shown_floor(CONTACTS, raised, BODY, WALK.frame_rate) - usual
    inner = slice(60, 180)
    assert np.abs(found - floor)[inner].max() < 0.4 * abs(slope) + 1e-9


def test_who_never_stands_shows_no_floor() -> None:
    assert not shown_floor((), POSITIONS, BODY, WALK.frame_rate).any()


def _ankle(heights: np.ndarray) -> np.ndarray:
    return np.stack([np.zeros(len(heights)), np.zeros(len(heights)), heights], axis=1)


@given(st.floats(0.02, 0.08), st.integers(30, 60))
def test_a_heel_stands_until_it_rises(rise: float, begin: int) -> None:
    """A heel is in contact until it rises over a ball that stands."""
    frames = np.arange(90)
    heights = 0.08 + rise * np.clip((frames - begin) / (89 - begin), 0.0, 1.0)
    rising = rising_heels([(0, 89)], contact_mask([(0, 89)], 90), _ankle(heights), 0.85)
    assert not rising[: begin + 1].any()
    assert rising[-1]
    assert np.all(np.diff(rising.astype(int)) >= 0)
    assert (heights[~rising] < 0.08 + 0.01).all()


def test_a_heel_that_trembles_stands() -> None:
    heights = 0.08 + 0.006 * np.sin(np.arange(90) / 3)
    assert not rising_heels([(0, 89)], contact_mask([(0, 89)], 90), _ankle(heights), 0.85).any()


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_a_heel_that_stands_is_no_rise(seed: int) -> None:
    """Half a degree of noise in every joint moves ankles by a centimetre."""
    ankle = _ankle(np.full(300, 0.08)) + np.random.default_rng(seed).normal(scale=0.012, size=(300, 3))
    assert rising_heels([(0, 299)], contact_mask([(0, 299)], 300), ankle, 0.85).mean() < 0.05
