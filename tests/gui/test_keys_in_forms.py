"""Keys while something of a form has the focus: each goes to whom a person means by it."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QCheckBox

from studio.app.application import show_views
from studio.panels.editor import EntityNameField
from studio.panels.fields import Choice, NumberField, press_button
from tests.gui.viewport_use import LEFT, NONE
from tests.patience import PATIENCE

CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def form(qtbot, window):
    """The form of a selected character beside the view and the timeline."""
    show_views(window)
    window.activateWindow()
    document = window.bench.document
    document.selection.set(("performers", next(iter(document.project.performers))))
    QApplication.processEvents()
    return window.inspector.editor


def field_of(form, name):
    return next(each for each in form.findChildren(NumberField) if each.accessibleName() == name)


def press(key, modifiers=NONE):
    QTest.keyClick(QApplication.focusWidget() or QApplication.activeWindow(), key, modifiers)


def plays(window):
    return window.bench.document.playhead.playing


def type_a_position(form):
    field = field_of(form, "Position X")
    QTest.mouseClick(field.lineEdit(), LEFT)
    field.lineEdit().selectAll()
    QTest.keyClicks(field, "2.5")
    return field


def position_of(window):
    return next(iter(window.bench.document.project.performers.values())).position[0]


def test_undo_takes_back_a_number_that_was_typed(form, window):
    before = position_of(window)
    type_a_position(form)
    press(Qt.Key.Key_Return)
    assert position_of(window) == 2.5
    press(Qt.Key.Key_Z, CONTROL)
    assert position_of(window) == before


def test_undo_takes_back_a_number_that_was_dragged(form, window):
    before = position_of(window)
    line = field_of(form, "Position X").lineEdit()
    QTest.mousePress(line, LEFT, NONE, QPoint(4, 8))
    for x in (12, 20, 30):
        QTest.mouseMove(line, QPoint(x, 8))
    QTest.mouseRelease(line, LEFT, NONE, QPoint(30, 8))
    assert position_of(window) != before
    press(Qt.Key.Key_Z, CONTROL)
    assert position_of(window) == before


def test_undo_concerns_the_text_while_it_is_typed(form, window):
    document = window.bench.document
    performer_id, performer = next(iter(document.project.performers.items()))
    document.replace("performers", performer_id, replace(performer, name="Other"), "Rename")
    field = type_a_position(form)
    press(Qt.Key.Key_Z, CONTROL)
    assert document.project.performers[performer_id].name == "Other"
    assert field.lineEdit().text() != "2.5"


def test_space_plays_and_letters_are_shortcuts_in_a_field_that_takes_numbers(form, window):
    type_a_position(form)
    press(Qt.Key.Key_Return)
    press(Qt.Key.Key_E)
    assert window.actions_by_id.by_id["rotate_tool"].isChecked()
    press(Qt.Key.Key_Space)
    assert plays(window)
    press(Qt.Key.Key_Space)
    assert not plays(window)


def test_return_in_a_name_gives_the_keys_back(form, window):
    name = form.findChild(EntityNameField)
    QTest.mouseClick(name, LEFT)
    name.selectAll()
    QTest.keyClicks(name, "Ann")
    press(Qt.Key.Key_Return)
    performers = window.bench.document.project.performers
    assert next(iter(performers.values())).name == "Ann"
    press(Qt.Key.Key_Space)
    assert plays(window)
    assert name.text() == "Ann"


def test_a_checkbox_that_was_clicked_leaves_space_to_the_playback(form, window):
    box = next(each for each in form.findChildren(QCheckBox) if each.text() == "Smooth pops")
    QTest.mouseClick(box, LEFT, NONE, QPoint(8, box.height() // 2))
    clicked = box.isChecked()
    press(Qt.Key.Key_Space)
    assert plays(window)
    assert box.isChecked() == clicked


def test_a_checkbox_reached_by_tab_is_toggled_by_space(form, window):
    box = next(each for each in form.findChildren(QCheckBox) if each.text() == "Smooth pops")
    box.setFocus(Qt.FocusReason.TabFocusReason)
    before = box.isChecked()
    press(Qt.Key.Key_Space)
    assert box.isChecked() != before
    assert not plays(window)


def test_a_button_reached_by_tab_is_pressed_by_space(form, window):
    pressed = []
    button = press_button("Press me", lambda: pressed.append(True))
    form.column.addWidget(button)
    QApplication.processEvents()
    button.setFocus(Qt.FocusReason.TabFocusReason)
    press(Qt.Key.Key_Space)
    assert pressed == [True]
    assert not plays(window)


def test_a_list_that_was_clicked_leaves_the_arrow_keys_to_the_playhead(form):
    assert all(each.focusPolicy() == Qt.FocusPolicy.TabFocus for each in form.findChildren(Choice))


def test_the_keys_are_the_windows_after_the_focused_form_has_gone(form, window):
    QTest.mouseClick(field_of(form, "Position X").lineEdit(), LEFT)
    window.bench.document.selection.clear()
    QApplication.processEvents()
    press(Qt.Key.Key_Space)
    assert plays(window)


def test_the_keys_are_the_windows_after_a_question_was_answered(form, window):
    window.question.ask_user("Really?", ("Yes", lambda: None), ("No", lambda: None))
    press(Qt.Key.Key_Return)
    press(Qt.Key.Key_Space)
    assert plays(window)


@pytest.mark.parametrize("shift", [NONE, Qt.KeyboardModifier.ShiftModifier])
@pytest.mark.parametrize("in_a_field", [False, True])
def test_the_keys_of_the_gizmo_are_heard_without_the_focus_in_the_view(form, window, qtbot, shift, in_a_field):
    viewport, document = window.bench.viewport, window.bench.document
    qtbot.waitUntil(lambda: len(viewport.posed) == 2, timeout=PATIENCE)
    window.actions_by_id.by_id["move_tool"].trigger()
    window.setFocus()
    if in_a_field:
        QTest.mouseClick(field_of(form, "Position Y").lineEdit(), LEFT)
    before = next(iter(document.project.performers.values())).position
    press(Qt.Key.Key_X)
    window.setFocus()
    press(Qt.Key.Key_Plus, shift)
    assert next(iter(document.project.performers.values())).position == (before[0] + 0.01, before[1])
