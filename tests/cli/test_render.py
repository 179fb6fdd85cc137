"""`render`: pictures and films without a window."""

import json
import struct

import pytest

from studio.cli.main import main
from studio.core.solver.adapt import body_point_positions
from studio.core.stage.placement import Placement
from studio.io.export import write_capture
from studio.io.project.project_file import new_document_id, write_project
from studio.jobs.performances import adapted_performers
from tests.builders import make_capture, make_project
from tests.engine.test_following import RIGHT, stage


@pytest.fixture
def walk(tmp_path):
    """Half a second of a small walk as a BVH file."""
    write_capture(make_capture(), tmp_path / "walk.bvh")
    return tmp_path / "walk.bvh"


def size_of(path):
    return struct.unpack(">2I", path.read_bytes()[16:24])


def test_a_capture_is_drawn_in_the_size_asked_for(capsys, walk, tmp_path):
    out = tmp_path / "new folder" / "walk.png"
    command = ["render", str(walk), "--out", str(out), "--size", "160x90", "--character", "child", "giant", "--json"]
    assert main(command) == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["file"], record["characters"], record["frames"]) == (str(out), 2, 1)
    assert size_of(out) == (160, 90)


def test_another_moment_is_another_picture(walk, tmp_path):
    command = ["render", str(walk), "--size", "160x90", "--character", "child"]
    for name, time in (("begin", "0"), ("again", "0"), ("end", "0.4")):
        assert main([*command, "--out", str(tmp_path / f"{name}.png"), "--time", time]) == 0
    begin, again, end = ((tmp_path / f"{name}.png").read_bytes() for name in ("begin", "again", "end"))
    assert begin == again != end


def test_a_project_is_drawn_with_its_own_characters(capsys, tmp_path):
    write_project(tmp_path / "play.studio", make_project(characters=2), new_document_id())
    assert main(["render", str(tmp_path / "play.studio"), "--out", str(tmp_path / "p.png"), "--size", "160x90"]) == 0
    assert "2 characters" in capsys.readouterr().out
    assert main(["render", str(tmp_path / "play.studio"), "--out", str(tmp_path / "p.png")]) == 1
    assert "p.png' already exists" in capsys.readouterr().err
    assert main(["render", str(tmp_path / "play.studio"), "--out", "other.png", "--character", "child"]) == 1
    assert "can only be used with a capture" in capsys.readouterr().err


@pytest.mark.parametrize("circle", [False, True])
def test_performers_who_follow_each_other_are_drawn_where_they_follow(circle):
    project = stage(2, p0="p1", **({"p1": "p0"} if circle else {}))
    made = adapted_performers(project)
    wrists = [
        Placement.of(project.performers[key]).to_stage(body_point_positions(RIGHT, made[key])) for key in ("p0", "p1")
    ]
    assert wrists[0] == pytest.approx(wrists[1], abs=1e-3)


def test_a_film_has_its_progress_on_standard_error(capsys, walk, tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    command = ["render", str(walk), "--out", str(tmp_path / "walk.mp4"), "--size", "160x90", "--character", "child"]
    assert main([*command, "--json", "--film-rate", "10"]) == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["frames"] == 5
    assert "100% walk.mp4" in printed.err
    assert (tmp_path / "walk.mp4").read_bytes()[4:8] == b"ftyp"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["walk.bvh", "walk.mp4"]


def test_a_folder_gets_a_picture_for_every_frame(capsys, walk, tmp_path):
    command = ["render", str(walk), "--out", str(tmp_path / "shots"), "--size", "160x90", "--character", "child"]
    assert main([*command, "--film-rate", "10"]) == 0
    assert "5 images" in capsys.readouterr().out
    assert sorted(path.name for path in (tmp_path / "shots").iterdir())[-1] == "shots_0005.png"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--out", "walk.gif"], "Use .png or .mp4"),
        (["--out", "walk.mp4", "--size", "161x90"], "even numbers"),
        (["--out", "walk.png", "--time", "9"], "--time 9 is outside walk.bvh, which lasts 0.48 seconds."),
        (["--out", "walk.mp4", "--time", "0"], "--time selects a still image"),
    ],
)
def test_what_cannot_be_drawn_is_a_sentence(capsys, walk, tmp_path, monkeypatch, arguments, sentence):
    monkeypatch.chdir(tmp_path)
    assert main(["render", str(walk), "--character", "child", *arguments]) == 1
    assert sentence in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["walk.bvh"]


@pytest.mark.parametrize("size", ["12x9", "big", "100000x100"])
def test_a_size_that_is_none_is_bad_usage(capsys, walk, size):
    with pytest.raises(SystemExit) as end:
        main(["render", str(walk), "--out", "walk.png", "--size", size])
    assert end.value.code == 2
    assert "is not a size" in capsys.readouterr().err
