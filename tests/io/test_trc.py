"""TRC files: read as the same trial in C3D is, in the dialects that programs write, or refused in a sentence."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.kinematics import joint_positions
from studio.core.captures.virtual_markers import virtual_trial
from studio.core.markers.trial import Trial
from studio.io.c3d.writer import write_c3d
from studio.io.importing import load_capture
from studio.io.trc.reader import read_trc
from tests.io.trc_text import trc_text
from tests.io.trials import make_trial

EXAMPLES = Path(__file__).parents[2] / "examples" / "captures"
LABELS = ("LASI", "RASI", "LKNE", "RKNE")


def read(folder: Path, text: str) -> Trial:
    return read_with_repairs(folder, text)[0]


def read_with_repairs(folder: Path, text: str) -> tuple[Trial, str]:
    path = folder / "take.trc"
    path.write_text(text, encoding="utf-8", newline="")
    file = read_trc(path)
    return file.trial, "\n".join(file.repairs)


@pytest.mark.parametrize(
    "dialect",
    [
        {},
        {"gap": "NaN"},
        {"gap": "nan", "between": " "},
        {"gap": "1.#QNAN"},
        {"blank": False},
        {"gap": "9999999.0"},
        {"gap": "0.0"},
    ],
)
def test_every_dialect_gives_the_same_places_and_gaps(tmp_path: Path, dialect: dict[str, str]) -> None:
    trial = make_trial(LABELS)
    found = read(tmp_path, trc_text(trial, **dialect))  # type: ignore[arg-type]
    assert found.labels == LABELS
    assert found.frame_rate == trial.frame_rate
    assert found.first_frame == trial.first_frame
    assert found.unit == "mm"
    np.testing.assert_allclose(found.points, trial.points, atol=1e-6)


def test_lines_of_windows_and_cells_left_out_at_the_end_are_read(tmp_path: Path) -> None:
    trial = make_trial(LABELS)
    points = np.array(trial.points)
    points[2, 3] = np.nan
    text = trc_text(trial.with_points(points)).replace("\t\t\t\n", "\n").replace("\n", "\r\n")
    np.testing.assert_allclose(read(tmp_path, text).points, points, atol=1e-6)


def test_decimal_commas_are_points_and_told(tmp_path: Path) -> None:
    trial = make_trial(LABELS)
    head, _, rows = trc_text(trial).partition("\n\n")
    found, repairs = read_with_repairs(tmp_path, f"{head}\n\n{rows.replace('.', ',')}")
    np.testing.assert_allclose(found.points, trial.points, atol=1e-6)
    assert "decimal commas" in repairs


@pytest.mark.parametrize(("said", "unit"), [("m", "m"), ("cm", "cm"), ("meters", "m"), ("in", "inch")])
def test_the_unit_of_the_header_is_believed(tmp_path: Path, said: str, unit: str) -> None:
    assert read(tmp_path, trc_text(make_trial(LABELS), unit=said)).unit == unit


def test_a_rate_of_zero_is_taken_from_the_times_and_told(tmp_path: Path) -> None:
    trial = make_trial(LABELS)
    text = trc_text(trial).replace("100\t100\t", "0\t0\t").replace("\t100\t1\t", "\t0\t1\t")
    found, repairs = read_with_repairs(tmp_path, text)
    assert found.frame_rate == 100.0
    assert "DataRate" in repairs


def test_a_count_of_absurdly_many_digits_is_told_like_any_wrong_one(tmp_path: Path) -> None:
    trial = make_trial(labels=LABELS)
    text = trc_text(trial).replace(f"\t{trial.frame_count}\t{len(LABELS)}\t", f"\t{'9' * 5000}\t{len(LABELS)}\t", 1)
    read_trial, repairs = read_with_repairs(tmp_path, text)
    assert read_trial.frame_count == trial.frame_count
    assert "found and read" in repairs


def test_a_file_cut_within_a_row_loses_that_row_and_says_so(tmp_path: Path) -> None:
    trial = make_trial(LABELS)
    found, repairs = read_with_repairs(tmp_path, trc_text(trial)[:-25])
    assert found.frame_count == trial.frame_count - 1
    np.testing.assert_allclose(found.points, trial.points[:-1], atol=1e-6)
    assert "cut off" in repairs
    assert "12 frames" in repairs


def test_names_that_stand_twice_are_numbered_and_told(tmp_path: Path) -> None:
    found, repairs = read_with_repairs(tmp_path, trc_text(make_trial(LABELS)).replace("RKNE", "LKNE"))
    assert found.labels == ("LASI", "RASI", "LKNE", "LKNE_2")
    assert "LKNE_2" in repairs


def test_a_body_is_found_where_the_c3d_of_the_same_take_has_it(tmp_path: Path) -> None:
    source = load_capture(EXAMPLES / "walk_turn.bvh")
    trial = virtual_trial(source, ())
    trial = trial.with_labels(trial.markers)  # a table cannot say which of its points a model computed
    write_c3d(tmp_path / "walk.c3d", trial)
    (tmp_path / "walk.trc").write_text(trc_text(trial), encoding="utf-8")
    found, other = load_capture(tmp_path / "walk.trc"), load_capture(tmp_path / "walk.c3d")
    assert found.body_map == other.body_map
    assert found.frame_rate == other.frame_rate
    places = [joint_positions(each.skeleton, each.poses) for each in (found, other)]
    np.testing.assert_allclose(*places, atol=1e-4)
