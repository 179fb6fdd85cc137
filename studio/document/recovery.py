"""Recovery of projects and undo history from the journals of crashed sessions."""

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from itertools import pairwise
from pathlib import Path
from typing import Any

from studio.core.changed_records import with_fields
from studio.core.errors import StudioError
from studio.core.names import counted_noun
from studio.core.stage.project import Project
from studio.document.commands.replace import Edit, with_edits_applied
from studio.document.file_lock import FileLock
from studio.document.journal import JournalEntry, StateHash, files_of, lock_of, remove_session, steps_of
from studio.document.playhead import PlayheadState
from studio.io.json_text import JsonObject
from studio.io.npy import array_of
from studio.io.project.archive import Stamp
from studio.io.project.entity_json import entity_of, parse_member, project_of
from studio.io.project.value_json import Array

DECLINED_KEPT_FOR = timedelta(days=30)


_DAMAGE = (sqlite3.Error, StudioError, ValueError, TypeError, KeyError, ArithmeticError, OSError)
"""Exceptions raised while reading a damaged journal."""
DAMAGED_FOLDER = "damaged"
"""Name of the folder for unreadable journals, within the folder of the journals."""


@dataclass(frozen=True)
class Session:
    """Session journal with edits that were not saved to a project file."""

    file: Path
    document_id: str
    path: Path | None
    """Path of the project file; None if the project was never saved."""
    edits: int
    begun: datetime
    declined: bool
    """True if the user chose not to save; the journal is kept for 30 days."""
    written: int = 0
    """Number of steps once written, whether or not they are readable."""
    damage: str = ""
    """Reason why nothing in the journal can be read; empty if something can."""
    stamp: Stamp | None = None
    """Digest of the project file as the session knew it; saving asks first if the file was changed since."""


@dataclass(frozen=True, eq=False)
class Recovered:
    """Newest valid state of a session, and the undo steps that lead to it from ``base``."""

    project: Project
    base: Project
    steps: tuple[JournalEntry, ...]
    problems: tuple[str, ...] = ()
    playhead: PlayheadState | None = None
    """State of the playhead; None if it was not stored."""


def recoverable_sessions(folder: Path, declined: bool = False) -> tuple[Session, ...]:
    """Sessions of crashed processes, newest first; with ``declined`` also those whose recovery the user declined."""
    found = [session for _, session in _abandoned(folder) if session is not None and not session.damage]
    wanted = [session for session in found if declined or not session.declined]
    return tuple(sorted(wanted, key=lambda session: session.begun, reverse=True))


def put_damaged_aside(folder: Path) -> tuple[str, ...]:
    """Move unreadable journals to the folder of damaged ones; returns one sentence about each."""
    damaged = [session for _, session in _abandoned(folder) if session is not None and session.damage]
    return tuple(move_damaged_session(session, session.damage) for session in damaged)


def move_damaged_session(session: Session, reason: str) -> str:
    """Move an unreadable journal to a folder in which nothing is deleted; returns a sentence with ``reason`` about
    it.
    """
    aside = session.file.parent / DAMAGED_FOLDER
    aside.mkdir(mode=0o700, exist_ok=True)
    for file in files_of(session.file):
        if file.exists():
            file.replace(aside / file.name)
    edits = f" of {counted_noun(session.written, 'edit')}" if session.written else ""
    return f"A backup{edits} from {session.begun:%Y-%m-%d %H:%M} cannot be read ({reason}). It is kept in '{aside}'."


def remove_useless_sessions(folder: Path, now: datetime | None = None) -> None:
    """Remove sessions without unsaved edits, and sessions declined more than 30 days ago."""
    long_ago = (now or datetime.now()) - DECLINED_KEPT_FOR
    for file, session in _abandoned(folder):
        if session is None or (session.declined and not session.damage and session.begun < long_ago):
            remove_session(file)


