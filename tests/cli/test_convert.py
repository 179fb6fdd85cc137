"""`convert`: the same motion in another file."""

import json

import numpy as np
import pytest

from benchmarks.read_back import places_in
from studio.cli.main import main
from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.io.export import write_capture
from studio.io.importing import load_capture, load_character
from tests.builders import make_capture


def test_joints_frames_and_rate_are_kept_and_named(capsys, tmp_path):
    write_capture(make_capture(), tmp_path / "walk.bvh")
    assert main(["convert", "--json", str(tmp_path / "walk.bvh"), str(tmp_path / "out.bvh")]) == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["frames"], record["frame_rate"], record["joints"]) == (30, 60.0, 21)
    assert record["file"] == str(tmp_path / "out.bvh")
    before, after = load_capture(tmp_path / "walk.bvh"), load_capture(tmp_path / "out.bvh")
    assert after.skeleton.names == before.skeleton.names


@pytest.mark.parametrize("name", ["pybvh_test3_fingers", "geno_bind_6ch"])
def test_a_real_capture_moves_as_before(captures, tmp_path, name):
    [source] = (captures / "bvh").rglob(f"{name}.bvh")
    assert main(["convert", str(source), str(tmp_path / "out.bvh")]) == 0
    before, after = load_capture(source), load_capture(tmp_path / "out.bvh")
    places = [joint_world(each.skeleton, each.poses)[0] for each in (before, after)]
    assert np.abs(places[1] - places[0]).max() < 1e-5


def test_what_was_repaired_is_told(capsys, captures, tmp_path):
    source = captures / "bvh" / "strikes" / "assimp_Boxing_Toes.bvh"
    assert main(["convert", str(source), str(tmp_path / "out.bvh")]) == 0
    assert "repaired" in capsys.readouterr().out


def test_an_unknown_format_is_refused_before_anything_is_read(capsys, tmp_path):
    assert main(["convert", str(tmp_path / "missing.bvh"), str(tmp_path / "out.xyz")]) == 1
    assert "End its name with .bvh" in capsys.readouterr().err


def test_a_rest_pose_that_a_format_has_not_is_refused_before_anything_is_read(capsys, tmp_path):
    assert main(["convert", str(tmp_path / "missing.bvh"), str(tmp_path / "out.csv"), "--rest-pose", "t"]) == 1
    assert "has no rest pose" in capsys.readouterr().err


def test_joints_get_the_names_of_another_program(tmp_path):
    write_capture(make_capture(), tmp_path / "walk.bvh")
    asked = ["--joint-names", "blender", "--rest-pose", "t"]
    assert main(["convert", str(tmp_path / "walk.bvh"), str(tmp_path / "out.bvh"), *asked]) == 0
    assert "upper_arm.L" in load_capture(tmp_path / "out.bvh").skeleton.names


@pytest.mark.parametrize("suffix", [".bvh", ".fbx", ".glb"])
def test_a_range_a_rate_and_a_root_are_chosen_on_the_command_line(tmp_path, suffix):
    write_capture(make_capture(frames=60), tmp_path / "walk.bvh")
    target = tmp_path / f"out{suffix}"
    asked = ["--range", "0.25", "0.75", "--rate", "30", "--root", "floor"]
    assert main(["convert", str(tmp_path / "walk.bvh"), str(target), *asked]) == 0
    back = places_in(target)
    assert back["root"].shape == (16, 3)
    assert np.ptp(back["root"][:, 2]) < 1e-6
    assert np.abs(back["root"][:, :2] - back["Hips"][:, :2]).max() < 1e-5


def test_a_damaged_file_leaves_the_target_as_it_was(capsys, tmp_path):
    (tmp_path / "bad.bvh").write_bytes(b"HIERARCHY\nROOT Hips\n{\n OFFSET 0,5 0 0\n")
    (tmp_path / "out.bvh").write_text("precious")
    assert main(["convert", str(tmp_path / "bad.bvh"), str(tmp_path / "out.bvh"), "--overwrite"]) == 1
    assert "bad.bvh, line 4" in capsys.readouterr().err
    assert (tmp_path / "out.bvh").read_text() == "precious"


@pytest.mark.parametrize("name", ["vrm1_debug_robot.vrm", "joe_hanim_kick.x3dv"])
@pytest.mark.parametrize("suffix", [".bvh", ".s4d", ".glb"])
def test_a_character_in_a_file_that_holds_no_motion_stands_for_one_frame(capsys, captures, tmp_path, name, suffix):
    source, target = captures / "characters" / name, tmp_path / f"out{suffix}"
    assert main(["convert", str(source), str(target)]) == 0
    assert "1 frame of" in capsys.readouterr().out
    character, capture = load_character(source).character, load_capture(target)
    assert capture.frame_count == 1
    standing = joint_world(capture.skeleton, capture.poses)[0][0]
    hip, ankle = (standing[capture.body_map[part], 2] for part in (BodyPart.LEFT_THIGH, BodyPart.LEFT_FOOT))
    assert hip - ankle == pytest.approx(character.morphology.leg_length, rel=0.05)
    if suffix == ".glb":
        again = load_character(target).character.skin.vertices
        assert again.min(axis=0) == pytest.approx(character.skin.vertices.min(axis=0), abs=0.02)
        assert again.max(axis=0) == pytest.approx(character.skin.vertices.max(axis=0), abs=0.02)


def test_markers_that_show_no_body_are_told_what_to_say(capsys, captures, tmp_path):
    source = captures / "c3d" / "sample15_FP1_metres.c3d"
    assert main(["convert", str(source), str(tmp_path / "actor.json")]) == 1
    assert "Map its markers with --marker-map." in capsys.readouterr().err


@pytest.mark.parametrize("target", ["walk.bvh", "there.bvh", "there.json", "link.bvh"])
def test_no_file_is_replaced_unless_that_is_asked_for(capsys, tmp_path, target):
    write_capture(make_capture(), tmp_path / "walk.bvh")
    (tmp_path / "link.bvh").symlink_to(tmp_path / "walk.bvh")
    for name in ("there.bvh", "there.json"):
        (tmp_path / name).write_text("precious")
    before = (tmp_path / target).read_bytes()
    command = ["convert", str(tmp_path / "walk.bvh"), str(tmp_path / target)]
    assert main(command) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert (tmp_path / target).read_bytes() == before
    assert main([*command, "--overwrite", "--unit", "m"]) == 0
    assert (tmp_path / target).read_bytes() != before
