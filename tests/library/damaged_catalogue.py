"""A catalogue that is damaged in many ways, one way a seed; what a person made must outlast each of them."""

import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from random import Random

from studio.library.catalogue import DATABASE_NAME, Catalogue
from studio.library.clip_labels import ClipLabel, Kind
from studio.library.confirmed_labels import CONFIRMED_LABELS, LABELS_COPY
from studio.library.indexing import correct_label, index_folders, load_library
from studio.library.library import POSES_FILE, POSES_STAMP_FILE, Library

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"
CAPTURES = "straight_punch.bvh", "front_kick.bvh"
COLUMNS = {
    "files": ("path", "size", "changed", "problem"),
    "actors": ("bones", "name", "body"),
    "takes": ("path", "actor", "name", "frame_rate", "spine_places", "contacts"),
    "clips": ("take", "label", "confirmed", "path_first", "path"),
}
VALUES = (None, "", "[]", "{}", "nan", "x" * 5000, b"\xff\xfe", -1, 0, 1e300, 2**62, "[[1, 2]]", '{"first": 1}', "null")


def make_catalogue(folder: Path) -> ClipLabel:
    """Index two captures in ``takes`` of ``folder`` into ``catalogue`` beside it; returns the confirmed label."""
    (folder / "takes").mkdir(parents=True)
    for name in CAPTURES:
        shutil.copy(EXAMPLES / name, folder / "takes")
    with Catalogue(folder / "catalogue") as catalogue:
        index_folders(catalogue, [folder / "takes"])
        clip = Library.of(catalogue).clips[0]
        label = replace(clip.label, tags=("mine",), hit=clip.label.hit - 2, confirmed=True)
        correct_label(catalogue, clip.number, label)
        Library.of(catalogue)
    return label


def damage(random: Random, catalogue: Path) -> str:
    """Damage a row or one or two files of a catalogue; returns words that tell how."""
    if random.random() < 0.3:
        return _damage_row(random, catalogue)
    labels = CONFIRMED_LABELS, LABELS_COPY
    if random.random() < 0.3:
        files = catalogue / DATABASE_NAME, catalogue / random.choice(labels)
    else:
        channels = sorted(file.name for file in catalogue.glob("take_*.npy"))
        files = (
            catalogue / random.choice([DATABASE_NAME, DATABASE_NAME, *labels, POSES_FILE, POSES_STAMP_FILE, *channels]),
        )
    return ", ".join(_damage_file(random, file) for file in files)


def _damage_file(random: Random, file: Path) -> str:
    content = bytearray(file.read_bytes())
    match random.randrange(5):
        case 0:
            how, content = "cut off", content[: random.randrange(len(content))]
        case 1:
            at = random.randrange(len(content))
            how, content[at : at + 4096] = "a page of zeros", bytes(min(4096, len(content) - at))
        case 2:
            how = "other bytes"
            for _ in range(random.choice([1, 5, 50])):
                content[random.randrange(len(content))] = random.randrange(256)
        case 3:
            how, content = "garbage", bytearray(random.randbytes(random.choice([1, 100, 9000])))
        case _:
            file.unlink()
            return f"{file.name}: lost"
    file.write_bytes(content)
    return f"{file.name}: {how}"


def _damage_row(random: Random, catalogue: Path) -> str:
    table = random.choice(sorted(COLUMNS))
    column, value = random.choice(COLUMNS[table]), random.choice(VALUES)
    with closing(sqlite3.connect(catalogue / DATABASE_NAME, isolation_level=None)) as database:
        numbers = [number for (number,) in database.execute(f"SELECT rowid FROM {table}")]
        database.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = ?", (value, random.choice(numbers)))
    return f"{table}.{column} = {value!r:.40}"


def use(folder: Path, label: ClipLabel) -> str:
    """Search and index a damaged catalogue as the studio does; returns what the user is told.

    Raises AssertionError where the confirmed label is lost, or where a clip that can be computed again is missing.
    """
    with Catalogue(folder / "catalogue") as catalogue:
        told = catalogue.remarks
        load_library(catalogue)
    with Catalogue(folder / "catalogue") as catalogue:
        told = f"{told} {catalogue.remarks}".strip()
        if not catalogue.read_only:
            index_folders(catalogue, [folder / "takes"])
        library = load_library(catalogue)
        found = [clip.label for clip in library.clips]
        assert label in found, "a confirmed label is lost"
        assert len(found) == len(CAPTURES), f"{len(found)} clips"
        assert {each.kind for each in found} == {Kind.PUNCH, Kind.KICK}
        if not catalogue.read_only:
            assert set(catalogue.files()) >= {str(folder / "takes" / name) for name in CAPTURES}
    return told
