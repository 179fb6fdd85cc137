"""A failed export leaves nothing half-written, and what was there before as it was: every format, every way to fail."""

import errno
import os

import numpy as np
import pytest

from studio.core.errors import StudioError
from studio.core.normalized.normalize import normalize_capture
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_adapted, take_of_capture, write_take
from studio.io.media.film import write_moving
from studio.io.registry import OWN_FORMATS
from tests.builders import make_capture, make_character

SUFFIXES = [suffix for known in OWN_FORMATS if known.motion_writer for suffix in known.suffixes]


class Stopped(Exception):  # noqa: N818 - as the window's own
    """Exception that progress raises when the user cancels."""


@pytest.fixture(scope="module")
def take():
    character = make_character()
    request = AdaptRequest(normalize_capture(make_capture())[0], character.morphology)
    return take_of_adapted("Woman", adapt(request), character, request)


def stopping_at(call):
    """Progress that is cancelled at its n-th report, and how often it was told."""
    told = []

    def progress(share, _text):
        assert 0.0 <= share <= 1.0
        told.append(share)
        if len(told) == call:
            raise Stopped

    return progress, told


def needs(suffix):
    if suffix.startswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")


@pytest.mark.parametrize("there_before", [True, False])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_cancelling_at_any_report_leaves_the_folder_as_it_was(take, tmp_path, suffix, there_before):
    needs(suffix)
    write_take(take, tmp_path / f"whole{suffix}", stopping_at(0)[0])
    progress, heard = stopping_at(0)  # of a capture whose normalised motion is kept: every later export is so
    write_take(take, tmp_path / f"whole{suffix}", progress)
    (tmp_path / f"whole{suffix}").unlink()
    assert heard, "an exporter that tells nothing cannot be cancelled"
    path = tmp_path / f"out{suffix}"
    if there_before:
        path.write_bytes(b"precious")
    for call in sorted({1, len(heard) // 2, len(heard) - 1} & set(range(1, len(heard) + 1))):
        if heard[call - 1] == 1.0:
            continue  # it is written by then
        with pytest.raises(Stopped):
            write_take(take, path, stopping_at(call)[0])
        assert [(each.name, each.read_bytes()) for each in tmp_path.iterdir()] == (
            [(path.name, b"precious")] if there_before else []
        )


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_long_motion_goes_out_in_pieces_each_of_which_may_be_the_last(tmp_path, suffix):
    needs(suffix)
    progress, told = stopping_at(0)
    write_take(take_of_capture(make_capture(frames=9000)), tmp_path / f"out{suffix}", progress)
    steps = np.diff([0.0, *told, 1.0])
    assert (steps >= 0.0).all()
    assert steps.max() <= 0.35


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_disk_that_is_full_is_told_and_leaves_the_old_file(take, tmp_path, monkeypatch, suffix):
    needs(suffix)
    path = tmp_path / f"out{suffix}"
    path.write_bytes(b"precious")

    def full(_descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StudioError, match="no room for"):
        write_take(take, path)
    assert [(each.name, each.read_bytes()) for each in tmp_path.iterdir()] == [(path.name, b"precious")]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_folder_that_is_not_there_is_told(take, tmp_path, suffix):
    needs(suffix)
    with pytest.raises(StudioError, match="Choose another folder"):
        write_take(take, tmp_path / "none" / f"out{suffix}")


def pictures(count, fails_at=None):
    for number in range(count):
        if number == fails_at:
            raise Stopped
        yield np.full((48, 64, 4), 10 * number, np.uint8)


@pytest.mark.parametrize("name", ["film.mp4", "shots"])
def test_a_film_that_is_stopped_half_way_is_not_there(tmp_path, name):
    with pytest.raises(Stopped):
        write_moving(tmp_path / name, pictures(6, fails_at=3), (64, 48), 30.0)
    assert list(tmp_path.iterdir()) == []


def test_pictures_are_numbered_in_a_new_folder(tmp_path):
    write_moving(tmp_path / "shots", pictures(3), (64, 48), 30.0)
    assert sorted(each.name for each in (tmp_path / "shots").iterdir()) == [f"shots_000{k}.png" for k in (1, 2, 3)]
    assert [each.name for each in tmp_path.iterdir()] == ["shots"]


def test_a_folder_with_something_in_it_is_not_taken(tmp_path):
    (tmp_path / "shots").mkdir()
    write_moving(tmp_path / "shots", pictures(2), (64, 48), 30.0)
    with pytest.raises(StudioError, match="Choose a new folder"):
        write_moving(tmp_path / "shots", pictures(3), (64, 48), 30.0)
    assert len(list((tmp_path / "shots").iterdir())) == 2
