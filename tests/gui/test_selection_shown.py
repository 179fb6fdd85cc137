"""The form, the rows and the view show the selection."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QCursor
from PySide6.QtTest import QTest

from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.panels.inspector import Inspector
from studio.panels.library_panel import LibraryPanel
from studio.panels.performer_editor import PerformerEditor
from tests.builders import make_capture, make_constraint, make_project
from tests.gui.hand import LEFT, NONE, RATE, curve

FIRST, SECOND = "performer 0", "performer 1"


@pytest.fixture
def document(qapp):
    """Two performers who play two motions, each with a constraint."""
    project = make_project(characters=2, constraints=0, contacts=0, frames=101)
    project = project.with_entity("captures", "other", make_capture("other", 101))
    project = project.with_entity("motions", "other", Motion("Other", "other"))
    rows = {FIRST: Clip("motion", 0, 100, 0.0, "walk"), SECOND: Clip("other", 0, 90, 50 / RATE, "kick")}
    for key, clip in rows.items():
        project = project.with_entity("performers", key, replace(project.performers[key], clips=(clip,)))
    for key, motion_id in (("wrist", "motion"), ("ankle", "other")):
        constraint = make_constraint(motion_id, key, activation=curve(20, 30, 50, 60))
        project = project.with_entity("constraints", key, constraint)
    document = Document(project)
    yield document
    document.close()


@pytest.fixture
def library(qtbot, document):
    library = LibraryPanel(document)
    qtbot.addWidget(library)
    library.resize(320, 700)
    library.show()
    return library


def click(library, item):
    QTest.mouseClick(library.view.viewport(), LEFT, NONE, library.row_rect(item).center() - QPoint(60, 0))


def test_a_constraint_that_is_selected_makes_a_body_active_that_plays_it(document, timeline):
    assert document.active_performer_id == FIRST
    document.selection.set(("constraints", "ankle"))
    assert document.active_performer_id == SECOND
    assert not timeline.row_rect("constraints", "ankle").isEmpty()


def test_esc_keeps_the_body_that_was_active_and_its_rows(document, timeline):
    document.selection.set(("performers", SECOND))
    document.selection.clear()
    assert document.active_performer_id == SECOND
    assert not timeline.row_rect("constraints", "ankle").isEmpty()
    document.selection.set(("constraints", "wrist"))
    document.selection.clear()
    assert document.active_performer_id == FIRST


def test_another_project_begins_with_its_first_body(document):
    document.selection.set(("performers", SECOND))
    document.new(document.project)
    assert document.active_performer_id == FIRST


def test_rows_of_hidden_bodies_go_and_come_again(document, timeline):
    third = replace(document.project.performers[FIRST], name="Third")
    document.add("performers", third, "Third")
    assert not timeline.row_rect("clip", SECOND).isEmpty()
    document.replace("performers", SECOND, replace(document.project.performers[SECOND], visible=False), "Hide")
    timeline.tracks.apart = True
    timeline.tracks.lay_out()
    assert timeline.row_rect("clip", SECOND).isEmpty()
    document.undo_stack.undo()
    assert not timeline.row_rect("clip", SECOND).isEmpty()


def test_a_click_on_a_character_that_is_lit_brings_its_form_back(qtbot, document, live, library):
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    document.selection.set(("performers", FIRST), ("clips", "walk"))
    click(library, ("performers", FIRST))
    assert document.selection.items == (("performers", FIRST),)
    assert isinstance(inspector.editor, PerformerEditor)


def test_ctrl_still_adds_to_what_is_selected_in_the_library(document, library):
    click(library, ("performers", FIRST))
    place = library.row_rect(("performers", SECOND)).center() - QPoint(60, 0)
    QTest.mouseClick(library.view.viewport(), LEFT, Qt.KeyboardModifier.ControlModifier, place)
    assert {*document.selection.items} == {("performers", FIRST), ("performers", SECOND)}


def test_a_row_that_is_clicked_stays_under_the_mouse_though_others_come_and_go(document, library):
    """The list went back to its top, so that a second click, or a Ctrl click beside it, met another row."""
    for index in range(30):
        document.add("props", Prop(f"Box {index}"), "Add box")
    for index in range(9):
        document.add("constraints", make_constraint("motion", f"Wrist {index}", priority=index + 2), "Add")
    document.selection.set(("performers", FIRST))
    library.resize(320, 260)
    bar = library.view.verticalScrollBar()
    bar.setValue(bar.value() + library.row_rect(("performers", FIRST)).top())
    before = library.row_rect(("performers", SECOND))
    QCursor.setPos(library.view.viewport().mapToGlobal(before.center()))
    click(library, ("performers", SECOND))
    assert document.active_performer_id == SECOND
    assert library.row_rect(("constraints", "wrist")).isEmpty()
    assert library.row_rect(("performers", SECOND)) == before
