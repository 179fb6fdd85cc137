from datetime import UTC, datetime
from pathlib import Path

from studio.app.problems import error_sentence
from studio.app.recovery_offer import session_message, session_title
from studio.app.verbs.files import next_increment
from studio.core.errors import StudioError
from studio.document.recovery import Session


def test_an_increment_counts_on_from_the_number_that_is_there(tmp_path):
    assert next_increment(tmp_path / "kick.studio").name == "kick_002.studio"
    assert next_increment(tmp_path / "kick_009.studio").name == "kick_010.studio"


def test_an_increment_never_names_a_file_that_is_there(tmp_path):
    (tmp_path / "kick_002.studio").touch()
    assert next_increment(tmp_path / "kick.studio").name == "kick_003.studio"


def test_an_error_for_the_user_is_told_as_it_is_and_a_fault_by_its_kind():
    assert error_sentence(StudioError("No such joint.")) == "No such joint."
    assert "KeyError: 'hips'" in error_sentence(KeyError("hips"))


def test_recovery_says_what_was_found_and_when():
    begun = datetime(2026, 5, 4, 14, 32, tzinfo=UTC).astimezone()
    session = Session(Path("j.sqlite"), "id", Path("walk.studio"), 12, begun, False)
    assert session_message(session) == f"Unsaved work on walk.studio from {begun:%H:%M} was found: 12 edits."


def test_earlier_work_is_listed_by_what_it_was_and_when():
    begun = datetime(2026, 5, 4, 14, 32, tzinfo=UTC).astimezone()
    session = Session(Path("j.sqlite"), "id", None, 1, begun, True)
    assert session_title(session) == ("Untitled", f"4 May {begun:%H:%M} · 1 edit")
