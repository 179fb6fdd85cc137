"""The catalogue of a library: what is known of files, actors, takes and clips, in SQLite and arrays beside it.

It lies in a folder of its own, never among the captures, and holds nothing but what indexing finds again and the labels
that somebody corrected. One that cannot be read is put aside and made anew.
"""

import json
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.normalized.motion import NormalizedMotion
from studio.library.clips import ClipLabel, HitSegment, Kind, Limb
from studio.library.hitting import HitPath

FloatArray = NDArray[np.float64]

VERSION = 1
DATABASE = "catalogue.sqlite"
PATIENCE = 60.0
"""Seconds for which one who writes waits for others who read or write."""
_TABLES = """
CREATE TABLE files (path TEXT PRIMARY KEY, size INTEGER, changed INTEGER, problem TEXT);
CREATE TABLE actors (id INTEGER PRIMARY KEY, bones TEXT UNIQUE, name TEXT, body TEXT);
CREATE TABLE takes (
    id INTEGER PRIMARY KEY, path TEXT UNIQUE REFERENCES files (path) ON DELETE CASCADE,
    actor INTEGER REFERENCES actors (id), name TEXT, frame_rate REAL, spine_places TEXT, contacts TEXT
);
CREATE TABLE clips (
    id INTEGER PRIMARY KEY, take INTEGER REFERENCES takes (id) ON DELETE CASCADE, label TEXT, confirmed INTEGER,
    path_first INTEGER, path TEXT
);
"""


@dataclass(frozen=True)
class FileState:
    """What a file was when it was looked at; ``problem`` is why it is not in the library, empty if it is."""

    size: int
    changed: int
    problem: str = ""


@dataclass(frozen=True, eq=False)
class Take:
    """A motion of the library on the body of its actor."""

    number: int
    path: str
    actor: int
    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]


@dataclass(frozen=True, eq=False)
class CatalogueClip:
    """A clip of a take."""

    number: int
    take: int
    label: ClipLabel
    path: HitPath


@dataclass(frozen=True, eq=False)
class Actor:
    """Who performed takes: everybody whose skeleton is the same."""

    number: int
    name: str
    body: Morphology


