"""The pose library: a pose is saved at one moment and brings parts of the body to it at another."""

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QDragEnterEvent, QDragMoveEvent, QDropEvent, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit

from studio import api
from studio.app.application import show_viewport
from studio.app.pose_library import PoseLibrary
from studio.core.rotations import from_rotation_vector, inverse, multiply, to_rotation_vector
from studio.core.stage.local_pose import POSE_REGIONS, local_pose
from studio.engine.posed_performer import pose_of
from studio.library.saved_poses import read_pose
from studio.viewport import picking
from tests.patience import PATIENCE

HANDSTAND = api.example_captures_folder() / "handstand.bvh"
SAVED_AT, APPLIED_AT = 2.5, 0.5
SOLVED_SECONDS = 30.0
ON_PLANTED_LEGS = ("Whole body", "Legs")
"""Regions that a correction reaches only above the constraints, as planted feet stay below them."""


@pytest.fixture
def project():
    """A handstand on one body."""
    scene = api.new_scene()
    motion = scene.add_capture(HANDSTAND)
    scene.add_performer(scene.add_character("adult_woman"), motion)
    return scene.project


@pytest.fixture
def poses(window, tmp_path):
    """The pose library of a window whose body is adapted, with a pose in it that was saved by its button."""
    bench = window.bench
    [performer] = bench.document.project.performers
    bench.document.selection.set(("performers", performer))
    library = window.pose_library = PoseLibrary(bench, tmp_path / "poses")
    window.docks["Poses"].setWidget(library.panel)
    window.show_dock("Poses")
    bench.document.playhead.set_time(SAVED_AT)
    assert bench.live.wait_until_solved(SOLVED_SECONDS)
    QTest.mouseClick(library.panel.save, Qt.MouseButton.LeftButton)
    return library


def shown_pose(window, time):
    """Local pose of the body at a moment."""
    bench = window.bench
    assert bench.live.wait_until_solved(SOLVED_SECONDS)
    [key] = bench.document.project.performers
    shown = pose_of(bench.document.project, key, bench.live.result(key), time)
    motion = shown.motion
    height = motion.positions[shown.row, 0, 2] / motion.body.leg_length
    return local_pose(motion.morphology.layout, motion.rotations[shown.row], float(height))


def degrees_apart(first, second, parts):
    """Angle of each part between two poses, in degrees."""
    own, other = (from_rotation_vector(np.array([pose.rotations[part] for part in parts])) for pose in (first, second))
    return np.degrees(np.linalg.norm(to_rotation_vector(multiply(inverse(own), other)), axis=1))


def apply(window, poses, region, fraction):
    window.bench.document.playhead.set_time(APPLIED_AT)
    assert window.bench.live.wait_until_solved(SOLVED_SECONDS)
    poses.panel.poses.setCurrentRow(0)
    poses.panel.region.show_value(region)
    poses.panel.set_blend(fraction)
    QTest.mouseClick(poses.panel.apply, Qt.MouseButton.LeftButton)


@pytest.mark.parametrize("fraction", [1.0, 0.5])
def test_each_part_of_the_body_is_brought_to_a_saved_pose_or_half_way(window, poses, fraction):
    document = window.bench.document
    saved, before = shown_pose(window, SAVED_AT), shown_pose(window, APPLIED_AT)
    plain, steps = document.project, document.undo_stack.count()
    for region, parts in POSE_REGIONS.items():
        apply(window, poses, region, fraction)
        assert document.undo_stack.index() == steps + 1
        [key] = document.project.corrections
        if region in ON_PLANTED_LEGS:
            api.Scene(document).change("corrections", key, above=True)
        after, away = shown_pose(window, APPLIED_AT), degrees_apart(before, saved, parts)
        assert away.max() > 5.0
        np.testing.assert_allclose(degrees_apart(after, saved, parts), (1.0 - fraction) * away, atol=1.0)
        np.testing.assert_allclose(degrees_apart(before, after, parts), fraction * away, atol=1.0)
        if region in ON_PLANTED_LEGS:
            wanted = before.hips_height + fraction * (saved.hips_height - before.hips_height)
            assert after.hips_height == pytest.approx(wanted, abs=1e-3)
        while document.undo_stack.index() > steps:
            document.undo_stack.undo()
        assert document.project == plain


