"""Keys that are pressed while the mouse drags: the drag ends first, and no edit comes between those of a drag."""

from contextlib import contextmanager
from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from tests.gui.test_ten_tasks import CTRL, LEFT, NONE, RATE, REACH, User, only, staged, user
from tests.gui.viewport_use import drag, on_arrow, send_move, settle

__all__ = ["user"]


@contextmanager
def dragging(widget, begin, end):
    """The button is down from ``begin`` to ``end``; what is pressed meanwhile is followed by another move."""
    drag(widget, begin, end, release=False)
    yield
    send_move(widget, end + QPoint(9, 9), LEFT, NONE)
    QTest.mouseRelease(widget, LEFT, NONE, end + QPoint(9, 9))


def frames(user: User, constraint_id):
    return [round(time * RATE) for time in user.project.constraints[constraint_id].target.times]


@pytest.fixture
def reach(user):
    """A reach with keys at frames 100, 160 and 220, which was renamed before and is selected."""
    [(key, constraint)] = user.project.constraints.items()
    user.document.replace("constraints", key, replace(constraint, name="Other"), "Rename")
    user.click(user.on_bar(key, 130))
    return key


@pytest.fixture
def project():
    return staged(made=[REACH])


def test_undo_takes_the_drag_of_a_key_back_and_the_mouse_moves_it_no_more(user, reach):
    tracks = user.timeline.tracks
    with dragging(tracks, user.on_bar(reach, 160), user.on_bar(reach, 180)):
        assert frames(user, reach)[1] == pytest.approx(180, abs=1)
        user.press(Qt.Key.Key_Z, CTRL, tracks)
    assert frames(user, reach) == [100, 160, 220]
    assert user.document.undo_stack.index() == 1
    assert user.document.undo_stack.canRedo()
    assert not user.window.bench.live.interactive


def arrow_of_target(user, reach):
    """Pixel on the upward arrow of the target's gizmo, at a frame without a key."""
    user.go_to(130)
    user.click(user.on_bar(reach, 120))
    for key in (Qt.Key.Key_F, Qt.Key.Key_W):
        user.press(key)
    settle(user.viewport)
    return on_arrow(user.viewport, "z", 0.7)


def test_undo_pressed_twice_in_a_drag_takes_the_edit_before_it_back_too(user, reach):
    begin = arrow_of_target(user, reach)
    with dragging(user.viewport, begin, begin - QPoint(0, 40)):
        assert frames(user, reach) == [100, 130, 160, 220]
        user.press(Qt.Key.Key_Z, CTRL)
        user.press(Qt.Key.Key_Z, CTRL)
    assert frames(user, reach) == [100, 160, 220]
    assert user.project.constraints[reach].name == "Reach"
    assert user.document.undo_stack.index() == 0


def test_the_first_edit_of_all_is_undone_in_its_drag(user):
    key, _ = only(user.project.constraints)
    user.click(user.on_bar(key, 130))
    with dragging(user.timeline.tracks, user.on_bar(key, 160), user.on_bar(key, 180)):
        user.press(Qt.Key.Key_Z, CTRL, user.timeline.tracks)
    assert frames(user, key) == [100, 160, 220]


def test_a_key_that_is_deleted_in_its_drag_stays_deleted(user, reach):
    with dragging(user.timeline.tracks, user.on_bar(reach, 160), user.on_bar(reach, 180)):
        user.press(Qt.Key.Key_Delete, widget=user.timeline.tracks)
    assert frames(user, reach) == [100, 220]


def test_a_bar_that_is_deleted_while_it_is_pressed_is_not_dragged(user, reach):
    tracks = user.timeline.tracks
    QTest.mousePress(tracks, LEFT, NONE, user.on_bar(reach, 130))
    user.press(Qt.Key.Key_Delete, widget=tracks)
    assert not user.project.constraints
    send_move(tracks, QPoint(600, 150), LEFT, NONE)
    QTest.mouseRelease(tracks, LEFT, NONE, QPoint(600, 150))
    user.document.undo_stack.undo()
    assert frames(user, reach) == [100, 160, 220]


def test_esc_still_cancels_a_drag(user, reach):
    begin = arrow_of_target(user, reach)
    with dragging(user.viewport, begin, begin - QPoint(0, 40)):
        user.press(Qt.Key.Key_Escape)
    assert frames(user, reach) == [100, 160, 220]
    assert user.document.undo_stack.index() == 1
