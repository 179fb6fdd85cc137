"""Only ordinary files are read, and nothing that a file names leads out of its folder."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from studio.cli.main import main
from studio.core.errors import StudioError
from studio.io.importing import load_capture
from studio.io.json_text import json_of
from studio.io.meshes.mesh_file import read_mesh
from studio.io.npy import array_of
from studio.io.project.character_file import read_character, write_character
from studio.io.project.constraint_file import read_constraints
from studio.io.project.project_file import read_project
from studio.io.zipped import npy_file
from studio.live.recording import read_recording
from tests.builders import make_character
from tests.cli.test_adapt import WRIST
from tests.io.seeds import OBJ

AREA = {**WRIST, "kind": "area", "shape": "mesh", "centre": [0, 0, 0], "size": [1, 1, 1]}
AREA.pop("target")

READERS = {
    ".studio": read_project,
    ".obj": read_mesh,
    ".constraints": lambda path: read_constraints(path, "m"),
    ".packets": lambda path: next(read_recording(path)),
}


@pytest.mark.skipif(os.name == "nt", reason="there are no such files")
@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    "suffix", [".bvh", ".c3d", ".s4d", ".glb", ".json", ".fbx", ".studio", ".obj", ".constraints", ".packets"]
)
def test_a_pipe_and_a_link_to_a_device_are_refused_at_once(tmp_path: Path, suffix: str) -> None:
    pipe, link = tmp_path / f"pipe{suffix}", tmp_path / f"link{suffix}"
    os.mkfifo(pipe)
    link.symlink_to("/dev/zero")
    for path in (pipe, link):
        with pytest.raises(StudioError, match="not an ordinary file"):
            READERS.get(suffix, load_capture)(path)


@pytest.mark.skipif(os.name == "nt", reason="there are no such files")
def test_a_pipe_as_an_option_of_a_verb_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    for option in ("--body-map", "--marker-map"):
        assert main(["info", "walk.bvh", option, str(tmp_path / "pipe.json")]) == 1
        assert "not an ordinary file" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["../roof.obj", "{absolute}", "link.obj", "a\0b.obj", "C:\\roof.obj"])
def test_a_mesh_that_lies_elsewhere_is_not_followed(tmp_path: Path, name: str) -> None:
    (tmp_path / "roof.obj").write_text(OBJ)
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "link.obj").symlink_to(tmp_path / "roof.obj")
    record = {**AREA, "mesh": name.format(absolute=tmp_path / "roof.obj")}
    (folder / "area.json").write_text(json.dumps({"constraints": [record]}))
    with pytest.raises(StudioError, match=r"constraints\[0\], mesh"):
        read_constraints(folder / "area.json", "m")
    record["mesh"] = "roof.obj"
    (folder / "roof.obj").write_text(OBJ)
    (folder / "area.json").write_text(json.dumps({"constraints": [record]}))
    assert len(read_constraints(folder / "area.json", "m").constraints) == 1


@pytest.mark.parametrize("name", ["../hero.npz", "link.npz", "a\0b.npz", "gone.npz", "."])
def test_the_mesh_of_a_character_lies_beside_it(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    write_character(make_character(), tmp_path / "hero.json")
    record = json.loads((tmp_path / "hero.json").read_text())
    (folder / "link.npz").symlink_to(tmp_path / "hero.npz")
    (folder / "hero.json").write_text(json.dumps({**record, "mesh": name}))
    with pytest.raises(StudioError):
        read_character(folder / "hero.json")


GOOD = npy_file(np.arange(6.0).reshape(2, 3))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        GOOD[:-1],
        GOOD + b"\0",
        GOOD.replace(b"(2, 3)", b"(9, 9)"),
        GOOD.replace(b"(2, 3)", b"(2, 3"),
        GOOD.replace(b"(2, 3), ", b"(2199023255552, 1073741824), "),
        GOOD.replace(b"'<f8'", b"'|O' "),
        GOOD.replace(b"'<f8'", b"'<f1'"),
        GOOD.replace(b"'descr': '<f8'", b"'descr': exec()"),
        GOOD.replace(b"{'descr'", b"{'dhap' "),
        GOOD.replace(b"(2, 3)", b"((((("),
    ],
)
def test_no_header_of_an_array_is_believed(content: bytes) -> None:
    with pytest.raises(ValueError, match=r"plain array|does not fit|not read"):
        array_of(content)


def test_a_whole_array_is_read_to_the_bit_in_either_order() -> None:
    for array in (np.arange(6.0).reshape(2, 3), np.asfortranarray(np.eye(3, dtype=np.float32)), np.arange(3) > 1):
        assert np.array_equal(array_of(npy_file(array)), array)


HIDDEN = b'["]]",' * 600 + b"0" + b"]" * 600
"""Deep, behind brackets in strings that seem to close it."""


@pytest.mark.parametrize(
    "content", [b"[" * 990 + b"]" * 990, b"9" * 5000, b"9" * 2000, b'"\\ud800"', b"{", b"\xff", HIDDEN]
)
def test_json_that_no_file_of_ours_has_is_refused(content: bytes) -> None:
    with pytest.raises(ValueError, match=r".+"):
        json_of(content)


def test_brackets_in_a_name_nest_nothing() -> None:
    record = {'a " [{ \\': ["[" * 200, "{" * 200]}
    assert json_of(json.dumps(record).encode()) == record


@pytest.mark.parametrize("name", ["a\0b", "a" * 5000, "\ud800"])
@pytest.mark.parametrize("suffix", [".bvh", ".s4d", ".json", ".studio", ".obj", ".constraints"])
def test_what_is_no_name_of_a_file_is_told_in_a_sentence(tmp_path: Path, name: str, suffix: str) -> None:
    with pytest.raises(StudioError, match=r"could not be read"):
        READERS.get(suffix, load_capture)(tmp_path / f"{name}{suffix}")
