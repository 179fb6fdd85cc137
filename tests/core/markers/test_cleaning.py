"""Steps that clean marker trials, and jumps that are told."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.captures.capture import Capture
from studio.core.captures.remarks import remarks_on
from studio.core.markers.cleaning import USUAL_STEPS, FillLongGaps, FillShortGaps, LowPass, UndoSwaps, cleaned_trial
from studio.core.markers.gaps import find_gaps
from studio.core.markers.jumps import marker_jumps
from studio.core.markers.trial import Trial
from studio.io.c3d.reader import read_c3d
from studio.io.c3d.writer import write_c3d
from studio.io.importing import load_capture
from tests.core.markers.made import RATE, made_trial

# Steps on made trials whose truth is known: what they fill, smooth and exchange, what they leave and what they say.


def _with_gap(trial: Trial, label: str, first: int, last: int) -> Trial:
    points = trial.points.copy()
    points[first : last + 1, trial.labels.index(label)] = np.nan
    return trial.with_points(points)


def _error(trial: Trial, truth: Trial, label: str) -> float:
    """Metres at worst."""
    return trial.metres * float(np.linalg.norm(trial.track(label) - truth.track(label), axis=1).max())


@given(st.integers(0, 40), st.integers(1, 12), st.integers(0, 3))
def test_a_cubic_path_is_splined_exactly(first: int, length: int, seed: int) -> None:
    time = np.arange(80.0)
    path = np.stack([np.polyval(row, time / 80.0) for row in np.random.default_rng(seed).normal(size=(3, 4))], axis=1)
    truth, _ = made_trial(("left_knee",))
    truth = Trial("t", "t", ("a",), ("marker",), path[:, None], np.zeros((80, 1)), RATE, 1, "m")
    first += 8
    cleaned, report = FillShortGaps().apply(_with_gap(truth, "a", first, first + length - 1))
    np.testing.assert_allclose(cleaned.points, truth.points, atol=1e-9)
    assert f"1 gap filled with a spline, {length} frame" in report.summary


@pytest.mark.parametrize(("length", "most"), [(5, 0.001), (15, 0.01)])
def test_a_short_gap_in_a_walk_is_filled_near_the_truth(length: int, most: float) -> None:
    truth, _ = made_trial()
    cleaned, _ = FillShortGaps().apply(_with_gap(truth, "leftwrist", 60, 59 + length))
    assert _error(cleaned, truth, "leftwrist") < most


def test_a_long_gap_is_left_to_the_neighbours_and_they_fill_it() -> None:
    """45 frames of a heel: ankle and toe, which never change their distance to it, carry it."""
    truth, _ = made_trial()
    gappy = _with_gap(truth, "leftheel", 50, 94)
    splined, report = FillShortGaps().apply(gappy)
    assert np.isnan(splined.points).any()
    filled, report = FillLongGaps().apply(splined)
    assert _error(filled, truth, "leftheel") < 0.001
    assert report.details == ("leftheel frames 50 to 94",)


def test_a_gap_at_the_end_is_filled_from_one_side() -> None:
    truth, _ = made_trial()
    filled, _ = FillLongGaps().apply(_with_gap(truth, "leftfronthead", 120, 149))
    assert _error(filled, truth, "leftfronthead") < 0.001


def test_without_stiff_neighbours_a_long_gap_stays_open_and_is_told() -> None:
    truth, _ = made_trial(("left_wrist", "right_knee", "left_toe", "right_elbow"))
    filled, report = FillLongGaps().apply(_with_gap(truth, "leftwrist", 40, 90))
    assert np.isnan(filled.track("leftwrist")[40:91]).all()
    assert report.summary == "Nothing filled. 1 gap left open."


def test_what_was_seen_is_never_changed_by_filling() -> None:
    truth, _ = made_trial()
    gappy = _with_gap(_with_gap(truth, "lefttoe", 10, 13), "lefttoe", 60, 99)
    cleaned, _ = cleaned_trial(gappy, USUAL_STEPS)
    seen = np.isfinite(gappy.points)
    assert np.array_equal(cleaned.points[seen], gappy.points[seen])
    assert not list(find_gaps(cleaned.points, tuple(range(len(cleaned.labels)))))


def test_the_trial_itself_stays_as_it_was_recorded() -> None:
    truth, _ = made_trial()
    gappy = _with_gap(truth, "lefttoe", 10, 13)
    before = gappy.points.copy()
    cleaned_trial(gappy, (UndoSwaps(), FillShortGaps(), FillLongGaps(), LowPass()))
    assert np.array_equal(gappy.points, before, equal_nan=True)


@pytest.mark.parametrize("rate", [50.0, 100.0, 250.0])
def test_smoothing_halves_the_power_at_its_cutoff_at_any_frame_rate_and_does_not_lag(rate: float) -> None:
    time = np.arange(0.0, 8.0, 1.0 / rate)
    waves = np.stack([np.sin(2 * np.pi * hertz * time) for hertz in (1.0, 6.0, 20.0)], axis=1)
    trial = Trial("t", "t", ("a",), ("marker",), waves[:, None], np.zeros((len(time), 1)), rate, 1, "m")
    smooth, _ = LowPass(cutoff=6.0).apply(trial)
    middle = slice(len(time) // 4, 3 * len(time) // 4)
    after, before = smooth.points[middle, 0], trial.points[middle, 0]
    gain = np.sum(after * before, axis=0) / np.sum(before**2, axis=0)  # a lag would take from it
    assert gain[0] == pytest.approx(1.0, abs=0.01)
    assert gain[1] == pytest.approx(np.sqrt(0.5), abs=0.01)
    assert abs(gain[2]) < 0.02


def test_smoothing_goes_up_to_gaps_and_not_over_them() -> None:
    truth, _ = made_trial(("left_knee",))
    smooth, _ = LowPass(cutoff=10.0).apply(_with_gap(truth, "leftknee", 70, 79))
    assert np.isnan(smooth.track("leftknee")[70:80]).all()
    assert np.isfinite(smooth.track("leftknee")[:70]).all()


def test_a_cutoff_beyond_the_frame_rate_changes_nothing_and_says_so() -> None:
    truth, _ = made_trial(("left_knee",))
    same, report = LowPass(cutoff=60.0).apply(truth)
    assert same is truth
    assert report.summary == "Nothing was smoothed: at 100 frames per second there is no signal above 45 Hz."


def _exchanged(trial: Trial, one: str, other: str, first: int, last: int) -> Trial:
    points = trial.points.copy()
    pair = [trial.labels.index(one), trial.labels.index(other)]
    points[first : last + 1, pair] = points[first : last + 1, pair[::-1]]
    return trial.with_points(points)


@given(st.integers(5, 80), st.integers(3, 60))
def test_a_swap_there_and_back_is_undone(first: int, length: int) -> None:
    truth, _ = made_trial(("left_knee", "right_knee", "left_toe", "right_toe", "left_front_hip"))
    swapped = _exchanged(truth, "leftknee", "rightknee", first, first + length)
    mended, report = UndoSwaps().apply(swapped)
    assert np.array_equal(mended.points, truth.points)
    assert report.details[0] == f"leftknee and rightknee from frame {first} on"


def test_markers_that_change_names_behind_a_gap_are_found() -> None:
    truth, _ = made_trial(("left_knee", "right_knee", "left_toe", "right_toe"))
    swapped = _exchanged(truth, "leftknee", "rightknee", 60, 149)
    for label in ("leftknee", "rightknee"):
        swapped = _with_gap(swapped, label, 56, 60)
    mended, _ = UndoSwaps().apply(swapped)
    assert np.array_equal(mended.points[61:], truth.points[61:])


def test_in_a_clean_trial_nothing_is_exchanged() -> None:
    truth, _ = made_trial()
    same, report = UndoSwaps().apply(truth)
    assert same is truth
    assert report.summary == "No swapped markers were found."


@pytest.mark.parametrize(("label", "first", "last"), [("RTH3", 100, 130), ("LSK4", 240, 265), ("PV1", 180, 200)])
def test_on_a_real_cluster_a_gap_of_half_a_second_is_filled_within_centimetres(
    captures: Path, label: str, first: int, last: int
) -> None:
    truth = read_c3d(captures / "c3d" / "sample01_Eb015pi.c3d").trial
    filled, _ = FillLongGaps().apply(_with_gap(truth, label, first, last))
    off = np.linalg.norm(filled.track(label)[first : last + 1] - truth.track(label)[first : last + 1], axis=1)
    assert off.max() * truth.metres < 0.015


@pytest.mark.parametrize(("one", "other"), [("LWRA", "LWRB"), ("LASI", "RASI"), ("RFHD", "RBHD"), ("LKNE", "RKNE")])
def test_a_swap_put_into_a_real_walk_is_found_and_nothing_else(captures: Path, one: str, other: str) -> None:
    truth = read_c3d(captures / "c3d" / "btk_PiG_FullBody_walk.c3d").trial
    mended, report = UndoSwaps().apply(_exchanged(truth, one, other, 90, 170))
    assert np.array_equal(mended.points, truth.points, equal_nan=True)
    assert report.summary == "2 swaps fixed."


# Markers that jump are found with their frames; those that a body moves are not, however hard it strikes.


def _moved(trial: Trial, label: str, frames: slice, by: float) -> Trial:
    """With a marker ``by`` metres aside in some frames."""
    points = trial.points.copy()
    points[frames, trial.labels.index(label), 0] += by / trial.metres
    return trial.with_points(points)


def test_nothing_jumps_in_a_walk() -> None:
    assert marker_jumps(made_trial()[0]) == {}


@pytest.mark.parametrize(
    ("frames", "into"), [(slice(60, 61), [60, 61]), (slice(60, 64), [60, 64]), (slice(60, None), [60])]
)
def test_a_marker_that_is_elsewhere_for_some_frames_or_from_one_on_jumps_there_and_back(
    frames: slice, into: list[int]
) -> None:
    [(label, (far, by))] = marker_jumps(_moved(made_trial()[0], "leftheel", frames, 0.1)).items()
    assert label == "leftheel"
    assert np.flatnonzero(far).tolist() == into
    assert by == pytest.approx(0.1, abs=0.03)


def test_a_marker_that_comes_back_elsewhere_after_a_gap_jumps_only_where_it_was_seen() -> None:
    trial = made_trial()[0]
    points = _moved(trial, "leftheel", slice(60, None), 0.1).points.copy()
    points[50:60, trial.labels.index("leftheel")] = np.nan
    assert marker_jumps(trial.with_points(points)) == {}


def test_a_kick_that_stops_at_its_target_within_a_frame_does_not_jump() -> None:
    way = np.concatenate([np.cumsum(np.linspace(0.0, 0.2, 60)), np.full(60, 6.0)])
    path = np.stack([way, np.zeros(120), np.zeros(120)], axis=1)
    path[60:] = path[59]
    kick = Trial("kick", "kick", ("toe",), ("marker",), path[:, None], np.zeros((120, 1)), 100.0, 1, "m")
    assert marker_jumps(kick) == {}


@pytest.fixture
def walk(tmp_path: Path) -> Capture:
    path = tmp_path / "walk.c3d"
    write_c3d(path, made_trial()[0])
    return load_capture(path)


def test_the_report_of_a_capture_names_the_markers_that_jump_most_and_counts_the_rest(walk: Capture) -> None:
    take, remarks = walk.markers, remarks_on(walk)
    assert take is not None
    assert not any("marker" in remark.words for remark in remarks)
    trial = take.trial
    for number, label in enumerate(trial.markers[:5]):
        trial = _moved(trial, label, slice(40, 41), 0.1 + 0.02 * number)
    told = [each for each in remarks_on(replace(walk, markers=replace(take, trial=trial))) if each not in remarks]
    assert [each.words.partition(" jumps")[0] for each in told[:3]] == [
        f"The marker {label}" for label in reversed(trial.markers[2:5])
    ]
    assert told[3].sentence.startswith("So do ")
    assert told[0].spans == ((40, 41),)
