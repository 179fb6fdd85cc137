"""The viewport: what its camera shows, and who moves it."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.stage.project import Motion
from studio.core.stage.prop import Prop
from studio.viewport.follow_camera import FollowCamera
from tests.builders import make_project
from tests.gui.viewport_use import LEFT, MIDDLE, NONE, drag, settle


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


def test_the_camera_stays_when_another_clip_comes_to_be_the_first_of_the_row(studio):
    viewport, document, _ = studio
    motion_id = document.add("motions", Motion("Again", "capture"), "Import")
    performer = document.project.performers["performer 0"]
    first = performer.clips[0]
    row = first, replace(first, motion_id=motion_id, start=first.start + 1.0, id="second")
    document.replace("performers", "performer 0", replace(performer, clips=row), "Add")
    settle(viewport)
    away = replace(viewport.camera, target=(4.0, 0.0, 0.9))
    viewport.set_camera(away)
    later = replace(first, start=first.start + 2.0)
    document.replace("performers", "performer 0", replace(performer, clips=(row[1], later)), "Move")
    settle(viewport)
    assert viewport.camera == away


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


def test_the_camera_follows_who_is_driven_live_and_not_its_clips(studio):
    viewport, _, _ = studio
    pose = viewport.posed["performer 1"]
    away = replace(pose.motion, positions=pose.motion.positions + np.array([2.0, -1.0, 0.0]))
    driven = replace(pose, motion=away, frames_around=pose.over_time)
    follower = FollowCamera()
    begin = follower.moved(viewport.camera, "performer 1", pose)
    gone = np.subtract(follower.moved(begin, "performer 1", driven).target, begin.target)
    assert gone == pytest.approx(pose.placement.rotation @ (2.0, -1.0, 0.0))


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
    viewport.set_view("front")
    settle(viewport)
    assert viewport.camera.axes[2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    viewport.set_view("top")
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
    viewport.frame_all()
    settle(viewport)
    assert seen()


def test_the_wheel_keeps_what_is_under_the_mouse_there(studio):
    viewport, _, _ = studio
    place = np.array(viewport.camera.target) + 0.4 * viewport.camera.axes[0]
    before = viewport.widget_point(place)
    QTest.wheelEvent(viewport.windowHandle(), before, QPoint(0, 240))
    assert (viewport.widget_point(place) - before).manhattanLength() < 0.5


def test_the_first_view_is_taken_anew_in_a_much_smaller_window_but_not_for_a_line_of_words(studio):
    viewport, _, _ = studio
    viewport.resize(900, 600)
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
