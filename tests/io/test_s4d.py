"""S4D: what is written comes back, in a file that zipfile and numpy alone can read."""

import json
import math
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.body.kinematics import joint_world
from studio.core.captures.annotations import Annotations, Label
from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.rotations import angle_between, from_matrix
from studio.io.export import take_of_capture, write_take
from studio.io.importing import ImportOptions, load_capture, read_capture
from studio.io.s4d.reader import read_s4d
from studio.io.s4d.writer import S4d, write_s4d
from tests.builders import make_capture, make_constraint, make_contact, make_morphology

TENTH_OF_A_MILLIMETRE = 1e-4
HUNDREDTH_OF_A_DEGREE = math.radians(0.01)
CLIPS = (
    "strikes/accad_male2_G9_RoundhouseRight",
    "varied/accad_female1_C03_Run",
    "varied/mass_cart",
    "conventions/rokoko_jesse_dance",
    "conventions/geno_bind_6ch",
)


def written(tmp_path, capture, annotations=None):
    path = tmp_path / "walk.s4d"
    write_s4d(path, S4d(capture, *normalize_capture(capture), annotations or Annotations()))
    return path


def errors(before, after):
    """Worst differences of any joint in any frame, metres and radians, in the world."""
    (there, turned), (back, turned_back) = (joint_world(each.skeleton, each.poses) for each in (before, after))
    angles = angle_between(from_matrix(turned), from_matrix(turned_back))
    return np.linalg.norm(there - back, axis=2).max(), angles.max()


@pytest.mark.parametrize("clip", CLIPS)
def test_a_real_capture_comes_back_from_less_than_half_of_its_bytes(captures, tmp_path, clip):
    [source] = (captures / "bvh").rglob(f"{clip.split('/')[1]}.bvh")
    capture = load_capture(source)
    path = written(tmp_path, capture)
    back = load_capture(path)
    position, rotation = errors(capture, back)
    assert position < TENTH_OF_A_MILLIMETRE
    assert rotation < HUNDREDTH_OF_A_DEGREE
    assert path.stat().st_size < source.stat().st_size / 2
    assert back.body_map == capture.body_map
    assert (back.frame_rate, back.first_frame, back.unit) == (capture.frame_rate, capture.first_frame, capture.unit)
    assert back.floor == pytest.approx(capture.floor, abs=1e-6)
    assert back.guesses == capture.guesses


def test_any_body_moves_the_same_by_the_motion_that_is_stored_and_by_the_capture_read(tmp_path):
    stored = read_s4d(written(tmp_path, make_capture(frames=90)))
    body = make_morphology(scale=1.4)
    places = [realize_motion(motion, body)[0] for motion in (stored.motion, normalize_capture(stored.capture)[0])]
    assert np.linalg.norm(places[1] - places[0], axis=2).max() < TENTH_OF_A_MILLIMETRE


def test_numpy_alone_reads_the_arrays_and_json_the_rest(tmp_path):
    capture = make_capture()
    path = written(tmp_path, capture)
    with np.load(path, allow_pickle=False) as file:
        assert file["channels"].dtype == np.float32
        assert file["channels"].shape == (30, 101)
        record = json.loads(file["s4d.json"])
    assert (record["format"], record["version"], record["frame_rate"]) == ("S4D", 1, 60.0)
    assert record["actor"]["joints"] == list(capture.skeleton.names)


def test_contacts_constraints_and_labels_come_along(tmp_path):
    notes = Annotations((make_contact(),), (make_constraint(), make_constraint(name="Two")), (Label("step", 2, 9),))
    path = written(tmp_path, make_capture(), notes)
    assert read_s4d(path, "other").annotations == notes.of_motion("other")
    assert read_capture(path).annotations.of_motion("motion") == notes.of_motion("motion")
    write_take(take_of_capture(load_capture(path), notes), tmp_path / "again.s4d")
    assert read_s4d(tmp_path / "again.s4d", "motion").annotations == notes.of_motion("motion")


