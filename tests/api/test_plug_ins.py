"""The example package of plug-ins, installed beside the studio, and packages that fail."""

import os
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.app.application import make_application, make_window
from studio.app.settings import Settings
from studio.document.document import Document
from studio.io import plug_ins
from tests.builders import make_project

ROOT = Path(__file__).parents[2]
WALK = ROOT / "examples" / "captures" / "walk_turn.bvh"


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """A folder into which pip has installed the example."""
    target = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*command, "--target", str(target), str(ROOT / "examples" / "plug_ins")], check=True)
    return target


@pytest.fixture
def open_window(qtbot, tmp_path):
    """Opens a window with two performers."""
    windows = []

    def opened():
        make_application()
        window = make_window(Settings(tmp_path / "studio.ini"), Document(make_project(characters=2)))
        windows.append(window)
        with qtbot.waitExposed(window):
            window.show()
        return window

    yield opened
    for window in windows:
        window.leave()
        window.deleteLater()
    QTest.qWait(0)


def _run(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(site), str(ROOT)))}
    command = [sys.executable, str(ROOT / "main.py"), *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def test_a_verb_of_a_package_is_run_and_listed(site: Path) -> None:
    done = _run(site, "contacts", str(WALK), "--at-least", "0.2")
    assert done.returncode == 0, done.stderr
    assert "left heel: " in done.stdout
    assert "contacts" in (listed := _run(site, "--help").stdout)
    assert "added by morpho-studio-example-plug-ins" in listed
    assert "--at-least SECONDS" in _run(site, "contacts", "--help").stdout


def test_a_panel_of_a_package_edits_the_open_project_by_undo_steps(site: Path, open_window, monkeypatch) -> None:
    monkeypatch.syspath_prepend(str(site))
    window = open_window()
    document = window.bench.document
    before = document.project
    _action(window, "Spacing panel").trigger()
    dock = window.docks["plug-in spacing"]
    assert dock.windowTitle() == "Spacing"
    dock.findChild(QPushButton).click()
    assert [each.position for each in document.project.performers.values()] == [(0.0, 0.0), (0.0, 1.5)]
    assert document.undo_stack.text(document.undo_stack.index() - 1) == "Space out performers"
    document.undo_stack.undo()
    assert document.project == before


def _action(window, text: str):
    return next(action for action in window.actions_by_id.menus["View"].actions() if action.text() == text)


def test_plug_ins_that_fail_are_told_and_the_studio_starts(open_window, monkeypatch, capsys) -> None:
    from studio.cli.main import main

    values = {"gone": "no_such_module:X", "wrong": "studio.core.errors:StudioError"}
    monkeypatch.setattr(
        plug_ins,
        "entry_points",
        lambda group: [] if group == plug_ins.FORMATS_GROUP else [EntryPoint(*each, group) for each in values.items()],
    )
    window = open_window()
    _action(window, "Gone panel").trigger()
    assert "The panel 'gone' of no_such_module:X could not be added: No module named" in window.strip.text
    window.actions_by_id.by_id["plug_ins"].trigger()
    assert window.choice_panel.list.topLevelItemCount() == 4
    assert main(["wrong"]) == 1
    assert "The verb 'wrong'" in capsys.readouterr().err
    assert main(["formats"]) == 0
