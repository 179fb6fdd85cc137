"""Catalogue of a library: files, actors, takes and clips, in an SQLite database and array files beside it.

The catalogue has a folder of its own, apart from the captures. Damaged entries are computed again from the captures.
Labels confirmed by a person are also stored in two files beside the database (``confirmed_labels``), and each of these
restores the others. A catalogue of a newer version is opened read-only, and a catalogue that another process has locked
is waited for.
"""

import json
import operator
import os
import sqlite3
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.core.plausible import FRAME_RATE_RANGE
from studio.io.npy import StoredArray, stored_array, write_stored
from studio.library.clip_labels import ClipLabel
from studio.library.confirmed_labels import LABEL_FILES, Labels, NewerLabels, read_labels, write_labels
from studio.library.hit_paths import HitPath

FloatArray = NDArray[np.float64]
T = TypeVar("T")

CATALOGUE_VERSION = 1
DATABASE_NAME = "catalogue.sqlite"
LOCK_WAIT_SECONDS = 60.0
"""Seconds to wait for another process that reads or writes."""
_TABLES = (
    "CREATE TABLE files (path TEXT PRIMARY KEY, size INTEGER, changed INTEGER, problem TEXT)",
    "CREATE TABLE actors (id INTEGER PRIMARY KEY, bones TEXT UNIQUE, name TEXT, body TEXT)",
    """CREATE TABLE takes (
    id INTEGER PRIMARY KEY, path TEXT UNIQUE REFERENCES files (path) ON DELETE CASCADE,
    actor INTEGER REFERENCES actors (id), name TEXT, frame_rate REAL, spine_places TEXT, contacts TEXT
)""",
    """CREATE TABLE clips (
    id INTEGER PRIMARY KEY, take INTEGER REFERENCES takes (id) ON DELETE CASCADE, label TEXT, confirmed INTEGER,
    path_first INTEGER, path TEXT
)""",
    f"PRAGMA user_version = {CATALOGUE_VERSION}",
)
_COLUMNS = {
    "files": "path, size, changed, problem",
    "actors": "id, bones, name, body",
    "takes": "id, path, actor, name, frame_rate, spine_places, contacts",
    "clips": "id, take, label, confirmed, path_first, path",
}
_WITHOUT_TAKE = "take IS NULL OR take NOT IN (SELECT id FROM takes)"
"""SQL condition of clips whose take is missing."""
_BAD_VALUES = (ValueError, TypeError, KeyError, ArithmeticError, AttributeError, LookupError, StudioError)
"""Exceptions raised by a row that is damaged."""
_BAD_DATABASE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_FORMAT, sqlite3.SQLITE_ERROR)
"""Primary codes of SQLite errors caused by the content of the file, not by other processes or the disk."""


@dataclass(frozen=True)
class FileState:
    """State of a file when it was indexed: ``size`` in bytes, modification time ``changed`` in nanoseconds, and
    ``problem``.

    ``problem`` is the reason why the file is not in the library, empty if it is.
    """

    size: int
    changed: int
    problem: str = ""


UNREAD_FILE_STATE = FileState(-1, -1)
"""State of a file that must be read again; no real file has this state."""


@dataclass(frozen=True, eq=False)
class LibraryTake:
    """Motion of a whole capture in the library, on the body of its actor."""

    number: int
    path: str
    actor: int
    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    checksum: int | None = None
    """Checksum of the channels of the motion; None in libraries of older versions."""


@dataclass(frozen=True, eq=False)
class CatalogueClip:
    """Clip of a take: its label, and the path of its hit point."""

    number: int
    take: int
    label: ClipLabel
    path: HitPath

    def is_within(self, take: LibraryTake) -> bool:
        """True if the frames of the clip lie within ``take``."""
        return max(self.label.last, self.path.last) < take.motion.frame_count


@dataclass(frozen=True, eq=False)
class Actor:
    """Actor of one or more takes; all captures with the same skeleton have the same actor."""

    number: int
    name: str
    body: Morphology


