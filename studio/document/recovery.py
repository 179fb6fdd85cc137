"""Recovery: sessions whose process died with unsaved edits, and the project and history out of them."""

import json
import sqlite3
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from studio.core.errors import StudioError
from studio.core.project import Project
from studio.document.commands.replace import Edit, applied
from studio.document.file_lock import FileLock
from studio.document.journal import StateHash, Step, lock_of, remove_session
from studio.document.playhead import PlayheadState
from studio.io.entity_json import entity_of, parsed, project_of
from studio.io.npy import array_of
from studio.io.value_json import Array

KEPT_WHEN_DECLINED = timedelta(days=30)


@dataclass(frozen=True)
class Session:
    """A journal that holds edits which no project file has."""

    file: Path
    document_id: str
    path: Path | None
    """The project's file, if it had one."""
    edits: int
    begun: datetime
    declined: bool
    """The user chose not to save; kept all the same."""


@dataclass(frozen=True, eq=False)
class Recovered:
    """The newest state that is right, and the way there from ``base``."""

    project: Project
    base: Project
    steps: tuple[Step, ...]
    problems: tuple[str, ...] = ()
    playhead: PlayheadState | None = None
    """Where the user stood; None where the session says nothing of it."""


def recoverable_sessions(folder: Path, declined: bool = False) -> tuple[Session, ...]:
    """Sessions of processes that are gone, newest first; with ``declined`` those too that the user gave up."""
    found = [session for _, session in _abandoned(folder) if session is not None]
    wanted = [session for session in found if declined or not session.declined]
    return tuple(sorted(wanted, key=lambda session: session.begun, reverse=True))


def tidy(folder: Path, now: datetime | None = None) -> None:
    """Take away sessions that hold nothing unsaved, and those that the user gave up a month ago."""
    long_ago = (now or datetime.now()) - KEPT_WHEN_DECLINED
    for file, session in _abandoned(folder):
        if session is None or (session.declined and session.begun < long_ago):
            remove_session(file)


def _abandoned(folder: Path) -> list[tuple[Path, Session | None]]:
    """Readable journals of processes that are gone; with None where everything in them was saved."""
    found = []
    for file in folder.glob("*.sqlite") if folder.is_dir() else ():
        lock = FileLock.taken(lock_of(file))
        if lock is None:
            continue
        try:
            found.append((file, _session(file)))
        except sqlite3.Error:  # not begun, or damaged: neither to be offered nor to be taken away
            continue
        finally:
            lock.release()
    return found


def recover(session: Session) -> Recovered:
    """The session's last state. Raises StudioError when not even its first state can be read.

    States are checked against their hashes; what comes after a damaged step is left out and told.
    """
    try:
        with closing(_opened(session.file)) as connection:
            return replace(_recovered(connection), playhead=_playhead(connection))
    except sqlite3.Error as error:
        raise StudioError(f"The journal '{session.file.name}' cannot be read: {error}.") from error


def mark_recovered(session: Session) -> None:
    """Do not offer this session again; another journal holds its edits now. Its file stays."""
    with closing(sqlite3.connect(session.file, isolation_level=None)) as connection:
        connection.execute("INSERT OR REPLACE INTO session VALUES ('ended', 'declined')")


def _opened(file: Path) -> sqlite3.Connection:
    return sqlite3.connect(file, isolation_level=None)


def _session(file: Path) -> Session | None:
    """None for a journal without unsaved edits."""
    with closing(_opened(file)) as connection:
        facts = dict(connection.execute("SELECT key, value FROM session"))
        saved = connection.execute("SELECT number, path, state FROM saves ORDER BY rowid DESC").fetchone()
        last = connection.execute("SELECT number, state FROM steps ORDER BY number DESC").fetchone()
    base_counts = facts.get("unsaved_base") == "1" and saved is None
    new_steps = last is not None and (saved is None or last[1] != saved[2])
    if not (base_counts or new_steps) or facts.get("ended") == "saved":
        return None
    path = saved[1] if saved else facts["path"]
    return Session(
        file,
        facts["document"],
        Path(path) if path else None,
        (last[0] if last else 0) - (saved[0] if saved else 0),
        datetime.fromtimestamp(float(facts["started"])),
        facts.get("ended") == "declined",
    )


def _recovered(connection: sqlite3.Connection) -> Recovered:
    def load(name: str) -> Array:
        row = connection.execute("SELECT content FROM arrays WHERE name = ?", (name,)).fetchone()
        if row is None:
            raise ValueError(f"'{name}' is missing from the journal.")
        return array_of(row[0])

    foreign = _foreign(connection)
    hashes = StateHash()
    states = {
        number: _state(content, state, load, hashes, foreign)
        for number, content, state in connection.execute("SELECT * FROM snapshots")
    }
    rows = connection.execute("SELECT * FROM steps ORDER BY number").fetchall()
    whole = _replayed(states.get(0), rows, load, hashes)
    if whole is not None and not whole.problems:
        return whole
    for number in sorted(states, reverse=True):
        later = [row for row in rows if row[0] > number]
        recovered = _replayed(states[number], later, load, hashes)
        if recovered is not None:
            return recovered
    raise StudioError("No state in the journal is whole. Open the project's file instead.")


def _playhead(connection: sqlite3.Connection) -> PlayheadState | None:
    row = connection.execute("SELECT value FROM session WHERE key = 'playhead'").fetchone()
    return PlayheadState(**json.loads(row[0])) if row else None


def _foreign(connection: sqlite3.Connection) -> dict[str, bytes]:
    """The members that belong to what a newer version wrote."""
    row = connection.execute("SELECT value FROM session WHERE key = 'foreign'").fetchone()
    names = json.loads(row[0]) if row else []
    select = "SELECT name, content FROM arrays WHERE name = ?"
    return dict(connection.execute(select, (name,)).fetchone() for name in names)


def _state(content: bytes, state: str, load: Any, hashes: StateHash, foreign: dict[str, bytes]) -> Project | None:
    """A snapshot's project, or None when it is not what was written."""
    try:
        project = project_of(parsed(content, "snapshot"), load).project
    except StudioError:
        return None
    if hashes.of(project) != state:
        return None
    return replace(project, carried={**project.carried, "members": foreign}) if foreign else project


def _replayed(base: Project | None, rows: list[Any], load: Any, hashes: StateHash) -> Recovered | None:
    if base is None:
        return None
    project = base
    steps: list[Step] = []
    for number, verb, text, gesture, content, state in rows:
        try:
            edits = tuple(_edit(record, project, load) for record in json.loads(content))
            after = applied(project, edits)
            if hashes.of(after) != state:
                raise ValueError("its hash is wrong")
        except (ValueError, KeyError, TypeError, StudioError) as error:
            problem = f"Edits from number {number} on ('{text}') could not be recovered: {error}."
            return Recovered(project, base, tuple(steps), (problem,))
        project = after
        steps.append(Step(verb, edits, text, gesture, project))
    return Recovered(project, base, tuple(steps))


def _edit(record: dict[str, Any], project: Project, load: Any) -> Edit:
    collection, entity_id = record["collection"], record["id"]
    new = None if record["new"] is None else entity_of(collection, record["new"], load)
    return Edit(collection, entity_id, project.get(collection, entity_id), new, record["place"])
