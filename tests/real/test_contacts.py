"""Contacts found on real walks are those of walking."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from studio.core.captures.capture import Capture
from studio.core.captures.contacts import FOOT_POINTS, ContactPoint, contact_mask
from studio.core.markers.force_plates import plate_reactions, sample_times
from studio.core.normalized.normalize import capture_contacts
from studio.io.importing import load_capture, read_capture
from studio.io.registry import ReadCapture
from tests.captures import capture_file, outside
from tests.real.taken import RECORDINGS, named, taken

MARKED = ("btk_PiG_FullBody_walk", "btk_PiG_LowerBody_walk", "sample09_PlugInC3D")
"""Trials in which an operator marked every strike and off of a foot."""
ON_PLATES = {"btk_Gait_dec_int": 10.0, "sample01_Eb015pi": 45.0}
"""Trials on force plates without such marks, and the newtons that their plates show when empty."""
WALKS = ("bvhtoolbox_walk01", "pybvh_cmu_12_01_walk", "accad_female1_B15_WalkTurnAround180")


def _stances(stem: str) -> np.ndarray:
    """(2, F) whether heel or toe of each foot stands."""
    capture = taken(named(stem))[0]
    return _standing(capture)[:, capture.first_frame :]


def _standing(capture: Capture) -> np.ndarray:
    found = capture_contacts(capture)
    masks = [contact_mask(found[point], capture.frame_count) for point in FOOT_POINTS]
    return np.array([masks[0] | masks[1], masks[2] | masks[3]])


@cache
def _read(path: Path) -> ReadCapture:
    return read_capture(path)


def _marked_misses(path: Path, capture: Capture) -> list[float]:
    """Seconds from each strike and off that is marked in a trial to the nearest one that is found."""
    stances = np.pad(_standing(capture), ((0, 0), (1, 1)))
    misses = []
    for label in _read(path).annotations.labels:
        side, _, what = label.name.split()
        turns = np.flatnonzero(
            np.diff(stances[("Left", "Right").index(side)].astype(int)) == (1 if what == "Strike" else -1)
        )
        if label.first < capture.frame_count - 3:  # a step that has hardly begun
            misses.append(np.abs(turns - label.first).min() / capture.frame_rate)
    return misses


def _plate_misses(capture: Capture, empty: float) -> list[float]:
    """The same by the force on its plates, whichever foot it is that treads on them."""
    assert capture.markers is not None
    trial, times = capture.markers.trial, sample_times(capture.markers.trial)
    stances = np.pad(_standing(capture), ((0, 0), (1, 1)))
    misses = []
    for plate in trial.plates:
        loaded = np.linalg.norm(plate_reactions(trial, plate)[1], axis=1) > empty
        for turn, way in ((loaded.argmax(), 1), (len(loaded) - 1 - loaded[::-1].argmax(), -1)):
            frames = np.flatnonzero((np.diff(stances.astype(int)) == way).any(axis=0))
            misses.append(np.abs(frames / capture.frame_rate - times[turn]).min())
    return misses


def test_feet_strike_and_leave_when_operators_and_force_plates_say_so(captures: Path) -> None:
    paths = {stem: captures / "c3d" / f"{stem}.c3d" for stem in (*MARKED, *ON_PLATES)}
    misses = [miss for stem in MARKED for miss in _marked_misses(paths[stem], _read(paths[stem]).capture)]
    misses += [miss for stem, empty in ON_PLATES.items() for miss in _plate_misses(_read(paths[stem]).capture, empty)]
    assert len(misses) >= 38
    assert np.median(misses) <= 0.01
    assert np.round(max(misses), 3) <= 0.03


def test_feet_strike_and_leave_at_the_same_time_by_their_motion_alone(captures: Path) -> None:
    misses = []
    for stem in (*MARKED, *ON_PLATES):
        path = captures / "c3d" / f"{stem}.c3d"
        capture = replace(_read(path).capture, plate_loads=())
        misses += _marked_misses(path, capture) if stem in MARKED else _plate_misses(capture, ON_PLATES[stem])
    assert len(misses) >= 38
    assert np.median(misses) <= 0.01
    assert max(misses) <= 0.05


@pytest.mark.parametrize(
    ("stem", "side", "first", "last"),
    outside(
        ("accad_female1_C03_Run", 0, 7, 12), ("accad_female1_C03_Run", 1, 18, 23), ("accad_female1_C03_Run", 0, 29, 34)
    ),
)
def test_the_steps_of_a_run_are_found(stem: str, side: int, first: int, last: int) -> None:
    """Frames by eye: the sole lies on the ground, or its last part does, and is left where it lay."""
    foot = _stances(stem)[side]
    assert foot[first + 1 : last].all()
    assert not foot[first - 2]
    assert not foot[last + 2 : last + 3].any()


@pytest.mark.parametrize("stem", ["walk", "walk_on_sinking_floor", "turn", "run", "get_up", "dance", "cartwheel"])
def test_feet_of_a_recording_stand_where_they_were_keyed(stem: str) -> None:
    """Contacts are kept under noise, tilted and sinking floors and skipped frames."""
    recording, stances = RECORDINGS[stem], _stances(stem)
    targets = recording.motion(recording.frame_rate)
    kept = recording.kept(len(targets.times))
    for side, foot in enumerate(targets.feet):
        planted, pitch = foot.planted[kept], foot.pitch[kept]
        flat, flies = planted & (np.abs(pitch) < 1.0), _within(~planted, 0.09, recording.frame_rate)
        assert stances[side][flat].mean() > 0.95
        assert not stances[side][flies].any()


def _within(mask: np.ndarray, seconds: float, frame_rate: float) -> np.ndarray:
    """Frames that are at least so many seconds from both ends of a run of ``mask``."""
    frames = 2 * round(seconds * frame_rate) + 1
    return np.convolve(mask, np.ones(frames), mode="same") == frames


@pytest.mark.parametrize("stem", ["walk", *outside(*WALKS)])
def test_each_foot_stands_about_half_the_time(stem: str) -> None:
    shares = _stances(stem).mean(axis=1)
    assert (shares > 0.4).all()
    assert (shares < 0.75).all()


@pytest.mark.parametrize("stem", ["walk", "turn", *outside(*WALKS)])
def test_left_and_right_land_in_turn(stem: str) -> None:
    landings = [(frame, side) for side, foot in enumerate(_stances(stem)) for frame in _rises(foot)]
    sides = [side for _, side in sorted(landings)]
    assert len(sides) >= 6
    assert (np.diff(sides) != 0).all()


@pytest.mark.parametrize("stem", ["walk", "turn", *outside(*WALKS)])
def test_one_foot_nearly_always_carries_the_body(stem: str) -> None:
    assert _stances(stem).any(axis=0).mean() > 0.85


@pytest.mark.parametrize(
    ("file", "first", "last"),
    [
        ("more_captures/accad_male2_A11_Crawl.bvh", 0, 372),
        ("bvh/varied/accad_female1_A11_CrawlForward.bvh", 0, 510),  # then she lies down
    ],
)
def test_who_crawls_does_not_sit(captures: Path, file: str, first: int, last: int) -> None:
    found = capture_contacts(load_capture(capture_file(file)))
    assert not contact_mask(found[ContactPoint.SEAT], last + 1000)[first : last + 1].any()


def test_heels_are_off_the_ground_in_a_plank(captures: Path) -> None:
    found = capture_contacts(load_capture(capture_file("more_captures/accad_female1_D4_RandomStuff.bvh")))
    for heel in (ContactPoint.LEFT_HEEL, ContactPoint.RIGHT_HEEL):
        assert not contact_mask(found[heel], 603)[254:272].any()


def _rises(mask: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.diff(mask.astype(int)) == 1)


@pytest.mark.parametrize(
    "stem",
    [
        "box_lift",
        "floor_reach",
        *outside("accad_male2_E20_DodgeRight", "accad_female1_A05_PickUpBox", "pybvh_test2_yxz"),
    ],
)
def test_feet_that_stay_stand_from_beginning_to_end(stem: str) -> None:
    assert _stances(stem).all()


@pytest.mark.parametrize(("stem", "kicking"), outside(("mass_kick", 1), ("accad_male2_G9_RoundhouseRight", 1)))
def test_a_kicking_foot_leaves_the_ground_and_the_other_carries(stem: str, kicking: int) -> None:
    stances = _stances(stem)
    assert stances[kicking].mean() < 0.5
    assert stances[1 - kicking].mean() > 0.8