class Catalogue:
    """Open catalogue in ``folder``; close it, or use it in a ``with`` statement. Each thread needs its own.

    Every method raises StudioError if another process locks the file too long, or the disk fails.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.repaired = ""
        """Sentences that say what was damaged and has been made again."""
        self.read_only = ""
        """Sentence that says why nothing can be changed; empty if it can."""
        self._database: sqlite3.Connection | None = None
        try:
            with self._refusing():
                folder.mkdir(parents=True, exist_ok=True)
                self._open()
        except StudioError:
            self.close()
            raise

    def __enter__(self) -> "Catalogue":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the database."""
        if self._database is not None:
            self._database.close()

    def add_remark(self, sentence: str) -> None:
        """Add a sentence about a repair, which is shown to the user."""
        self.repaired = f"{self.repaired} {sentence}".strip()

    @property
    def remarks(self) -> str:
        """Sentences for the user about repairs of the catalogue; empty if there were none."""
        return f"{self.repaired} {self.read_only}".strip()

    @contextmanager
    def write_transaction(self) -> Iterator[None]:
        """Context of a transaction: either everything that its block writes is stored, or nothing.

        Raises StudioError if nothing can be written.
        """
        if self.read_only:
            raise StudioError(self.read_only)
        with self._refusing(), self._connection:
            self._connection.execute("BEGIN IMMEDIATE")
            yield

    @contextmanager
    def read_transaction(self) -> Iterator[None]:
        """Context of a transaction: all values that its block reads belong to one moment, whatever other processes
        write.
        """
        with self._refusing(), self._connection:
            self._connection.execute("BEGIN")
            yield

    def paths(self) -> list[str]:
        """Paths of all indexed files, with those that could not be read, sorted."""
        return sorted(path for (path,) in self._rows("SELECT path FROM files") if isinstance(path, str))

    def files(self) -> dict[str, FileState]:
        """State of each file whose entries are complete, by path; the other files of ``paths`` must be read again."""
        if self._rows(f"SELECT 1 FROM clips WHERE {_WITHOUT_TAKE} LIMIT 1"):
            return {}  # the take that lost a clip is unknown
        takes = {take.path: take for take in self.takes().values()}
        labels = self._labels()
        counts = dict(self._rows("SELECT take, count(*) FROM clips GROUP BY take"))
        clips = defaultdict(list)
        for clip in self.clips():
            clips[clip.take].append(clip)

        def is_whole(take: LibraryTake) -> bool:
            known = [clip for clip in clips[take.number] if clip.is_within(take)]
            confirmed = Counter(clip.label for clip in known if clip.label.confirmed)
            given = Counter(label for label in labels.get(take.path, ()) if label.last < take.motion.frame_count)
            channels = self._stored(take.number)
            return (
                len(known) == counts.get(take.number, 0)
                and confirmed == given
                and channels is not None
                and channels.is_whole()
            )

        rows = self._rows("SELECT path, size, changed, problem FROM files ORDER BY path")
        with_take = {path for (path,) in self._rows("SELECT path FROM takes")}
        return {
            path: FileState(*state)
            for path, *state in rows
            if (path in takes and is_whole(takes[path]) and state[2] == "") or (path not in with_take and state[2])
        }

    def forget(self, path: str) -> None:
        """Remove a file and all entries made from it, except the labels that a person confirmed."""
        for (number,) in self._rows("SELECT id FROM takes WHERE path = ?", path):
            self._channels_file(number).unlink(missing_ok=True)
        for table in ("takes", "files"):
            self._connection.execute(f"DELETE FROM {table} WHERE path = ?", (path,))
        self._connection.execute(f"DELETE FROM clips WHERE {_WITHOUT_TAKE}")

    def store_file_state(self, path: str, state: FileState) -> None:
        """Store the state of a file, and remove the entries made from its previous content."""
        self.forget(path)
        self._connection.execute("INSERT INTO files VALUES (?, ?, ?, ?)", (path, *asdict(state).values()))

    def actor(self, bones: str, name: str, body: Morphology) -> Actor:
        """Actor whose skeleton is identified by ``bones`` (any text); it is added if there is none."""
        rows = self._rows("SELECT id, name, body FROM actors WHERE bones = ?", bones)
        for found in _parsed(rows, _actor):
            return found
        for number, *_ in rows:  # its body is damaged
            self._connection.execute("UPDATE actors SET name = ?, body = ? WHERE id = ?", (name, _body(body), number))
            return Actor(number, name, body)
        added = self._connection.execute(
            "INSERT INTO actors (bones, name, body) VALUES (?, ?, ?)", (bones, name, _body(body))
        )
        return Actor(int(added.lastrowid or 0), name, body)

    def add_take(self, path: str, actor: Actor, motion: NormalizedMotion, contacts: Sequence[ContactInterval]) -> int:
        """Add the motion of a capture, and return the number of the take."""
        spans = [(each.point.value, each.first, each.last) for each in contacts]
        added = self._connection.execute(
            "INSERT INTO takes (path, actor, name, frame_rate, spine_places, contacts) VALUES (?, ?, ?, ?, ?, ?)",
            (path, actor.number, motion.name, motion.frame_rate, _text(motion.spine_places), json.dumps(spans)),
        )
        number = int(added.lastrowid or 0)
        write_stored(self._channels_file(number), motion.channels)
        return number

    def add_clip(self, take: int, label: ClipLabel, path: HitPath) -> int:
        """Add a clip and return its number."""
        values = (take, json.dumps(label.to_json()), label.confirmed, path.first, _text(path.places))
        added = self._connection.execute(
            "INSERT INTO clips (take, label, confirmed, path_first, path) VALUES (?, ?, ?, ?, ?)", values
        )
        return int(added.lastrowid or 0)

    def change_clip(self, number: int, label: ClipLabel, path: HitPath) -> None:
        """Replace the label and path of a clip; a confirmed label is also stored in the files of confirmed labels."""
        rows = self._rows("SELECT takes.path, label FROM clips, takes WHERE takes.id = take AND clips.id = ?", number)
        labels = self._labels()
        self._connection.execute(
            "UPDATE clips SET label = ?, confirmed = ?, path_first = ?, path = ? WHERE id = ?",
            (json.dumps(label.to_json()), label.confirmed, path.first, _text(path.places), number),
        )
        if label.confirmed:
            for file, old in _parsed(rows, lambda row: (row[0], _label(row[1]))):
                kept = tuple(each for each in labels.get(file, ()) if each != old)
                write_labels(self.folder, labels | {file: (*kept, label)})

    def remove_clip(self, number: int) -> None:
        """Remove one clip."""
        self._connection.execute("DELETE FROM clips WHERE id = ?", (number,))

    def confirmed_labels(self, path: str) -> list[ClipLabel]:
        """Labels that a person confirmed in the take of the file ``path``."""
        return list(self._labels().get(path, ()))

    def actors(self) -> dict[int, Actor]:
        """All actors by their number."""
        rows = self._rows("SELECT id, name, body FROM actors ORDER BY id")
        return {actor.number: actor for actor in _parsed(rows, _actor)}

    def clips(self) -> list[CatalogueClip]:
        """All clips, those of each take in succession."""
        return list(_parsed(self._rows("SELECT id, take, label, path_first, path FROM clips ORDER BY take, id"), _clip))

    def takes(self) -> dict[int, LibraryTake]:
        """All takes by number; their channels stay on disk until they are read.

        Takes whose entries or channels are lost, or which another process is removing, are left out.
        """
        actors = self.actors()
        rows = self._rows(
            "SELECT id, takes.path, actor, name, frame_rate, spine_places, contacts FROM takes, files"
            " WHERE files.path = takes.path ORDER BY id"
        )
        return {take.number: take for take in _parsed(rows, lambda row: self._take(row, actors))}

    def _take(self, row: tuple[Any, ...], actors: dict[int, Actor]) -> LibraryTake:
        """Take of a row. Raises one of ``_BAD_VALUES`` if the row or the channels are damaged."""
        number, path, actor, name, rate, places, contacts = row
        stored = self._stored(number)
        spine_places = np.array(json.loads(places), dtype=np.float64)
        if stored is None or not np.isfinite(spine_places).all():
            raise ValueError("it has no channels")
        if len(spine_places) != actors[actor].body.layout.spine_count:
            raise ValueError("it is the motion of another body")
        if not FRAME_RATE_RANGE.least <= rate <= FRAME_RATE_RANGE.most:
            raise ValueError("it has no frame rate")
        motion = NormalizedMotion(str(name), rate, stored.values, spine_places)
        spans = [ContactInterval(str(number), *span) for span in json.loads(contacts)]
        return LibraryTake(number, path, actor, motion, tuple(spans), stored.checksum)

    def _channels_file(self, take: int) -> Path:
        return self.folder / f"take_{take}.npy"

    def _stored(self, take: int) -> StoredArray | None:
        """Channels of a take on disk; None if they cannot be read."""
        with suppress(OSError, ValueError):
            found = stored_array(self._channels_file(take))
            if found.values.dtype == np.float64 and len(found.values):
                return found
        return None

    @property
    def _connection(self) -> sqlite3.Connection:
        if self._database is None:
            raise StudioError(f"The library in '{self.folder}' is closed.")
        return self._database

    def _rows(self, question: str, *values: object) -> list[tuple[Any, ...]]:
        with self._refusing():
            return self._connection.execute(question, values).fetchall()

    @contextmanager
    def _refusing(self) -> Iterator[None]:
        """Context in which any error of SQLite or of the disk is raised as a StudioError."""
        try:
            yield
        except (sqlite3.Error, UnicodeError, OSError) as error:
            raise self._refusal(error) from error

    def _refusal(self, error: Exception) -> StudioError:
        if _code(error) in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            return StudioError(
                f"The library in '{self.folder}' is in use by another process. Wait until that is done, and try again."
            )
        if self.read_only:
            return StudioError(self.read_only)
        reason = getattr(error, "strerror", None) or error
        return StudioError(f"The library's folder '{self.folder}' cannot be used: {reason}. Choose another.")

    def _open(self) -> None:
        rescued: Labels = {}
        try:
            self._database = self._opened()
        except sqlite3.DatabaseError as error:
            if _code(error) not in _BAD_DATABASE or self.read_only:
                raise
            aside = self._put_aside(self.folder / DATABASE_NAME)
            self.add_remark(
                f"The catalogue could not be read ({error}); a new one is made, the old one is {aside.name}. Add your"
                " folders again where files are missing."
            )
            self._database = self._opened()
            rescued = _rescued(aside)
        self._settle_labels(rescued)

    def _opened(self) -> sqlite3.Connection:
        """Connection to a checked database, created if there is none. Raises sqlite3.DatabaseError if it is damaged."""
        file = self.folder / DATABASE_NAME
        if file.exists() and not file.is_file():
            raise StudioError(f"'{file}' is no ordinary file. Remove it, or choose another library.")
        database = _connected(file, "mode=rwc")
        try:
            (state,) = database.execute("PRAGMA integrity_check(1)").fetchone()
            if state != "ok":
                raise _damaged(str(state).splitlines()[-1])
            (version,) = database.execute("PRAGMA user_version").fetchone()
            if version > CATALOGUE_VERSION:
                self._only_read(
                    f"its catalogue is of version {version}, and this studio's of version {CATALOGUE_VERSION}"
                )
                database.close()
                database = _connected(file, "mode=ro")
            elif version == 0 and not database.execute("SELECT 1 FROM sqlite_master").fetchone():
                _make_tables(database)
            elif version != CATALOGUE_VERSION:
                raise _damaged(f"it is of version {version}")
            elif not _is_schema_whole(database):
                raise _damaged("its tables are not those of this version")
            for table, columns in _COLUMNS.items():
                database.execute(f"SELECT {columns} FROM {table} LIMIT 0")
        except UnicodeDecodeError as error:  # a name of a table or column, or a message with it
            database.close()
            raise _damaged("a name in it is no text") from error
        except BaseException:
            database.close()
            raise
        return database

    def _only_read(self, reason: str) -> None:
        self.read_only = (
            f"The library in '{self.folder}' was written by a newer version of the studio ({reason}). It can be"
            " searched but not changed. Update the studio, or choose another library."
        )

    def _put_aside(self, file: Path) -> Path:
        """Rename a damaged file and its journal to a free name, and return the new path."""
        numbers = ("", *(f"-{number}" for number in range(2, 10_000)))
        aside = next(
            path for path in (self.folder / f"{file.name}.damaged{each}" for each in numbers) if not path.exists()
        )
        file.replace(aside)
        with suppress(FileNotFoundError):  # else it would be applied to the new file
            file.with_name(f"{file.name}-journal").replace(aside.with_name(f"{aside.name}-journal"))
        return aside

    def _settle_labels(self, rescued: Labels) -> None:
        """Restore the files of confirmed labels from each other and ``rescued``, and mark files with missing entries as
        unread.
        """
        found = [self._settled_labels(name) for name in LABEL_FILES]
        if self.read_only:
            return
        labels = next((each for each in found if each is not None), None)
        if labels is None:
            labels = {path: each for path, each in (rescued or self._labels_in_database()).items() if each}
        if labels and any(each != labels for each in found):
            write_labels(self.folder, labels)
        entered = set(self.paths())
        if labels and not entered and not self.repaired:
            self.add_remark(
                "The catalogue was lost; a new one is made. Add your folders again where files are missing."
            )
        missing = (rescued.keys() | labels.keys()) - entered
        present = [path for path in sorted(missing) if os.path.isfile(path)]
        if present:
            with self.write_transaction():
                for path in present:
                    self.store_file_state(path, UNREAD_FILE_STATE)

    def _settled_labels(self, name: str) -> Labels | None:
        """Labels in the file ``name``; a damaged file is renamed, and gives None."""
        try:
            return read_labels(self.folder / name)
        except NewerLabels as error:
            self._only_read(str(error))
        except ValueError as error:
            if not self.read_only:
                aside = self._put_aside(self.folder / name)
                self.add_remark(
                    f"The confirmed labels in {name} could not be read ({error}); those in its copy or in the catalogue"
                    f" are used, the old file is {aside.name}."
                )
        return None

    def _labels(self) -> Labels:
        """Confirmed labels, by path."""
        for name in LABEL_FILES:
            with suppress(ValueError, NewerLabels):
                if (found := read_labels(self.folder / name)) is not None:
                    return found
        return self._labels_in_database()

    def _labels_in_database(self) -> Labels:
        return _grouped(
            self._rows(
                "SELECT takes.path, label FROM clips, takes WHERE takes.id = take AND confirmed ORDER BY clips.id"
            )
        )


