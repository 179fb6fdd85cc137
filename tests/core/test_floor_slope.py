"""The slope of a captured floor is found where steps lead far enough to show it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.captures.contacts import FOOT_POINTS, contact_mask, detect_contacts
from studio.core.captures.floor_slope import find_floor_slope

RATE = 30.0
HEEL_BALL_TIP = np.array([[-0.06, 0.0, 0.0], [0.14, 0.0, 0.02], [0.2, 0.0, 0.02]])
UPRIGHT = np.ones((150, 2), dtype=bool)


def _walk(stride: float, count: int = 150) -> np.ndarray:
    """Soles (F, 2, 3, 3) on a level floor that stand for half a second, then swing for half a second."""
    soles = np.zeros((count, 2, 3, 3))
    for side in range(2):
        swing = np.clip((np.arange(count) + 15 * side) % 30 - 15, 0, 15) / 15.0
        stepped = (np.arange(count) + 15 * side) // 30 + swing - np.sin(2 * np.pi * swing) / (2 * np.pi)
        ankle = np.stack([stride * stepped, np.full(count, 0.2 * side), 0.1 * np.sin(np.pi * swing) ** 2], axis=1)
        soles[:, side] = ankle[:, None] + HEEL_BALL_TIP
    return soles


def _tilted(soles: np.ndarray, gradient: tuple[float, float]) -> np.ndarray:
    tilted = soles.copy()
    tilted[..., 2] += soles[..., :2] @ np.array(gradient)
    return tilted


@given(st.floats(-0.035, 0.035), st.floats(-0.035, 0.035))
def test_a_walk_shows_how_its_floor_rises_along_it(along: float, across: float) -> None:
    found = find_floor_slope(_tilted(_walk(1.2), (along, across)), UPRIGHT, RATE)
    assert abs(found.gradient[0] - along) < 0.1 * abs(along) + 0.002
    assert abs(found.gradient[1]) < abs(across) + 0.002  # it leads nowhere across


@pytest.mark.parametrize("rise", [-0.035, 0.035])
def test_a_walk_on_a_tilted_floor_stands_where_it_does_on_a_level_one(rise: float) -> None:
    walk = _walk(1.2)
    tilted = _tilted(walk, (rise, 0.0))
    levelled = find_floor_slope(tilted, UPRIGHT, RATE).levelled(tilted)
    level, found = (detect_contacts(soles, RATE) for soles in (walk, levelled))
    for point in FOOT_POINTS:
        stands, kept = contact_mask(level[point], 150), contact_mask(found[point], 150)
        assert stands.sum() > 50
        assert (stands & kept).sum() >= 0.95 * stands.sum()


def test_steps_on_the_spot_show_no_slope() -> None:
    soles = _walk(0.0)
    soles[90:, 0, :, 2] += 0.03  # from here on the left foot stands on something
    assert np.linalg.norm(find_floor_slope(soles, UPRIGHT, RATE).gradient) < 0.005


def test_stairs_are_no_slope() -> None:
    assert not find_floor_slope(_tilted(_walk(0.6), (0.4, 0.0)), UPRIGHT, RATE).gradient.any()


def test_legs_that_do_not_stand_show_no_slope() -> None:
    assert not find_floor_slope(_tilted(_walk(1.2), (0.03, 0.0)), ~UPRIGHT, RATE).gradient.any()
