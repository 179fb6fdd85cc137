"""Files appear whole or not at all, with the usual mode, and nothing is left beside them."""

import json
import os
import resource
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.io import atomic_write as module
from studio.io.atomic_write import FolderNotWritable, atomic_replacements, write_atomically
from studio.io.bvh.reader import read_bvh, write_bvh
from studio.io.json_text import write_json
from studio.io.media.film import write_film
from studio.io.png import write_png
from studio.io.project.archive import write_archive
from studio.io.project.character_file import bundled_characters, read_character, write_character
from tests.builders import make_poses, make_skeleton

PIXELS = np.full((16, 16, 4), 200, dtype=np.uint8)


def _bvh(path: Path) -> None:
    write_bvh(path, make_skeleton(), make_poses(make_skeleton()), 60.0)


WRITERS: dict[str, Callable[[Path], object]] = {
    "take.bvh": _bvh,
    "report.json": lambda path: write_json(path, {"a": 1}),
    "picture.png": lambda path: write_png(path, PIXELS),
    "walk.studio": lambda path: write_archive(path, {"a": b"1"}),
    "child.json": lambda path: write_character(bundled_characters()["child"], path),
    "film.mp4": lambda path: write_film(path, [PIXELS] * 3, (16, 16), 30.0),
}


@contextmanager
def _at_most(size: int) -> Iterator[None]:
    """No file grows beyond ``size`` bytes, as on a disk that is full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def _fill(*paths: Path, failure: type[BaseException] | None = None) -> None:
    with atomic_replacements(*paths) as parts:
        for part in parts:
            part.write_bytes(b"new")
        if failure is not None:
            raise failure


def _mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_a_new_file_has_the_mode_that_the_umask_says(tmp_path: Path, name: str, mask: int) -> None:
    before = os.umask(mask)
    try:
        WRITERS[name](tmp_path / name)
    finally:
        os.umask(before)
    assert {_mode(path) for path in tmp_path.iterdir()} == {0o666 & ~mask}


@pytest.mark.parametrize("name", WRITERS)
def test_a_file_that_is_replaced_keeps_its_mode(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"old")
    (tmp_path / name).chmod(0o640)
    WRITERS[name](tmp_path / name)
    assert _mode(tmp_path / name) == 0o640
    assert (tmp_path / name).read_bytes() != b"old"


@pytest.mark.parametrize("name", WRITERS)
def test_on_a_full_disk_the_old_file_stays_and_a_sentence_says_so(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"old")
    with _at_most(3), pytest.raises(StudioError, match=r"no room for|could not be written") as refusal:
        WRITERS[name](tmp_path / name)
    assert name in str(refusal.value)
    assert (tmp_path / name).read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", WRITERS)
def test_a_folder_that_is_not_there_is_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(FolderNotWritable, match=r"could not be written: No such file.*Choose another folder"):
        WRITERS[name](tmp_path / "gone" / name)


STEPS = ["open", "chmod", "os.fsync", "os.replace"]


@pytest.mark.parametrize("step", STEPS)
def test_whatever_step_fails_both_old_files_are_whole(
    tmp_path: Path, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    for path in (one, two):
        path.write_bytes(b"old")

    def fail(*_arguments: object) -> None:
        raise OSError(5, "Input/output error")

    target = {"open": module, "chmod": Path}.get(step, os)
    monkeypatch.setattr(target, step.removeprefix("os."), fail, raising=False)
    with pytest.raises(StudioError, match="Input/output error"):
        _fill(one, two)
    assert (one.read_bytes(), two.read_bytes()) == (b"old", b"old")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "two"]


@pytest.mark.parametrize("failure", [ValueError, StudioError, KeyboardInterrupt])
def test_an_error_of_the_writer_itself_goes_on_as_it_is(tmp_path: Path, failure: type[BaseException]) -> None:
    path = tmp_path / "take.bvh"
    path.write_bytes(b"old")
    with pytest.raises(failure):
        _fill(path, failure=failure)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link_and_its_target_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_atomically(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_what_is_no_ordinary_file_is_never_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    for name in ("pipe", "folder"):
        with pytest.raises(StudioError, match="could not be written: it is not an ordinary file"):
            write_atomically(tmp_path / name, b"new")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_a_write_protected_file_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "kept.bvh"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, "access", lambda *_arguments: False)  # root may write everything
    with pytest.raises(FolderNotWritable, match="Permission denied"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"


def test_a_character_whose_record_cannot_be_written_keeps_its_mesh(tmp_path: Path) -> None:
    path = tmp_path / "dancer.json"
    write_character(bundled_characters()["child"], path)
    path.unlink()
    path.mkdir()
    mesh = path.with_suffix(".npz").read_bytes()
    with pytest.raises(StudioError, match="could not be written"):
        write_character(bundled_characters()["giant"], path)
    assert path.with_suffix(".npz").read_bytes() == mesh


def test_a_film_that_the_disk_cuts_short_is_refused(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 255, (20, 64, 64, 4), dtype=np.uint8)
    with _at_most(20_000), pytest.raises(StudioError, match="could not be written"):
        write_film(tmp_path / "film.mp4", noise, (64, 64), 30.0)
    assert list(tmp_path.iterdir()) == []


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    for name, write in WRITERS.items():
        write(tmp_path / name)
    assert len(read_bvh(tmp_path / "take.bvh").frames) == make_poses(make_skeleton()).frame_count
    assert json.loads((tmp_path / "report.json").read_text()) == {"a": 1}
    assert read_character(tmp_path / "child.json").name == bundled_characters()["child"].name
    assert b"ftyp" in (tmp_path / "film.mp4").read_bytes()[:16]


def test_where_no_folder_can_be_opened_files_are_replaced_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows."""
    monkeypatch.delattr(os, "O_DIRECTORY")
    target = tmp_path / "file"
    target.write_bytes(b"old")
    write_atomically(target, b"new")
    assert target.read_bytes() == b"new"
