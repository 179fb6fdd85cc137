"""The viewport: what a click picks, and what is made of it."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from studio.core.stage.project import Project
from studio.document.colours import SELECTED_HANDLE
from tests.gui.viewport_use import (
    LEFT,
    NONE,
    chip,
    joint_pixel,
    select_performer,
    send_move,
    settle,
    targets_of,
    wrists,
)

NO_BUTTON = Qt.MouseButton.NoButton


def test_a_click_on_a_joint_selects_its_performer_and_offers_to_constrain_it(studio):
    viewport, document, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 1", "right wrist"))
    settle(viewport)
    assert document.selection.items == (("performers", "performer 1"),)
    assert viewport.joint_picked.joint.name == "right wrist"
    offer = chip(viewport, "constrain_the_picked_joint")
    assert offer.isVisible()
    assert "right wrist" in offer.text()


def test_c_constrains_the_picked_joint_where_it_is_as_one_undo_step(studio):
    viewport, document, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "left wrist"))
    place = viewport.posed["performer 0"]
    viewport.add_constraint_at_pick()
    collection, constraint_id = document.selection.current
    constraint = document.project.constraints[constraint_id]
    assert collection == "constraints"
    assert (constraint.name, constraint.priority) == ("Left wrist", 1)
    layout = place.motion.morphology.layout
    [handle] = [one for one in viewport.handles() if one.is_primary and one.constraint_id == constraint_id]
    assert handle.target == pytest.approx(place.motion.positions[place.row, layout.wrist_point(0)])
    assert constraint.activation.at(0.2) == 1.0
    assert constraint.activation.start >= 0.0
    assert constraint.activation.end <= 29 / 60 + 1e-12
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert list(document.project.constraints) == ["constraint 0"]


def test_each_body_has_the_new_target_at_its_own_joint(studio):
    viewport, _, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    constraint_id = viewport.add_constraint_at_pick()
    places = targets_of(viewport, constraint_id)
    for performer_id, wrist in wrists(viewport).items():
        assert places[performer_id] == pytest.approx(wrist)


def test_nothing_is_asked_of_a_body_whose_motion_went_since_the_last_picture(studio):
    viewport, document, _ = studio
    wrist = joint_pixel(viewport, "performer 0", "right wrist")
    document.new(Project())
    QTest.mouseDClick(viewport, LEFT, NONE, wrist)
    assert not document.project.constraints


def test_a_click_on_a_held_target_picks_the_joint_under_it_too_so_that_more_can_be_asked_of_it(studio):
    viewport, document, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    constraint_id = viewport.add_constraint_at_pick()
    document.selection.clear()
    settle(viewport)
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    assert document.selection.current == ("constraints", constraint_id)
    assert viewport.joint_picked.joint.name == "right wrist"
    second = viewport.add_constraint_at_pick("orientation")
    assert document.project.constraints[second].kind == "orientation"
    assert document.project.constraints[second].point.part == "right_hand"


def test_a_double_click_on_a_joint_constrains_it(studio):
    viewport, document, _ = studio
    QTest.mouseDClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 1", "left ankle"))
    assert [one.name for one in document.project.constraints.values()] == ["Target 0", "Left ankle"]


def test_a_click_on_a_target_selects_its_constraint_and_a_click_on_nothing_lets_go(studio):
    viewport, document, _ = studio
    handle = next(one for one in viewport.handles() if one.is_primary)
    QTest.mouseClick(viewport, LEFT, NONE, viewport.widget_point(handle.target).toPoint())
    assert document.selection.current == ("constraints", "constraint 0")
    QTest.mouseClick(viewport, LEFT, NONE, QPoint(880, 300))
    assert document.selection.items == ()


def test_a_picked_joint_has_no_gizmo_beside_it(studio):
    viewport, _, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 1", "right wrist"))
    settle(viewport)
    assert viewport.gizmo() is None


def test_joints_of_the_feet_go_before_the_handles_about_them(studio):
    viewport, document, _ = studio
    select_performer(viewport, document)
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 1", "left ankle"))
    assert viewport.joint_picked.joint.name == "left ankle"


def test_the_joints_of_the_body_under_the_mouse_are_seen(studio):
    viewport, _, _ = studio
    hip, knee = (joint_pixel(viewport, "performer 1", f"right {name}") for name in ("hip", "knee"))
    thigh = (hip + knee) / 2  # far from any joint

    def dots():
        colour = QColor(SELECTED_HANDLE).name()
        image = viewport.grab().toImage()
        pixels = [joint_pixel(viewport, "performer 1", name) for name in ("left knee", "right elbow", "left wrist")]
        return [image.pixelColor(pixel).name() == colour for pixel in pixels]

    send_move(viewport, QPoint(3, 3), NO_BUTTON, NONE)
    settle(viewport)
    assert not any(dots())
    send_move(viewport, thigh, NO_BUTTON, NONE)
    settle(viewport)
    assert viewport.body_hovered == "performer 1"
    assert all(dots())
