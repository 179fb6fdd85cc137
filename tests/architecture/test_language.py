"""One language: a name stands for one thing in the whole project, and docstrings say what is returned or done."""

import ast
import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT, place_of, tree_of

ONE_FILE_A_KIND = (
    "app/verbs", "cli", "core/constraints", "core/kernels/tasks", "core/solver/task_assembly/kinds", "library/scenes",
    "panels/constraint_editors", "timeline/gestures", "timeline/tracks",
)  # fmt: skip
"""Folders whose files are named after a kind of thing that stands elsewhere as well, beside the folders of formats."""
SAME_CONSTANT = dict.fromkeys(
    ("CLAVICLE", "FOOT", "HAND", "HEAD", "HIPS", "NECK", "PELVIS", "SPINE", "TOE", "YAW"),
    "columns, which stand behind the name of their table: ``channel.HEAD``, ``measure.HEAD``",
) | {"T": "type variable"}
"""Constants that mean the same in every file that has them, with the reason."""
SAME_FUNCTION = {
    "angular_acceleration": "a kernel, and its call over all frames",
    "centre_of_mass": "a kernel, and its call over all frames",
    "compiled": "two decorators of which one is used, by how kernels are linked",
    "joint_world": "a kernel, and its call over all frames",
}
"""Functions of the core that mean the same wherever they stand, with the reason."""
RIDDLES = (
    "what", "who", "whom", "whose", "whether", "how", "why", "that which", "by how much", "by what", "as of", "of a",
    "which", "where", "when", "whoever", "whatever", "as which", "as who", "of all", "of the", "of its", "of each",
    "of what", "in which", "by which", "to which", "those who",
)  # fmt: skip
"""Beginnings of docstrings that name neither the returned thing nor an action."""


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


def functions_of_core(file: Path) -> set[str]:
    """Public functions of a module of the core, but for kinds of constraint, which all answer the same questions."""
    place = file.relative_to(ROOT / "studio").as_posix()
    if not place.startswith("core/") or place.startswith("core/solver/task_assembly/kinds/"):
        return set()
    names = {node.name for node in tree_of(file).body if isinstance(node, ast.FunctionDef)}
    return {name for name in names if not name.startswith("_")}


def twice(names_of: Callable[[Path], Iterator[str] | set[str]]) -> dict[str, list[str]]:
    """Names that several files of studio define, with these files."""
    found = defaultdict(list)
    for file in every_file():
        for name in set(names_of(file)):
            found[name].append(place_of(file))
    return {name: places for name, places in found.items() if len(places) > 1}


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


def test_no_public_class_shares_its_name() -> None:
    assert twice(classes_of) == {}


def test_no_module_constant_shares_its_name_with_another() -> None:
    assert {name: files for name, files in twice(constants_of).items() if name not in SAME_CONSTANT} == {}


def file_name(file: Path) -> set[str]:
    """Name of the file, unless it is that of a kind or format."""
    folder = file.parent.relative_to(ROOT / "studio").as_posix()
    of_a_kind = folder in ONE_FILE_A_KIND or folder.startswith("io/") or file.name == "__init__.py"
    return set() if of_a_kind else {file.name}


def test_no_function_of_the_core_shares_its_name_with_another_meaning() -> None:
    assert twice(functions_of_core).keys() == SAME_FUNCTION.keys()


def test_no_file_shares_its_name_but_for_kinds_and_formats() -> None:
    assert twice(file_name) == {}


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
