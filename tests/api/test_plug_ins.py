"""The example package of plug-ins, installed beside the studio, and packages that fail."""

import json
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.app.application import make_application, make_window
from studio.app.settings import Settings
from studio.cli.main import main
from studio.core.constraints import kinds
from studio.core.constraints.position import PositionConstraint
from studio.document.document import Document
from studio.io import plug_ins
from studio.io.project.project_file import read_project, write_project
from studio.panels.constraint_editors import editor_of_kind
from studio.panels.constraint_editors.common import ConstraintEditor
from studio.timeline.curves import plotted_quantities
from tests.api.conftest import ROOT, installed, run_beside
from tests.builders import make_project

WALK = ROOT / "examples" / "captures" / "walk_turn.bvh"


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """A folder into which pip has installed the example."""
    return installed(ROOT / "examples" / "plug_ins", tmp_path_factory.mktemp("site"))


@pytest.fixture
def registered(site: Path, register) -> None:
    """Registers what the example adds."""
    register(site)


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
        window.close_without_saving()
        window.deleteLater()
    QTest.qWait(0)


def test_a_verb_of_a_package_is_run_and_listed(site: Path, registered, capsys) -> None:
    assert "left heel: " in run_beside(site, str(ROOT / "main.py"), "contacts", str(WALK), "--at-least", "0.2")
    for words, expected in (
        (["--help"], "added by morpho-studio-example-plug-ins"),
        (["contacts", "--help"], "--at-least SECONDS"),
    ):
        with pytest.raises(SystemExit) as end:
            main(words)
        assert end.value.code == 0
        listed = capsys.readouterr().out
        assert "contacts" in listed
        assert expected in listed


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
    assert window.choice_panel.list.topLevelItemCount() == 8
    assert main(["wrong"]) == 1
    assert "The verb 'wrong'" in capsys.readouterr().err
    assert main(["formats"]) == 0


HEIGHT_SCRIPT = """
import json, sys
import numpy as np
from studio import api
from example_plug_ins.height import HeightConstraint

scene = api.new_scene()
motion = scene.add_capture(sys.argv[1])
body = scene.add_performer(scene.add_character("child"), motion)
hand = api.BodyPoint(api.BodyPart.RIGHT_FOREARM, at_end=True)
when = api.ActivationCurve(0.5, 1.0, 1.4, 1.9)
before = scene.adapt(body)[body].place_of(hand)
height = float(before[0, 2]) + 0.05
key = scene.add_constraint(HeightConstraint(motion, "Level hand", hand, api.Chain(trunk=0.5), 0, when, height=height))
adapted = scene.adapt(body)[body]
full = (adapted.times > 1.0) & (adapted.times < 1.4)
away = np.abs(adapted.place_of(hand)[full, 2] - height)
scene.save(sys.argv[2])
again = api.open_scene(sys.argv[2])
same = again.project.constraints[key] == scene.project.constraints[key]
print(json.dumps({"away": away.max(), "before": np.abs(before[full, 2] - height).max(), "same": same,
                  "told": float(np.nanmax(adapted.residuals[key][full])), "measures": adapted.report["measures"]}))
"""


def test_a_kind_of_constraint_and_a_measure_of_a_package_are_solved_saved_and_reported(
    site: Path, tmp_path: Path, request
) -> None:
    script, saved = tmp_path / "height.py", tmp_path / "height.studio"
    script.write_text(HEIGHT_SCRIPT)
    found = json.loads(run_beside(site, str(script), str(WALK), str(saved)).splitlines()[-1])
    assert found["away"] < 2e-4 < 0.01 < found["before"]
    assert found["told"] == pytest.approx(found["away"], abs=1e-6)
    assert found["same"]
    assert found["measures"]["Hand speed"]["unit"] == "m/s"
    assert 0.1 < found["measures"]["Hand speed"]["mean"] < found["measures"]["Hand speed"]["greatest"] < 20.0

    opened = read_project(saved)
    assert not opened.problems
    assert not opened.project.constraints
    assert "'Level hand'" in " ".join(opened.remarks)
    write_project(saved, opened.project, "document")
    request.getfixturevalue("registered")
    [constraint] = read_project(saved).project.constraints.values()
    assert type(constraint).__name__ == "HeightConstraint"


def test_a_kind_of_a_package_has_its_form_and_a_measure_can_be_plotted(registered) -> None:
    assert editor_of_kind("example_height").__name__ == "HeightEditor"
    assert editor_of_kind("no_such_kind") is ConstraintEditor
    assert [each.value for each in plotted_quantities()][-1] == "Hand speed"
    assert plug_ins.kind_of(kinds.CONSTRAINT_KINDS["example_height"]).value.kind == "example_height"
    with pytest.raises(ValueError, match="already"):
        kinds.add_kind(kinds.ConstraintKind(PositionConstraint, lambda: None))


def test_kinds_and_measures_that_fail_are_told_and_register_nothing(monkeypatch) -> None:
    values = {"gone": "no_such_module:X", "wrong": "studio.core.errors:StudioError"}
    monkeypatch.setattr(plug_ins, "entry_points", lambda group: [EntryPoint(*each, group) for each in values.items()])
    plug_ins.load_registered.cache_clear()
    before = dict(kinds.CONSTRAINT_KINDS)
    failures = plug_ins.load_registered()
    plug_ins.load_registered.cache_clear()
    assert before == kinds.CONSTRAINT_KINDS
    assert [each.split(" could not")[0] for each in failures] == [
        f"The {words} '{name}' of {values[name]}" for words in ("constraint", "measure") for name in values
    ]
