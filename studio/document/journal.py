"""Session journal: every edit is written to disk immediately, in an SQLite database of its own.

One writer thread uses SQLite in WAL mode with ``synchronous=FULL``. A step stores the changed entities and the hash of
the state after it; every fiftieth step is followed by a snapshot; arrays are stored once. While the user pauses, the
log is merged into the database. A file beside the database counts the steps, so that missing ones are noticed. If
writing fails, or the file was deleted, a new journal is started after a while with the current state.
"""

import hashlib
import json
import os
import queue
import sqlite3
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from studio.core.names import counted_noun
from studio.core.stage.project import COLLECTIONS, Entity, Project
from studio.document.commands.replace import Edit
from studio.document.file_lock import FileLock
from studio.document.playhead import PlayheadState
from studio.io.project.archive import Stamp
from studio.io.project.entity_json import Members, entity_record, npy_parts, project_json, record_line

STEPS_BETWEEN_SNAPSHOTS = 50
IDLE_SECONDS, RETRY_SECONDS = 2.0, 2.0
"""Seconds without an edit after which the log is merged into the database, and after which a failed journal is started
again.
"""
_PIECE = 1 << 20
"""Bytes of an array that are stored by one statement."""
SCHEMA = """
CREATE TABLE session (key TEXT PRIMARY KEY, value TEXT);
CREATE TABLE arrays (name TEXT PRIMARY KEY, content BLOB);
CREATE TABLE snapshots (number INTEGER PRIMARY KEY, project BLOB, state TEXT);
CREATE TABLE steps (number INTEGER PRIMARY KEY, verb TEXT, text TEXT, gesture INTEGER, edits TEXT, state TEXT);
CREATE TABLE saves (number INTEGER, path TEXT, state TEXT);
"""


@dataclass(frozen=True, eq=False)
class JournalEntry:
    """Entry of the journal: ``verb`` is ``edit``, ``undo`` or ``redo``; ``project`` is the state after it."""

    verb: str
    edits: tuple[Edit, ...]
    text: str
    gesture: int | None
    project: Project


@dataclass(frozen=True, eq=False)
class _Save:
    project: Project
    path: Path
    stamp: Stamp


@dataclass(frozen=True, eq=False)
class _Numbered:
    number: int
    step: JournalEntry


_Item = _Numbered | _Save | PlayheadState | str


class StateHash:
    """SHA-256 of a project's state; encodings of unchanged entities are cached."""

    def __init__(self) -> None:
        self._digests: dict[tuple[str, str], tuple[Entity, str]] = {}

    def of(self, project: Project) -> str:
        """Hash over all entities of ``project`` in order."""
        total = hashlib.sha256()
        for collection in COLLECTIONS:
            for key, entity in getattr(project, collection).items():
                known = self._digests.get((collection, key))
                if known is None or known[0] is not entity:
                    text = record_line(entity_record(collection, key, entity, {}))
                    known = (entity, hashlib.sha256(text.encode()).hexdigest())
                    self._digests[collection, key] = known
                total.update(f"{collection}/{key}:{known[1]}\n".encode())
        return total.hexdigest()


