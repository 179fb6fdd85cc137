"""``adapt --stage``: every performer of a project as the window plays it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer
from studio.io.importing import load_capture
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.jobs.performances import stage_performances
from tests.builders import make_capture, make_project
from tests.core.motions import ALWAYS


@pytest.fixture
def play(tmp_path):
    """Two performers, one with a row of two clips; a third plays a capture whose body is not known."""
    project = make_project(characters=2)
    first = project.performers["performer 0"]
    row = (*first.clips, Clip("motion", 5, 25, 0.6, "again", mirrored=True))
    project = project.with_entity("performers", "performer 0", replace(first, clips=row))
    project = project.with_entity("captures", "bare", make_capture("bare", body_map=None))
    project = project.with_entity("motions", "bare", replace(project.motions["motion"], capture_id="bare"))
    bare = Performer("Lost", first.character_id, (Clip("bare", 0, 10, id="bare clip"),))
    write_project(tmp_path / "play.studio", project.with_entity("performers", "lost", bare), new_document_id())
    return tmp_path / "play.studio"


def test_every_performer_is_a_file_and_a_report_and_one_that_fails_keeps_nobody_back(play, capsys, tmp_path):
    out = tmp_path / "out"
    assert main(["adapt", "--stage", str(play), "--out", str(out), "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert [each["name"] for each in report["performers"]] == ["Body 0", "Body 1"]
    assert [each["name"] for each in report["failed"]] == ["Lost"]
    assert len(report["performers"][0]["clips"]) == 2
    assert all(np.isfinite(each["slide_mm"]) for each in report["performers"])
    made = stage_performances(read_project(play).project)
    for key, record in zip(made.performances, report["performers"], strict=True):
        assert load_capture(record["file"]).frame_count == made.performances[key].adapted_on_stage.frame_count
    assert json.loads((out / "report.json").read_text()) == report
    assert main(["adapt", "--stage", str(play), "--out", str(out)]) == 1
    assert "already exists" in capsys.readouterr().err


def test_a_clip_that_ends_before_its_capture_is_reported_with_what_is_asked_of_it(play, capsys, tmp_path):
    """It ended in a fault: frames after the clip's last one were counted as well."""
    project = read_project(play).project.with_entity("performers", "lost", None)
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    asked = PositionConstraint("motion", "Reach", wrist, Chain(), 0, ALWAYS, target=(0.3, -0.2, 1.2))
    [clip] = project.performers["performer 1"].clips
    short = replace(project.performers["performer 1"], clips=(replace(clip, first=4, last=clip.last - 6),))
    project = project.with_entity("constraints", "reach", asked).with_entity("performers", "performer 1", short)
    write_project(tmp_path / "short.studio", project, new_document_id())
    assert main(["adapt", "--stage", str(tmp_path / "short.studio"), "--out", str(tmp_path / "o"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert 0 < report["performers"][1]["constraints"][0]["frames_asked"] <= clip.last - 9


def test_what_a_project_has_itself_is_refused_in_a_sentence(play, capsys, tmp_path):
    for more in (["walk.bvh"], ["--character", "child"], ["--place", "child", "0", "0", "0"]):
        assert main(["adapt", *more, "--stage", str(play), "--out", str(tmp_path / "out")]) == 1
        assert "leave out" in capsys.readouterr().err
    assert main(["adapt", "--out", str(tmp_path / "out")]) == 1
    assert "--stage" in capsys.readouterr().err


def test_a_picture_of_a_stage_tells_who_is_not_on_it(play, capsys, tmp_path):
    assert main(["render", str(play), "--out", str(tmp_path / "p.png"), "--size", "160x90"]) == 0
    said = capsys.readouterr().out
    assert "2 characters" in said
    assert "Not adapted: Lost" in said


def test_a_name_that_is_neither_a_project_nor_a_scene_lists_the_scenes(tmp_path, capsys):
    assert main(["adapt", "--stage", "dance", "--out", str(tmp_path / "out")]) == 1
    assert "There is no project 'dance'. Name a file, or a scene: fight-training," in capsys.readouterr().err
