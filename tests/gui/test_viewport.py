"""The viewport driven as a person would: mouse and keys on the widget, looking at the document."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton

from studio.core.project import Motion
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.engine.empty_stage import HIDDEN
from studio.viewport.body_points import body_joints
from studio.viewport.gizmo import AXES, RING
from studio.viewport.widget import Viewport
from tests.builders import make_project
from tests.viewport.standing import StandingLive

LEFT, MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton
NONE = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def studio(qtbot):
    document = Document(make_project(characters=2, constraints=1))
    live = StandingLive(document)
    viewport = Viewport(document, live)
    viewport.resize(900, 600)
    with qtbot.waitSignal(viewport.started):
        viewport.show()
    document.playhead.set_time(0.2)
    settle(viewport)
    yield viewport, document, live
    viewport.close()
    viewport.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


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
    place = gizmo.centre + share * (gizmo.tips[AXES.index(axis)] - gizmo.centre)
    return QPoint(*(round(float(number)) for number in place))


def target(document):
    return np.array(document.project.constraints["constraint 0"].target)


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
    QTest.keyClick(viewport, Qt.Key.Key_C)
    collection, constraint_id = document.selection.current
    constraint = document.project.constraints[constraint_id]
    assert collection == "constraints"
    assert (constraint.name, constraint.priority) == ("Left wrist", 1)
    layout = place.motion.morphology.layout
    [handle] = [one for one in viewport.handles() if one.main and one.constraint_id == constraint_id]
    assert handle.target == pytest.approx(place.motion.positions[place.row, layout.wrist(0)])
    assert constraint.activation.at(0.2) == 1.0
    assert constraint.activation.start >= 0.0
    assert constraint.activation.end <= 29 / 60 + 1e-12
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert list(document.project.constraints) == ["constraint 0"]


def wrists(viewport):
    """Where each performer has the right wrist on the stage."""
    return {key: pose.points[pose.motion.morphology.layout.wrist(1)] for key, pose in viewport.posed.items()}


def targets_of(viewport, constraint_id):
    return {one.performer_id: one.target for one in viewport.handles() if one.constraint_id == constraint_id}


def test_each_body_has_the_new_target_at_its_own_joint(studio):
    viewport, _, _ = studio
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    constraint_id = viewport.add_constraint_at_pick()
    places = targets_of(viewport, constraint_id)
    for performer_id, wrist in wrists(viewport).items():
        assert places[performer_id] == pytest.approx(wrist)


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


def test_another_motion_is_framed_and_the_camera_of_the_user_is_left_alone_by_other_edits(studio):
    viewport, document, _ = studio
    document.playhead.set_time(0.0)
    away = replace(viewport.camera, target=(40.0, 0.0, 0.9))
    viewport.set_camera(away)
    document.add("props", Prop("Box"), "Add a box")
    settle(viewport)
    assert viewport.camera == away
    motion_id = document.add("motions", Motion("Again", "capture"), "Import")
    with document.group("Import"):
        for key, performer in document.project.performers.items():
            played = replace(performer, clips=(replace(performer.clips[0], motion_id=motion_id),))
            document.replace("performers", key, played, "Import")
    settle(viewport)
    pixels, depth = viewport.camera.project(np.concatenate([p.points for p in viewport.posed.values()]), (900, 600))
    assert (depth > 0).all()
    assert ((pixels > 0) & (pixels < (900, 600))).all()


def test_the_camera_follows_the_selected_character_and_stays_when_told_to(studio):
    viewport, document, _ = studio
    document.selection.set(("performers", "performer 1"))
    viewport.set_following(True)
    document.playhead.set_frame(0)
    settle(viewport)
    begin, start = viewport.camera, viewport.posed["performer 1"].points[0]
    assert viewport.camera.target[:2] == pytest.approx(start[:2], abs=0.2)
    document.playhead.set_frame(29)
    settle(viewport)
    gone = np.array(viewport.camera.target) - begin.target
    assert gone[0] > 0.05
    assert gone[1:] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert (viewport.camera.azimuth, viewport.camera.distance) == (begin.azimuth, begin.distance)
    viewport.set_following(False)
    document.playhead.set_frame(0)
    settle(viewport)
    assert viewport.camera.target[0] == pytest.approx(begin.target[0] + gone[0])


def test_a_double_click_on_a_joint_constrains_it(studio):
    viewport, document, _ = studio
    QTest.mouseDClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 1", "left ankle"))
    assert [one.name for one in document.project.constraints.values()] == ["Target 0", "Left ankle"]


def test_a_click_on_a_target_selects_its_constraint_and_a_click_on_nothing_lets_go(studio):
    viewport, document, _ = studio
    handle = next(one for one in viewport.handles() if one.main)
    QTest.mouseClick(viewport, LEFT, NONE, viewport.widget_point(handle.target).toPoint())
    assert document.selection.current == ("constraints", "constraint 0")
    QTest.mouseClick(viewport, LEFT, NONE, QPoint(880, 300))
    assert document.selection.items == ()


@pytest.mark.parametrize("axis", AXES)
def test_dragging_an_arrow_moves_the_target_along_that_axis_alone_in_one_step(studio, axis):
    viewport, document, live = studio
    select_constraint(viewport, document)
    before, gizmo = target(document), viewport.gizmo()
    begin, end = on_arrow(viewport, axis, 0.7), on_arrow(viewport, axis, 1.5)
    drag(viewport, begin, end)
    index = AXES.index(axis)
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


def select_performer(viewport, document):
    document.selection.set(("performers", "performer 1"))
    viewport.frame_selection()
    settle(viewport)
    return document.project.performers["performer 1"]


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
    begin, end = on_ring(viewport, 29), on_ring(viewport, 31)
    assert viewport.gizmo().part_at(begin.x(), begin.y()) == RING
    drag(viewport, begin, end)
    settle(viewport)
    after = document.project.performers["performer 1"]
    assert after.heading - before.heading == pytest.approx(np.radians(15.0), abs=np.radians(2.0))
    assert viewport.posed["performer 1"].points[0] == pytest.approx(root, abs=1e-9)
    assert document.undo_stack.text(0).startswith("Turn")
    drag(viewport, begin, end, modifiers=Qt.KeyboardModifier.ControlModifier)
    assert document.project.performers["performer 1"].heading - after.heading == pytest.approx(np.radians(15.0))


def test_esc_while_a_body_is_turned_turns_it_back(studio):
    viewport, document, _ = studio
    before = select_performer(viewport, document)
    drag(viewport, on_ring(viewport, 29), on_ring(viewport, 33), release=False)
    assert document.project.performers["performer 1"] != before
    viewport.cancel_gesture()
    assert document.project.performers["performer 1"] == before
    assert document.undo_stack.count() == 0


def on_ring(viewport, place):
    return QPoint(*(round(float(number)) for number in viewport.gizmo().ring[place]))


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


def test_the_select_tool_hides_the_gizmo_and_w_brings_it_back(studio):
    viewport, document, _ = studio
    select_constraint(viewport, document)
    QTest.keyClick(viewport, Qt.Key.Key_Q)
    assert viewport.gizmo() is None
    QTest.keyClick(viewport, Qt.Key.Key_W)
    assert viewport.gizmo() is not None


@pytest.mark.parametrize(
    ("button", "modifiers"),
    [
        (LEFT, Qt.KeyboardModifier.AltModifier),
        (MIDDLE, NONE),
        (Qt.MouseButton.RightButton, Qt.KeyboardModifier.AltModifier),
    ],
)
def test_orbit_pan_and_zoom_move_the_camera_and_leave_the_document_alone(studio, button, modifiers):
    viewport, document, _ = studio
    project, camera, items = document.project, viewport.camera, document.selection.items
    drag(viewport, QPoint(400, 300), QPoint(460, 330), button, modifiers)
    assert viewport.camera != camera
    assert document.project is project
    assert document.undo_stack.count() == 0
    assert document.selection.items == items


def test_the_wheel_zooms_and_the_views_glide_to_where_they_say(studio):
    viewport, _, _ = studio
    near = viewport.camera.distance
    QTest.wheelEvent(viewport.windowHandle(), QPoint(450, 300), QPoint(0, 120))
    assert viewport.camera.distance < near
    QTest.keyClick(viewport, Qt.Key.Key_1)
    settle(viewport)
    assert viewport.camera.axes[2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    QTest.keyClick(viewport, Qt.Key.Key_7)
    settle(viewport)
    assert viewport.camera.axes[2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)


def test_the_first_view_waits_for_every_body_unless_the_user_has_moved_it(studio):
    viewport, document, live = studio
    live.late = {"performer 1"}
    document.new(make_project(characters=2))
    settle(viewport)
    alone = viewport.camera
    live.late = set()
    live.adapt()
    QTest.qWait(30)
    together = viewport.camera
    assert together.distance > alone.distance
    live.adapt()
    QTest.qWait(30)
    assert viewport.camera == together
    live.late = {"performer 1"}
    document.new(make_project(characters=2))
    settle(viewport)
    drag(viewport, QPoint(400, 300), QPoint(460, 330), MIDDLE)
    moved = viewport.camera
    live.late = set()
    live.adapt()
    QTest.qWait(30)
    assert viewport.camera == moved


def test_the_opening_camera_and_frame_all_show_every_body_whole(studio):
    viewport, _, _ = studio

    def seen():
        points = np.concatenate([pose.points for pose in viewport.posed.values()])
        pixels = viewport.camera.project(points, viewport.view_size)[0]
        return ((pixels >= 0) & (pixels <= viewport.view_size)).all()

    assert seen()
    viewport.set_camera(viewport.camera.zoomed(6.0))
    assert not seen()
    QTest.keyClick(viewport, Qt.Key.Key_A)
    settle(viewport)
    assert seen()


def test_the_problem_chip_goes_to_the_worst_frame_and_selects_the_constraint(studio):
    viewport, document, live = studio
    live.adapt()
    settle(viewport)
    problem = chip(viewport, "most_important_problem")
    assert problem.isVisible()
    assert "short of 'Target 0' at frame" in problem.text()
    QTest.mouseClick(problem, LEFT)
    assert document.playhead.frame == int(problem.text().rsplit(" ", 1)[1])
    assert document.selection.current == ("constraints", "constraint 0")


def test_chips_turn_bones_ghost_and_parallel_view_on_and_off(studio):
    viewport, _, _ = studio
    picture = viewport.grab().toImage()
    for name in ("skin_or_bones", "ghost_of_the_source", "perspective_or_parallel_view"):
        QTest.mouseClick(chip(viewport, name), LEFT)
        settle(viewport)
        assert viewport.grab().toImage() != picture
    assert viewport.ghost_shown
    assert viewport.camera.parallel
    assert chip(viewport, "skin_or_bones").text() == "Bones"
    assert chip(viewport, "perspective_or_parallel_view").text() == "Parallel"


def test_everything_to_click_has_an_accessible_name_and_can_be_reached_by_tab(studio):
    viewport, _, _ = studio
    assert viewport.accessibleName()
    for button in viewport.findChildren(QPushButton):
        assert button.accessibleName()
        assert button.focusPolicy() & Qt.FocusPolicy.TabFocus


def test_the_bodies_follow_the_playhead_frame_by_frame(studio):
    viewport, document, _ = studio
    document.playhead.set_frame(5)
    settle(viewport)
    shown = viewport.posed["performer 0"]
    assert shown.row == 5
    document.playhead.set_time(5.3 / 60)
    settle(viewport)
    assert viewport.posed["performer 0"] is shown
    document.playhead.set_time(5.7 / 60)
    settle(viewport)
    assert viewport.posed["performer 0"].row == 6


def test_the_wheel_keeps_what_is_under_the_mouse_there(studio):
    viewport, _, _ = studio
    place = np.array(viewport.camera.target) + 0.4 * viewport.camera.axes[0]
    before = viewport.widget_point(place)
    QTest.wheelEvent(viewport.windowHandle(), before, QPoint(0, 240))
    assert (viewport.widget_point(place) - before).manhattanLength() < 0.5


def test_a_narrow_view_leaves_out_chips_instead_of_cutting_them(studio):
    viewport, _, _ = studio
    viewport.resize(300, 300)
    settle(viewport)
    for button in (one for one in viewport.findChildren(QPushButton) if one.isVisible()):
        assert button.width() >= button.sizeHint().width()
        assert viewport.rect().contains(button.geometry())


def test_another_project_takes_the_place_of_this_one(studio):
    viewport, document, _ = studio
    document.new(make_project(characters=1))
    settle(viewport)
    assert list(viewport.posed) == ["performer 0"]
    document.new(make_project(characters=0, constraints=0))
    settle(viewport)
    assert viewport.posed == {}


def test_the_image_for_thumbnails_has_the_size_of_the_widget_and_no_chips(studio):
    viewport, _, _ = studio
    image = viewport.grab_image()
    assert (image.width(), image.height()) == (900, 600)
    assert image.pixelColor(30, 23).lightness() < 60


def test_a_viewport_opens_and_closes_many_times_and_leaves_document_and_engine_usable(qtbot):
    document = Document(make_project(characters=1))
    live = StandingLive(document)
    for _ in range(4):
        viewport = Viewport(document, live)
        viewport.resize(300, 200)
        viewport.show()
        viewport.start()
        viewport.close()
        viewport.stop()
        viewport.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        document.playhead.step(1)
        live.adapt()
        QTest.qWait(5)
    assert document.playhead.frame == 4
    assert all(live.result(performer) is not None for performer in document.project.performers)


def test_a_viewport_closed_before_it_has_started_stays_closed(qtbot):
    document = Document(make_project(characters=1))
    viewport = Viewport(document, StandingLive(document))
    started = []
    viewport.started.connect(lambda: started.append(True))
    viewport.show()
    viewport.stop()
    viewport.repaint()
    QTest.qWait(20)
    assert not started
    viewport.close()
    viewport.deleteLater()


def test_a_body_whose_motion_is_not_there_yet_stands_in_its_rest_pose(studio):
    viewport, document, live = studio
    live.late = {"performer 1"}
    viewport.show_again()
    settle(viewport)
    assert set(viewport.posed) == {"performer 0"}
    assert set(viewport.resting) == {"performer 1"}
    [placed] = viewport.resting.values()
    assert placed.points[0, 1] == pytest.approx(document.project.performers["performer 1"].position[1])


def test_while_nobody_performs_the_view_says_what_is_under_way_and_else_what_to_do(studio):
    viewport, document, live = studio
    assert viewport.notice == ""
    live.late = set(document.project.performers)
    viewport.show_again()
    settle(viewport)
    viewport.show_progress("Opening walk.bvh", 0.4)
    assert viewport.notice == "Opening walk.bvh"
    viewport.show_progress("", 0.0)
    assert viewport.notice == ""
    for key, performer in document.project.performers.items():
        document.replace("performers", key, replace(performer, visible=False), "Hide")
    assert viewport.notice == HIDDEN


def test_the_first_view_is_taken_anew_in_a_much_smaller_window_but_not_for_a_line_of_words(studio):
    viewport, _, _ = studio
    first = viewport.camera
    viewport.resize(900, 570)
    assert viewport.camera == first
    viewport.resize(470, 260)
    assert viewport.camera != first
    heads = [
        viewport.widget_point(one.points[one.motion.morphology.layout.head_end]) for one in viewport.posed.values()
    ]
    assert all(head.y() > 50 for head in heads)
    looked_at = viewport.camera.panned(0.5, 0.0)
    viewport.set_camera(looked_at)
    viewport.resize(900, 600)
    assert viewport.camera == looked_at


def test_the_playhead_may_move_when_what_is_shown_is_gone(studio):
    viewport, document, _ = studio
    assert viewport.posed
    document.new(make_project(characters=0, constraints=0, contacts=0))
    document.playhead.set_time(0.1)
    settle(viewport)
    assert not viewport.posed
