"""Files of captures that have moved are found by their content, else by their name."""

from dataclasses import replace

import pytest

from studio.core.errors import StudioError
from studio.io.export import take_of_capture, write_take
from studio.io.importing import GUESS_ALL, load_capture, read_capture
from studio.io.source_files import SourceMissing, digest_of, find_source
from tests.builders import make_capture


def silent(_share, _text):
    pass


@pytest.fixture
def walk(tmp_path):
    """A file with the capture that was read from it."""
    (tmp_path / "first").mkdir()
    write_take(take_of_capture(make_capture()), tmp_path / "first" / "walk.bvh")
    return load_capture(tmp_path / "first" / "walk.bvh")


def test_a_capture_knows_the_content_of_its_file_however_it_is_interpreted(tmp_path, walk):
    path = tmp_path / "first" / "walk.bvh"
    assert walk.digest == digest_of(path)
    read = read_capture(path)
    assert read.interpret(replace(GUESS_ALL, unit="inch"), silent).digest == walk.digest


def test_a_file_that_stayed_is_found_where_it_lay(tmp_path, walk):
    path = tmp_path / "first" / "walk.bvh"
    assert find_source(walk, path, (), silent).path == path


def test_a_file_is_found_by_its_content_under_another_name_in_another_folder(tmp_path, walk):
    known = tmp_path / "first" / "walk.bvh"
    (tmp_path / "second" / "takes").mkdir(parents=True)
    write_take(take_of_capture(make_capture(frames=9)), tmp_path / "second" / "walk.bvh")
    moved = known.rename(tmp_path / "second" / "takes" / "renamed.bvh")
    found = find_source(walk, known, (tmp_path / "first", tmp_path / "second"), silent)
    assert (found.path, found.digest) == (moved, walk.digest)


def test_where_nothing_has_its_content_a_file_of_its_name_is_taken(tmp_path, walk):
    known = tmp_path / "first" / "walk.bvh"
    known.unlink()
    (tmp_path / "second").mkdir()
    write_take(take_of_capture(make_capture(frames=9)), tmp_path / "second" / "walk.bvh")
    found = find_source(walk, known, (tmp_path / "gone", tmp_path / "second"), silent)
    assert found.path == tmp_path / "second" / "walk.bvh"
    assert found.digest != walk.digest


def test_a_capture_of_an_earlier_version_is_found_by_its_name(tmp_path, walk):
    found = find_source(replace(walk, digest=""), None, (tmp_path,), silent)
    assert found.path == tmp_path / "first" / "walk.bvh"


def test_a_source_that_is_nowhere_is_an_error_that_says_what_to_do(tmp_path, walk):
    (tmp_path / "first" / "walk.bvh").unlink()
    with pytest.raises(SourceMissing, match="File > Relink source"):
        find_source(walk, None, (tmp_path, tmp_path / "first"), silent)


def test_looking_for_a_file_can_be_cancelled(tmp_path, walk):
    def cancel(_share, _text):
        raise StudioError("cancelled")

    with pytest.raises(StudioError, match="cancelled"):
        find_source(walk, None, (tmp_path,), cancel)
