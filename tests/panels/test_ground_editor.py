"""The ground's form: a kind to choose, sliders that move the ground live, one undo step a drag."""

import math

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QSlider

from studio.core.grounds import Bumps, HeightMap, Slope, Steps
from studio.core.grounds.ground import Ground
from studio.core.stage.project import GROUND_ID
from studio.document.document import Document
from studio.panels.fields import Choice, NumberField
from studio.panels.ground_editor import GROUND_CHOICES, NUMERIC_GROUND_KINDS, GroundEditor
from tests.builders import make_project
from tests.solved_live import SolvedLive


@pytest.fixture
def document(qapp):
    document = Document(make_project(characters=1))
    yield document
    document.close()


@pytest.fixture
def editor(qtbot, document):
    editor = GroundEditor(document, SolvedLive(document), "grounds", GROUND_ID)
    qtbot.addWidget(editor)
    document.entity_changed.connect(lambda *_: editor.refresh())
    editor.resize(316, 500)
    editor.show()
    return editor


def named(editor, kind, name):
    return next(widget for widget in editor.findChildren(kind) if widget.accessibleName() == name)


def choose(editor, kind):
    choice = named(editor, Choice, "Ground type")
    index = [each for each, _ in GROUND_CHOICES if each in NUMERIC_GROUND_KINDS].index(kind)
    choice.setCurrentIndex(index)
    choice.activated.emit(index)


def test_a_kind_is_chosen_keeps_the_height_and_shows_its_own_measures(editor, document):
    document.replace("grounds", GROUND_ID, Ground(0.2), "Raise")
    choose(editor, Steps)
    assert document.project.ground == Steps(0.2)
    assert named(editor, QSlider, "Tread").isVisible()
    assert not named(editor, QSlider, "Wavelength").isVisible()
    choose(editor, Ground)
    assert document.project.ground == Ground(0.2)
    assert not named(editor, QSlider, "Tread").isVisible()


def test_a_direction_stays_when_steps_become_a_slope(editor, document):
    document.replace("grounds", GROUND_ID, Steps(direction=0.5), "Turn")
    choose(editor, Slope)
    assert document.project.ground == Slope(direction=0.5)


def test_a_drag_of_a_slider_is_live_and_one_undo_step(editor, document):
    choose(editor, Bumps)
    before, steps = document.project.ground, document.undo_stack.count()
    slider = named(editor, QSlider, "Amplitude")
    start = QPoint(round(slider.width() * slider.value() / slider.maximum()), slider.height() // 2)
    seen = set()
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=start)
    for ahead in (10, 25, 40):
        QTest.mouseMove(slider, start + QPoint(ahead, 0))
        seen.add(document.project.ground.amplitude)
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=start + QPoint(40, 0))
    assert len(seen) == 3
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert document.project.ground == before


def test_numbers_of_steps_stay_whole(editor, document):
    choose(editor, Steps)
    named(editor, QSlider, "Steps").setValue(333)
    assert type(document.project.ground.count) is int


def test_the_foot_of_a_slope_is_moved_by_its_numbers(editor, document):
    choose(editor, Slope)
    named(editor, NumberField, "Start position Y").setValue(1.5)
    assert document.project.ground.foot == (0.0, 1.5)


def test_a_double_click_gives_the_usual_measure_back(editor, document):
    document.replace("grounds", GROUND_ID, Slope(angle=0.4), "Tilt")
    named(editor, QSlider, "Angle").restored.emit()
    assert document.project.ground.angle == pytest.approx(math.radians(10.0))


def test_a_ground_out_of_a_file_is_shown_by_its_kind(editor, document):
    document.replace("grounds", GROUND_ID, HeightMap(0.1), "Load")
    assert named(editor, Choice, "Ground type").currentText() == "Height map"
