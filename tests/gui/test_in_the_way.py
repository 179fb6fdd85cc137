"""Small things of a first day: eyes of the library, priorities by keys, a file that hovers, names that are too long."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from studio.app.application import import_views, show_views
from studio.app.strike_edit import _known_capture
from studio.document.priorities import shared_priorities_after_move
from studio.panels.library_delegate import EYE_COLUMN_PX
from tests.builders import make_capture, make_constraint, make_project
from tests.gui.viewport_use import LEFT, NONE
from tests.gui.window_use import drop
from tests.patience import PATIENCE

ALT = Qt.KeyboardModifier.AltModifier


@pytest.fixture
def project():
    """Project that is open in the window."""
    return make_project(characters=4, constraints=3)


def eye(library, performer_id):
    rect = library.row_rect(("performers", performer_id))
    return QPoint(rect.right() - EYE_COLUMN_PX // 2, rect.center().y())


def shown(document):
    return [key for key, each in document.project.performers.items() if each.visible]


def test_an_eye_hides_all_that_are_selected_in_one_step_and_alt_shows_one_alone(window):
    document, library = window.bench.document, window.library
    one, two, three, four = document.project.performers
    document.selection.set(("performers", one), ("performers", two), ("performers", three))
    steps = document.undo_stack.count()
    QTest.mouseClick(library.view.viewport(), LEFT, NONE, eye(library, two))
    assert shown(document) == [four]
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    document.selection.set(("performers", one))
    QTest.mouseClick(library.view.viewport(), LEFT, ALT, eye(library, three))
    assert shown(document) == [three]
    QTest.mouseClick(library.view.viewport(), LEFT, ALT, eye(library, three))
    assert shown(document) == [one, two, three, four]
    assert document.undo_stack.count() == steps + 2


def test_priorities_change_by_keys_wherever_the_keyboard_is(window):
    document = window.bench.document
    order = list(document.project.constraints_of("motion"))
    document.selection.set(("constraints", order[-1]))
    window.setFocus()
    QApplication.processEvents()
    raise_it = window.actions_by_id.by_id["raise_priority"]
    assert raise_it.isEnabled()
    assert raise_it.shortcut().toString() == "Alt+Up"
    raise_it.trigger()
    assert list(document.project.constraints_of("motion"))[-2] == order[-1]
    window.actions_by_id.by_id["lower_priority"].trigger()
    assert list(document.project.constraints_of("motion")) == order


def test_selected_bars_change_their_priority_together_by_keys_and_say_so_where_they_cannot(window):
    document = window.bench.document
    order = list(document.project.constraints_of("motion"))
    document.selection.set(("constraints", order[-1]), ("constraints", order[-2]))
    window.activateWindow()
    steps = document.undo_stack.count()
    QTest.keyClick(window, Qt.Key.Key_Up, ALT)
    assert list(document.project.constraints_of("motion")) == [*order[:-3], *order[-2:], order[-3]]
    assert document.undo_stack.count() == steps + 1
    QTest.keyClick(window, Qt.Key.Key_Down, ALT)
    assert list(document.project.constraints_of("motion")) == order
    assert window.strip.text == ""
    QTest.keyClick(window, Qt.Key.Key_Down, ALT)
    assert list(document.project.constraints_of("motion")) == order
    assert window.strip.text == "The selection already has the lowest priority."
    assert document.undo_stack.count() == steps + 2


def test_constraints_of_one_priority_that_move_together_keep_it_and_join_those_between_which_they_come():
    constraints = {
        key: make_constraint(name=key, priority=priority)
        for key, priority in (("a", 0), ("b", 0), ("c", 1), ("d", 1), ("e", 2))
    }
    assert shared_priorities_after_move(constraints, ["c", "d", "a", "b", "e"], {"c", "d"}) == [
        False,
        True,
        False,
        True,
        False,
    ]
    assert shared_priorities_after_move(constraints, ["a", "c", "d", "b", "e"], {"c", "d"}) == [
        False,
        True,
        True,
        True,
        False,
    ]
    assert shared_priorities_after_move(constraints, ["a", "b", "e", "c", "d"], {"e"}) == [
        False,
        True,
        False,
        False,
        True,
    ]


def test_a_file_that_hovers_is_answered_by_a_frame_until_it_leaves_or_is_dropped(window, walk):
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(walk))])
    assert window.drop_frame.isHidden()
    enter = QDragEnterEvent(QPoint(400, 300), Qt.DropAction.CopyAction, content, LEFT, NONE)
    window.dragEnterEvent(enter)
    assert window.drop_frame.isVisible()
    assert window.drop_frame.geometry() == window.rect()
    window.dragLeaveEvent(QDragLeaveEvent())
    assert window.drop_frame.isHidden()
    window.dragEnterEvent(enter)
    drop(window, walk)
    assert window.drop_frame.isHidden()


def test_a_strike_whose_capture_the_project_has_does_not_bring_it_again():
    project = make_project()
    [(key, capture)] = project.captures.items()
    read_again = replace(capture, name="the same file", source="elsewhere.bvh")
    assert _known_capture(project, read_again) == key
    assert _known_capture(project, make_capture(frames=capture.frame_count + 1)) is None
    assert _known_capture(replace(project, motions={}), read_again) is None


def test_deleting_bodies_says_that_they_leave_the_stage_and_their_characters_stay(window):
    document = window.bench.document
    one, two, three, _ = document.project.performers
    document.selection.set(("performers", one), ("performers", two))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    assert document.undo_stack.undoText() == "Remove 2 characters from stage"
    assert len(document.project.characters) == 4
    document.selection.set(("performers", three))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    assert document.undo_stack.undoText() == "Remove Body 2 from stage"
    document.selection.set(*(("constraints", key) for key in document.project.constraints))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    assert document.undo_stack.undoText() == "Delete 3 constraints"


def test_the_menus_of_props_and_of_the_library_are_their_own(window):
    menus = window.actions_by_id.by_menu()
    assert "Add box" in [action.text() for action in menus["Prop"]]
    assert "Find strike…" in [action.text() for action in menus["Library"]]
    assert not {"Add box", "Pick up prop at playhead"} & {action.text() for action in menus["Constraint"]}


def test_boxes_that_are_added_one_after_another_lie_beside_each_other(window):
    import_views()
    show_views(window)
    document, add = window.bench.document, window.actions_by_id.by_id["add_box"]
    for _ in range(3):
        add.trigger()
    places = np.array([each.position for each in document.project.props.values()])
    apart = np.linalg.norm(places[:, None] - places, axis=-1)[np.triu_indices(3, 1)]
    assert apart.min() >= 0.4
    assert apart.max() < 1.2
    assert places[:, 2] == pytest.approx(0.2)


def test_focus_is_seen_wherever_tab_leads(window, qtbot):
    """Tools, history, tabs, order of priorities, timeline and 3D view looked the same with the keyboard and without."""
    import_views()
    show_views(window)
    qtbot.waitUntil(lambda: len(window.bench.viewport.posed) == 4, timeout=PATIENCE)
    window.bench.document.selection.set(("constraints", "constraint 1"))
    window.show_dock("Strikes")
    window.activateWindow()
    QTest.qWait(50)
    unseen = []
    for widget in window.findChildren(QWidget):
        tabbed = bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus) and widget.focusProxy() is None
        if not (tabbed and widget.isVisible() and widget.isEnabled()):
            continue
        pictures = []
        for focused in (False, True):
            (widget.setFocus if focused else widget.clearFocus)()
            QApplication.processEvents()
            pictures.append(widget.grab().toImage())
        if widget.hasFocus() and pictures[0] == pictures[1]:
            unseen.append(f"{type(widget).__name__} {widget.objectName()} {widget.accessibleName()}")
    assert not unseen
