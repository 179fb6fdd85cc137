"""The first minute of the README, walked with mouse and keys on the whole window with its real engine."""

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox

from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.settings import Settings
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.document.document import Document
from studio.engine.residuals import worst_residual
from studio.panels.constraint_editors.target_rows import KEYED_KIND, PLACE_KINDS
from studio.timeline.strip_states import StripState
from studio.viewport.body_points import body_joints
from tests.gui.window_use import choose_by_keys, drop, wait_until_idle
from tests.patience import SECONDS

LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
HEIGHT_OF_KICK = 154
HELD, SHORT = 0.002, 0.020
"""Metres: nobody sees less; everybody sees more."""


@pytest.fixture
def window(qtbot, tmp_path):
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    with qtbot.waitExposed(window):
        window.show()
    window.resize(1400, 900)
    window.actions_by_id.by_id["open_sample"].trigger()
    import_views()
    show_views(window)
    wait_until_idle(qtbot, window)
    solved(window)
    yield window
    window.close_without_saving()
    window.deleteLater()
    QTest.qWait(0)


def solved(window):
    assert window.bench.live.wait_until_solved(SECONDS)
    QTest.qWait(50)
    while window.bench.viewport.moving and not window.bench.document.playhead.playing:
        QTest.qWait(5)


def move(widget, place):
    local = QPointF(place)
    event = QMouseEvent(QEvent.Type.MouseMove, local, widget.mapToGlobal(local), Qt.MouseButton.NoButton, LEFT, NONE)
    QApplication.sendEvent(widget, event)


def misses(window, constraint_id):
    """Metres by which each performer misses the target in its worst frame of the hold."""
    project, live = window.bench.document.project, window.bench.live
    worst = {key: worst_residual(project, key, live.reported_motion(key), constraint_id) for key in project.performers}
    assert all(each.fully_active for each in worst.values())
    return {key: each.amount for key, each in worst.items()}


def pixel(viewport, place):
    return viewport.widget_point(place).toPoint()


def test_the_first_minute_is_as_the_readme_says(qtbot, window, walk):
    pause(window)
    constraint_id = ask_for_the_kick(window)
    choose_one_place_for_all(window, constraint_id)
    drag_up_until_the_child_falls_short(window, constraint_id)
    drag_a_handle_of_the_bar(window, constraint_id)
    drop_an_own_capture(qtbot, window, walk)
    QTest.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert window.bench.document.dirty  # it asks for a name first


def test_arrow_keys_key_a_target_without_one_place_for_all_on_the_way(window):
    pause(window)
    constraint_id = ask_for_the_kick(window)
    edits = len(window.bench.document.history)
    [choice] = [each for each in window.inspector.findChildren(QComboBox) if each.accessibleName() == "Target type"]
    choose_by_keys(choice, [kind for kind, _ in PLACE_KINDS].index(KEYED_KIND))
    assert isinstance(window.bench.document.project.constraints[constraint_id].target, KeyedOwnPlace)
    assert len(window.bench.document.history) == edits + 1


def pause(window):
    """1. Five characters play; Space pauses."""
    document = window.bench.document
    assert document.playhead.playing
    assert len(window.bench.viewport.posed) == 5
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert not document.playhead.playing


def ask_for_the_kick(window):
    """2. The playhead to the kick, a click on the ball of the child's right foot, C; the constraint's id."""
    document, viewport, timeline = window.bench.document, window.bench.viewport, window.bench.timeline
    ruler = timeline.row_rect("ruler")
    QTest.mouseClick(
        timeline.tracks, LEFT, NONE, QPoint(round(timeline.x_of_frame(HEIGHT_OF_KICK)), ruler.center().y())
    )
    assert document.playhead.frame == HEIGHT_OF_KICK
    solved(window)
    pose = viewport.posed["child"]
    ball = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right ball of foot")
    QTest.mouseClick(viewport, LEFT, NONE, pixel(viewport, pose.points[ball.index]))
    assert (viewport.joint_picked.performer_id, viewport.joint_picked.joint.name) == ("child", ball.name)
    QTest.keyClick(viewport, Qt.Key.Key_C)
    solved(window)
    _, constraint_id = document.selection.current
    assert timeline.row_rect("constraints", constraint_id).height() > 0
    assert all(miss < HELD for miss in misses(window, constraint_id).values())
    return constraint_id