def _connected(file: Path, options: str) -> sqlite3.Connection:
    database = sqlite3.connect(f"{file.absolute().as_uri()}?{options}", timeout=LOCK_WAIT_SECONDS, uri=True)
    database.text_factory = lambda content: content.decode(errors="replace")
    database.execute("PRAGMA foreign_keys = ON")
    return database


def _make_tables(database: sqlite3.Connection) -> None:
    with database:
        database.execute("BEGIN IMMEDIATE")
        if not database.execute("SELECT 1 FROM sqlite_master").fetchone():  # unless another process has just made them
            for statement in _TABLES:
                database.execute(statement)


def _is_schema_whole(database: sqlite3.Connection) -> bool:
    """True if every table and index is declared as this version declares it."""
    schema = "SELECT type, name, tbl_name, sql FROM sqlite_master"
    with closing(sqlite3.connect(":memory:")) as whole:
        _make_tables(whole)
        return set(whole.execute(schema)) <= set(database.execute(schema))


def _rescued(aside: Path) -> Labels:
    """Paths that can be read in the damaged catalogue ``aside``, with the labels that were confirmed there."""
    with closing(_connected(aside, "immutable=1")) as database:
        paths = _readable(database, "SELECT path FROM files")
        labels = _readable(database, "SELECT takes.path, label FROM clips, takes WHERE takes.id = take AND confirmed")
    return {path: () for (path,) in paths if isinstance(path, str)} | _grouped(labels)


