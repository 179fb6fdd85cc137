"""Contacts of feet that tread on force plates."""

import numpy as np
import pytest

from studio.core.captures.contacts import ContactPoint, Span
from studio.core.captures.plate_steps import contacts_fitted_to_plates
from studio.core.markers.force_plates import PlateLoad

RATE = 100.0
PLATE = np.array([[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]])
HEEL, TOE = ContactPoint.LEFT_HEEL, ContactPoint.LEFT_TOE
OTHER = {ContactPoint.RIGHT_HEEL: [(0, 99)], ContactPoint.RIGHT_TOE: [(0, 99)]}


def soles(left: float = 0.0, right: float = 2.0) -> np.ndarray:
    """(100, 2, 3, 3): feet that point along X, their balls at ``left`` and ``right`` from the middle of the plate."""
    places = np.zeros((100, 2, 3, 3))
    places[..., 0] = np.array([left, right])[:, None] + np.array([-0.15, 0.0, 0.08])
    return places


def fitted(heel: list[Span], toe: list[Span], load: Span, places: np.ndarray) -> tuple[list[Span], list[Span]]:
    found = contacts_fitted_to_plates({HEEL: heel, TOE: toe, **OTHER}, places, [PlateLoad(*load, PLATE)], RATE)
    assert {point: found[point] for point in OTHER} == OTHER
    return found[HEEL], found[TOE]


@pytest.mark.parametrize("corners", [PLATE, PLATE[::-1]])
@pytest.mark.parametrize(
    ("load", "heel", "toe"), [((20, 70), [(20, 50)], [(35, 70)]), ((28, 62), [(28, 50)], [(35, 62)])]
)
def test_a_foot_stands_from_the_first_to_the_last_frame_of_its_load(
    corners: np.ndarray, load: Span, heel: list[Span], toe: list[Span]
) -> None:
    found = contacts_fitted_to_plates(
        {HEEL: [(25, 50)], TOE: [(35, 66)], **OTHER}, soles(), [PlateLoad(*load, corners)], RATE
    )
    assert (found[HEEL], found[TOE]) == (heel, toe)


def test_a_foot_does_not_leave_a_plate_that_it_loads() -> None:
    assert fitted([(20, 40)], [(30, 48), (56, 70)], (20, 70), soles()) == ([(20, 40)], [(30, 70)])


@pytest.mark.parametrize("places", [soles(left=0.3), soles(right=0.1), soles(left=1.0)])
def test_a_foot_across_the_edge_both_feet_or_none_on_a_plate_stand_by_their_motion(places: np.ndarray) -> None:
    assert fitted([(25, 50)], [(35, 66)], (20, 70), places) == ([(25, 50)], [(35, 66)])


def test_a_foot_may_rest_on_a_plate_long_before_it_loads_it() -> None:
    assert fitted([(0, 99)], [(0, 99)], (40, 95), soles()) == ([(0, 95)], [(0, 95)])
