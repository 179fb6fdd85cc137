"""Things selected together move, trim and are edited together, as one undo step."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QCheckBox, QLabel

from studio.core.captures.contacts import ContactPoint
from studio.document.document import Document
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from tests.builders import make_constraint, make_contact, make_project
from tests.gui.hand import LEFT, NONE, RATE, curve, frames, in_lane, pixels

CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0, contacts=0, frames=101)
    for index, key in enumerate(("kick", "punch", "other")):
        constraint = make_constraint(name=key, activation=curve(20, 30 + index, 50, 60), priority=index)
        project = project.with_entity("constraints", key, constraint)
    for key, first, last in (("early", 5, 15), ("late", 20, 40), ("last", 70, 90)):
        contact = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        project = project.with_entity("contacts", key, contact)
    document = Document(project)
    yield document
    document.close()


@pytest.fixture
def inspector(qtbot, document, live):
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    inspector.show()
    return inspector


def bar(timeline, key, frame=40):
    row = timeline.row_rect("constraints", key)
    return QPoint(round(timeline.x_of_frame(frame)), row.top() + 12)


def select_both(timeline):
    QTest.mouseClick(timeline.tracks, LEFT, NONE, bar(timeline, "kick"))
    QTest.mouseClick(timeline.tracks, LEFT, CTRL, bar(timeline, "punch"))


def curves(document):
    return {key: frames(each.activation) for key, each in document.project.constraints.items()}


def test_one_of_two_selected_bars_drags_both_and_both_stay_selected(document, timeline, hand):
    select_both(timeline)
    hand.drag(bar(timeline, "kick"), pixels(timeline, 10))
    assert curves(document) == {"kick": (30, 40, 60, 70), "punch": (30, 41, 60, 70), "other": (20, 32, 50, 60)}
    assert {*document.selection.of("constraints")} == {"kick", "punch"}
    assert document.undo_stack.count() == 1
    assert document.undo_stack.undoText() == "Move 2 constraints"
    document.undo_stack.undo()
    assert curves(document)["kick"] == (20, 30, 50, 60)


def test_bars_that_move_together_stop_where_the_first_of_them_would_leave_the_motion(document, timeline, hand):
    later = replace(document.project.constraints["punch"], activation=curve(70, 75, 80, 90))
    document.replace("constraints", "punch", later, "Later")
    QTest.mouseClick(timeline.tracks, LEFT, NONE, bar(timeline, "kick"))
    QTest.mouseClick(timeline.tracks, LEFT, CTRL, bar(timeline, "punch", 78))
    hand.drag(bar(timeline, "kick"), pixels(timeline, 55))
    assert (curves(document)["kick"][0], curves(document)["punch"][0]) == (50, 100)


def test_a_handle_of_one_moves_that_of_all_that_are_selected(document, timeline, hand):
    select_both(timeline)
    row = timeline.row_rect("constraints", "punch")
    hand.drag(QPoint(round(timeline.x_of_frame(60)), row.top() + 25), pixels(timeline, 8))
    assert curves(document) == {"kick": (20, 30, 50, 68), "punch": (20, 31, 50, 68), "other": (20, 32, 50, 60)}
    assert document.undo_stack.count() == 1


def test_a_click_on_one_of_several_leaves_it_alone_selected(document, timeline):
    select_both(timeline)
    QTest.mouseClick(timeline.tracks, LEFT, NONE, bar(timeline, "kick"))
    assert document.selection.items == (("constraints", "kick"),)


def test_the_arrow_keys_move_a_handle_of_all(document, timeline):
    select_both(timeline)
    timeline.tracks.setFocus()
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Tab)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Right)
    assert [curves(document)[key][0] for key in ("kick", "punch", "other")] == [21, 21, 20]
    assert document.undo_stack.count() == 1


def test_selected_contacts_move_together_up_to_their_neighbours(document, timeline, hand):
    QTest.mouseClick(timeline.tracks, LEFT, NONE, in_lane(timeline, 10))
    QTest.mouseClick(timeline.tracks, LEFT, CTRL, in_lane(timeline, 30))
    hand.drag(in_lane(timeline, 30), pixels(timeline, 50))
    contacts = {key: (each.first, each.last) for key, each in document.project.contacts.items()}
    assert contacts == {"early": (34, 44), "late": (49, 69), "last": (70, 90)}
    assert document.undo_stack.count() == 1


def test_on_and_numbers_of_a_form_are_set_on_all_that_are_selected(document, timeline, inspector):
    select_both(timeline)
    inspector.editor.findChild(QCheckBox).click()
    states = {key: each.enabled for key, each in document.project.constraints.items()}
    assert states == {"kick": False, "punch": False, "other": True}
    assert document.undo_stack.count() == 1
    assert document.undo_stack.undoText().endswith(" and 1 other")
    document.undo_stack.undo()
    assert all(each.enabled for each in document.project.constraints.values())


def test_a_form_changes_only_what_was_edited_and_says_what_differs(document, timeline, inspector):
    select_both(timeline)
    texts = [each.text() for each in inspector.editor.findChildren(QLabel) if each.isVisible()]
    [told] = [text for text in texts if text.startswith("2 constraints")]
    assert "activation" in told
    assert "point" not in told
    [field] = [each for each in inspector.editor.findChildren(NumberField) if each.accessibleName() == "Offset X"]
    field.begun.emit()
    field.edited.emit(5.0)
    field.ended.emit()
    for key in ("kick", "punch"):
        assert document.project.constraints[key].point.offset == pytest.approx((0.05, 0.0, 0.0))
    assert document.project.constraints["other"].point.offset == (0.0, 0.0, 0.0)
    assert curves(document)["punch"] == (20, 31, 50, 60)
    assert document.project.constraints["kick"].name == "kick"
    assert document.undo_stack.count() == 1


def test_a_constraint_that_is_not_selected_is_edited_alone(document, timeline, inspector):
    QTest.mouseClick(timeline.tracks, LEFT, NONE, bar(timeline, "kick"))
    inspector.editor.findChild(QCheckBox).click()
    states = {key: each.enabled for key, each in document.project.constraints.items()}
    assert states == {"kick": False, "punch": True, "other": True}
    assert RATE == 60.0