class Catalogue:
    """What was indexed, in ``folder``; close it, or use it in a ``with``. One for each thread."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.repaired = ""
        """What was the matter with a catalogue that had to be made anew."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
            try:
                self._open()
            except sqlite3.DatabaseError as error:
                self._put_aside(str(error))
                self._open()
        except (OSError, sqlite3.Error) as error:
            reason = getattr(error, "strerror", None) or error
            raise StudioError(f"The library's folder '{folder}' cannot be used: {reason}. Choose another.") from error

    def __enter__(self) -> "Catalogue":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._database.close()

    @contextmanager
    def changing(self) -> Iterator[None]:
        """All that is written in the block, or nothing of it."""
        with self._database:
            yield

    @contextmanager
    def unchanging(self) -> Iterator[None]:
        """All that is read in the block is of one moment, whoever writes meanwhile."""
        with self._database:
            self._database.execute("BEGIN")
            yield

    def files(self) -> dict[str, FileState]:
        """Every file that was looked at, by its path; not those whose channels are lost: they are to be read again."""
        rows = self._database.execute(
            "SELECT files.path, takes.id, size, changed, problem FROM files LEFT JOIN takes ON takes.path = files.path"
            " ORDER BY files.path"
        )
        return {
            path: FileState(*rest) for path, take, *rest in rows if take is None or self._channels(take) is not None
        }

    def forget(self, path: str) -> None:
        """Leave out a file with all that came from it."""
        for (number,) in self._database.execute("SELECT id FROM takes WHERE path = ?", (path,)).fetchall():
            self._channels_file(number).unlink(missing_ok=True)
        self._database.execute("DELETE FROM files WHERE path = ?", (path,))

    def note(self, path: str, state: FileState) -> None:
        """A file was looked at; what came from it before is forgotten."""
        self.forget(path)
        self._database.execute("INSERT INTO files VALUES (?, ?, ?, ?)", (path, *asdict(state).values()))

    def actor(self, bones: str, name: str, body: Morphology) -> Actor:
        """The actor with these ``bones`` (any text that tells skeletons apart), added when there is none."""
        found = self._database.execute("SELECT id, name, body FROM actors WHERE bones = ?", (bones,)).fetchone()
        if found is not None:
            return Actor(found[0], found[1], Morphology.from_json(json.loads(found[2])))
        added = self._database.execute(
            "INSERT INTO actors (bones, name, body) VALUES (?, ?, ?)", (bones, name, json.dumps(body.to_json()))
        )
        return Actor(int(added.lastrowid or 0), name, body)

    def add_take(self, path: str, actor: Actor, motion: NormalizedMotion, contacts: Sequence[ContactInterval]) -> int:
        """Add a motion and return its number."""
        spans = [(each.point.value, each.first, each.last) for each in contacts]
        added = self._database.execute(
            "INSERT INTO takes (path, actor, name, frame_rate, spine_places, contacts) VALUES (?, ?, ?, ?, ?, ?)",
            (path, actor.number, motion.name, motion.frame_rate, _text(motion.spine_places), json.dumps(spans)),
        )
        number = int(added.lastrowid or 0)
        np.save(self._channels_file(number), motion.channels)
        return number

    def add_clip(self, take: int, label: ClipLabel, path: HitPath) -> int:
        """Add a clip and return its number."""
        values = (take, json.dumps(asdict(label)), label.confirmed, path.first, _text(path.places))
        added = self._database.execute(
            "INSERT INTO clips (take, label, confirmed, path_first, path) VALUES (?, ?, ?, ?, ?)", values
        )
        return int(added.lastrowid or 0)

    def change_clip(self, number: int, label: ClipLabel, path: HitPath) -> None:
        """Put another label in the place of a clip's own."""
        self._database.execute(
            "UPDATE clips SET label = ?, confirmed = ?, path_first = ?, path = ? WHERE id = ?",
            (json.dumps(asdict(label)), label.confirmed, path.first, _text(path.places), number),
        )

    def remove_clip(self, number: int) -> None:
        """Leave out one clip."""
        self._database.execute("DELETE FROM clips WHERE id = ?", (number,))

    def confirmed(self, path: str) -> list[ClipLabel]:
        """The labels of a file's take that somebody gave."""
        rows = self._database.execute(
            "SELECT label FROM clips, takes WHERE takes.id = take AND takes.path = ? AND confirmed ORDER BY clips.id",
            (path,),
        )
        return [_label(text) for (text,) in rows]

    def actors(self) -> dict[int, Actor]:
        """All actors by their number."""
        rows = self._database.execute("SELECT id, name, body FROM actors ORDER BY id")
        return {number: Actor(number, name, Morphology.from_json(json.loads(body))) for number, name, body in rows}

    def clips(self) -> list[CatalogueClip]:
        """All clips, those of one take together."""
        rows = self._database.execute("SELECT id, take, label, path_first, path FROM clips ORDER BY take, id")
        return [CatalogueClip(number, take, _label(text), _path(*rest)) for number, take, text, *rest in rows]

    def takes(self) -> dict[int, Take]:
        """All takes by their number; their channels stay on disk until they are asked for.

        Those whose channels are lost, or are being forgotten by somebody else, are left out.
        """
        rows = self._database.execute(
            "SELECT id, path, actor, name, frame_rate, spine_places, contacts FROM takes ORDER BY id"
        )
        found = {}
        for number, path, actor, name, rate, places, contacts in rows.fetchall():
            if (channels := self._channels(number)) is None:
                continue
            motion = NormalizedMotion(name, rate, channels, np.array(json.loads(places)))
            spans = [ContactInterval(str(number), *span) for span in json.loads(contacts)]
            found[number] = Take(number, path, actor, motion, tuple(spans))
        return found

    def _channels_file(self, take: int) -> Path:
        return self.folder / f"take_{take}.npy"

    def _channels(self, take: int) -> FloatArray | None:
        """Those of a take, where they are on the disk; None where they are not, or not whole."""
        try:
            return np.asarray(np.load(self._channels_file(take), mmap_mode="r"))
        except (OSError, ValueError, EOFError):
            return None

    def _open(self) -> None:
        self._database = sqlite3.connect(self.folder / DATABASE, timeout=PATIENCE)
        self._database.execute("PRAGMA foreign_keys = ON")
        (version,) = self._database.execute("PRAGMA user_version").fetchone()
        if version == 0:
            with self._database:
                self._database.executescript(_TABLES)
                self._database.execute(f"PRAGMA user_version = {VERSION}")
        elif version != VERSION:
            raise sqlite3.DatabaseError(f"it is of version {version}, and this studio's of version {VERSION}")
        self._database.execute("SELECT count(*) FROM clips").fetchone()

    def _put_aside(self, reason: str) -> None:
        self._database.close()
        damaged = self.folder / f"{DATABASE}.damaged"
        (self.folder / DATABASE).replace(damaged)
        self.repaired = f"The catalogue could not be read ({reason}); a new one is made, the old one is {damaged.name}."


def _text(values: Any) -> str:
    return json.dumps(np.asarray(values).tolist())


def _label(text: str) -> ClipLabel:
    record = json.loads(text)
    kinds = Limb(record["limb"]), Kind(record["kind"]), HitSegment(record["segment"])
    frames = record["first"], record["last"], record["hit"]
    return ClipLabel(*frames, *kinds, tuple(record["tags"]), record["confirmed"])


def _path(first: int, text: str) -> HitPath:
    places = np.array(json.loads(text), dtype=np.float64).reshape(-1, 3)
    return HitPath(first, first + len(places) - 1, places)
