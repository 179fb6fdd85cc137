"""Markers that jump are found with their frames; those that a body moves are not, however hard it strikes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.captures.capture import Capture
from studio.core.captures.remarks import remarks_on
from studio.core.markers.jumps import marker_jumps
from studio.core.markers.trial import Trial
from studio.io.c3d.writer import write_c3d
from studio.io.importing import load_capture
from tests.core.markers.made import made_trial


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
