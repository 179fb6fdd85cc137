"""Captures of people, which others own and this project does not ship: where they are, and which tests need them."""

import os
from pathlib import Path
from typing import Any

import pytest

VARIABLE = "MORPHO_CAPTURES"
CAPTURES = Path(os.environ.get(VARIABLE) or Path(__file__).resolve().parents[2] / "shared" / "captures")
"""Folder with ``bvh``, ``c3d`` and ``characters``; a folder ``more_captures`` may be beside it."""


def missing(path: Path = CAPTURES) -> str:
    """Reason for skipping a test whose capture ``path`` is not there."""
    return (
        f"{path} is not there: download captures of people (CMU, ACCAD, Bandai-Namco, c3d.org), lay them out as "
        f"CONTRIBUTING.md says, and name their folder in {VARIABLE}."
    )


def capture_file(name: str) -> Path:
    """Path of one file below or beside the captures' folder; the test is skipped where it is not there."""
    path = CAPTURES.parent / name if name.startswith("more_captures/") else CAPTURES / name
    if not path.is_file():
        pytest.skip(missing(path))
    return path


def outside(*cases: Any) -> list[Any]:
    """Parameters of tests that need captures of people: one value a case, or a tuple of values."""
    return [pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.captures) for case in cases]


def outside_files(pattern: str) -> list[Any]:
    """Files below the captures' folder as parameters; one that is not there, to be skipped, where it is empty."""
    paths = sorted(CAPTURES.glob(pattern)) or [CAPTURES / pattern]
    return [pytest.param(path, id=path.name, marks=pytest.mark.captures) for path in paths]
