"""`info`: what a person, or another program, learns about files."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.captures.contacts import CONTACT_POINTS
from studio.io.c3d.writer import write_c3d
from studio.io.export import write_capture
from studio.io.project.project_file import new_document_id, write_project
from studio.resources_folder import resources_folder
from tests.architecture.sources import ROOT
from tests.builders import make_capture, make_project
from tests.core.markers.made import made_trial

KEYS = {
    *("file", "ok", "error", "kind", "frames", "frame_rate", "joints", "unit", "up_axis", "body_map", "contacts"),
    *("round_trip", "assumptions", "repairs", "remarks"),
}
PROP = """HIERARCHY
ROOT Box
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  End Site
  {
    OFFSET 0 10 0
  }
}
MOTION
Frames: 2
Frame Time: 0.04
0 0 0 0 0 0
0 1 0 0 0 0
"""


@pytest.fixture
def walk(tmp_path):
    """A BVH file of a small walk."""
    write_capture(make_capture(), tmp_path / "walk.bvh")
    return tmp_path / "walk.bvh"


def info(capsys, *arguments):
    code = main(["info", "--json", *map(str, arguments)])
    printed = capsys.readouterr()
    return code, json.loads(printed.out)


def test_a_body_is_told_with_the_keys_that_others_build_on(capsys, walk):
    code, [record] = info(capsys, walk)
    assert code == 0
    assert record.keys() >= KEYS
    assert (record["file"], record["ok"], record["error"], record["kind"]) == (str(walk), True, None, "skeleton")
    assert (record["frames"], record["frame_rate"], record["joints"]) == (30, 60.0, 21)
    assert (record["unit"], record["up_axis"]) == ("cm", "Y")
    assert record["body_map"]["left_hand"] == "LeftHand"
    assert record["contacts"].keys() == set(CONTACT_POINTS)
    assert record["round_trip"]["position_mm"] < 0.1
    assert record["round_trip"]["rotation_deg"] < 0.01
    assert any(sentence.startswith("unit: cm") for sentence in record["assumptions"])


def test_what_is_no_human_has_no_round_trip_and_no_contacts(capsys, tmp_path):
    (tmp_path / "box.bvh").write_text(PROP)
    code, [record] = info(capsys, tmp_path / "box.bvh")
    assert code == 0
    assert (record["round_trip"], record["contacts"], record["body_map"]) == (None, {}, {})
    assert record["joints"] == 1


def test_a_file_that_fails_says_why_and_the_others_are_still_told(capsys, tmp_path, walk):
    (tmp_path / "empty.bvh").write_text("")
    code, [bad, good] = info(capsys, tmp_path / "empty.bvh", walk)
    assert code == 1
    assert bad.keys() == {*KEYS}
    assert (bad["ok"], good["ok"]) == (False, True)
    assert "empty.bvh" in bad["error"]


def test_a_character_is_told_by_its_measures(capsys):
    code, [record] = info(capsys, resources_folder() / "characters" / "child.json")
    assert code == 0
    assert (record["kind"], record["unit"], record["up_axis"]) == ("character", "m", "Z")
    assert record["stature"] == pytest.approx(1.2, abs=0.02)
    assert record["body_map"]["left_hand"] == "LeftHand"


def test_a_project_is_told_by_what_it_holds(capsys, tmp_path):
    write_project(tmp_path / "play.studio", make_project(characters=2), new_document_id())
    code, [record] = info(capsys, tmp_path / "play.studio")
    assert code == 0
    assert record["kind"] == "project"
    assert record["contents"]["characters"] == 2
    assert main(["info", str(tmp_path / "play.studio")]) == 0
    printed = capsys.readouterr().out
    assert "1 capture, 1 motion, 2 characters, 2 performers" in printed


def test_the_user_knows_better_than_a_guess(capsys, walk):
    _, [record] = info(capsys, walk, "--unit", "m", "--frame-rate", "25")
    assert (record["unit"], record["frame_rate"]) == ("m", 25.0)
    assert not any(sentence.startswith(("unit", "frame rate")) for sentence in record["assumptions"])


def test_the_body_map_that_is_printed_can_be_given_back(capsys, walk, tmp_path):
    _, [record] = info(capsys, walk)
    (tmp_path / "map.json").write_text(json.dumps(record["body_map"]))
    _, [again] = info(capsys, walk, "--body-map", tmp_path / "map.json")
    assert again["body_map"] == record["body_map"]


def test_people_get_lines_with_everything_guessed(capsys, walk):
    assert main(["info", str(walk)]) == 0
    printed = capsys.readouterr().out
    assert "round trip" in printed
    assert "assumption" in printed


def test_the_program_itself_prints_one_document_and_ends_with_the_exit_code(walk):
    command = [sys.executable, str(ROOT / "main.py"), "info", "--json", str(walk), "missing.bvh"]
    done = subprocess.run(command, cwd=walk.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert [record["ok"] for record in json.loads(done.stdout)] == [True, False]
    assert done.stderr == ""


def test_a_file_is_told_of_without_waiting_for_what_only_solves(walk):
    late = (
        "scipy.ndimage",
        "scipy.linalg",
        "scipy.spatial",
        "scipy.interpolate",
        "studio.core.solver.adapt",
        "vtkmodules",
    )
    script = (
        "import contextlib, io, sys; from studio.cli.main import main\n"
        "with contextlib.redirect_stdout(io.StringIO()): main(sys.argv[1:])\n"
        f"print(*({{*{late}}} & sys.modules.keys()))"
    )
    command = [sys.executable, "-c", script, "info", str(walk)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize(
    ("name", "joints", "frames", "unit", "up_axis"),
    [
        ("strikes/accad_male2_G2_FrontKick", 22, 70, "cm", "Y"),
        ("conventions/pybvh_test1_inch_zup", 24, 75, "inch", "Z"),
        ("strikes/mass_kick", 37, 231, "cm", "Y"),
    ],
)
def test_real_captures_are_read_as_they_were_made(captures, capsys, name, joints, frames, unit, up_axis):
    code, [record] = info(capsys, captures / "bvh" / f"{name}.bvh")
    assert code == 0
    assert (record["joints"], record["frames"], record["unit"], record["up_axis"]) == (joints, frames, unit, up_axis)
    assert record["round_trip"]["position_mm"] < 0.1
    assert record["round_trip"]["rotation_deg"] < 0.01


@pytest.fixture
def gappy(tmp_path):
    """A C3D with two markers that are hidden for a while, a tenth and half a second, and its map."""
    trial, marker_map = made_trial()
    points = trial.points.copy()
    knee, toe = (trial.labels.index(label) for label in ("leftknee", "righttoe"))
    points[40:50, knee] = np.nan
    points[60:110, toe] = np.nan
    write_c3d(tmp_path / "walk.c3d", replace(trial, points=points))
    record = {"name": "Made", "markers": {role: list(labels) for role, labels in marker_map.markers.items()}}
    (tmp_path / "map.json").write_text(json.dumps(record))
    return tmp_path / "walk.c3d", "--marker-map", tmp_path / "map.json"


@pytest.mark.parametrize(
    ("options", "steps", "first"),
    [
        ([], ["Fill short gaps", "Fill long gaps"], "1 gap filled with a spline, 10 frames in all."),
        (["--fill-gaps", "0.05"], ["Fill short gaps", "Fill long gaps"], "Nothing filled."),
        (["--fill-gaps", "0"], [], ""),
        (["--fill-gaps", "0", "--smooth", "6"], ["Smooth"], "Smoothed at 6 Hz; no marker moved more than"),
        (
            ["--undo-swaps"],
            ["Fix marker swaps", "Fill short gaps", "Fill long gaps"],
            "No swapped markers were found.",
        ),
    ],
)
def test_markers_are_cleaned_as_the_options_say_and_the_reports_are_printed(capsys, gappy, options, steps, first):
    code, [record] = info(capsys, *gappy, *options)
    assert code == 0
    reports = record["markers"]["cleaning"]
    assert [each["step"] for each in reports] == steps
    assert (reports or [{"summary": ""}])[0]["summary"].startswith(first)


@pytest.mark.parametrize(
    ("option", "text"), [("--fill-gaps", "-1"), ("--fill-gaps", "long"), ("--smooth", "0"), ("--smooth", "nan")]
)
def test_a_step_that_is_none_is_refused(capsys, gappy, option, text):
    with pytest.raises(SystemExit):
        main(["info", str(gappy[0]), f"{option}={text}"])
    assert f"argument {option}: '{text}' is not a number of" in capsys.readouterr().err


def test_convert_and_adapt_tell_what_was_cleaned_too(capsys, gappy, tmp_path):
    asked = [*map(str, gappy[1:]), "--smooth", "8", "--json"]
    assert main(["convert", str(gappy[0]), str(tmp_path / "out.bvh"), *asked]) == 0
    converted = json.loads(capsys.readouterr().out)
    assert main(["adapt", str(gappy[0]), "--character", "child", "--out", str(tmp_path / "out"), *asked]) == 0
    adapted = json.loads(capsys.readouterr().out)
    assert [each["step"] for each in converted["cleaning"]] == ["Fill short gaps", "Fill long gaps", "Smooth"]
    assert adapted["cleaning"] == converted["cleaning"]


def test_what_cannot_be_read_is_said_on_standard_error_and_the_others_on_standard_output(capsys, tmp_path, walk):
    (tmp_path / "empty.bvh").write_text("")
    assert main(["info", str(tmp_path / "empty.bvh"), str(walk)]) == 1
    printed = capsys.readouterr()
    assert "walk.bvh" in printed.out
    assert "empty.bvh" not in printed.out
    assert printed.err.startswith("morpho-studio: empty.bvh")
