"""`make test` runs the contracts on the studio itself; here it is shown that they notice what they should."""

import re
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


def lint(checkout):
    command = [LINT_IMPORTS, "--no-logo", "--no-cache"]
    return subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=False)


def test_empty_packages_break_no_contract(checkout):
    assert lint(checkout).returncode == 0


AGAINST_THE_ORDER = {
    ("studio.core.body.pose", "studio.io"),
    ("studio.core.body.pose", "pathlib"),
    ("studio.core.body.pose", "studio.core.solver"),
    ("studio.core.body.pose", "PySide6"),
    ("studio.io.bvh.reader", "studio.document"),
    ("studio.cli.render", "pyqtgraph"),
    ("studio.viewport.stage_picture", "studio.panels"),
    ("studio.timeline.tracks", "studio.viewport"),
    ("studio.document.commands", "studio.app"),
}


def test_each_import_against_the_order_and_a_package_without_a_place_in_it_is_named(checkout):
    for importer, imported in AGAINST_THE_ORDER:
        with (checkout / f"{importer.replace('.', '/')}.py").open("a") as file:
            file.write(f"import {imported}\n")
    (checkout / "studio" / "helpers").mkdir()
    (checkout / "studio" / "helpers" / "__init__.py").touch()
    done = lint(checkout)
    assert done.returncode != 0
    assert set(re.findall(r"- +([\w.]+) -> ([\w.]+)", done.stdout)) == AGAINST_THE_ORDER
    assert "not listed as layers:\n\n- studio.helpers\n" in done.stdout
