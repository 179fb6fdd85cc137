"""Packages of plug-ins, installed beside the studio and registered for a test."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from studio.core.constraints import kinds
from studio.core.quality import motion_measures
from studio.io import plug_ins

ROOT = Path(__file__).parents[2]


def installed(package: Path, target: Path) -> Path:
    """Folder ``target``, into which pip has installed a package."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*command, "--target", str(target), str(package)], check=True)
    return target


def run_beside(site: Path, *command: str) -> str:
    """Output of a program with an installed package beside it; its exit code has to be 0."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(site), str(ROOT)))}
    done = subprocess.run([sys.executable, *command], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def register(monkeypatch) -> Iterator[Callable[[Path], None]]:
    """Registers what the packages of a folder add, until the test ends."""
    known = (kinds.CONSTRAINT_KINDS, motion_measures.ADDED_MEASURES)
    before = [dict(each) for each in known]

    def forget() -> None:
        for looked_up in (plug_ins.entry_points, plug_ins.load_registered):
            looked_up.cache_clear()

    def registered(site: Path) -> None:
        monkeypatch.syspath_prepend(str(site))
        forget()
        assert plug_ins.load_registered() == ()

    yield registered
    forget()
    for each, was in zip(known, before, strict=True):
        each.clear()
        each.update(was)
