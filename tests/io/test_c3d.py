"""C3D files read as they are: equal to what another reader finds, and to what was written."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.core.markers.trial import MARKER_KIND, Trial
from studio.io.c3d.reader import read_c3d
from studio.io.c3d.writer import write_c3d
from tests.captures import CAPTURES
from tests.io.trials import make_trial, same

FILES = tuple(path.stem for path in sorted((CAPTURES / "c3d").glob("*.c3d")))
REFUSED_BY_EZC3D = {"btk_mocap36_optitrack", "sample01_Eb015si", "sample06_MACsample"}
READ_BY_EZC3D = tuple(name for name in FILES if name not in REFUSED_BY_EZC3D)
SIZES = {
    "btk_Gait_dec_int": ("DEC", True, 487, 33, 1, 100.0, 28, (4, 4), 0),
    "btk_PiG_FullBody_walk": ("Intel", False, 315, 193, 148, 100.0, 38, (2, 2), 12),
    "btk_PiG_LowerBody_walk": ("Intel", False, 293, 97, 725, 100.0, 34, (2, 2, 2), 12),
    "btk_mocap36_optitrack": ("Intel", False, 1380, 36, 1, 100.0, 0, (), 0),
    "btk_shd01_prefix": ("Intel", False, 237, 27, 91, 250.0, 6, (4, 0), 0),
    "sample01_Eb015pi": ("Intel", True, 450, 26, 1, 50.0, 16, (2, 2), 3),
    "sample01_Eb015si": ("MIPS", True, 450, 26, 1, 50.0, 16, (2, 2), 3),
    "sample01_Eb015vr": ("DEC", False, 450, 26, 1, 50.0, 16, (2, 2), 3),
    "sample06_MACsample": ("MIPS", True, 180, 33, 1, 60.0, 16, (), 0),
    "sample08_TESTDPI": ("Intel", True, 450, 26, 1, 50.0, 16, (2, 2), 3),
    "sample09_PlugInC3D": ("DEC", True, 281, 86, 1, 60.0, 36, (2, 2), 8),
    "sample15_FP1_metres": ("Intel", False, 480, 8, 1, 60.0, 12, (3,), 4),
}
"""Byte order, integers, frames, points, first frame, rate, signals, kinds of plates, events."""


def _trial(captures: Path, name: str) -> Trial:
    return read_c3d(captures / "c3d" / f"{name}.c3d").trial


def _ezc3d(captures: Path, name: str) -> Any:
    ezc3d = pytest.importorskip("ezc3d", reason="ezc3d, the other reader, is not installed here")
    return ezc3d.c3d(str(captures / "c3d" / f"{name}.c3d"))


@pytest.mark.parametrize("name", FILES)
def test_every_shared_file_opens_with_all_that_it_has(captures: Path, name: str) -> None:
    file = read_c3d(captures / "c3d" / f"{name}.c3d")
    trial = file.trial
    found = (file.order, file.integers, trial.frame_count, len(trial.labels), trial.first_frame, trial.frame_rate)
    found += (len(trial.analog.labels), tuple(plate.kind for plate in trial.plates), len(trial.events))
    assert found == SIZES[name]


@pytest.mark.parametrize("name", READ_BY_EZC3D)
def test_points_and_gaps_are_those_of_ezc3d_to_the_last_bit(captures: Path, name: str) -> None:
    """But for points at exactly (0, 0, 0), which no camera saw: here they are gaps."""
    trial, other = _trial(captures, name), _ezc3d(captures, name)
    points = other["data"]["points"][:3].transpose(2, 1, 0)
    points[~points.any(axis=-1)] = np.nan
    assert np.array_equal(trial.points, points, equal_nan=True)
    labels = other["parameters"]["POINT"]["LABELS"]["value"][: len(trial.labels)]
    assert all(own == label or own.startswith(f"{label}_") for own, label in zip(trial.labels, labels, strict=True))
    assert trial.first_frame == other["header"]["points"]["first_frame"] + 1
    assert trial.frame_rate == other["header"]["points"]["frame_rate"]


@pytest.mark.parametrize("name", READ_BY_EZC3D)
def test_signals_are_those_of_ezc3d_to_the_last_bit(captures: Path, name: str) -> None:
    """But for offsets beyond 32767 of unsigned signals, which ezc3d takes as |offset|, not as 16 bits without sign."""
    trial, other = _trial(captures, name), _ezc3d(captures, name)
    analog = other["parameters"]["ANALOG"]
    assert trial.analog.labels == tuple(analog["LABELS"]["value"][: len(trial.analog.labels)])
    signals = other["data"]["analogs"][0].T
    right = np.ones(len(trial.analog.labels), dtype=bool)
    if analog["FORMAT"]["value"] == ["UNSIGNED"]:
        right = analog["OFFSET"]["value"] >= 0
        raw = signals / analog["SCALE"]["value"] + np.abs(analog["OFFSET"]["value"])
        wrong = (raw - analog["OFFSET"]["value"] % 65536) * analog["SCALE"]["value"]
        np.testing.assert_allclose(trial.analog.samples[:, ~right], wrong[:, ~right], atol=1e-6)
    assert np.array_equal(trial.analog.samples[:, right], signals[:, right])


@pytest.mark.parametrize("name", READ_BY_EZC3D)
def test_residuals_are_the_low_byte_and_cameras_the_high_one(captures: Path, name: str) -> None:
    """ezc3d takes them the other way round, by which bit 7 of the residual is lost."""
    trial, other = _trial(captures, name), _ezc3d(captures, name)
    bits = other["data"]["meta_points"]["camera_masks"].transpose(2, 1, 0)
    low = (bits * (1 << np.arange(7))).sum(axis=-1)
    seen = trial.residuals >= 0.0
    step = abs(other["parameters"]["POINT"]["SCALE"]["value"][0])
    assert np.array_equal(np.round(trial.residuals[seen] / step).astype(int) % 128, low[seen])


def test_three_encodings_of_one_take_give_equal_points(captures: Path) -> None:
    intel, dec, mips, moved = (
        _trial(captures, name)
        for name in ("sample01_Eb015pi", "sample01_Eb015vr", "sample01_Eb015si", "sample08_TESTDPI")
    )
    assert np.array_equal(intel.points, mips.points, equal_nan=True)
    assert np.array_equal(intel.points, moved.points, equal_nan=True)
    np.testing.assert_allclose(dec.points, intel.points, atol=0.02)
    assert np.array_equal(intel.analog.samples, mips.analog.samples)
    assert intel.events == mips.events == dec.events


def test_angles_and_forces_among_the_points_are_known_as_such(captures: Path) -> None:
    trial = _trial(captures, "btk_PiG_FullBody_walk")
    kinds = dict(zip(trial.labels, trial.kinds, strict=True))
    assert (kinds["LHipAngles"], kinds["LKneeForce"], kinds["LASI"]) == ("angle", "force", MARKER_KIND)
    assert not any("Angle" in label or "Moment" in label or "Power" in label for label in trial.markers)


def test_events_lie_among_the_frames_where_feet_strike(captures: Path) -> None:
    """The heel is at its lowest, within a few centimetres, when the file says Right Foot Strike."""
    trial = _trial(captures, "btk_PiG_FullBody_walk")
    strikes = [event for event in trial.events if (event.label, event.context) == ("Foot Strike", "Right")]
    heel = trial.track("RHEE")[:, 2]
    frames = [round(trial.event_frame(event)) for event in strikes]
    assert [event.time for event in strikes] == pytest.approx([1.53, 2.54, 3.57, 4.59])
    assert all(heel[frame] < np.nanmin(heel) + 40.0 for frame in frames if 0 <= frame < trial.frame_count)


def test_a_trial_is_read_back_as_it_was_written(tmp_path: Path) -> None:
    trial = make_trial()
    write_c3d(tmp_path / "take.c3d", trial)
    file = read_c3d(tmp_path / "take.c3d")
    assert same(file.trial, trial)
    assert file.repairs == ()


@pytest.mark.parametrize("name", FILES)
def test_a_shared_file_written_again_says_the_same(captures: Path, tmp_path: Path, name: str) -> None:
    trial = _trial(captures, name)
    write_c3d(tmp_path / f"{name}.c3d", trial)
    again = read_c3d(tmp_path / f"{name}.c3d").trial
    np.testing.assert_allclose(again.points, trial.points, rtol=1e-6)
    assert (again.labels, again.kinds, again.unit) == (trial.labels, trial.kinds, trial.unit)
    assert (again.first_frame, again.frame_count) == (trial.first_frame, trial.frame_count)
    assert [plate.channels for plate in again.plates] == [plate.channels for plate in trial.plates]


def test_a_long_trial_keeps_every_frame(tmp_path: Path) -> None:
    """Headers count to 65535; others have lost what came after it."""
    trial = make_trial(("A", "B"), 70000)
    write_c3d(tmp_path / "long.c3d", trial)
    assert read_c3d(tmp_path / "long.c3d").trial.frame_count == 70000


def test_hundreds_of_points_keep_their_names(tmp_path: Path) -> None:
    labels = tuple(f"Anna:M{index}" for index in range(700))
    write_c3d(tmp_path / "take.c3d", make_trial(labels))
    assert read_c3d(tmp_path / "take.c3d").trial.labels == labels


def test_ezc3d_reads_what_is_written(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d", reason="ezc3d, the other reader, is not installed here")
    trial = make_trial()
    write_c3d(tmp_path / "take.c3d", trial)
    other = ezc3d.c3d(str(tmp_path / "take.c3d"))
    assert np.array_equal(other["data"]["points"][:3].transpose(2, 1, 0), trial.points, equal_nan=True)
    assert np.array_equal(other["data"]["analogs"][0].T, trial.analog.samples)
    assert other["parameters"]["EVENT"]["LABELS"]["value"] == ["Foot Strike", "Foot Off"]