def _readable(database: sqlite3.Connection, question: str) -> list[tuple[Any, ...]]:
    """Rows that answer the SQL ``question``, up to the first row that cannot be read."""
    rows = []
    with suppress(sqlite3.Error, UnicodeDecodeError):
        for row in database.execute(question):
            rows.append(row)
    return rows


def _code(error: Exception) -> int:
    """Primary code of an SQLite error; -1 for any other error."""
    code: int = getattr(error, "sqlite_errorcode", -1)
    return code & 0xFF if code >= 0 else code


def _damaged(reason: str) -> sqlite3.DatabaseError:
    error = sqlite3.DatabaseError(reason)
    error.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
    return error


def _parsed(rows: Iterable[tuple[Any, ...]], make: Callable[[tuple[Any, ...]], T]) -> Iterator[T]:
    """Results of ``make`` for all rows; damaged rows are skipped."""
    for row in rows:
        with suppress(*_BAD_VALUES):
            yield make(row)


def _grouped(rows: Iterable[tuple[Any, ...]]) -> Labels:
    """Confirmed labels by path, from rows of path and label."""
    found: Labels = {}
    for path, label in _parsed(rows, lambda row: (str(row[0]), _label(row[1]))):
        found[path] = (*found.get(path, ()), replace(label, confirmed=True))
    return found


def _text(values: Any) -> str:
    return json.dumps(np.asarray(values).tolist())


def _body(body: Morphology) -> str:
    return json.dumps(body.to_json())


def _actor(row: tuple[Any, ...]) -> Actor:
    number, name, body = row
    return Actor(number, str(name), Morphology.from_json(json.loads(body)))


def _label(text: str) -> ClipLabel:
    return ClipLabel.from_json(json.loads(text))


def _clip(row: tuple[Any, ...]) -> CatalogueClip:
    number, take, label, first, text = row
    places = np.array(json.loads(text), dtype=np.float64).reshape(-1, 3)
    if not len(places) or not np.isfinite(places).all() or operator.index(first) < 0:
        raise ValueError("it has no path")
    return CatalogueClip(number, take, _label(label), HitPath(first, first + len(places) - 1, places))
