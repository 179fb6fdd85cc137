"""Contacts found on real walks are those of walking."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.contacts import ContactPoint, contact_mask
from studio.core.normalized.normalize import capture_contacts
from tests.real.taken import named, taken

WALKS = ("bvhtoolbox_walk01", "pybvh_cmu_12_01_walk", "accad_female1_B15_WalkTurnAround180")


def _stances(stem: str) -> np.ndarray:
    """(2, F) whether heel or toe of each foot stands."""
    capture = taken(named(stem))[0]
    found = capture_contacts(capture)
    masks = [contact_mask(found[point], capture.frame_count)[capture.first_frame :] for point in ContactPoint]
    return np.array([masks[0] | masks[1], masks[2] | masks[3]])


@pytest.mark.parametrize("stem", WALKS)
def test_each_foot_stands_about_half_the_time(captures: Path, stem: str) -> None:
    shares = _stances(stem).mean(axis=1)
    assert (shares > 0.4).all()
    assert (shares < 0.75).all()


@pytest.mark.parametrize("stem", WALKS)
def test_left_and_right_land_in_turn(captures: Path, stem: str) -> None:
    landings = [(frame, side) for side, foot in enumerate(_stances(stem)) for frame in _rises(foot)]
    sides = [side for _, side in sorted(landings)]
    assert len(sides) >= 6
    assert (np.diff(sides) != 0).all()


@pytest.mark.parametrize("stem", WALKS)
def test_one_foot_nearly_always_carries_the_body(captures: Path, stem: str) -> None:
    assert _stances(stem).any(axis=0).mean() > 0.85


def _rises(mask: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.diff(mask.astype(int)) == 1)


@pytest.mark.parametrize("stem", ["accad_male2_E20_DodgeRight", "accad_female1_A05_PickUpBox", "pybvh_test2_yxz"])
def test_feet_that_stay_stand_from_beginning_to_end(captures: Path, stem: str) -> None:
    assert _stances(stem).all()


@pytest.mark.parametrize(("stem", "kicking"), [("mass_kick", 1), ("accad_male2_G9_RoundhouseRight", 1)])
def test_a_kicking_foot_leaves_the_ground_and_the_other_carries(captures: Path, stem: str, kicking: int) -> None:
    stances = _stances(stem)
    assert stances[kicking].mean() < 0.5
    assert stances[1 - kicking].mean() > 0.8
