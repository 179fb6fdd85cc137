"""A mirrored clip on the whole window with its real engine: all that has a side goes with the mirror."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit

from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.settings import Settings
from studio.core.captures.contacts import ContactPoint
from studio.document.clip_edits import edit_clip
from studio.document.document import Document
from studio.timeline.hover import hover_text
from studio.viewport.paths import contact_marks
from tests.gui.viewport_use import LEFT, NONE, drag, joint_pixel
from tests.gui.window_use import wait_until_idle
from tests.patience import SECONDS

KICK = 154
"""Frame of the sample in which the right foot kicks and the left one stands."""


@pytest.fixture
def window(qtbot, tmp_path):
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    with qtbot.waitExposed(window):
        window.show()
    window.resize(1000, 680)
    window.actions_by_id.by_id["open_sample"].trigger()
    import_views()
    show_views(window)
    wait_until_idle(qtbot, window)
    document = window.bench.document
    document.playhead.pause()
    for key in ("giant", "toy", "man"):
        if key in document.project.performers:
            document.remove("performers", key, "Remove")
    document.playhead.set_frame(KICK)
    solved(window)
    yield window
    window.close_without_saving()
    window.deleteLater()
    QTest.qWait(0)


def solved(window):
    assert window.bench.live.wait_until_solved(SECONDS)
    QTest.qWait(50)
    while window.bench.viewport.moving:
        QTest.qWait(5)


def clip_bar(window):
    timeline = window.bench.timeline
    clips = [row for row in timeline.tracks.sheet.rows if row.kind == "clip"]
    row = timeline.row_rect("clip", clips[0].id)
    return QPoint(round(timeline.x_of_frame(KICK - 20)), row.center().y())


def mirror(window):
    QTest.mouseClick(window.bench.timeline.tracks, LEFT, NONE, clip_bar(window))
    QTest.keyClick(window, Qt.Key.Key_M, Qt.KeyboardModifier.ControlModifier)
    solved(window)
    assert window.bench.document.active_clip.mirrored


def constrain(window, joint):
    viewport = window.bench.viewport
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "child", joint))
    QTest.keyClick(viewport, Qt.Key.Key_C)
    solved(window)
    return window.bench.document.selection.of("constraints")[-1]


def feet(pose):
    """(2, 2, 3) metres: heel and toe of the left and the right foot."""
    layout = pose.motion.morphology.layout
    return np.array([[pose.points[layout.ankle_point(side)], pose.points[layout.toe_point(side)]] for side in (0, 1)])


def miss(window, constraint_id, side):
    """The most, of all bodies, that a handle lies away from the toes of a side, metres."""
    viewport = window.bench.viewport
    handles = {each.performer_id: each for each in viewport.handles() if each.constraint_id == constraint_id}
    assert handles
    ends = {key: pose.motion.morphology.layout.toe_point(side) for key, pose in viewport.posed.items()}
    gaps = [np.linalg.norm(handles[key].target - viewport.posed[key].points[ends[key]], axis=-1) for key in handles]
    return max(gaps)


def standing_rows(window):
    """The sides of which the timeline shows a contact at the playhead."""
    timeline = window.bench.timeline
    x = timeline.x_of_frame(KICK)
    found = []
    for side in ("left", "right"):
        row = timeline.row_rect("lane", f"{side} foot")
        hits = {timeline.tracks.sheet.part_under_playhead(QPointF(x, row.center().y() + dy)).kind for dy in (-4, 4)}
        found += [side] if "contacts" in hits else []
    return found


def assert_all_is_of_the_left(window, constraint_id):
    viewport, document = window.bench.viewport, window.bench.document
    assert miss(window, constraint_id, side=0) < 0.2 < miss(window, constraint_id, side=1)
    for pose in viewport.posed.values():
        assert feet(pose)[0, :, 2].min() > feet(pose)[1, :, 2].max() + 0.2, "the left foot kicks"
    for mark in contact_marks(document.project, viewport.posed):
        centre = mark.points[:-1, :2].mean(axis=0)
        gaps = {
            side: min(
                np.linalg.norm(feet(pose)[side, :, :2] - centre, axis=-1).min() for pose in viewport.posed.values()
            )
            for side in (0, 1)
        }
        assert gaps[1] < 0.1 < gaps[0]
    assert standing_rows(window) == ["right"]


def test_contacts_handles_names_and_forms_of_a_mirrored_clip_are_of_the_side_that_is_seen(window):
    constraint_id = constrain(window, "right ball of foot")
    assert standing_rows(window) == ["left"]
    mirror(window)
    document, timeline = window.bench.document, window.bench.timeline
    document.selection.set(("performers", "child"), ("constraints", constraint_id))
    solved(window)
    assert_all_is_of_the_left(window, constraint_id)
    names = [each.text() for each in window.inspector.findChildren(QLineEdit) if each.isVisible()]
    assert "Left ball of foot" in names
    assert "1 · Left ball of foot" in [row.text for row in window.library.model.rows]
    row = timeline.row_rect("constraints", constraint_id)
    text = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(60, row.center().y()))
    assert text.startswith("Left ball of foot")


def test_a_handle_of_a_mirrored_clip_lifts_the_foot_that_it_lies_on(window):
    constraint_id = constrain(window, "right ball of foot")
    mirror(window)
    document, viewport = window.bench.document, window.bench.viewport
    document.selection.set(("performers", "child"), ("constraints", constraint_id))
    solved(window)
    before = feet(viewport.posed["child"])
    gizmo = viewport.gizmo()
    tip = QPoint(*np.rint(gizmo.centre + 0.7 * (gizmo.tips[2] - gizmo.centre)).astype(int))
    drag(viewport, tip, tip - QPoint(0, 20))
    solved(window)
    after = feet(viewport.posed["child"])
    assert after[0, 1, 2] > before[0, 1, 2] + 0.02
    assert after[1] == pytest.approx(before[1], abs=0.03)
    assert document.undo_stack.undoText() == "Move target of Left ball of foot"


def test_a_joint_that_is_constrained_on_a_mirrored_clip_is_the_one_that_was_picked(window):
    mirror(window)
    constraint_id = constrain(window, "left ball of foot")
    assert window.bench.document.undo_stack.undoText() == "Add 'Left ball of foot'"
    assert_all_is_of_the_left(window, constraint_id)
    assert miss(window, constraint_id, side=0) < 0.01
    project = window.bench.document.project
    right = [
        each for each in project.contacts.values() if each.point in (ContactPoint.RIGHT_HEEL, ContactPoint.RIGHT_TOE)
    ]
    lifted = max(
        each.last for each in right if each.last < KICK
    )  # the captured right foot is the left one that is seen
    assert project.constraints[constraint_id].activation.start >= lifted / 60.0
    constrain(window, "right wrist")
    window.actions_by_id.by_id["raise_priority"].trigger()
    assert window.bench.document.undo_stack.undoText() == "Reorder priority of Right wrist"


def test_the_second_loop_of_a_mirrored_clip_shows_the_same_sides(window):
    from dataclasses import replace

    constraint_id = constrain(window, "right ball of foot")
    document = window.bench.document
    clip_id = document.active_clip.id
    edit_clip(document, clip_id, lambda clip: (replace(clip, mirrored=True, repeats=2),), "Loop")
    solved(window)
    clip = document.active_clip
    document.playhead.set_time(clip.start + (clip.last - clip.first + KICK - clip.first) / document.playhead.frame_rate)
    solved(window)
    assert miss(window, constraint_id, side=0) < 0.2 < miss(window, constraint_id, side=1)
    pose = window.bench.viewport.posed["child"]
    assert feet(pose)[0, :, 2].min() > feet(pose)[1, :, 2].max() + 0.2
