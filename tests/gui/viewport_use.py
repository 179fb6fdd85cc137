"""Actions of a person in the viewport, for tests: click, drag, wait."""

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton

from studio.viewport.body_points import body_joints
from studio.viewport.gizmo import GIZMO_AXES

LEFT, MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
NONE = Qt.KeyboardModifier.NoModifier


def settle(viewport):
    """Let the viewport draw what it was told, and end a glide."""
    QTest.qWait(5)
    while viewport.moving and viewport.gesture is None:
        QTest.qWait(5)
    QTest.qWait(5)


def joint_pixel(viewport, performer_id, name):
    pose = viewport.posed[performer_id]
    joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == name)
    return viewport.widget_point(pose.points[joint.index]).toPoint()


def drag(viewport, begin, end, button=LEFT, modifiers=NONE, release=True):
    QTest.mousePress(viewport, button, modifiers, begin)
    for share in (0.25, 0.5, 0.75, 1.0):
        where = begin + (end - begin) * share
        move = QPoint(round(where.x()), round(where.y()))
        send_move(viewport, move, button, modifiers)
    if release:
        QTest.mouseRelease(viewport, button, modifiers, end)


def send_move(viewport, where, button, modifiers):
    """QTest.mouseMove knows neither buttons nor keys."""
    local = QPointF(where)
    event = QMouseEvent(
        QEvent.Type.MouseMove, local, viewport.mapToGlobal(local), Qt.MouseButton.NoButton, button, modifiers
    )
    QApplication.sendEvent(viewport, event)


def select_constraint(viewport, document):
    document.selection.set(("performers", "performer 0"), ("constraints", "constraint 0"))
    viewport.frame_selection()
    settle(viewport)


def chip(viewport, name):
    return viewport.findChild(QPushButton, name)


def on_arrow(viewport, axis, share):
    gizmo = viewport.gizmo()
    place = gizmo.centre + share * (gizmo.tips[GIZMO_AXES.index(axis)] - gizmo.centre)
    return QPoint(*(round(float(number)) for number in place))


def target(document):
    return np.array(document.project.constraints["constraint 0"].target)


def select_performer(viewport, document):
    document.selection.set(("performers", "performer 1"))
    viewport.frame_selection()
    settle(viewport)
    return document.project.performers["performer 1"]


def on_ring(viewport, part, degrees):
    """A pixel of a ring of the rotate tool, so many degrees round its axis."""
    ring = viewport.gizmo().ring(part)
    return QPoint(
        *(round(float(number)) for number in ring[round(degrees / 360.0 * (len(ring) - 1)) % (len(ring) - 1)])
    )


def wrists(viewport):
    """Place of each performer's right wrist on the stage."""
    return {key: pose.points[pose.motion.morphology.layout.wrist_point(1)] for key, pose in viewport.posed.items()}


def targets_of(viewport, constraint_id):
    return {one.performer_id: one.target for one in viewport.handles() if one.constraint_id == constraint_id}
