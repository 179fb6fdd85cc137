"""Every wrong guess of an import report is put right with mouse and keys, and holds for the next file of its kind."""

import numpy as np
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.panels.fields import Choice, NumberField
from tests.gui.window_use import LEFT, drop, wait_until_idle


def _field(window, kind, name):
    [found] = [each for each in window.inspector.findChildren(kind) if each.accessibleName() == name]
    scroll = found.parentWidget()
    while scroll is not None and not hasattr(scroll, "ensureWidgetVisible"):
        scroll = scroll.parentWidget()
    scroll.ensureWidgetVisible(found)
    assert found.isVisible()
    return found


def _choose(window, name, text):
    choice = _field(window, Choice, name)
    QTest.mouseClick(choice, LEFT, pos=QPoint(8, choice.height() // 2))
    items = choice.view()
    index = items.model().index(choice.findText(text), 0)
    items.scrollTo(index)
    place = items.visualRect(index).center()
    QTest.mouseMove(items.viewport(), place - QPoint(0, 1))
    QTest.mouseMove(items.viewport(), place)
    QTest.mouseClick(items.viewport(), LEFT, pos=place)


def _type(window, name, text):
    field = _field(window, NumberField, name)
    QTest.mouseClick(field.lineEdit(), LEFT)
    field.lineEdit().selectAll()
    QTest.keyClicks(field.lineEdit(), text)
    QTest.keyClick(field.lineEdit(), Qt.Key.Key_Return)


def test_unit_axis_rate_floor_map_and_reference_are_corrected_and_remembered(qtbot, window, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    capture_id = list(document.project.captures)[-1]
    guessed = document.project.captures[capture_id]
    document.selection.set(("captures", capture_id))
    QTest.qWait(0)
    for name, text in (("Unit", "inches"), ("Up axis", "Z up")):
        _choose(window, name, text)
        wait_until_idle(qtbot, window)
    document.playhead.set_frame(7)
    _choose(window, "Reference pose", "Frame at the playhead")
    wait_until_idle(qtbot, window)
    _type(window, "Frame rate", "48")
    _type(window, "Floor", "0.125")
    [show] = [each for each in window.inspector.findChildren(QPushButton) if each.text() == "Show" and each.isVisible()]
    QTest.mouseClick(show, LEFT)
    QTest.qWait(0)
    _choose(window, "Left toe", "none")
    wait_until_idle(qtbot, window)
    corrected = document.project.captures[capture_id]
    assert (corrected.unit, corrected.up_axis, corrected.frame_rate, corrected.floor) == ("inch", "Z", 48.0, 0.125)
    assert "left_toe" in guessed.body_map.to_json(guessed.skeleton)
    assert "left_toe" not in corrected.body_map.to_json(corrected.skeleton)
    np.testing.assert_array_equal(corrected.reference_rotations, corrected.poses.local_rotations[7])

    second = walk.with_name("second.bvh")
    second.write_bytes(walk.read_bytes())
    drop(window, second)
    wait_until_idle(qtbot, window)
    again = document.project.captures[list(document.project.captures)[-1]]
    assert again.source == "second.bvh"
    assert (again.unit, again.up_axis, again.frame_rate, again.floor) == ("inch", "Z", 48.0, 0.125)
    assert "left_toe" not in again.body_map.to_json(again.skeleton)
    np.testing.assert_allclose(again.reference_rotations, corrected.reference_rotations, atol=1e-12)
    assert "as you corrected its kind of file before" in window.strip.text