def choose_one_place_for_all(window, constraint_id):
    [choice] = [
        box
        for box in window.inspector.findChildren(QComboBox)
        if box.accessibleName() == "Target type" and box.isVisible()
    ]
    choose_by_keys(choice)
    solved(window)
    assert isinstance(window.bench.document.project.constraints[constraint_id].target, tuple)
    assert all(miss < HELD for miss in misses(window, constraint_id).values())


def drag_up_until_the_child_falls_short(window, constraint_id):
    """3. The blue arrow, up, until the child cannot reach it any more; the others still can."""
    document, viewport, timeline = window.bench.document, window.bench.viewport, window.bench.timeline
    while (missed := misses(window, constraint_id))["child"] < SHORT:
        assert max(miss for key, miss in missed.items() if key != "child") < HELD
        height = document.project.constraints[constraint_id].target[2]
        gizmo = viewport.gizmo()
        tip = QPoint(*np.rint(gizmo.centre + 0.7 * (gizmo.tips[2] - gizmo.centre)).astype(int))
        QTest.mousePress(viewport, LEFT, NONE, tip)
        for step in (2, 4, 6, 8):
            move(viewport, tip - QPoint(0, step))
        QTest.mouseRelease(viewport, LEFT, NONE, tip - QPoint(0, 8))
        solved(window)
        assert document.project.constraints[constraint_id].target[2] > height + 0.01
    assert max(miss for key, miss in missed.items() if key != "child") < SHORT
    curve = document.project.constraints[constraint_id].activation
    shown = {timeline.strip_state(constraint_id, "child", round(60 * time)) for time in (curve.full, curve.full_end)}
    assert StripState.NOT_REACHED in shown


def drag_a_handle_of_the_bar(window, constraint_id):
    """4."""
    document, timeline = window.bench.document, window.bench.timeline
    before = document.project.constraints[constraint_id].activation
    handle = timeline.handle_point(constraint_id, "end")
    QTest.mousePress(timeline.tracks, LEFT, NONE, handle)
    for step in (10, 20, 30):
        move(timeline.tracks, handle + QPoint(step, 0))
    QTest.mouseRelease(timeline.tracks, LEFT, NONE, handle + QPoint(30, 0))
    assert document.project.constraints[constraint_id].activation.end > before.end


def drop_an_own_capture(qtbot, window, walk):
    """5."""
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    solved(window)
    assert document.project.motions[document.active_motion_id].name == "walk"
    assert all(window.bench.viewport.posed[key].motion.frame_count == 40 for key in document.project.performers)


def test_the_first_minute_can_be_walked_by_keys_alone(window):
    """Playhead, joint, constraint, shared target, its height and the end of its hold: no mouse, all undone by keys."""
    document, viewport = window.bench.document, window.bench.viewport
    before = document.project
    press(Qt.Key.Key_Space)
    press(Qt.Key.Key_Home)
    for _ in range(HEIGHT_OF_KICK):
        press(Qt.Key.Key_Right)
    assert document.playhead.frame == HEIGHT_OF_KICK
    solved(window)
    press(Qt.Key.Key_J, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClicks(QApplication.focusWidget(), "right ball")
    press(Qt.Key.Key_Return)
    assert viewport.joint_picked.joint.name == "right ball of foot"
    press(Qt.Key.Key_C)
    solved(window)
    _, constraint_id = document.selection.current
    assert all(miss < HELD for miss in misses(window, constraint_id).values())
    tab_to("Target type")
    choose_by_keys(QApplication.focusWidget())
    tab_to("Target Z")
    press(Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    QTest.keyClicks(QApplication.focusWidget(), "1.8")
    press(Qt.Key.Key_Return)
    solved(window)
    assert document.project.constraints[constraint_id].target[2] == pytest.approx(1.8)
    assert misses(window, constraint_id)["child"] > SHORT
    curve = document.project.constraints[constraint_id].activation
    tab_to("fade-out start")
    press(Qt.Key.Key_Right)
    moved = document.project.constraints[constraint_id].activation.full_end
    assert moved == pytest.approx(round(60 * curve.full_end + 1) / 60)  # on a frame
    for _ in range(document.undo_stack.index()):
        press(Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert document.project == before


def press(key, modifiers=NONE):
    QTest.keyClick(QApplication.focusWidget() or QApplication.activeWindow(), key, modifiers)


def tab_to(words):
    """Go on with Tab until what has the keyboard is called so."""
    for _ in range(100):
        press(Qt.Key.Key_Tab)
        if words in QApplication.focusWidget().accessibleName():
            return
    raise AssertionError(f"no widget called {words} is reached with Tab")