def _abandoned(folder: Path) -> list[tuple[Path, Session | None]]:
    """(file, session) of each journal whose process has ended; the session is None if all its edits were saved."""
    found = []
    for file in folder.glob("*.sqlite") if folder.is_dir() else ():
        try:
            lock = FileLock.acquired(lock_of(file))
        except OSError:  # a folder in its place: nobody's journal
            continue
        if lock is None:
            continue
        try:
            found.append((file, _session(file)))
        finally:
            lock.release()
    return found


def recovered_session(session: Session) -> Recovered:
    """Last valid state of a session. Raises StudioError if not even its first state can be read.

    States are checked against their hashes; steps after a damaged one are left out and reported.
    """
    try:
        with closing(_opened(session.file)) as connection:
            recovered, last = _recovered(connection)
            playhead = _playhead(connection)
    except _DAMAGE as error:
        raise StudioError(f"The backup '{session.file.name}' cannot be read: {error}") from error
    problems = recovered.problems
    if last < session.written:
        lost = f"{session.written - last} of the {counted_noun(session.written, 'edit')}"
        problems += (f"{lost} in the backup could not be read: it is damaged.",)
    return replace(recovered, problems=problems, playhead=playhead)


def mark_recovered(session: Session) -> None:
    """Mark a session as recovered, so that it is not offered again. Its file is kept."""
    with closing(sqlite3.connect(session.file, isolation_level=None)) as connection:
        connection.execute("INSERT OR REPLACE INTO session VALUES ('ended', 'declined')")


def _opened(file: Path) -> sqlite3.Connection:
    return sqlite3.connect(file, isolation_level=None)


def _session(file: Path) -> Session | None:
    """Session of a journal file; None if it has no unsaved edits."""
    counted = _counted(file)
    begun = datetime.fromtimestamp(file.stat().st_mtime)
    try:
        with closing(_opened(file)) as connection:
            if not counted and not connection.execute("SELECT 1 FROM sqlite_master").fetchone():
                return None  # its process ended before anything was in it
            facts = dict(connection.execute("SELECT key, value FROM session"))
            saved = connection.execute("SELECT number, path, state FROM saves ORDER BY rowid DESC").fetchone()
            last = connection.execute("SELECT number, state FROM steps ORDER BY number DESC").fetchone()
            written = max(counted, last[0] if last else 0)
            base_counts = facts.get("unsaved_base") == "1" and saved is None
            new_steps = last is not None and (saved is None or last[1] != saved[2])
            whole = written == (last[0] if last else 0)
            if whole and (not (base_counts or new_steps) or facts.get("ended") == "saved"):
                return None
            path = saved[1] if saved else facts.get("path")
            return Session(
                file,
                facts.get("document") or _document_of(file),
                Path(path) if path else None,
                _edits_since(connection, saved[0] if saved else 0) + written - (last[0] if last else 0),
                _begun(facts.get("started"), begun),
                facts.get("ended") == "declined",
                written,
                stamp=_stamp(facts.get("stamp")) if path else None,
            )
    except _DAMAGE as error:
        return Session(
            file, _document_of(file), None, counted, begun, False, counted, str(error) or type(error).__name__
        )


def _edits_since(connection: sqlite3.Connection, number: int) -> int:
    """Number of edits after step ``number`` as the user counts them: the steps of one gesture are one edit."""
    gestures = [
        row[0] for row in connection.execute("SELECT gesture FROM steps WHERE number > ? ORDER BY number", (number,))
    ]
    return sum(here is None or here != before for before, here in pairwise([None, *gestures]))


def _counted(file: Path) -> int:
    """Number of steps stored in the file beside the journal; 0 if it holds no number."""
    try:
        return max(int(steps_of(file).read_bytes()[:12]), 0)
    except (OSError, ValueError):
        return 0


def _document_of(file: Path) -> str:
    return file.stem.partition("-")[0]


def _stamp(told: str | None) -> Stamp:
    """Stamp of the project file; if the journal has none, one that never matches, so that saving asks before
    overwriting.
    """
    try:
        node, size, time = json.loads(told or "")
        return int(node), int(size), int(time)
    except (ValueError, TypeError):
        return 0, 0, 0


