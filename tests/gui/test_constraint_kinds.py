"""Every kind of constraint from the menu to the inspector and the gizmo, as a person would."""

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QComboBox

from studio.core.canonical import BodyPart
from studio.core.constraints.area import AreaShape
from studio.core.constraints.base import BodyPoint
from studio.core.metrics import centre_of_mass
from studio.document.document import Document
from studio.engine.moments import Moment
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from studio.viewport.gizmo import AXES
from studio.viewport.handle_places import handle_place
from studio.viewport.widget import Viewport
from tests.builders import make_project
from tests.gui.test_viewport import drag, joint_pixel, settle
from tests.viewport.standing import StandingLive

LEFT = Qt.MouseButton.LeftButton
KINDS = ("position", "orientation", "look_at", "distance", "balance", "area")


@pytest.fixture
def studio(qtbot):
    document = Document(make_project(characters=2, constraints=0))
    live = StandingLive(document)
    viewport, inspector = Viewport(document, live), Inspector(document, live)
    qtbot.addWidget(inspector)
    inspector.resize(316, 1400)
    inspector.show()
    viewport.resize(900, 600)
    with qtbot.waitSignal(viewport.started):
        viewport.show()
    document.playhead.set_time(0.2)
    settle(viewport)
    yield viewport, document, inspector
    viewport.close()
    viewport.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def add(studio, kind, joint="right wrist"):
    viewport, document, _ = studio
    QTest.mouseClick(viewport, LEFT, Qt.KeyboardModifier.NoModifier, joint_pixel(viewport, "performer 0", joint))
    constraint_id = viewport.add_constraint_at_pick(kind)
    settle(viewport)
    return document.project.constraints[constraint_id]


def current(document):
    return document.project.constraints[document.selection.current[1]]


def visible_numbers(inspector):
    return [each for each in inspector.editor.findChildren(NumberField) if each.isVisible()]


def field(inspector, name):
    [found] = [each for each in visible_numbers(inspector) if each.accessibleName() == name]
    return found


def enter(inspector, name, text):
    number = field(inspector, name)
    number.setFocus()
    number.selectAll()
    QTest.keyClicks(number, text)
    QTest.keyClick(number, Qt.Key.Key_Return)


def press(inspector, name):
    [button] = [each for each in inspector.editor.findChildren(QAbstractButton) if each.accessibleName() == name]
    QTest.mouseClick(button, LEFT)


def choose(inspector, name, text):
    [box] = [each for each in inspector.editor.findChildren(QComboBox) if each.accessibleName() == name]
    box.setCurrentText(text)
    box.activated.emit(box.currentIndex())


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_is_added_at_a_pick_as_one_step_is_selected_and_has_its_form(studio, kind):
    _, document, inspector = studio
    constraint = add(studio, kind)
    assert constraint.kind == kind
    assert document.selection.current[0] == "constraints"
    assert current(document) is constraint
    assert inspector.editor.entity is constraint
    assert document.undo_stack.count() == 1
    assert constraint.activation.at(0.2) == 1.0
    document.undo_stack.undo()
    assert not document.project.constraints


@pytest.mark.parametrize("kind", KINDS)
def test_what_needs_a_joint_waits_for_one_and_the_others_take_the_active_body(studio, kind):
    viewport, document, _ = studio
    made = viewport.add_constraint_at_pick(kind)
    assert (made is not None) == (kind in ("look_at", "balance"))
    assert document.undo_stack.count() == (1 if made else 0)


def test_an_orientation_at_the_wrist_keeps_the_hand_as_it_is_and_is_turned_in_degrees(studio):
    _, document, inspector = studio
    constraint = add(studio, "orientation")
    assert constraint.point.part is BodyPart.RIGHT_HAND
    before = [field(inspector, f"Turn {axis}").value() for axis in "XYZ"]
    enter(inspector, "Turn Z", f"{before[2] + 30:.2f}")
    first, second = np.array(constraint.target), np.array(current(document).target)
    assert np.degrees(2 * np.arccos(abs(first @ second))) == pytest.approx(30.0, abs=0.05)
    assert document.undo_stack.count() == 2


def test_angles_stay_as_they_were_typed_past_the_pole(studio):
    _, _, inspector = studio
    add(studio, "orientation")
    for axis, degrees in zip("XYZ", ("10", "120", "20"), strict=True):
        enter(inspector, f"Turn {axis}", degrees)
    assert [field(inspector, f"Turn {axis}").value() for axis in "XYZ"] == [10.0, 120.0, 20.0]


def test_a_look_at_begins_two_metres_ahead_of_the_eyes_and_its_target_is_typed(studio):
    viewport, document, inspector = studio
    constraint = add(studio, "look_at")
    pose = viewport.posed["performer 0"]
    head = pose.motion.positions[pose.row, pose.motion.morphology.layout.head_joint]
    assert constraint.target[0] - head[0] == pytest.approx(2.08, abs=1e-6)
    enter(inspector, "Target Z", "1.1")
    assert current(document).target == (*constraint.target[:2], 1.1)


