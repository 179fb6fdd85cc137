"""Panels after another project was opened: none shows what the last one had."""

from dataclasses import replace

import pytest
from PySide6.QtWidgets import QAbstractItemView, QComboBox, QLabel, QLineEdit, QTableView, QWidget

from studio.core.stage.prop import Prop
from studio.panels.strikes import POSE_CLIPS_HINT, READY_HINT
from tests.builders import make_project
from tests.gui.test_strikes import opened
from tests.gui.window_use import PATIENCE, wait_until_idle

NAME = "Zebra"
"""A part of the names of all that the first project has."""


def shown_texts(window):
    """Texts of all widgets that show one, also in panels behind others, by the kind of widget."""
    for widget in window.findChildren(QWidget):
        if widget.isHidden():
            continue
        if isinstance(widget, (QLabel, QLineEdit)):
            yield type(widget).__name__, widget.text()
        elif isinstance(widget, QComboBox):
            yield from ((type(widget).__name__, widget.itemText(index)) for index in range(widget.count()))
        elif isinstance(widget, QAbstractItemView) and widget.model() is not None:
            model = widget.model()
            for row in range(model.rowCount()):
                for column in range(model.columnCount() if isinstance(widget, QTableView) else 1):
                    yield type(widget).__name__, f"{model.index(row, column).data() or ''}"
        yield f"tip of {type(widget).__name__}", widget.toolTip()


@pytest.fixture
def project():
    """A project in which every entity has a name of its own."""
    project = make_project(characters=2)
    for collection in ("captures", "motions", "characters", "performers", "constraints"):
        for key, each in getattr(project, collection).items():
            project = project.with_entity(collection, key, replace(each, name=f"{NAME} {key}"))
    return project.with_entity("props", "box", Prop(f"{NAME} box", (0.1, 0.1, 0.1), (0.75, -0.1, 1.3)))


@pytest.mark.parametrize("way", ["new", "scene"])
def test_no_panel_shows_what_the_last_project_had(window, qtbot, library_folder, way):
    """Strikes listed the clips of the pose that was chosen in the last project."""
    document, actions = window.bench.document, window.actions_by_id.by_id
    for dock in window.docks.values():
        dock.show()
    opened(window, qtbot, library_folder)
    for collection, key in (("props", "box"), ("performers", "performer 0"), ("constraints", "constraint 0")):
        document.selection.set((collection, key))
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    window.striking.search()
    wait_until_idle(qtbot, window)
    qtbot.waitUntil(lambda: window.problems.table.rowCount() > 0, timeout=PATIENCE)
    assert any(NAME in text for _, text in shown_texts(window))
    document.undo_stack.setClean()
    if way == "new":
        actions["new"].trigger()
    else:
        document.new(type(document.project)())
    wait_until_idle(qtbot, window)
    qtbot.waitUntil(lambda: window.problems.table.rowCount() == 0, timeout=PATIENCE)
    assert {kind: text for kind, text in shown_texts(window) if NAME in text} == {}


def test_strikes_of_a_pose_are_not_listed_once_another_project_is_open(window, qtbot, library_folder):
    made = opened(window, qtbot, library_folder)
    window.bench.document.remove("props", "box", "Remove")
    made.list_clips(made.library.clips[:2])
    assert made.panel.results.count() == 2
    assert made.panel.hint.text() == POSE_CLIPS_HINT
    window.bench.document.new(type(window.bench.document.project)())
    wait_until_idle(qtbot, window)
    assert made.panel.hint.text() != POSE_CLIPS_HINT
    assert made.panel.results.count() == len(made.library.clips)
    assert not made.panel.use.isEnabled()


def test_strikes_for_a_performer_that_is_gone_are_found_again(window, qtbot, library_folder):
    document = window.bench.document
    added = document.add("performers", replace(document.project.performers["performer 1"], position=(3.0, 0.0)), "Add")
    document.selection.set(("performers", added))
    made = opened(window, qtbot, library_folder)
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    made.search()
    wait_until_idle(qtbot, window)
    assert made.panel.hint.text() == READY_HINT
    document.undo_stack.undo()
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    wait_until_idle(qtbot, window)
    assert made._searched_for in ("", *document.project.performers)


def test_strikes_behind_another_panel_are_found_again_when_it_is_shown(window, qtbot, library_folder):
    made = opened(window, qtbot, library_folder)
    window.bench.document.remove("props", "box", "Remove")
    made.list_clips(made.library.clips[:2])
    window.docks["Strikes"].hide()
    window.bench.document.new(type(window.bench.document.project)())
    wait_until_idle(qtbot, window)
    window.docks["Strikes"].show()
    wait_until_idle(qtbot, window)
    assert made.panel.results.count() == len(made.library.clips)
