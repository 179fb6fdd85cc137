"""`make test` runs the contracts on the studio itself; here it is shown that they notice what they should."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT

LINT_IMPORTS = Path(sys.executable).with_name("lint-imports")


@pytest.fixture
def checkout(tmp_path):
    """The studio's packages without their content, under its own contracts."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    packages = [file.parent for file in (ROOT / "studio").rglob("__init__.py")]
    for package in packages:
        copy = tmp_path / package.relative_to(ROOT)
        copy.mkdir(parents=True, exist_ok=True)
        (copy / "__init__.py").touch()
    (tmp_path / "studio" / "resources_folder.py").touch()
    return tmp_path


def contracts_hold(checkout):
    command = [LINT_IMPORTS, "--no-logo", "--no-cache"]
    return subprocess.run(command, cwd=checkout, capture_output=True, check=False).returncode == 0


def test_empty_packages_break_no_contract(checkout):
    assert contracts_hold(checkout)


@pytest.mark.parametrize(
    ("importer", "statement"),
    [
        ("core/body/pose.py", "import studio.io"),
        ("core/body/pose.py", "import pathlib"),
        ("core/body/pose.py", "import studio.core.solver"),
        ("core/body/pose.py", "from PySide6.QtCore import QObject"),
        ("io/bvh/reader.py", "import studio.document"),
        ("cli/render.py", "import pyqtgraph"),
        ("viewport/stage_picture.py", "import studio.panels"),
        ("timeline/tracks.py", "import studio.viewport"),
        ("document/commands.py", "import studio.app"),
    ],
)
def test_an_import_against_the_order_is_noticed(checkout, importer, statement):
    (checkout / "studio" / importer).write_text(statement + "\n")
    assert not contracts_hold(checkout)


def test_a_package_without_a_place_in_the_order_is_noticed(checkout):
    (checkout / "studio" / "helpers").mkdir()
    (checkout / "studio" / "helpers" / "__init__.py").touch()
    assert not contracts_hold(checkout)