class Journal(QObject):
    """Writer of the session journal of one document. ``acknowledged`` is the number of steps on disk."""

    acknowledged_changed = Signal()
    failed = Signal(str)

    def __init__(
        self,
        folder: Path,
        document_id: str,
        base: Project,
        path: Path | None,
        unsaved: bool = False,
        parent: QObject | None = None,
        stamp: Stamp | None = None,
    ) -> None:
        """Without a first edit nothing is written. ``stamp`` is the digest of the file at ``path`` when it was opened,
        by which recovery notices later changes of the file.
        """
        super().__init__(parent)
        self.recorded = 0
        self.acknowledged = 0
        self.unsaved = self._unsaved_base = unsaved
        self._base, self._document_id, self._path, self._stamp = base, document_id, path, stamp
        self._folder, self._files = folder, list[Path]()
        self._queue: queue.SimpleQueue[_Item | None] = queue.SimpleQueue()
        self._latest, self._before = (0, base), 0
        self._hash = StateHash()
        self._stored = set[str]()
        self._begun, self._closing = threading.Event(), threading.Event()
        self._stopped = False
        self._lock: FileLock | None = None
        self._thread: threading.Thread | None = None
        if unsaved:
            self._start()

    @property
    def state(self) -> str:
        """Text for the status bar."""
        if self._stopped:
            return "Backup stopped - save the project"
        if self.acknowledged == self.recorded:
            return f"All changes backed up - {counted_noun(self.recorded, 'edit')}"
        return f"Backing up - {self.acknowledged} of {counted_noun(self.recorded, 'edit')}"

    def record(self, step: JournalEntry) -> None:
        """Queue a step for writing, without waiting."""
        self.recorded += 1
        self.unsaved = True
        self._latest = self.recorded, step.project
        self._start()
        self._queue.put(_Numbered(self.recorded, step))

    def mark_saved(self, project: Project, path: Path, stamp: Stamp, all_of_it: bool) -> None:
        """Record that the file holds ``project``, so that only later steps need to be recovered; ``all_of_it`` if no
        edit was made since.
        """
        self.unsaved = not all_of_it
        self._path, self._stamp = path, stamp
        if self._thread is not None:
            self._queue.put(_Save(project, path, stamp))

    def record_playhead(self, playhead: PlayheadState) -> None:
        """Store the state of the playhead, if there is anything to recover."""
        if self._thread is not None:
            self._queue.put(playhead)

    def flush(self, timeout: float = 10.0) -> bool:
        """Wait until every recorded step is on disk; False if ``timeout`` seconds pass before."""
        if self._thread is None:
            return True
        end = time.monotonic() + timeout
        while not self._begun.is_set() or self.acknowledged < self.recorded:
            if time.monotonic() > end or self._stopped or not self._thread.is_alive():
                return False
            time.sleep(0.001)
        return True

    def close(self) -> None:
        """End the session. Its files are removed if nothing is unsaved; otherwise they are kept and marked as declined
        by the user.
        """
        if self._thread is None:
            return
        self._queue.put("declined" if self.unsaved else "saved")
        self._queue.put(None)
        self._closing.set()
        self._thread.join()
        self._thread = None
        if not self.unsaved:
            for file in self._files:
                remove_session(file)
        if self._lock is not None:
            self._lock.release()

    def _start(self) -> None:
        """Start the writer thread with the first edit, so that merely viewing a project writes nothing."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._write, name="journal", daemon=True)
            self._thread.start()

    def _write(self) -> None:
        """Write sessions until the journal is closed; runs in the writer thread."""
        while True:
            try:
                self._write_session()
                return
            except (sqlite3.Error, OSError) as error:
                told, self._stopped = self._stopped, True
                if not told:
                    self.failed.emit(
                        f"The backup folder '{self._folder}' cannot be written ({error}). Save the project now:"
                        " edits are not backed up until it can be."
                    )
                    self.acknowledged_changed.emit()
                if self._closing.wait(RETRY_SECONDS):
                    return

    def _write_session(self) -> None:
        """Write a new session file, from the current state on."""
        file = self._folder / f"{self._document_id}-{os.getpid()}-{time.time_ns():x}.sqlite"
        lock = FileLock.acquired(lock_of(file))
        if self._lock is not None:
            self._lock.release()
        self._lock = lock
        self._folder.chmod(0o700)
        os.close(os.open(file, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
        self._files.append(file)
        connection = sqlite3.connect(file, isolation_level=None)
        try:
            self._begin(connection)
            while (items := self._waiting()) is not None:
                if items:
                    self._commit(connection, items)
                else:
                    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
                    self._see_that_it_is_there()
        finally:
            connection.close()

    def _see_that_it_is_there(self) -> None:
        """Raise an error if the database file was deleted: SQLite would go on writing to it without one."""
        if not self._files[-1].exists():
            raise FileNotFoundError(f"'{self._files[-1].name}' was moved or deleted")

    def _waiting(self) -> list["_Item"] | None:
        """Queued items; an empty list after a pause without edits, None if the journal is closed."""
        try:
            items = [self._queue.get(timeout=IDLE_SECONDS)]
        except queue.Empty:
            return []
        while not self._queue.empty():
            items.append(self._queue.get())
        wanted = [item for item in items if item is not None]
        if None in items:
            self._queue.put(None)
        return wanted or None

    def _begin(self, connection: sqlite3.Connection) -> None:
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute("PRAGMA synchronous=FULL")
        if anew := bool(self._files[1:]):
            self._before, self._base = self._latest
        self._stored = set(self._base.carried.get("members", {}))
        connection.execute("BEGIN")
        for statement in SCHEMA.strip().split(";\n"):
            connection.execute(statement)
        foreign = self._base.carried.get("members", {})
        session = {
            "document": self._document_id,
            "path": str(self._path or ""),
            "stamp": json.dumps(self._stamp),
            "process": str(os.getpid()),
            "started": str(time.time()),
            "unsaved_base": str(int(self._unsaved_base or (anew and self.unsaved))),
            "foreign": json.dumps(sorted(foreign)),
        }
        connection.executemany("INSERT INTO arrays VALUES (?, ?)", foreign.items())
        connection.executemany("INSERT INTO session VALUES (?, ?)", session.items())
        self._snapshot(connection, 0, self._base)
        connection.execute("COMMIT")
        self._count(0)
        self._acknowledge(self._before)
        self._begun.set()

    def _commit(self, connection: sqlite3.Connection, items: list["_Item"]) -> None:
        done = self.acknowledged
        connection.execute("BEGIN")
        for item in items:
            match item:
                case _Numbered():
                    if item.number > self._before:
                        done = item.number
                        self._insert(connection, done - self._before, item.step)
                case _Save():
                    row = (done - self._before, str(item.path), self._hash.of(item.project))
                    connection.execute("INSERT INTO saves VALUES (?, ?, ?)", row)
                    _put_fact(connection, "stamp", json.dumps(item.stamp))
                case PlayheadState():
                    _put_fact(connection, "playhead", json.dumps(asdict(item)))
                case str():
                    _put_fact(connection, "ended", item)
        connection.execute("COMMIT")
        self._see_that_it_is_there()
        self._count(done - self._before)
        self._acknowledge(done)

    def _count(self, steps: int) -> None:
        """Write the number of steps to the file beside the database."""
        file = os.open(steps_of(self._files[-1]), os.O_CREAT | os.O_WRONLY, 0o600)
        try:
            os.write(file, b"%012d" % steps)
        finally:
            os.close(file)

    def _acknowledge(self, done: int) -> None:
        self.acknowledged, self._stopped = done, False
        self.acknowledged_changed.emit()

    def _insert(self, connection: sqlite3.Connection, number: int, step: JournalEntry) -> None:
        members: Members = {}
        # One by one: an import brings thousands of contacts, and JSON is made under Python's lock.
        edits = ",".join(json.dumps(edit_record(edit, members)) for edit in step.edits)
        self._store(connection, members)
        row = (number, step.verb, step.text, step.gesture, f"[{edits}]", self._hash.of(step.project))
        connection.execute("INSERT INTO steps VALUES (?, ?, ?, ?, ?, ?)", row)
        if number % STEPS_BETWEEN_SNAPSHOTS == 0:
            self._snapshot(connection, number, step.project)

    def _snapshot(self, connection: sqlite3.Connection, number: int, project: Project) -> None:
        members: Members = {}
        content = project_json(project, members)
        self._store(connection, members)
        row = (number, content, self._hash.of(project))
        connection.execute("INSERT INTO snapshots VALUES (?, ?, ?)", row)

    def _store(self, connection: sqlite3.Connection, members: Members) -> None:
        """Store arrays in pieces: a large array in one statement would hold Python's global lock and freeze the
        window.
        """
        for name in members.keys() - self._stored:
            parts = npy_parts(members[name])
            row = (name, sum(map(len, parts)))
            stored = connection.execute("INSERT OR IGNORE INTO arrays VALUES (?, zeroblob(?))", row)
            if stored.rowcount and stored.lastrowid is not None:
                with connection.blobopen("arrays", "content", stored.lastrowid) as blob:
                    for part in parts:
                        for start in range(0, len(part), _PIECE):
                            blob.write(part[start : start + _PIECE])
            self._stored.add(name)


def _put_fact(connection: sqlite3.Connection, key: str, value: str) -> None:
    connection.execute("INSERT OR REPLACE INTO session VALUES (?, ?)", (key, value))


def edit_record(edit: Edit, members: Members) -> dict[str, object]:
    """Edit as JSON, without the entity's former value, which the previous state has."""
    record = None if edit.new is None else entity_record(edit.collection, edit.entity_id, edit.new, members)
    return {"collection": edit.collection, "id": edit.entity_id, "place": edit.place, "new": record}


def lock_of(session: Path) -> Path:
    """Path of the lock that the process of a session holds."""
    return session.with_suffix(".lock")


def steps_of(session: Path) -> Path:
    """Path of the file with the number of steps of a session."""
    return session.with_suffix(".steps")


def files_of(session: Path) -> tuple[Path, ...]:
    """Paths of all files of a session."""
    return tuple(session.with_suffix(suffix) for suffix in (".sqlite", ".sqlite-wal", ".sqlite-shm", ".steps", ".lock"))


def remove_session(session: Path) -> None:
    """Remove the files of a session without unsaved edits."""
    for file in files_of(session):
        file.unlink(missing_ok=True)
