"""`info`: what a person, or another program, learns about files."""

import json
import subprocess
import sys

import pytest

from studio.cli.main import main
from studio.core.contacts import ContactPoint
from studio.io.export import write_capture
from studio.io.project_file import new_document_id, write_project
from studio.resources_folder import resources_folder
from tests.architecture.sources import ROOT
from tests.builders import make_capture, make_project

KEYS = {
    *("file", "ok", "error", "kind", "frames", "frame_rate", "joints", "unit", "up_axis", "body_map", "contacts"),
    *("round_trip", "assumptions", "repairs"),
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
    assert record["contacts"].keys() == set(ContactPoint)
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


def test_the_user_knows_better_than_a_guess(capsys, walk):
    _, [record] = info(capsys, walk, "--unit", "m", "--frame-rate", "25")
    assert (record["unit"], record["frame_rate"]) == ("m", 25.0)
    assert not any(sentence.startswith(("unit", "frame rate")) for sentence in record["assumptions"])


def test_the_body_map_that_is_printed_can_be_given_back(capsys, walk, tmp_path):
    _, [record] = info(capsys, walk)
    (tmp_path / "map.json").write_text(json.dumps(record["body_map"]))
    _, [again] = info(capsys, walk, "--body-map", tmp_path / "map.json")
    assert again["body_map"] == record["body_map"]


@pytest.mark.parametrize("rate", ["0", "-30", "nan"])
def test_a_frame_rate_that_is_none_is_refused(capsys, walk, rate):
    assert main(["info", str(walk), f"--frame-rate={rate}"]) == 1
    assert "frame rate" in capsys.readouterr().err


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
