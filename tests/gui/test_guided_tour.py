"""The guided tour, walked by mouse and by keys on the whole window with its real engine."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.guided_tour import END_SENTENCE, TOUR_STEPS
from studio.app.sample import SAMPLE_MOTION_ID
from studio.app.settings import Settings
from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain
from studio.document.document import Document
from studio.viewport.body_points import body_joints
from tests.core.motions import ALWAYS
from tests.gui.test_first_minute import HEIGHT_OF_KICK, LEFT, move, pixel, press, solved
from tests.gui.window_use import wait_until_idle

CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def window(qtbot, tmp_path):
    """Window in which nothing is open."""
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    with qtbot.waitExposed(window):
        window.show()
    window.resize(1400, 900)
    import_views()
    show_views(window)
    yield window
    window.close_without_saving()
    window.deleteLater()
    QTest.qWait(0)


def begin(qtbot, window):
    window.actions_by_id.by_id["tour"].trigger()
    wait_until_idle(qtbot, window)
    solved(window)
    assert window.bench.document.active_motion_id == SAMPLE_MOTION_ID
    assert window.bench.document.playhead.playing
    assert at_step(window) == 1


def at_step(window):
    """Number of the step that is shown; None when none is."""
    shown = window.tour_strip.text
    return next((number for number, step in enumerate(TOUR_STEPS, 1) if step.sentence in shown), None)


def test_the_tour_goes_on_with_what_the_mouse_does(qtbot, window):
    begin(qtbot, window)
    document, viewport, timeline = window.bench.document, window.bench.viewport, window.bench.timeline
    QTest.mouseClick(timeline.transport.play, LEFT)
    assert at_step(window) == 2
    document.playhead.set_frame(HEIGHT_OF_KICK)
    solved(window)
    pose = viewport.posed["child"]
    ball = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right ball of foot")
    QTest.mouseClick(viewport, LEFT, Qt.KeyboardModifier.NoModifier, pixel(viewport, pose.points[ball.index]))
    assert at_step(window) == 3
    QTest.keyClick(viewport, Qt.Key.Key_C)
    solved(window)
    assert at_step(window) == 4
    gizmo = viewport.gizmo()
    tip = QPoint(*np.rint(gizmo.centre + 0.7 * (gizmo.tips[2] - gizmo.centre)).astype(int))
    QTest.mousePress(viewport, LEFT, Qt.KeyboardModifier.NoModifier, tip)
    for step in (2, 4, 6, 8):
        move(viewport, tip - QPoint(0, step))
        assert at_step(window) == 4  # until the drag has ended
    QTest.mouseRelease(viewport, LEFT, Qt.KeyboardModifier.NoModifier, tip - QPoint(0, 8))
    solved(window)
    assert at_step(window) == 5
    QTest.keyClick(viewport, Qt.Key.Key_Z, CTRL)
    assert window.tour_strip.text == END_SENTENCE
    window.tour_strip.press("Close")
    document.playhead.play()
    document.playhead.pause()
    assert window.tour_strip.text == ""  # it follows nothing any more


def test_the_tour_goes_on_with_what_keys_do_and_stays_when_a_target_is_undone(qtbot, window):
    begin(qtbot, window)
    press(Qt.Key.Key_Space)
    assert at_step(window) == 2
    press(Qt.Key.Key_J, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClicks(QApplication.focusWidget(), "right ball")
    press(Qt.Key.Key_Return)
    assert at_step(window) == 3
    press(Qt.Key.Key_C)
    solved(window)
    press(Qt.Key.Key_Z, CTRL)
    assert at_step(window) == 4


def test_a_balance_over_no_place_that_is_added_meanwhile_is_no_moved_target(qtbot, window):
    begin(qtbot, window)
    document = window.bench.document
    document.playhead.pause()
    while at_step(window) < 4:
        window.tour_strip.press("Skip")
    pelvis = BodyPoint(BodyPart.PELVIS)
    balance = BalanceConstraint(SAMPLE_MOTION_ID, "Balance", pelvis, Chain(), 0, ALWAYS)
    document.add("constraints", balance, "Add balance")
    assert at_step(window) == 4


def test_every_step_can_be_skipped_and_another_project_begins_the_tour_again(qtbot, window):
    begin(qtbot, window)
    window.bench.document.playhead.pause()
    for number in (2, 3, 4, 5):
        assert at_step(window) == number
        window.tour_strip.press("Skip")
    assert window.tour_strip.text == END_SENTENCE
    window.actions_by_id.by_id["tour"].trigger()
    window.tour_strip.press("Skip")
    window.actions_by_id.by_id["open_sample"].trigger()
    wait_until_idle(qtbot, window)
    assert at_step(window) == 1
    window.tour_strip.press("End tour")
    window.bench.document.playhead.pause()
    assert window.tour_strip.text == ""