StoredRow = tuple[Any, ...]
"""Row of a database table of the journal."""
LoadArray = Callable[[str], Array]
"""Function that returns an array by its name; it raises ValueError if the journal has none of that name."""


def _begun(told: str | None, otherwise: datetime) -> datetime:
    try:
        return datetime.fromtimestamp(float(told or ""))
    except (ValueError, ArithmeticError, OSError):
        return otherwise


def _readable(connection: sqlite3.Connection, question: str) -> list[StoredRow]:
    """Rows of a query up to the first unreadable one."""
    rows = []
    try:
        for row in connection.execute(question):
            rows.append(row)
    except sqlite3.Error:
        return rows
    return rows


def _recovered(connection: sqlite3.Connection) -> tuple[Recovered, int]:
    """Newest valid state, and the number of the last step that it includes."""

    def load(name: str) -> Array:
        row = connection.execute("SELECT content FROM arrays WHERE name = ?", (name,)).fetchone()
        if row is None:
            raise ValueError(f"'{name}' is missing from the backup.")
        return array_of(row[0])

    foreign = _foreign(connection)
    hashes = StateHash()
    states = {
        number: _state(content, state, load, hashes, foreign)
        for number, content, state in _readable(connection, "SELECT * FROM snapshots ORDER BY number")
    }
    rows = _readable(connection, "SELECT * FROM steps ORDER BY number")
    whole = _replayed(states.get(0), rows, load, hashes)
    if whole is not None and not whole.problems:
        return whole, len(whole.steps)
    for number in sorted(states, reverse=True):
        later = [row for row in rows if row[0] > number]
        recovered = _replayed(states[number], later, load, hashes)
        if recovered is not None:
            return recovered, number + len(recovered.steps)
    raise StudioError("The backup is damaged and cannot be recovered. Open the project's file instead.")


def _playhead(connection: sqlite3.Connection) -> PlayheadState | None:
    row = connection.execute("SELECT value FROM session WHERE key = 'playhead'").fetchone()
    try:
        return PlayheadState(**json.loads(row[0])) if row else None
    except (ValueError, TypeError):
        return None


def _foreign(connection: sqlite3.Connection) -> dict[str, bytes]:
    """Files of the project archive that were written by a newer version, by name."""
    row = connection.execute("SELECT value FROM session WHERE key = 'foreign'").fetchone()
    names = json.loads(row[0]) if row else []
    select = "SELECT name, content FROM arrays WHERE name = ?"
    return dict(connection.execute(select, (name,)).fetchone() for name in names)


def _state(content: bytes, state: str, load: LoadArray, hashes: StateHash, foreign: dict[str, bytes]) -> Project | None:
    """Project of a snapshot; None if its hash does not match ``state``."""
    try:
        project = project_of(parse_member(content, "snapshot"), load).project
    except (StudioError, ValueError, TypeError):
        return None
    if hashes.of(project) != state:
        return None
    return with_fields(project, carried={**project.carried, "members": foreign}) if foreign else project


def _replayed(base: Project | None, rows: list[StoredRow], load: LoadArray, hashes: StateHash) -> Recovered | None:
    if base is None:
        return None
    project = base
    steps: list[JournalEntry] = []
    for number, verb, text, gesture, content, state in rows:
        try:
            edits = tuple(_edit(record, project, load) for record in json.loads(content))
            after = with_edits_applied(project, edits)
            if hashes.of(after) != state:
                raise ValueError("its checksum does not match")
        except (ValueError, KeyError, TypeError, StudioError) as error:
            problem = f"Edits from number {number} on ('{text}') could not be recovered: {error}."
            return Recovered(project, base, tuple(steps), (problem,))
        project = after
        steps.append(JournalEntry(verb, edits, text, gesture, project))
    return Recovered(project, base, tuple(steps))


def _edit(record: JsonObject, project: Project, load: LoadArray) -> Edit:
    collection, entity_id = record["collection"], record["id"]
    new = None if record["new"] is None else entity_of(collection, record["new"], load)
    return Edit(collection, entity_id, project.get(collection, entity_id), new, record["place"])
