"""Saved cameras: stored and recalled by keys, named in the inspector, undone, and written with the project."""

import math
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit

from studio.app.application import show_views
from studio.core.errors import StudioError
from studio.core.stage.saved_camera import CameraPlacement, SavedCamera
from studio.document.stored_cameras import camera_in_slot, give_slot, store_camera
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.viewport.camera import OrbitCamera
from studio.viewport.shots import View
from tests.gui.viewport_use import LEFT, settle
from tests.patience import PATIENCE

LOW = CameraPlacement((0.5, -0.2, 1.1), 2.5, 1.0, -0.4, parallel=True)


@pytest.fixture
def seen(qtbot, window):
    """The window with its 3D view."""
    show_views(window)
    assert window.bench.live.wait_until_solved(PATIENCE)
    qtbot.waitUntil(lambda: bool(window.bench.viewport.posed), timeout=PATIENCE)
    settle(window.bench.viewport)
    return window


def press(window, key, modifiers=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(window.bench.viewport, key, modifiers)
    settle(window.bench.viewport)


def test_a_view_is_stored_by_shift_and_a_key_and_recalled_by_the_key(seen):
    document, viewport = seen.bench.document, seen.bench.viewport
    viewport.set_camera(OrbitCamera.at(LOW))
    press(seen, Qt.Key.Key_F6, Qt.KeyboardModifier.ShiftModifier)
    assert [each.placement for each in document.project.cameras.values()] == [LOW]
    viewport.set_view("top")
    settle(viewport)
    press(seen, Qt.Key.Key_F6)
    assert viewport.placement == LOW
    assert document.history == ("Store Camera 2",)


def test_storing_again_replaces_the_camera_and_undo_brings_the_first_one_back(seen):
    document, viewport = seen.bench.document, seen.bench.viewport
    viewport.set_camera(OrbitCamera.at(LOW))
    press(seen, Qt.Key.Key_F5, Qt.KeyboardModifier.ControlModifier)
    viewport.set_camera(OrbitCamera.at(replace(LOW, distance=7.0)))
    press(seen, Qt.Key.Key_F5, Qt.KeyboardModifier.ControlModifier)
    assert [each.placement.distance for each in document.project.cameras.values()] == [7.0]
    document.undo_stack.undo()
    press(seen, Qt.Key.Key_F5)
    assert viewport.placement == LOW


def test_a_key_without_a_camera_says_how_to_store_one(seen):
    said = []
    seen.bench.message_posted.connect(lambda message: said.append(message.sentence))
    press(seen, Qt.Key.Key_F8)
    assert said == ["Camera slot 4 is empty. Store the view with View > Store camera 4."]


def test_a_camera_gets_a_name_in_the_inspector_and_the_menu_shows_it(seen):
    document = seen.bench.document
    camera_id = store_camera(document, LOW, 3)
    document.selection.set(("cameras", camera_id))
    name = seen.inspector.current_form().findChild(QLineEdit)
    name.setFocus()
    name.selectAll()
    QTest.keyClicks(name, "Low angle")
    QTest.keyClick(name, Qt.Key.Key_Return)
    assert document.project.cameras[camera_id].name == "Low angle"
    seen.actions_by_id.refresh()
    assert seen.actions_by_id.by_id["camera_3"].text() == "Look through Low angle"
    seen.actions_by_id.by_id["cameras"].trigger()
    assert seen.choice_panel.isVisible()
    seen.choice_panel.hide()
    seen.actions_by_id.by_id["delete"].trigger()
    assert not document.project.cameras


def test_a_key_recalls_one_camera_only(seen):
    document = seen.bench.document
    first, second = store_camera(document, LOW, 1), store_camera(document, replace(LOW, distance=9.0))
    give_slot(document, second, 1)
    assert camera_in_slot(document.project, 1) == second
    assert document.project.cameras[first].slot is None
    document.undo_stack.undo()
    assert camera_in_slot(document.project, 1) == first


def test_cameras_are_written_with_the_project(tmp_path, window):
    document = window.bench.document
    store_camera(document, LOW, 4)
    store_camera(document, replace(LOW, parallel=False))
    path = tmp_path / "stage.morpho"
    write_project(path, document.project, new_document_id())
    assert dict(read_project(path).project.cameras) == dict(document.project.cameras)


@pytest.mark.parametrize(
    "wrong",
    [
        {"distance": 0.0},
        {"distance": math.inf},
        {"target": (0.0, math.nan, 1.0)},
        {"azimuth": 1e9},
        {"elevation": math.nan},
    ],
)
def test_a_placement_that_cannot_be_is_refused(wrong):
    with pytest.raises(ValueError, match=r"camera|position|angle"):
        SavedCamera("Broken", replace(LOW, **wrong))
    with pytest.raises(ValueError, match="slot 9"):
        SavedCamera("Broken", LOW, 9)


def test_the_turntable_goes_round_until_a_click_stops_it(seen):
    viewport = seen.bench.viewport
    viewport.set_camera(OrbitCamera.at(LOW))
    seen.actions_by_id.by_id["turntable"].trigger()
    QTest.qWait(120)
    assert viewport.turntable
    assert viewport.view.turning > 0.0
    QTest.mouseClick(viewport, LEFT)
    stopped = viewport.camera
    assert stopped.azimuth > LOW.azimuth
    assert replace(stopped, azimuth=LOW.azimuth) == OrbitCamera.at(LOW)
    QTest.qWait(60)
    assert viewport.camera == stopped
    assert viewport.view == View(stopped, viewport.view.height, trail=viewport.view.trail, time=viewport.view.time)


def test_no_camera_of_that_name_is_a_sentence_with_the_names_there_are():
    from argparse import Namespace
    from pathlib import Path

    from studio.cli.render import placement_of
    from tests.builders import make_project

    project = make_project().with_entity("cameras", "c", SavedCamera("Low", LOW))
    asked = Namespace(camera="Low", source=Path("stage.morpho"))
    assert placement_of(project, asked) == LOW
    asked.camera = "High"
    with pytest.raises(StudioError, match=r"has no camera 'High'\. It has Low\."):
        placement_of(project, asked)
