"""A damaged catalogue, one of a newer version and one in use cost nothing that a person made."""

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from studio.core.errors import StudioError
from studio.library import catalogue as catalogues
from studio.library.catalogue import CATALOGUE_VERSION, DATABASE_NAME, Catalogue
from studio.library.clip_labels import ClipLabel
from studio.library.confirmed_labels import CONFIRMED_LABELS, LABELS_COPY
from studio.library.indexing import correct_label, index_folders, load_library
from studio.library.library import POSES_FILE, POSES_STAMP_FILE, Library
from tests.library.damaged_catalogue import COLUMNS, VALUES, damage, make_catalogue, use

MUTANTS = 20


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ClipLabel]:
    folder = tmp_path_factory.mktemp("made").resolve()
    return folder, make_catalogue(folder)


@pytest.fixture
def label(made: tuple[Path, ClipLabel]) -> Iterator[ClipLabel]:
    """The confirmed label; the catalogue is as it was made again after the test."""
    folder, label = made
    kept = folder / "kept"
    shutil.copytree(folder / "catalogue", kept)
    yield label
    shutil.rmtree(folder / "catalogue")
    kept.rename(folder / "catalogue")


@pytest.fixture
def folder(made: tuple[Path, ClipLabel], label: ClipLabel) -> Path:
    return made[0]


def put(folder: Path, statement: str, *values: object) -> None:
    with closing(sqlite3.connect(folder / "catalogue" / DATABASE_NAME, isolation_level=None)) as database:
        database.execute(statement, values)


@pytest.mark.parametrize("seed", range(MUTANTS))
def test_no_damage_costs_a_confirmed_label_or_what_can_be_computed(folder: Path, label: ClipLabel, seed: int) -> None:
    how = damage(Random(seed), folder / "catalogue")
    try:
        use(folder, label)
    except AssertionError as error:
        raise AssertionError(f"{how}: {error}") from error


def test_every_row_may_hold_anything(folder: Path, label: ClipLabel) -> None:
    random = Random(1)
    for table, columns in COLUMNS.items():
        for column in columns:
            put(folder, f"UPDATE OR IGNORE {table} SET {column} = ?", random.choice(VALUES))
            with Catalogue(folder / "catalogue") as catalogue:
                Library.of(catalogue)
    use(folder, label)


@pytest.mark.parametrize("take", [None, "", "null", -1, 0, 1e300, 2**62])
def test_a_clip_of_no_take_is_found_again_in_its_file(folder: Path, label: ClipLabel, take: object) -> None:
    """Nobody missed it: its take seemed to have no clip."""
    put(folder, "UPDATE clips SET take = ? WHERE id = (SELECT max(id) FROM clips)", take)
    use(folder, label)
    with closing(sqlite3.connect(folder / "catalogue" / DATABASE_NAME)) as database:
        assert not database.execute("SELECT * FROM clips WHERE take IS NULL OR take = ?", (take,)).fetchall()


@pytest.mark.parametrize("path", ["x" * 5000, "nul\0l", "\U0010ffff", ""])
def test_a_path_that_can_be_none_is_that_of_no_file(folder: Path, label: ClipLabel, path: str) -> None:
    put(folder, "UPDATE files SET path = ? WHERE path = (SELECT max(path) FROM files)", path)
    use(folder, label)


@pytest.mark.parametrize("name", [b"sqlite_autoindex_files_1", b"sqlite_autoindex_takes_1", b"spine_places", b"CREATE"])
def test_a_name_in_the_file_that_is_no_text_is_damage(folder: Path, label: ClipLabel, name: bytes) -> None:
    database = folder / "catalogue" / DATABASE_NAME
    content = database.read_bytes()
    assert name in content
    database.write_bytes(content.replace(name, b"\xd0" + name[1:]))
    use(folder, label)


