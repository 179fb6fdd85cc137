"""Heels that rise over a ball that stands."""

import numpy as np
import pytest

from studio.core.kernels.support import heel_roll
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS
from studio.core.rotations import to_matrix
from tests.core.motions import about

SOLE = np.array([[0.13, 0.0, -0.05, 0.08, 0.05, 0.06]])
"""Ankle to toe joint, ankle above the sole, heel behind the ankle, length of the toe."""
STATES = np.repeat([SOLE_STANDS, TOE_STANDS, 0, SOLE_STANDS], [30, 30, 30, 30])
RISE = np.where(STATES == TOE_STANDS, 0.04 * np.clip((np.arange(120) - 30) / 20, 0.0, 1.0), 0.0)


def _level() -> np.ndarray:
    return to_matrix(about([0.0, 1.0, 0.0], np.zeros(120)))


def _ankles(rotations: np.ndarray) -> np.ndarray:
    """Heights of the ankle over a sole whose ball stands."""
    return SOLE[0, 3] + SOLE[0, 2] - rotations[:, 2] @ SOLE[0, :3]


def test_an_ankle_is_as_high_as_the_motion_has_it_soon_after_its_heel_left_the_ground() -> None:
    rotations = _level()
    heel_roll.lift_heels(SOLE, STATES, SOLE[0, 3] + RISE, 10.0, 10.0, rotations)
    assert np.allclose(_ankles(rotations)[:30], SOLE[0, 3], atol=1e-12)
    assert np.allclose(_ankles(rotations)[45:60], SOLE[0, 3] + RISE[45:60], atol=0.1 * 0.04)


def test_the_ankle_of_a_foot_that_becomes_steep_rises_ever_more_slowly_as_captured() -> None:
    """The foot pitches to 65 degrees: an ankle that went its own way from some pitch on would straighten the knee."""
    pitches = np.radians(65.0) * np.where(STATES == TOE_STANDS, np.clip((np.arange(120) - 29) / 30, 0.0, 1.0), 0.0)
    steep, captured = (to_matrix(about([0.0, 1.0, 0.0], fraction * pitches)) for fraction in (1.0, 0.8))
    heel_roll.lift_heels(SOLE, STATES, _ankles(captured), 10.0, 10.0, steep)
    assert (np.diff(_ankles(captured)[45:60], 2) < 0.0).all()
    assert (np.diff(_ankles(steep)[45:60], 2) < 0.0).all()


def test_a_contact_in_which_no_heel_stands_is_left_as_it_is() -> None:
    """A body that kneels or lies rolls over nothing."""
    states = np.where(STATES == SOLE_STANDS, 0, STATES)
    rotations = _level()
    heel_roll.lift_heels(SOLE, states, SOLE[0, 3] + RISE, 10.0, 10.0, rotations)
    assert np.array_equal(rotations, _level())


@pytest.mark.parametrize("miss", [0.0, 0.005, 0.02, 0.05])
def test_a_foot_rolls_on_where_its_leg_is_too_short_and_its_ball_stays(miss: float) -> None:
    rotations, ankles = _level(), np.tile([0.0, 0.0, SOLE[0, 3]], (120, 1))
    hips = np.tile([0.4, 0.0, 0.8], (120, 1))
    reaches = np.full(120, np.linalg.norm(hips[0] - ankles[0]) - miss)
    balls = ankles + rotations @ SOLE[0, :3]
    heel_roll.roll_feet(SOLE, STATES, hips, reaches, 10.0, ankles, rotations)
    assert np.allclose((ankles + rotations @ SOLE[0, :3])[STATES != 0], balls[STATES != 0], atol=1e-12)
    lacks = np.linalg.norm(hips - ankles, axis=1) - reaches
    assert np.allclose(lacks[:30], miss, atol=1e-12)
    assert lacks[50:60].max() < 0.35 * miss + 1e-9


@pytest.mark.parametrize("miss", [0.0, 0.005, 0.02])
def test_a_foot_that_lands_rolls_back_over_its_heel_where_its_leg_is_too_short(miss: float) -> None:
    states = np.repeat([0, HEEL_STANDS, SOLE_STANDS, 0], 30)
    rotations, ankles = _level(), np.tile([0.0, 0.0, SOLE[0, 3]], (120, 1))
    hips = np.tile([-0.4, 0.0, 0.8], (120, 1))
    reaches = np.full(120, np.linalg.norm(hips[0] - ankles[0]) - miss)
    edge = [-SOLE[0, 4], 0.0, -SOLE[0, 3]]
    heel_roll.roll_feet(SOLE, states, hips, reaches, 10.0, ankles, rotations)
    assert np.allclose((ankles + rotations @ edge)[30:90], edge + np.array([0.0, 0.0, SOLE[0, 3]]), atol=1e-12)
    lacks = np.linalg.norm(hips - ankles, axis=1) - reaches
    assert np.allclose(lacks[60:90], miss, atol=1e-12)
    assert lacks[30:50].max() < 0.35 * miss + 1e-9


def test_a_ball_that_has_risen_stands_on_the_tip_of_its_toes() -> None:
    pitches = np.empty(120)
    heel_roll.tiptoe_pitches(SOLE, STATES, RISE, 10.0, pitches)
    assert not pitches[STATES != TOE_STANDS].any()
    assert 0.3 < pitches[59] < heel_roll.STEEPEST_TOE
    heel_roll.tiptoe_pitches(SOLE, STATES, 0.2 * RISE, 10.0, pitches)
    assert not pitches.any()