def test_where_a_motion_came_from_is_kept_through_every_saving(tmp_path):
    path = written(tmp_path, make_capture())
    write_take(take_of_capture(load_capture(path)), tmp_path / "again.s4d")
    again = load_capture(tmp_path / "again.s4d")
    assert again.source == "walk.bvh"
    assert again.guesses == make_capture().guesses


def test_saving_again_loses_nothing_more(tmp_path):
    first = load_capture(written(tmp_path, make_capture(frames=90)))
    write_take(take_of_capture(first), tmp_path / "again.s4d")
    position, _ = errors(first, load_capture(tmp_path / "again.s4d"))
    assert position < TENTH_OF_A_MILLIMETRE


def test_fingers_and_joints_that_travel_pass_through(tmp_path):
    capture = make_capture()
    hand_end = capture.skeleton.index("LeftHandEnd")
    skeleton = replace(capture.skeleton, end_sites=np.zeros(26, dtype=bool))
    rotations, translations = (np.array(a) for a in (capture.poses.local_rotations, capture.poses.local_translations))
    rotations[:, hand_end, 0] = np.linspace(0.1, 0.9, 30)
    translations[:, hand_end, 1] += np.linspace(0.0, 0.3, 30)
    poses = replace(capture.poses, local_rotations=rotations, local_translations=translations)
    capture = replace(capture, skeleton=skeleton, poses=poses)
    path = written(tmp_path, capture)
    record = json.loads(zipfile.ZipFile(path).read("s4d.json"))
    assert hand_end in record["actor"]["rotations_of"]
    assert record["actor"]["translations_of"] == [hand_end]
    assert errors(capture, load_capture(path))[0] < TENTH_OF_A_MILLIMETRE


def test_what_the_file_cannot_have_guessed_cannot_be_overruled(tmp_path):
    path = written(tmp_path, make_capture(unit="cm"))
    assert load_capture(path, ImportOptions(unit="cm", frame_rate=25.0, floor=0.1)).frame_rate == 25.0
    with pytest.raises(StudioError, match=r"unit cannot be chosen. Read walk.bvh again"):
        load_capture(path, ImportOptions(unit="mm"))


def test_a_capture_that_is_no_human_is_refused(tmp_path):
    with pytest.raises(StudioError, match="choose which joint plays which part"):
        write_take(take_of_capture(make_capture(body_map=None)), tmp_path / "out.s4d")
    assert list(tmp_path.iterdir()) == []


def test_every_field_that_is_written_is_told_in_the_documentation(tmp_path):
    text = (Path(__file__).resolve().parents[2] / "docs" / "s4d.md").read_text()
    notes = Annotations((make_contact(),), (make_constraint(),), (Label("step", 2, 9),))
    with zipfile.ZipFile(written(tmp_path, make_capture(), notes)) as archive:
        record = json.loads(archive.read("s4d.json"))
        fields = [*archive.namelist(), *record, *record["actor"], *record["provenance"], *record["actor"]["morphology"]]
    fields += [*record["provenance"]["guesses"][0], *record["labels"][0], *record["contacts"]]
    assert [field for field in fields if f"`{field}`" not in text and f'"{field}"' not in text] == []


def test_the_program_of_the_documentation_reads_a_file(tmp_path, monkeypatch):
    text = (Path(__file__).resolve().parents[2] / "docs" / "s4d.md").read_text()
    written(tmp_path, make_capture()).rename(tmp_path / "kick.s4d")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(text.split("```python")[1].split("```")[0], names)
    assert names["hips"].shape == (30, 3)


def test_a_motion_stored_with_constraints_is_adapted_to_them(tmp_path, capsys):
    path = written(tmp_path, make_capture(), Annotations((make_contact(),), (make_constraint(name="Bell"),)))
    assert main(["adapt", str(path), "--character", "child", "--out", str(tmp_path / "out"), "--json"]) == 0
    [child] = json.loads(capsys.readouterr().out)["characters"]
    assert [each["name"] for each in child["constraints"]] == ["Bell"]