@pytest.mark.parametrize(
    "word", [b"REFERENCES files", b"(path) ON", b"bones TEXT UNIQUE", b"CASCADE", b"PRIMARY KEY, take"]
)
@pytest.mark.parametrize("letter", [b"K", b"\xa6"])
def test_a_table_that_is_declared_otherwise_is_damage(
    folder: Path, label: ClipLabel, word: bytes, letter: bytes
) -> None:
    """It could be read, but not written: references to other tables are looked up in each insertion."""
    put(folder, "UPDATE files SET size = size + 1")  # they are read again
    database = folder / "catalogue" / DATABASE_NAME
    content = database.read_bytes()
    assert word in content
    database.write_bytes(content.replace(word, word[:-1] + letter))
    use(folder, label)


def test_a_damaged_catalogue_that_seems_to_be_of_a_newer_version_is_made_anew(folder: Path, label: ClipLabel) -> None:
    put(folder, f"PRAGMA user_version = {CATALOGUE_VERSION + 1}")
    database = folder / "catalogue" / DATABASE_NAME
    content = database.read_bytes()
    database.write_bytes(content[:100] + bytes(100) + content[200:])
    assert "a new one is made" in use(folder, label)
    assert list((folder / "catalogue").glob("*.damaged*"))


@pytest.mark.parametrize("version", [CATALOGUE_VERSION + 1, CATALOGUE_VERSION + 98, 2**31 - 1])
def test_a_catalogue_of_a_newer_version_is_searched_and_never_changed(
    folder: Path, label: ClipLabel, version: int
) -> None:
    put(folder, f"PRAGMA user_version = {version}")
    before = {file.name: file.read_bytes() for file in (folder / "catalogue").iterdir()}
    for _ in range(2):
        with Catalogue(folder / "catalogue") as catalogue:
            assert "newer version" in catalogue.read_only
            library = load_library(catalogue)
            assert label in [clip.label for clip in library.clips]
            assert index_folders(catalogue, [folder / "takes"]).read == 0
            with pytest.raises(StudioError, match="newer version"):
                correct_label(catalogue, library.clips[0].number, label)
        assert {file.name: file.read_bytes() for file in (folder / "catalogue").iterdir()} == before


def test_a_catalogue_of_a_newer_version_with_other_tables_is_refused_and_left_alone(folder: Path) -> None:
    put(folder, "ALTER TABLE clips RENAME COLUMN label TO labels")
    put(folder, f"PRAGMA user_version = {CATALOGUE_VERSION + 1}")
    before = (folder / "catalogue" / DATABASE_NAME).read_bytes()
    with pytest.raises(StudioError, match="newer version"):
        Catalogue(folder / "catalogue")
    assert (folder / "catalogue" / DATABASE_NAME).read_bytes() == before


@pytest.mark.parametrize("hold", ["IMMEDIATE", "EXCLUSIVE"])
def test_a_catalogue_in_use_is_waited_for_and_never_renamed(
    folder: Path, label: ClipLabel, hold: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(catalogues, "LOCK_WAIT_SECONDS", 0.2)
    with closing(sqlite3.connect(folder / "catalogue" / DATABASE_NAME, isolation_level=None)) as other:
        other.execute(f"BEGIN {hold}")
        with pytest.raises(StudioError, match="in use by another process"), Catalogue(folder / "catalogue") as opened:
            correct_label(opened, Library.of(opened).clips[0].number, label)
        other.execute("COMMIT")
    assert not list((folder / "catalogue").glob("*.damaged*"))
    assert use(folder, label) == ""


def test_what_is_no_file_is_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / DATABASE_NAME).mkdir()
    with pytest.raises(StudioError, match="no ordinary file"):
        Catalogue(tmp_path)


def test_each_damaged_catalogue_is_kept_under_a_name_of_its_own(folder: Path, label: ClipLabel) -> None:
    for content in (b"first" * 999, b"second" * 999):
        (folder / "catalogue" / DATABASE_NAME).write_bytes(content)
        assert "a new one is made" in use(folder, label)
    kept = {file.read_bytes()[:5] for file in (folder / "catalogue").glob("*.damaged*")}
    assert kept == {b"first", b"secon"}