def test_a_pose_applied_again_changes_the_same_correction_and_stays(window, poses):
    saved = shown_pose(window, SAVED_AT)
    apply(window, poses, "Arms", 0.5)
    apply(window, poses, "Arms", 1.0)
    [correction] = window.bench.document.project.corrections.values()
    assert len(correction.keys.times) == 1
    after = shown_pose(window, APPLIED_AT)
    assert degrees_apart(after, saved, POSE_REGIONS["Arms"]).max() < 1.0


def test_the_name_is_typed_in_the_list_and_the_file_has_it(qtbot, window, poses, tmp_path):
    editor = poses.panel.poses.findChild(QLineEdit)
    QTest.keyClicks(editor, "Bow")
    QTest.keyClick(editor, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: [path.name for path in (tmp_path / "poses").iterdir()] == ["bow.json"], timeout=PATIENCE)
    assert poses.panel.poses.item(0).text() == "Bow"
    assert not window.bench.document.project.corrections
    QTest.mouseClick(poses.panel.delete, Qt.MouseButton.LeftButton)
    assert not list((tmp_path / "poses").iterdir())
    assert not poses.panel.poses.count()


def test_a_pose_is_dragged_onto_a_body_which_takes_it_as_one_undo_step(window, poses, monkeypatch, tmp_path):
    bench, view = window.bench, poses.panel.poses
    show_viewport(window)
    [key] = bench.document.project.performers
    bench.document.playhead.set_time(APPLIED_AT)
    assert bench.live.wait_until_solved(SOLVED_SECONDS)
    saved = read_pose(next((tmp_path / "poses").glob("*.json"))).pose
    begun = []
    view.startDrag = begun.append
    start = view.visualItemRect(view.item(0)).center()
    QTest.mousePress(view.viewport(), Qt.MouseButton.LeftButton, pos=start)
    for step in (20, 40):
        place = QPointF(start + QPoint(step, 0))
        at, held, keys = view.viewport().mapToGlobal(place), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        QApplication.sendEvent(view.viewport(), QMouseEvent(QEvent.Type.MouseMove, place, at, held, held, keys))
    QTest.mouseRelease(view.viewport(), Qt.MouseButton.LeftButton, pos=start)
    assert begun
    monkeypatch.setattr(picking, "body_at", lambda *_: key)
    content = view.mimeData([view.item(0)])
    place, copy = QPoint(200, 200), Qt.DropAction.CopyAction
    for event in (
        QDragEnterEvent(place, copy, content, held, keys),
        QDragMoveEvent(place, copy, content, held, keys),
        QDropEvent(QPointF(place), copy, content, held, keys),
    ):
        event.ignore()
        QApplication.sendEvent(bench.viewport, event)
        assert event.isAccepted()
    assert bench.document.history == ("Apply pose 'Pose 1'",)
    assert [each.name for each in bench.document.project.corrections.values()] == ["Pose 1"]
    assert degrees_apart(shown_pose(window, APPLIED_AT), saved, POSE_REGIONS["Arms"]).max() < 1.0


def test_each_pose_has_a_picture_of_its_own(window, poses):
    window.bench.document.playhead.set_time(0.0)
    assert window.bench.live.wait_until_solved(SOLVED_SECONDS)
    QTest.mouseClick(poses.panel.save, Qt.MouseButton.LeftButton)
    icons = [poses.panel.poses.item(row).icon().pixmap(72).toImage() for row in range(2)]
    assert icons[0] != icons[1]
    for icon in icons:
        assert sum(icon.pixelColor(x, y).alpha() > 0 for x in range(72) for y in range(72)) > 200


def test_without_a_body_that_plays_a_sentence_says_what_to_do(window, poses):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    [key] = window.bench.document.project.performers
    window.bench.document.remove("performers", key, "Delete performer")
    QTest.mouseClick(poses.panel.apply, Qt.MouseButton.LeftButton)
    assert said
    assert not window.bench.document.project.corrections
