"""Body maps by mouse: a part is clicked, then its joint; saved, loaded and chosen by names."""

import json
import threading
import time
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.app import character_import
from studio.core.body.canonical import BodyPart
from studio.core.mesh.rig import rig_body_map
from studio.io.figure.body import remapped_character
from studio.io.figure.body_maps import naming_families
from studio.io.importing import ImportOptions, load_character
from studio.panels.body_map_section import BodyMapSection, body_of_capture, body_of_character
from studio.panels.constraint_editors.body_figure import BODY_FIGURE_SCALE, SEGMENT_SHAPES
from tests.builders import make_capture
from tests.io.character_files import Gltf
from tests.io.test_remapped import SWAPPED_ARMS
from tests.patience import SECONDS

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def hero(tmp_path):
    path = tmp_path / "hero.glb"
    path.write_bytes(Gltf().glb())
    return load_character(path, ImportOptions())


@pytest.fixture
def section(window, hero):
    """The section of a character whose arms are exchanged, on show in the inspector."""
    document = window.bench.document
    key = document.add("characters", remapped_character(hero.character, hero.joints | SWAPPED_ARMS), "Add")
    document.selection.set(("characters", key))
    [found] = [each for each in window.findChildren(BodyMapSection) if each.isVisibleTo(window)]
    found._unfold()
    found.resize(320, 900)
    return found, document, key


def map_by_mouse(section, part, joint):
    QTest.mouseClick(section._parts, LEFT, pos=(SEGMENT_SHAPES[part].center() * BODY_FIGURE_SCALE).toPoint())
    click_joint(section, joint)


def click_joint(section, joint):
    QTest.mouseClick(section._joints, LEFT, pos=section._joints.place_of(joint).toPoint())
    wait_for_tasks(section)


def wait_for_tasks(section):
    """Wait until nothing runs beside the window."""
    runner = section.window().bench.runner
    end = time.monotonic() + SECONDS
    while runner.running and time.monotonic() < end:
        QTest.qWait(5)
    assert not runner.running


def joints_of(character):
    return body_of_character(character).joints


def test_a_wrong_map_is_mended_by_naming(section, hero):
    found, document, key = section
    family = next(each for each in naming_families() if each.name.startswith("VRM"))
    found._preset.value_chosen.emit(family)
    wait_for_tasks(found)
    assert joints_of(document.project.characters[key]) == hero.joints
    document.undo_stack.undo()
    assert joints_of(document.project.characters[key]) == hero.joints | SWAPPED_ARMS


def test_exchanged_arms_are_mended_by_mouse_and_undone(section, hero):
    found, document, key = section
    for part, joint in (("upper_arm", "leftUpperArm"), ("forearm", "leftLowerArm"), ("hand", "leftHand")):
        map_by_mouse(found, BodyPart(f"left_{part}"), joint)
    assert joints_of(document.project.characters[key]) == hero.joints
    mended = document.project.characters[key]
    assert mended.build.arm == pytest.approx(hero.character.build.arm, abs=1e-5)
    assert (mended.skin.segments[:, 0] == hero.character.skin.segments[:, 0]).all()
    for _ in range(3):
        document.undo_stack.undo()
    assert joints_of(document.project.characters[key]) == hero.joints | SWAPPED_ARMS


def test_the_chest_is_chosen_by_mouse(section, hero):
    found, document, key = section
    QTest.mouseClick(found._parts, LEFT, pos=(SEGMENT_SHAPES[BodyPart.THORAX].center() * BODY_FIGURE_SCALE).toPoint())
    click_joint(found, "spine")
    assert document.project.characters[key].build.layout.spine_count == 2
    click_joint(found, "chest")
    assert document.project.characters[key].build.layout.spine_count == 3
    rig = document.project.characters[key].skin.rig
    assert rig.names[rig_body_map(rig, 3).spine[-1]] == "chest"


def test_a_map_that_is_saved_mends_another_character(section, hero, tmp_path):
    found, document, key = section
    path = tmp_path / "hero.json"
    path.write_text(json.dumps(hero.joints))
    found.load_from(path)
    wait_for_tasks(found)
    assert joints_of(document.project.characters[key]) == hero.joints
    found.save_to(tmp_path / "again.json")
    assert json.loads((tmp_path / "again.json").read_text()) == hero.joints
    path.write_text("[1]")
    found.load_from(path)
    assert "a body map is a record" in found.window().strip.text


def test_a_capture_has_the_same_figures():
    capture = make_capture()
    body = body_of_capture(capture)
    assert body.joints == capture.body_map.to_json(capture.skeleton)


def test_a_performer_has_the_section_of_its_character(window, hero):
    document = window.bench.document
    key = next(iter(document.project.performers))
    character = document.project.performers[key].character_id
    document.replace("characters", character, remapped_character(hero.character, hero.joints | SWAPPED_ARMS), "Replace")
    document.selection.set(("performers", key))
    [found] = [each for each in window.findChildren(BodyMapSection) if each.isVisibleTo(window)]
    found._unfold()
    found.resize(320, 900)
    map_by_mouse(found, BodyPart.LEFT_HAND, "leftHand")
    assert joints_of(document.project.characters[character])["left_hand"] == "leftHand"


def test_the_window_goes_on_meanwhile_and_a_cancelled_one_changes_nothing(section, monkeypatch):
    found, document, key = section
    may_go_on, threads = threading.Event(), []

    def slow(character, names):
        threads.append(threading.current_thread())
        may_go_on.wait(SECONDS)
        return remapped_character(character, names)

    monkeypatch.setattr(character_import, "remapped_character", slow)
    runner, before = found.window().bench.runner, document.project.characters[key]
    QTest.mouseClick(
        found._parts, LEFT, pos=(SEGMENT_SHAPES[BodyPart.LEFT_HAND].center() * BODY_FIGURE_SCALE).toPoint()
    )
    QTest.mouseClick(found._joints, LEFT, pos=found._joints.place_of("leftHand").toPoint())
    [task] = runner.running  # the click has come back
    runner.cancel(task)
    may_go_on.set()
    wait_for_tasks(found)
    assert threads != [threading.main_thread()]
    assert document.project.characters[key] is before


def test_a_character_that_was_changed_meanwhile_is_kept_and_the_user_told(section):
    found, document, key = section
    QTest.mouseClick(
        found._parts, LEFT, pos=(SEGMENT_SHAPES[BodyPart.LEFT_HAND].center() * BODY_FIGURE_SCALE).toPoint()
    )
    QTest.mouseClick(found._joints, LEFT, pos=found._joints.place_of("leftHand").toPoint())
    changed = replace(document.project.characters[key], name="Other")
    document.replace("characters", key, changed, "Rename")
    wait_for_tasks(found)
    assert document.project.characters[key] is changed
    assert "changed while you mapped it" in found.window().strip.text