def test_a_lost_database_is_made_anew_with_the_labels(folder: Path, label: ClipLabel) -> None:
    (folder / "catalogue" / DATABASE_NAME).unlink()
    assert "lost" in use(folder, label)


def test_labels_of_a_library_without_a_file_of_labels_are_put_into_one(folder: Path, label: ClipLabel) -> None:
    for name in (CONFIRMED_LABELS, LABELS_COPY):
        (folder / "catalogue" / name).unlink()
    with Catalogue(folder / "catalogue"):
        pass
    (folder / "catalogue" / DATABASE_NAME).write_bytes(b"nonsense" * 999)
    use(folder, label)


def test_a_label_outlasts_garbage_in_the_database_and_in_one_file_of_labels(folder: Path, label: ClipLabel) -> None:
    """Twice, as the damaged file is made again from the other one."""
    for name in (CONFIRMED_LABELS, LABELS_COPY):
        for garbage in (DATABASE_NAME, name):
            (folder / "catalogue" / garbage).write_bytes(b"nonsense" * 999)
        use(folder, label)


def test_labels_of_a_library_of_a_former_version_get_a_copy(folder: Path, label: ClipLabel) -> None:
    catalogue = folder / "catalogue"
    (catalogue / LABELS_COPY).unlink()
    with Catalogue(catalogue):
        pass
    assert (catalogue / LABELS_COPY).read_bytes() == (catalogue / CONFIRMED_LABELS).read_bytes()


def test_a_label_outlasts_its_file_being_away_or_unreadable_for_a_while(folder: Path, label: ClipLabel) -> None:
    contents = {path: path.read_bytes() for path in (folder / "takes").iterdir()}
    for change in (Path.unlink, lambda path: path.write_bytes(b"HIERARCHY"), lambda path: path.write_bytes(b"")):
        for path in contents:
            change(path)
        with Catalogue(folder / "catalogue") as catalogue:
            index_folders(catalogue, [folder / "takes"])
            assert not Library.of(catalogue).clips
        for path, content in contents.items():
            path.write_bytes(content)
        use(folder, label)


def test_poses_of_other_motions_with_the_same_frames_are_computed_again(folder: Path, label: ClipLabel) -> None:
    channels = sorted((folder / "catalogue").glob("take_*.npy"))
    with Catalogue(folder / "catalogue") as catalogue:
        first = Library.of(catalogue)
        rows = first.table.rows.copy()
    (folder / "catalogue" / POSES_FILE).write_bytes((folder / "catalogue" / POSES_FILE).read_bytes()[:-9] + b"\xff" * 9)
    with Catalogue(folder / "catalogue") as catalogue:
        assert (Library.of(catalogue).table.rows == rows).all()
    one, other = (path.read_bytes() for path in channels)
    for path, content in zip(channels, (other, one), strict=True):
        path.write_bytes(content)
    with Catalogue(folder / "catalogue") as catalogue:
        assert (Library.of(catalogue).table.rows != rows).any() or len(one) != len(other)


def test_a_library_in_a_folder_that_holds_no_poses_is_searched_from_memory(folder: Path, label: ClipLabel) -> None:
    for name in (POSES_FILE, POSES_STAMP_FILE):
        (folder / "catalogue" / name).unlink()
    (folder / "catalogue" / POSES_FILE).mkdir()
    with Catalogue(folder / "catalogue") as catalogue:
        assert len(Library.of(catalogue).clips) == 2
        assert "computed at each start" in catalogue.repaired
    (folder / "catalogue" / POSES_FILE).rmdir()


def test_a_label_written_before_a_kill_is_there_after_it(folder: Path, label: ClipLabel) -> None:
    with Catalogue(folder / "catalogue") as catalogue:
        clip = next(clip for clip in catalogue.clips() if clip.label == label)
        new = replace(label, tags=("new",))

        def change_and_die() -> None:
            with catalogue.write_transaction():
                catalogue.change_clip(clip.number, new, clip.path)
                raise RuntimeError("killed before the commit")

        with pytest.raises(RuntimeError):
            change_and_die()
    use(folder, new)
