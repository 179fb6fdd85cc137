"""A damaged journal is offered with what can be read of it, or told and put aside; it never stops a start."""

import shutil
import sqlite3
import stat
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from random import Random
from typing import Any

import pytest

from studio.core.errors import StudioError
from studio.core.stage.prop import Prop
from studio.document import journal as journals
from studio.document.document import Document
from studio.document.recovery import (
    DAMAGED_FOLDER,
    move_damaged_session,
    put_damaged_aside,
    recoverable_sessions,
    recovered_session,
    remove_useless_sessions,
)
from tests.document.test_journal import edit, make_document, state

__all__ = ["make_document"]

MUTANTS = 40


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rests and heals without anyone waiting for it."""
    monkeypatch.setattr(journals, "IDLE_SECONDS", 0.02)
    monkeypatch.setattr(journals, "RETRY_SECONDS", 1.0)


def killed(document: Document, tmp_path: Path) -> Path:
    """The folder of the journals as a kill would leave it now."""
    assert document.journal is not None
    assert document.journal.flush()
    folder = tmp_path / "killed"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(tmp_path / "state", folder)
    return folder


def damage(random: Random, file: Path) -> None:
    content = bytearray(file.read_bytes())
    match random.randrange(3):
        case 0:
            content = content[: random.randrange(len(content) + 1)]
        case 1:
            at = random.randrange(len(content) or 1)
            content[at : at + 4096] = bytes(min(4096, len(content) - at))
        case 2:
            for _ in range(random.choice([1, 5, 50])):
                content[random.randrange(len(content))] = random.randrange(256)
    file.write_bytes(content)


def test_no_damage_is_passed_over_in_silence_and_nothing_is_deleted(
    make_document: Callable[..., Document], tmp_path: Path
) -> None:
    document = make_document()
    edit(document, 30)
    last, folder = state(document.project), killed(document, tmp_path)
    [name] = (file.name for file in folder.glob("*.sqlite"))
    told = 0
    for seed in range(MUTANTS):
        random, copy = Random(seed), tmp_path / f"copy {seed}"
        shutil.copytree(folder, copy)
        damage(random, copy / (name + random.choice(["", "-wal"])))
        for _ in put_damaged_aside(copy):
            told += 1
        sessions = recoverable_sessions(copy)
        remove_useless_sessions(copy)
        for session in sessions:
            try:
                recovered = recovered_session(session)
            except StudioError as error:
                move_damaged_session(session, str(error))
                told += 1
            else:
                assert recovered.problems or state(recovered.project) == last
                told += bool(recovered.problems)
        assert (copy / name).exists() or (copy / DAMAGED_FOLDER / name).exists(), seed
    assert told > MUTANTS // 4


@pytest.mark.parametrize("started", ["soon", "1e300", "-1e300", "nan", "", None])
def test_a_session_begun_at_no_time_is_offered_all_the_same(
    make_document: Callable[..., Document], tmp_path: Path, started: str | None
) -> None:
    document = make_document()
    edit(document)
    last, folder = state(document.project), killed(document, tmp_path)
    [file] = folder.glob("*.sqlite")
    with closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.execute("UPDATE session SET value = ? WHERE key = 'started'", (started,))
    [session] = recoverable_sessions(folder)
    assert state(recovered_session(session).project) == last


def test_what_lies_in_the_folder_stops_no_start(tmp_path: Path) -> None:
    (tmp_path / "nonsense.sqlite").write_bytes(b"nonsense" * 1000)
    (tmp_path / "folder.sqlite").mkdir()
    (tmp_path / "empty.sqlite").write_bytes(b"")
    assert recoverable_sessions(tmp_path) == ()
    sentences = put_damaged_aside(tmp_path)
    assert len(sentences) == 2
    assert all(str(tmp_path / DAMAGED_FOLDER) in sentence for sentence in sentences)
    assert (tmp_path / DAMAGED_FOLDER / "nonsense.sqlite").read_bytes() == b"nonsense" * 1000
    assert put_damaged_aside(tmp_path) == ()


def test_while_nobody_edits_all_goes_into_the_database(
    make_document: Callable[..., Document], tmp_path: Path, quick: None, qtbot: Any
) -> None:
    document = make_document()
    edit(document)
    last = state(document.project)
    assert document.journal.flush()
    [log] = (tmp_path / "state").glob("*.sqlite-wal")
    qtbot.waitUntil(lambda: log.stat().st_size == 0)
    folder = killed(document, tmp_path)
    for file in folder.glob("*.sqlite-*"):
        file.unlink()
    [session] = recoverable_sessions(folder)
    assert state(recovered_session(session).project) == last


def test_a_journal_that_was_taken_away_begins_anew_and_is_safe_only_then(
    make_document: Callable[..., Document], tmp_path: Path, quick: None, qtbot: Any
) -> None:
    document = make_document()
    edit(document)
    assert document.journal.flush()
    (tmp_path / "state").rename(tmp_path / "elsewhere")
    with qtbot.waitSignal(document.problem_reported) as told:
        pass
    assert "Save the project now" in told.args[0]
    assert document.journal_state == "Backup stopped - save the project"
    qtbot.waitUntil(lambda: document.journal_state.startswith("All changes backed up"))
    document.add("props", Prop("Late"), "Add")
    last = state(document.project)
    [session] = recoverable_sessions(killed(document, tmp_path))
    assert state(recovered_session(session).project) == last


def test_a_journal_stopped_by_a_full_disk_goes_on_when_there_is_room(
    make_document: Callable[..., Document], tmp_path: Path, quick: None, qtbot: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = make_document()
    edit(document)
    assert document.journal.flush()
    insert = journals.Journal._insert

    def full(*_arguments: object) -> None:
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(journals.Journal, "_insert", full)
    with qtbot.waitSignal(document.problem_reported):
        document.add("props", Prop("First"), "Add")
    monkeypatch.setattr(journals.Journal, "_insert", insert)
    qtbot.waitUntil(lambda: document.journal_state.startswith("All changes backed up"))
    document.add("props", Prop("Second"), "Add")
    last = state(document.project)
    sessions = recoverable_sessions(killed(document, tmp_path))
    assert state(recovered_session(sessions[0]).project) == last


def test_only_the_owner_may_read_a_journal(make_document: Callable[..., Document], tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    assert document.journal.flush()
    assert stat.S_IMODE((tmp_path / "state").stat().st_mode) == 0o700
    files = [file for file in (tmp_path / "state").iterdir() if file.is_file()]
    assert len(files) >= 4
    assert {stat.S_IMODE(file.stat().st_mode) for file in files} == {0o600}
