"""One registry: what a file is, who reads it, and what is added to the studio from outside."""

import json
import re
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from examples.formats.trace_format import FORMAT as TRACE
from studio.cli.main import main
from studio.core.errors import StudioError
from studio.io import plug_ins, registry
from studio.io.export import take_of_capture, write_capture, write_take
from studio.io.importing import ImportOptions, load_capture, load_character
from studio.io.registry import OWN_FORMATS, Format, format_of, known_formats
from tests.builders import make_capture

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "formats" / "trace_format.py"


@pytest.fixture
def installed(monkeypatch):
    """Lets packages be installed that add formats: name and what their entry point names."""

    def install(**entries: str) -> None:
        group = [EntryPoint(name, value, plug_ins.FORMATS_GROUP) for name, value in entries.items()]
        monkeypatch.setattr(plug_ins, "entry_points", lambda group, group_=group: group_)
        known_formats.cache_clear()

    yield install
    known_formats.cache_clear()


@pytest.mark.parametrize("known", OWN_FORMATS, ids=lambda known: known.name)
def test_every_function_that_a_format_of_the_studio_names_is_there(known: Format):
    jobs = ("sniff", "capture_reader", "character_reader", "reader", "motion_writer", "character_writer")
    named = [known._function(job) for job in jobs if getattr(known, job)]
    assert named
    assert all(suffix.startswith(".") and suffix == suffix.lower() for suffix in known.suffixes)


def test_a_format_from_outside_reads_and_writes_in_every_verb(installed, tmp_path, capsys):
    installed(trace="examples.formats.trace_format:FORMAT")
    capture = make_capture()
    write_capture(capture, tmp_path / "walk.trace")
    back = load_capture(tmp_path / "walk.trace")
    assert np.array_equal(back.poses.local_translations[:, 0], capture.poses.local_translations[:, 0])
    assert back.frame_rate == pytest.approx(capture.frame_rate, abs=0.01)
    assert [guess.subject for guess in back.guesses] == ["unit"]
    assert load_capture(tmp_path / "walk.trace", ImportOptions(frame_rate=25.0)).frame_rate == 25.0
    assert main(["convert", str(tmp_path / "walk.trace"), str(tmp_path / "walk.bvh")]) == 0
    assert main(["info", str(tmp_path / "walk.trace")]) == 0
    assert "A trace does not say its unit." in capsys.readouterr().out


def test_the_example_of_a_format_is_short():
    assert len(EXAMPLE.read_text().splitlines()) < 60


def test_a_format_that_fails_is_listed_with_its_error_and_the_others_are_there(installed, tmp_path):
    installed(
        gone="no_such_module:FORMAT",
        wrong="studio.core.errors:StudioError",
        again="studio.io.registry:OWN_BVH",
        trace="examples.formats.trace_format:FORMAT",
    )
    known = known_formats()
    assert known.formats == (*OWN_FORMATS, TRACE)
    gone, wrong, again = known.failures
    assert "'gone'" in gone
    assert "No module named 'no_such_module'" in gone
    assert "StudioError'> is not a studio.io.registry.Format" in wrong
    assert "OWN_BVH" in again
    (tmp_path / "take.xyz").write_bytes(b"?")
    with pytest.raises(StudioError, match="no_such_module"):
        load_capture(tmp_path / "take.xyz")


def test_the_verb_lists_what_there_is_and_what_failed(installed, capsys):
    installed(gone="no_such_module:FORMAT", trace="examples.formats.trace_format:FORMAT")
    assert main(["formats"]) == 1
    told = capsys.readouterr().out
    assert re.search(r"Trace +\.trace +capture +motion", told)
    assert re.search(r"BVH +\.bvh +capture +motion", told)
    assert "No module named 'no_such_module'" in told
    assert main(["formats", "--json"]) == 1
    assert len(json.loads(capsys.readouterr().out)["failures"]) == 1


def old_format():
    return Format("Old", (".old",), capture_reader="studio.io.bvh.capture:load_bvh", annotation_reader="a:b")  # type: ignore[call-arg]


def load_bare_capture(path, options, progress):
    return make_capture()


def test_a_format_of_an_earlier_protocol_is_refused_with_what_has_changed(installed, monkeypatch, tmp_path):
    monkeypatch.setattr(EntryPoint, "load", lambda self: old_format())
    installed(old="old:FORMAT")
    [failure] = known_formats().failures
    assert "'annotation_reader'" in failure
    assert "written for an earlier version of the studio: docs/formats.md" in failure


def test_a_reader_that_returns_a_bare_capture_is_named_with_what_it_should_return(monkeypatch, tmp_path):
    old = Format("Old", (".old",), capture_reader=f"{__name__}:load_bare_capture")
    monkeypatch.setattr(registry, "resolve_name", lambda name: load_bare_capture)
    with pytest.raises(StudioError, match="reader of Old returns a Capture, not a ReadCapture"):
        old.read_capture(tmp_path / "take.old", ImportOptions(), lambda share, text: None)


def test_a_second_format_of_the_same_name_is_refused(installed, monkeypatch):
    monkeypatch.setattr("examples.formats.trace_format.FORMAT", OWN_FORMATS[0])
    installed(bvh="examples.formats.trace_format:FORMAT")
    assert "there is already a format called BVH" in known_formats().failures[0]


def test_a_reader_that_cannot_be_imported_is_a_sentence(monkeypatch, tmp_path):
    broken = Format("Broken", (".broken",), capture_reader="no_such_module:read")
    monkeypatch.setattr(registry, "OWN_FORMATS", (broken,))
    known_formats.cache_clear()
    (tmp_path / "take.broken").write_bytes(b"?")
    with pytest.raises(StudioError, match="The capture reader of Broken could not be loaded: No module named"):
        load_capture(tmp_path / "take.broken")
    known_formats.cache_clear()


def test_a_file_is_what_its_first_bytes_say_before_what_it_is_called(tmp_path):
    write_take(take_of_capture(make_capture()), tmp_path / "walk.bvh")
    renamed = (tmp_path / "walk.bvh").rename(tmp_path / "walk.json")
    assert format_of(renamed, "capture_reader", "character_reader").name == "BVH"
    assert load_capture(renamed).frame_count == 30


def test_what_no_format_knows_is_refused_with_those_there_are(tmp_path):
    (tmp_path / "notes.txt").write_bytes(b"Dear diary")
    with pytest.raises(StudioError, match=r"notes\.txt is not a capture the studio reads\. It reads BVH"):
        load_capture(tmp_path / "notes.txt")
    with pytest.raises(StudioError, match=r"notes\.txt is not a character the studio reads\. It reads "):
        load_character(tmp_path / "notes.txt")
