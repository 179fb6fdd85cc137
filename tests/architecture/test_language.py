"""One language: a name stands for one thing in the whole project, and docstrings say what is returned or done."""

import ast
import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT, place_of, tree_of

DONE = ("core/kernels", "core/solver")
"""Rooms of studio/ that speak it. A room that is put here stays here."""
TO_COME = (
    "api", "app", "cli", "core", "core/body", "core/captures", "core/constraints", "core/grounds", "core/mannequin",
    "core/markers", "core/mesh", "core/normalized", "core/quality", "core/stage", "document", "engine", "io", "jobs",
    "library", "live", "panels", "startup", "timeline", "viewport", "resources_folder",
)  # fmt: skip
"""Rooms whose names are still to be put into it; a new room begins in it."""
KINDS_OF_CONSTRAINT = {
    "area.py",
    "balance.py",
    "distance.py",
    "look_at.py",
    "orientation.py",
    "position.py",
    "upright.py",
}
SAME_FILE_NAME = KINDS_OF_CONSTRAINT | {"__init__.py"} | {
    "adapt.py": "the call of the engine and the verb of the shell",
    "following.py": "still to come outside of the engine",
    "props.py": "still to come outside of the engine",
    "stage.py": "still to come outside of the engine",
    "warm_up.py": "each package warms up its own kernels",
}.keys()  # fmt: skip
SAME_CONSTANT = dict.fromkeys(
    ("FOOT", "HAND", "HEAD", "HIPS", "NECK", "PELVIS", "SPINE", "TOE", "YAW"),
    "columns of a frame of channels, which stand behind the name of their table: ``at.HIPS``",
) | {"T": "type variable"}
"""Constants that mean the same in every file that has them, with the reason."""
RIDDLES = (
    "what", "who", "whom", "whose", "whether", "how", "why", "that which", "by how much", "by what", "as of", "of a",
    "which",
)  # fmt: skip
"""Beginnings of docstrings that name neither the returned thing nor an action."""


def files_of(rooms: tuple[str, ...]) -> list[Path]:
    return sorted(file for room in rooms for file in (ROOT / "studio" / room).rglob("*.py"))


def every_file(folders: tuple[str, ...] = ("studio",)) -> list[Path]:
    return sorted(file for folder in folders for file in (ROOT / folder).rglob("*.py"))


def classes_of(file: Path) -> Iterator[str]:
    for node in tree_of(file).body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield node.name


def constants_of(file: Path) -> set[str]:
    """Public module constants; one that is imported from elsewhere is not defined here."""
    found = set()
    for node in tree_of(file).body:
        for target in node.targets if isinstance(node, ast.Assign) else ():
            found |= {each.id for each in ast.walk(target) if isinstance(each, ast.Name) and each.id.isupper()}
    return {name for name in found if not name.startswith("_")}


def twice(names_of: Callable[[Path], Iterator[str] | set[str]], rooms: tuple[str, ...] = DONE) -> dict[str, list[str]]:
    """Names in ``rooms`` that several files of studio define, with these files."""
    found = defaultdict(list)
    for file in every_file():
        for name in set(names_of(file)):
            found[name].append(file)
    ours = set(files_of(rooms))
    return {
        name: [place_of(each) for each in files] for name, files in found.items() if len(files) > 1 and ours & {*files}
    }


def docstrings_of(file: Path) -> Iterator[tuple[int, str]]:
    """Line and text of the docstrings of a module, its classes, functions and constants."""
    tree = tree_of(file)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for each in body if isinstance(body, list) else ():
            if (
                isinstance(each, ast.Expr)
                and isinstance(each.value, ast.Constant)
                and isinstance(each.value.value, str)
            ):
                yield each.lineno, each.value.value.strip()


def is_riddle(text: str) -> bool:
    return any(re.match(rf"{words}\b", text, re.IGNORECASE) for words in RIDDLES)


def test_every_room_speaks_the_language_or_is_named_as_still_to_come() -> None:
    studio = ROOT / "studio"
    rooms = {each.parent.relative_to(studio).as_posix() for each in studio.rglob("__init__.py")}
    top = {room for room in rooms if room.count("/") <= room.startswith("core")} - {"."}
    listed = {*DONE, *TO_COME}
    assert top - listed == set()
    assert not {*DONE} & {*TO_COME}


def test_no_public_class_shares_its_name() -> None:
    assert twice(classes_of, ("",)) == {}


def test_no_module_constant_shares_its_name_with_another() -> None:
    assert {name: files for name, files in twice(constants_of, ("",)).items() if name not in SAME_CONSTANT} == {}


def test_no_file_of_these_rooms_shares_its_name() -> None:
    found = twice(lambda file: {file.name})
    assert {name: files for name, files in found.items() if name not in SAME_FILE_NAME} == {}


def test_docstrings_begin_with_what_is_returned_or_done() -> None:
    riddles = [
        f"{place_of(file, line)} {text[:50]}"
        for file in every_file(("studio", "tests", "benchmarks", "examples"))
        for line, text in docstrings_of(file)
        if is_riddle(text)
    ]
    assert riddles == []


@pytest.mark.parametrize(
    "text", ["What it is.", "Whether it is.", "By how much it is off.", "How far it goes.", "Of a pose."]
)
def test_a_riddle_is_found(text: str) -> None:
    assert is_riddle(text)


@pytest.mark.parametrize("text", ["Residual (C,) in metres.", "True if it acts.", "Write the poses.", "Whole frames."])
def test_a_plain_docstring_is_none(text: str) -> None:
    assert not is_riddle(text)
