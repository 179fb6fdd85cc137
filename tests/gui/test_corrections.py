"""Manual corrections by the mouse: a joint is turned and pulled in the view, its bar and keys moved on the timeline."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio import api
from studio.app.application import show_views
from studio.core.body.canonical import BodyPart
from studio.core.stage.correction import Correction
from studio.core.stage.holding import REACH_SPEED
from studio.panels.correction_editor import CorrectionEditor
from studio.panels.fields import NumberField
from studio.timeline.shown import ItemPart
from studio.timeline.tracks.correction import handle_points
from tests.gui.viewport_use import LEFT, NONE, chip, drag, joint_pixel, on_arrow, settle
from tests.patience import PATIENCE, SECONDS

WALK = api.example_captures_folder() / "walk_turn.bvh"
TIME = 0.8


@pytest.fixture
def project():
    """A walk on one body."""
    scene = api.new_scene()
    motion = scene.add_capture(WALK)
    scene.add_performer(scene.add_character("adult_woman"), motion)
    return scene.project


@pytest.fixture
def posing(window, qtbot):
    """The window at a moment of the walk, with its viewport in the mode that corrects poses."""
    bench = window.bench
    show_views(window)
    assert bench.live.wait_until_solved(SECONDS)
    qtbot.waitUntil(lambda: bool(bench.viewport.posed), timeout=PATIENCE)
    bench.document.playhead.set_time(TIME)
    bench.viewport.set_view("perspective")
    settle(bench.viewport)
    bench.viewport.setFocus()
    QTest.keyClick(window, "p")
    assert bench.viewport.correcting
    return window


def the_correction(window) -> Correction:
    [made] = window.bench.document.project.corrections.values()
    return made


def swing_time(project):
    """Seconds in the middle of the longest time in which the right foot is in the air."""
    [motion] = project.motions
    frames = {frame for each in project.contacts_of(motion).values() if each.point.side == 1 and each.point.is_foot
              for frame in range(each.first, each.last + 1)}  # fmt: skip
    stands = sorted(frames)
    before, after = max(pairwise(stands), key=lambda pair: pair[1] - pair[0])
    return (before + after) / 2 / next(iter(project.captures.values())).frame_rate


def pick(window, name):
    viewport = window.bench.viewport
    [performer] = window.bench.document.project.performers
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, performer, name))
    settle(viewport)
    assert viewport.joint_picked.joint.name == name
    return performer


def turn_by_ring(viewport, degrees):
    """Drag the ring that is seen best so many degrees."""
    gizmo = viewport.gizmo()
    part = max("xyz", key=lambda each: abs(float(gizmo.axis(each) @ gizmo.sight)))
    front, corners = gizmo.in_front(part), gizmo.ring(part)
    sides = [side for side in np.flatnonzero(front) if gizmo.part_at(*np.rint(corners[side])) == part]
    side = sides[len(sides) // 2]
    count = len(corners)
    begin, end = corners[side], corners[(side + round(degrees / 360 * count)) % count]
    drag(viewport, QPoint(*np.rint(begin).astype(int).tolist()), QPoint(*np.rint(end).astype(int).tolist()))
    settle(viewport)


def test_an_elbow_of_a_walk_is_corrected_for_a_moment_by_three_clicks(posing, qtbot):
    bench, viewport = posing.bench, posing.bench.viewport
    document, performer = bench.document, pick(posing, "left elbow")
    viewport.frame_selection()
    settle(viewport)
    plain = bench.live.result(performer)
    QTest.keyClick(posing, "e")
    steps = document.undo_stack.count()
    turn_by_ring(viewport, 40)
    assert document.undo_stack.count() == steps + 1
    made = the_correction(posing)
    assert made.keys.parts == (BodyPart.LEFT_FOREARM,)
    assert not document.project.constraints
    assert viewport.joint_picked is not None
    assert bench.live.wait_until_solved(SECONDS)
    posed = bench.live.result(performer)
    off = np.linalg.norm(np.asarray(posed.positions[:]) - np.asarray(plain.positions[:]), axis=2).max(axis=1)
    times = plain.composite.timing.begin + np.arange(len(off)) / plain.frame_rate
    assert off[np.abs(times - TIME).argmin()] > 0.05
    outside = (times < made.activation.start) | (times > made.activation.end)
    assert outside[np.abs(times - TIME) > 0.5].all()
    assert off[outside].max() < 1e-5
    qtbot.waitUntil(lambda: isinstance(posing.inspector.editor, CorrectionEditor), timeout=PATIENCE)
    document.undo_stack.undo()
    assert not document.project.corrections


@pytest.mark.parametrize(
    ("name", "axis", "sign"),
    [("left wrist", "z", 1.0), ("right ankle", "z", 1.0), ("pelvis", "z", -1.0), ("head", "x", 1.0)],
)
def test_a_hand_a_foot_the_hips_and_the_head_are_pulled_where_the_mouse_goes(posing, name, axis, sign):
    viewport = posing.bench.viewport
    if "ankle" in name:
        posing.bench.document.playhead.set_time(swing_time(posing.bench.document.project))
        settle(viewport)
    performer = pick(posing, name)
    QTest.keyClick(posing, "w")
    before, gizmo = viewport.movable().place, viewport.gizmo()
    grip = on_arrow(viewport, axis, 0.8)
    along = sign * (gizmo.tips["xyz".index(axis)] - gizmo.centre)
    step = np.rint(0.2 * along).astype(int).tolist()
    drag(viewport, grip, grip + QPoint(*step))
    settle(viewport)
    assert the_correction(posing).performer_id == performer
    moved = sign * float((viewport.movable().place - before) @ gizmo.axes["xyz".index(axis)])
    wanted = 0.2 * gizmo.length
    assert moved == pytest.approx(wanted, abs=0.35 * wanted)


def pull_up(viewport, share):
    """Pull the vertical arrow up so many of its lengths."""
    gizmo, grip = viewport.gizmo(), on_arrow(viewport, "z", 0.8)
    drag(viewport, grip, grip + QPoint(*np.rint(share * (gizmo.tips[2] - gizmo.centre)).astype(int).tolist()))
    settle(viewport)


def test_a_drag_outside_the_range_of_the_selected_correction_makes_another_one(posing):
    bench, viewport = posing.bench, posing.bench.viewport
    document = bench.document
    pick(posing, "left wrist")
    QTest.keyClick(posing, "w")
    pull_up(viewport, 0.2)
    [first] = document.selection.of("corrections")
    before = document.project.corrections[first]
    later = before.activation.end + 0.4
    document.playhead.set_time(later)
    settle(viewport)
    pull_up(viewport, 0.2)
    assert document.project.corrections[first] == before
    [other] = document.selection.of("corrections")
    assert other != first
    assert document.project.corrections[other].keys.times == (pytest.approx(later),)


def test_a_drag_where_the_correction_is_disabled_makes_another_one_that_moves_the_hand(posing):
    bench, viewport = posing.bench, posing.bench.viewport
    document = bench.document
    pick(posing, "left wrist")
    QTest.keyClick(posing, "w")
    pull_up(viewport, 0.2)
    [first] = document.selection.of("corrections")
    off = replace(document.project.corrections[first], enabled=False)
    document.replace("corrections", first, off, "Disable")
    settle(viewport)
    pull_up(viewport, 0.2)
    assert document.project.corrections[first] == off
    assert len(document.project.corrections) == 2


def test_fields_of_the_form_key_their_own_correction_wherever_the_playhead_is(posing, qtbot):
    document = posing.bench.document
    [performer] = document.project.performers
    key = api.Scene(document).correct_pose(performer, TIME, {"left_forearm": (0.5, 0.0, 0.0)})
    document.selection.set(("performers", performer), ("corrections", key))
    document.playhead.set_time(TIME + 1.0)
    qtbot.waitUntil(lambda: isinstance(posing.inspector.editor, CorrectionEditor), timeout=PATIENCE)
    field = next(one for one in posing.inspector.editor.findChildren(NumberField) if "x" in one.accessibleName())
    field.setFocus()
    field.selectAll()
    QTest.keyClicks(field, "30")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert the_correction(posing).keys.times == (TIME, pytest.approx(TIME + 1.0))


@pytest.mark.parametrize("drags", [1, 2])
def test_a_correction_by_the_mouse_fades_as_slowly_as_its_hand_needs(posing, drags):
    """Also one that was small at first, and was dragged on."""
    bench, viewport = posing.bench, posing.bench.viewport
    performer = pick(posing, "left wrist")
    plain = bench.live.result(performer)
    wrist = plain.morphology.layout.wrist_point(0)

    def peak(motion):
        steps = np.linalg.norm(np.diff(np.asarray(motion.positions[:, wrist]), axis=0), axis=1)
        return steps.max() * motion.frame_rate

    QTest.keyClick(posing, "w")
    for each in range(drags):
        pull_up(viewport, 0.1 if each < drags - 1 else 0.8)
        assert bench.live.wait_until_solved(SECONDS)
    assert bench.document.undo_stack.count() == drags
    assert len(bench.document.project.corrections) == 1
    posed = bench.live.result(performer)
    lifted = np.linalg.norm(np.asarray(posed.positions[:, wrist]) - np.asarray(plain.positions[:, wrist]), axis=1)
    assert lifted.max() > 0.25
    assert peak(posed) < 1.2 * max(peak(plain), REACH_SPEED)


def test_fades_that_the_user_has_set_are_kept_by_the_next_drag(posing):
    bench, viewport = posing.bench, posing.bench.viewport
    document = bench.document
    pick(posing, "left wrist")
    QTest.keyClick(posing, "w")
    pull_up(viewport, 0.1)
    [key] = document.project.corrections
    made = document.project.corrections[key]
    trimmed = made.activation.with_times(TIME - 0.15, TIME - 0.05, TIME + 0.05, TIME + 0.15)
    document.replace("corrections", key, replace(made, activation=trimmed), "Trim")
    settle(viewport)
    pull_up(viewport, 1.2)
    assert the_correction(posing).activation == trimmed


def test_a_drag_that_is_cancelled_leaves_no_correction(posing):
    viewport, document = posing.bench.viewport, posing.bench.document
    pick(posing, "left wrist")
    QTest.keyClick(posing, "w")
    steps = document.undo_stack.count()
    upwards = on_arrow(viewport, "z", 0.8)
    drag(viewport, upwards, upwards - QPoint(0, 12), release=False)
    assert document.project.corrections
    viewport.cancel_gesture()
    assert not document.project.corrections
    assert document.undo_stack.count() == steps


def bar(window):
    canvas = window.bench.timeline.tracks
    [key] = window.bench.document.project.corrections
    return canvas, canvas.sheet.rect(canvas.sheet.find("corrections", key)), key


def test_the_bar_on_the_timeline_moves_with_its_keys_and_its_ends_are_dragged(posing, qtbot):
    bench = posing.bench
    [performer] = bench.document.project.performers
    api.Scene(bench.document).correct_pose(performer, TIME, {"left_forearm": (0.5, 0.0, 0.0)})
    QTest.qWait(50)
    canvas, row, key = bar(posing)
    before = the_correction(posing)
    points = handle_points(canvas.sheet.context, row, before.activation)
    middle = QPoint(round((points[ItemPart.START].x() + points[ItemPart.FULL].x()) / 2), row.bottom() - 8)
    drag(canvas, middle, middle + QPoint(40, 0))
    after = the_correction(posing)
    later = after.activation.start - before.activation.start
    assert later > 0.0
    assert after.keys.times[0] - before.keys.times[0] == pytest.approx(later)
    end = handle_points(canvas.sheet.context, row, after.activation)[ItemPart.END].toPoint()
    drag(canvas, end, end + QPoint(30, 0))
    assert the_correction(posing).activation.end > after.activation.end
    assert the_correction(posing).activation.start == after.activation.start
    diamond = QPoint(round(canvas.axis.x_of_time(after.keys.times[0])), row.center().y())
    QTest.mouseClick(canvas, LEFT, NONE, diamond)
    assert [each.field.entity_id for each in bench.document.keys.items] == [key]
    QTest.keyClick(canvas, Qt.Key.Key_Delete)
    assert not bench.document.project.corrections


def test_s_sets_a_key_of_the_selected_correction_and_its_range_grows_to_it(posing):
    bench = posing.bench
    [performer] = bench.document.project.performers
    key = api.Scene(bench.document).correct_pose(performer, TIME, {"left_forearm": (0.5, 0.0, 0.0)})
    bench.document.selection.set(("performers", performer), ("corrections", key))
    bench.document.playhead.set_time(TIME + 0.5)
    QTest.keyClick(posing, "s")
    made = the_correction(posing)
    assert len(made.keys.times) == 2
    assert made.activation.end > TIME + 0.5


def test_pose_correction_ends_with_its_project_and_its_menu_follows_the_chip(posing):
    viewport, action = posing.bench.viewport, posing.actions_by_id.by_id["correct_pose"]
    assert action.isChecked()
    posing.bench.document.new(posing.bench.document.project)
    assert not viewport.correcting
    assert not action.isChecked()
    QTest.mouseClick(chip(viewport, "pose_joints_with_the_gizmo_on_a_correction_layer"), LEFT)
    assert viewport.correcting
    assert action.isChecked()
