"""The viewport: what is dragged by the gizmo."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.stage.prop import Prop
from studio.viewport.gizmo import GIZMO_AXES
from tests.gui.viewport_use import (
    LEFT,
    MIDDLE,
    NONE,
    chip,
    drag,
    joint_pixel,
    on_arrow,
    on_ring,
    select_constraint,
    select_performer,
    send_move,
    settle,
    target,
    targets_of,
)


def test_a_drag_moves_it_for_every_body_by_its_measure_and_one_with_its_own_offset_alone(studio):
    viewport, document, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    constraint_id = viewport.add_constraint_at_pick()
    before = targets_of(viewport, constraint_id)
    viewport.movable().move(before["performer 0"] + [0.0, 0.0, 0.1], document.new_gesture())
    after = targets_of(viewport, constraint_id)
    legs = [viewport.posed[f"performer {k}"].motion.morphology.leg_length for k in range(2)]
    assert after["performer 0"] - before["performer 0"] == pytest.approx([0.0, 0.0, 0.1])
    assert after["performer 1"] - before["performer 1"] == pytest.approx([0.0, 0.0, 0.1 * legs[1] / legs[0]])
    constraint = document.project.constraints[constraint_id]
    apart = constraint.target.with_own("performer 0", (0.0, 0.0, 0.0))
    document.replace("constraints", constraint_id, replace(constraint, target=apart), "Own offset")
    viewport.movable().move(after["performer 0"] + [0.2, 0.0, 0.0], document.new_gesture())
    alone = targets_of(viewport, constraint_id)
    assert alone["performer 0"] - after["performer 0"] == pytest.approx([0.2, 0.0, 0.0])
    assert alone["performer 1"] == pytest.approx(after["performer 1"])
    for _ in range(3):
        document.undo_stack.undo()
    for performer_id, place in targets_of(viewport, constraint_id).items():
        assert place == pytest.approx(before[performer_id])


@pytest.mark.parametrize("axis", GIZMO_AXES)
def test_dragging_an_arrow_moves_the_target_along_that_axis_alone_in_one_step(studio, axis):
    viewport, document, live = studio
    select_constraint(viewport, document)
    before, gizmo = target(document), viewport.gizmo()
    begin, end = on_arrow(viewport, axis, 0.7), on_arrow(viewport, axis, 1.5)
    drag(viewport, begin, end)
    index = GIZMO_AXES.index(axis)
    expected = (gizmo.grip(axis, end.x(), end.y()) - gizmo.grip(axis, begin.x(), begin.y()))[index]
    assert target(document) - before == pytest.approx(expected * np.eye(3)[index], abs=1e-9)
    assert abs(expected) > 0.05
    assert document.undo_stack.count() == 1
    assert all(live.was_interactive)
    assert not live.interactive
    document.undo_stack.undo()
    assert target(document) == pytest.approx(before)


def test_the_ball_is_dragged_in_the_plane_of_the_picture_and_follows_the_mouse(studio):
    viewport, document, _ = studio
    select_constraint(viewport, document)
    begin = on_arrow(viewport, "x", 0.0)
    drag(viewport, begin, begin + QPoint(60, -40))
    settle(viewport)
    away = viewport.widget_point(viewport.gizmo().origin).toPoint() - (begin + QPoint(60, -40))
    assert away.manhattanLength() <= 2


def test_escape_during_a_drag_restores_the_target_and_leaves_no_step(studio):
    viewport, document, live = studio
    select_constraint(viewport, document)
    before = target(document)
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.4), release=False)
    assert not np.allclose(target(document), before)
    QTest.keyClick(viewport, Qt.Key.Key_Escape)
    assert target(document) == pytest.approx(before, abs=0)
    assert document.undo_stack.count() == 0
    assert not live.interactive
    QTest.mouseRelease(viewport, LEFT, NONE, QPoint(450, 300))
    assert target(document) == pytest.approx(before, abs=0)


def test_a_drag_ends_quietly_when_what_it_drags_is_removed(studio):
    viewport, document, live = studio
    select_constraint(viewport, document)
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.2), release=False)
    document.remove("constraints", "constraint 0", "Remove")
    send_move(viewport, QPoint(300, 200), LEFT, NONE)
    QTest.mouseRelease(viewport, LEFT, NONE, QPoint(300, 200))
    assert viewport.gesture is None
    assert not live.interactive


def test_shift_moves_a_fifth_as_far_and_ctrl_to_whole_centimetres(studio):
    viewport, document, _ = studio
    select_constraint(viewport, document)
    before = target(document)
    begin, end = on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.7)
    drag(viewport, begin, end)
    whole = target(document)[2] - before[2]
    document.undo_stack.undo()
    drag(viewport, begin, end, modifiers=Qt.KeyboardModifier.ShiftModifier)
    assert target(document)[2] - before[2] == pytest.approx(whole / 5, rel=1e-6)
    document.undo_stack.undo()
    drag(viewport, begin, end, modifiers=Qt.KeyboardModifier.ControlModifier)
    assert target(document)[2] * 100 == pytest.approx(round(target(document)[2] * 100), abs=1e-9)


def test_a_selected_prop_is_moved_by_the_gizmo(studio):
    viewport, document, _ = studio
    prop_id = document.add("props", Prop("Box", position=(0.6, 0.6, 0.2)), "Add a box")
    document.selection.set(("props", prop_id))
    viewport.frame_selection()
    settle(viewport)
    drag(viewport, on_arrow(viewport, "x", 0.7), on_arrow(viewport, "x", 1.3))
    x, y, z = document.project.props[prop_id].position
    assert x > 0.65
    assert (y, z) == (0.6, 0.2)


def test_a_selected_body_is_moved_over_the_ground_with_all_that_it_plays(studio):
    viewport, document, _ = studio
    before = select_performer(viewport, document)
    root = viewport.posed["performer 1"].points[0]
    drag(viewport, on_arrow(viewport, "y", 0.9), on_arrow(viewport, "y", 1.6))
    settle(viewport)
    after = document.project.performers["performer 1"]
    moved = after.position[1] - before.position[1]
    assert moved > 0.05
    assert after.position[0] == pytest.approx(before.position[0])
    assert viewport.posed["performer 1"].points[0] - root == pytest.approx([0.0, moved, 0.0])
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert document.project.performers["performer 1"] == before


def test_a_selected_body_is_turned_by_the_ring_about_where_it_stands(studio):
    viewport, document, _ = studio
    before = select_performer(viewport, document)
    root = viewport.posed["performer 1"].points[0]
    viewport.set_tool("rotate")
    begin, end = on_ring(viewport, "z", 220), on_ring(viewport, "z", 235)
    assert viewport.gizmo().part_at(begin.x(), begin.y()) == "z"
    drag(viewport, begin, end)
    settle(viewport)
    after = document.project.performers["performer 1"]
    assert after.heading - before.heading == pytest.approx(np.radians(15.0), abs=np.radians(2.0))
    assert viewport.posed["performer 1"].points[0] == pytest.approx(root, abs=1e-9)
    assert document.undo_stack.text(0).startswith("Rotate")
    drag(viewport, begin, end, modifiers=Qt.KeyboardModifier.ControlModifier)
    assert document.project.performers["performer 1"].heading - after.heading == pytest.approx(np.radians(15.0))


def test_esc_while_a_body_is_turned_turns_it_back(studio):
    viewport, document, _ = studio
    before = select_performer(viewport, document)
    viewport.set_tool("rotate")
    drag(viewport, on_ring(viewport, "z", 220), on_ring(viewport, "z", 250), release=False)
    assert document.project.performers["performer 1"] != before
    viewport.cancel_gesture()
    assert document.project.performers["performer 1"] == before
    assert document.undo_stack.count() == 0


def test_the_view_leaves_the_keys_of_actions_to_the_key_map(studio):
    viewport, _, _ = studio
    QTest.keyClick(viewport, Qt.Key.Key_Q)
    assert viewport.tool == "move"


def test_the_select_tool_hides_the_gizmo_and_the_move_tool_brings_it_back(studio):
    viewport, document, _ = studio
    select_constraint(viewport, document)
    viewport.set_tool("select")
    assert viewport.gizmo() is None
    viewport.set_tool("move")
    assert viewport.gizmo() is not None


@pytest.mark.parametrize("tool", ["move", "rotate", "scale"])
def test_a_gizmo_under_the_chips_is_seen_and_takes_the_mouse(studio, tool):
    viewport, document, _ = studio
    document.add("props", Prop("Box", position=(0.0, 0.0, 0.5)), "Add")
    [prop_id] = document.project.props
    document.selection.set(("performers", "performer 0"), ("props", prop_id))
    viewport.frame_selection()
    settle(viewport)
    viewport.set_tool(tool)
    word = chip(viewport, "skin_or_bones")
    where = word.geometry().center()
    assert viewport.childAt(where) is word
    centre = viewport.gizmo().centre
    drag(viewport, QPoint(300, 200), QPoint(300, 200) + where - QPoint(*(round(each) for each in centre)), MIDDLE)
    settle(viewport)
    viewport.grab()
    assert viewport.gizmo().part_at(where.x(), where.y()) is not None
    assert viewport.childAt(where) is None
    assert not word.grab().toImage().pixelColor(word.rect().center()).alpha()
    document.selection.clear()
    settle(viewport)
    viewport.grab()
    assert viewport.childAt(where) is word