def test_a_distance_at_a_wrist_is_to_the_other_one_and_at_an_ankle_to_a_place(studio):
    _, document, inspector = studio
    hands = add(studio, "distance")
    assert hands.other == BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    assert hands.distance > 0.2
    enter(inspector, "Distance", "0.25")
    assert current(document).distance == 0.25
    choose(inspector, "Distance from", "A place outside")
    assert isinstance(current(document).other, tuple)
    enter(inspector, "Place X", "0.5")
    assert current(document).other[0] == 0.5
    ankle = add(studio, "distance", "left ankle")
    assert (ankle.distance, isinstance(ankle.other, tuple)) == (0.0, True)


def test_a_point_has_no_distance_from_itself_and_the_form_says_so(studio, qtbot):
    _, document, inspector = studio
    before = add(studio, "distance")
    with qtbot.waitSignal(document.problem) as told:
        choose(inspector, "Distance from", "Right wrist")
    assert "no distance from itself" in told.args[0]
    assert current(document) is before


def test_balance_is_fixed_where_the_centre_of_mass_is_now_and_moved_on_the_ground_alone(studio):
    viewport, document, inspector = studio
    assert add(studio, "balance").place is None
    assert viewport.gizmo() is None
    press(inspector, "Centre of mass: Fixed place")
    pose = viewport.posed["performer 0"]
    expected = centre_of_mass(pose.motion)[pose.row, :2]
    assert current(document).place == pytest.approx(tuple(expected), abs=1e-9)
    settle(viewport)
    gizmo = viewport.gizmo()
    assert [gizmo.usable(part) for part in ("z", "yz", "zx", "xy")] == [False, False, False, True]
    enter(inspector, "Place Y", "0.07")
    assert current(document).place[1] == 0.07


def test_a_table_reaches_up_to_the_wrist_and_its_shape_changes_with_its_numbers(studio):
    viewport, document, inspector = studio
    table = add(studio, "area")
    wrist = viewport.posed["performer 0"].points[viewport.posed["performer 0"].motion.morphology.layout.wrist(1)]
    assert table.centre[2] + table.size[2] / 2 == pytest.approx(wrist[2], abs=1e-6)
    assert table.centre[2] == pytest.approx(table.size[2] / 2)
    enter(inspector, "Heading", "30")
    assert np.degrees(current(document).heading) == pytest.approx(30.0)
    choose(inspector, "Shape", "Sphere")
    assert not any(each.accessibleName() == "Heading" for each in visible_numbers(inspector))
    press(inspector, "Point stays: Inside")
    enter(inspector, "Size X", "0.4")
    assert (current(document).shape, current(document).inside, current(document).size[0]) == ("sphere", True, 0.4)
    choose(inspector, "Shape", "Half-space")
    assert current(document).size == (0.0, 0.0, 1.0)
    choose(inspector, "Shape", "Box")
    assert current(document).shape is AreaShape.BOX
    assert min(current(document).size) > 0.0


@pytest.mark.parametrize("kind", ["position", "look_at", "area"])
def test_dragging_an_arrow_moves_the_place_of_any_kind_in_one_step(studio, kind):
    viewport, document, _ = studio
    before = add(studio, kind)
    viewport.frame_selection()
    settle(viewport)
    gizmo = viewport.gizmo()
    tip = gizmo.tips[AXES.index("z")]
    begin, end = (QPoint(*np.rint(gizmo.centre + share * (tip - gizmo.centre)).astype(int)) for share in (0.7, 1.5))
    drag(viewport, begin, end)
    way = np.array(handle_place(current(document))) - handle_place(before)
    assert way[2] > 0.02
    assert way[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert document.undo_stack.count() == 2


@pytest.mark.parametrize("kind", KINDS)
def test_a_selected_constraint_is_framed_with_all_that_is_drawn_of_it(studio, kind):
    viewport, _, _ = studio
    constraint = add(studio, kind)
    viewport.frame_selection()
    settle(viewport)
    [handle] = [one for one in viewport.handles() if one.main]
    assert handle.kind == constraint.kind
    pixels, depth = viewport.camera.project(handle.extent, viewport.view_size)
    assert ((pixels >= 0) & (pixels <= viewport.view_size)).all()
    assert (depth > 0).all()


def test_a_place_that_is_written_is_read_again_and_what_has_none_stays_as_it_is(studio):
    for kind in KINDS:
        constraint = add(studio, kind, "left ankle")
        place = handle_place(constraint)
        viewport, document, _ = studio
        moment = Moment(document.project, viewport.posed, viewport.posed["performer 0"])
        moved = moment.moved(constraint, (0.1, 0.2, 0.3))
        if place is None:
            assert moved is constraint
        else:
            assert handle_place(moved, floor=0.3) == (0.1, 0.2, 0.3)
        document.undo_stack.undo()
