"""Rows of the library that are dragged by the mouse onto the 3D view and onto the timeline."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.app.application import show_timeline, show_viewport
from studio.core.stage.project import Motion
from tests.builders import make_capture, make_project
from tests.gui.hand import LEFT, NONE

OFF_STAGE, HIDDEN, SHOWN = ("characters", "spare"), ("performers", "performer 1"), ("performers", "performer 0")
OTHER = ("captures", "other")


@pytest.fixture
def project():
    """Two bodies, one hidden; a character that is not on the stage; a capture that nobody plays."""
    project = make_project(characters=2)
    project = project.with_entity("captures", "other", make_capture("Other", 50))
    project = project.with_entity("motions", "other", Motion("Other", "other"))
    spare = replace(project.characters["character 0"], name="Spare")
    hidden = replace(project.performers["performer 1"], visible=False)
    return project.with_entity("characters", "spare", spare).with_entity("performers", "performer 1", hidden)


@pytest.fixture(params=["viewport", "timeline"])
def target(request, qtbot, window):
    """The 3D view, or the rows of the timeline."""
    if request.param == "viewport":
        show_viewport(window)
        return window.bench.viewport
    show_timeline(window)
    qtbot.waitUntil(lambda: window.bench.timeline.tracks.sheet is not None)
    return window.bench.timeline.tracks


def drag(window, item, target):
    """Press on a row and move; if that begins a drag, take it to the middle of ``target`` and let go where accepted.

    Qt's own loop of a drag ends at once off screen: in its place its three events are sent to the target.
    """
    view, begun = window.library.view, []
    view.startDrag = begun.append
    start = window.library.row_rect(item).center() - QPoint(60, 0)
    QTest.mousePress(view.viewport(), LEFT, NONE, start)
    for step in (20, 40):
        place = QPointF(start + QPoint(step, 0))
        move = QMouseEvent(QEvent.Type.MouseMove, place, view.viewport().mapToGlobal(place), LEFT, LEFT, NONE)
        QApplication.sendEvent(view.viewport(), move)
    QTest.mouseRelease(view.viewport(), LEFT, NONE, start)
    if not begun:
        return False
    content = view.model().mimeData(view.selectionModel().selectedIndexes())
    place, copy = target.rect().center(), Qt.DropAction.CopyAction
    for event in (
        QDragEnterEvent(place, copy, content, LEFT, NONE),
        QDragMoveEvent(place, copy, content, LEFT, NONE),
        QDropEvent(QPointF(place), copy, content, LEFT, NONE),
    ):
        event.ignore()
        QApplication.sendEvent(target, event)
        assert event.isAccepted()
    return True


def test_a_character_that_is_dragged_there_comes_on_the_stage(window, target):
    document = window.bench.document
    assert drag(window, OFF_STAGE, target)
    assert [each.character_id for each in document.project.performers.values()].count("spare") == 1
    assert document.history == ("Show Spare",)


def test_a_hidden_body_that_is_dragged_there_is_shown(window, target):
    document = window.bench.document
    assert drag(window, HIDDEN, target)
    assert document.project.performers["performer 1"].visible
    assert document.undo_stack.count() == 1


def test_a_body_that_is_shown_stays_so(window, target):
    document = window.bench.document
    assert not drag(window, SHOWN, target)
    assert document.project.performers["performer 0"].visible
    assert document.undo_stack.count() == 0


def test_a_capture_is_played_by_the_bodies_that_are_shown_or_becomes_a_clip_of_the_timeline(window, target):
    document = window.bench.document
    before = len(document.project.performers["performer 0"].clips)
    assert drag(window, OTHER, target)
    clips = document.project.performers["performer 0"].clips
    assert clips[-1].motion_id == "other"
    assert len(clips) == (1 if window.bench.has_viewport else before + 1)
    assert document.undo_stack.count() == 1
