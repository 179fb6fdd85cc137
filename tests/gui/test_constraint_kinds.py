"""Every kind of constraint from the menu to the inspector and the gizmo, as a person would."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QComboBox

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.area import AreaShape
from studio.core.constraints.balance import Support
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.curves.keyed import KeyedPlace
from studio.core.quality.metrics import centre_of_mass
from studio.core.rotations import from_euler
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.engine.target_context import TargetContext
from studio.panels.constraint_editors.body_figure import BODY_FIGURE_SCALE, SEGMENT_SHAPES, BodyFigure
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from studio.viewport.gizmo import GIZMO_AXES
from studio.viewport.handle_places import handle_position
from studio.viewport.widget import Viewport
from tests.builders import make_contact, make_project
from tests.gui.viewport_use import drag, joint_pixel, settle
from tests.patience import PATIENCE
from tests.viewport.standing import StandingLive

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def studio(qtbot):
    document = Document(make_project(characters=2, constraints=0))
    live = StandingLive(document)
    viewport, inspector = Viewport(document, live), Inspector(document, live)
    qtbot.addWidget(inspector)
    inspector.resize(316, 1400)
    inspector.show()
    viewport.resize(600, 400)
    with qtbot.waitSignal(viewport.started, timeout=PATIENCE):
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
    [button] = [
        each
        for each in inspector.editor.findChildren(QAbstractButton)
        if each.accessibleName() == name and not each.isHidden()
    ]
    QTest.mouseClick(button, LEFT)


def numbers_of(inspector, name):
    return [field(inspector, f"{name} {axis}").value() for axis in "XYZ"]


def chosen(inspector, name):
    [box] = [each for each in inspector.editor.findChildren(QComboBox) if each.accessibleName() == name]
    return box.currentText()


def choose(inspector, name, text):
    [box] = [each for each in inspector.editor.findChildren(QComboBox) if each.accessibleName() == name]
    box.setCurrentText(text)
    box.activated.emit(box.currentIndex())


STANCES = ((0, 5), (8, 9), (20, 29))
"""Frames, at 60 Hz, in which the left foot stands; the playhead is at frame 12."""


@pytest.mark.parametrize("kind", ["position", "orientation"])
def test_a_new_constraint_on_a_foot_acts_between_its_stances_and_one_on_the_other_is_free_of_them(studio, kind):
    _, document, _ = studio
    for first, last in STANCES:
        heel = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        document.add_all("contacts", [heel], "Add")
    left = add(studio, kind, "left ankle").activation
    document.undo_stack.undo()
    right = add(studio, kind, "right ankle").activation
    assert 9 / 60 - 1e-9 < left.start < left.end < 20 / 60 + 1e-9
    if kind == "orientation":  # it is constant here; a position that moves on is led more briefly
        assert (left.start, left.end) == pytest.approx((9 / 60, 20 / 60))
        assert right.start == 0.0
        assert right.end > 20 / 60


def test_a_new_constraint_on_a_standing_foot_acts_through_its_stance(studio):
    _, document, _ = studio
    document.add("contacts", make_contact(point=ContactPoint.LEFT_TOE, first=8, last=20), "Add")
    made = add(studio, "orientation", "left ankle").activation  # its position moves on in this motion, in spite of it
    assert made.start == 0.0
    assert made.end > 20 / 60


@pytest.mark.parametrize("kind", CONSTRAINT_KINDS)
def test_each_kind_is_added_at_a_pick_as_one_step_has_its_form_and_is_framed_with_all_that_is_drawn(studio, kind):
    viewport, document, inspector = studio
    constraint = add(studio, kind)
    assert constraint.kind == kind
    assert document.selection.current[0] == "constraints"
    assert current(document) is constraint
    assert inspector.editor.entity is constraint
    assert document.undo_stack.count() == 1
    assert constraint.activation.at(0.2) == 1.0
    viewport.frame_selection()
    settle(viewport)
    [handle] = [one for one in viewport.handles() if one.is_primary]
    assert handle.kind == kind
    pixels, depth = viewport.camera.project(handle.extent, viewport.view_size)
    assert ((pixels >= 0) & (pixels <= viewport.view_size)).all()
    assert (depth > 0).all()
    document.undo_stack.undo()
    assert not document.project.constraints


def test_what_needs_a_joint_waits_for_one_and_the_others_take_the_active_body(studio):
    viewport, document, _ = studio
    made = []
    for kind in CONSTRAINT_KINDS:
        document.selection.set()
        count = document.undo_stack.count()
        if viewport.add_constraint_at_pick(kind) is not None:
            made.append(kind)
        assert document.undo_stack.count() == count + (kind in made)
    assert set(made) == {"look_at", "balance", "clear"}


def test_an_orientation_at_the_wrist_keeps_the_hand_as_it_is_and_is_turned_in_degrees(studio):
    _, document, inspector = studio
    constraint = add(studio, "orientation")
    assert constraint.point.part is BodyPart.RIGHT_HAND
    before = [field(inspector, f"Rotation {axis}").value() for axis in "XYZ"]
    enter(inspector, "Rotation Z", f"{before[2] + 30:.2f}")
    first, second = np.array(constraint.target), np.array(current(document).target)
    assert np.degrees(2 * np.arccos(abs(first @ second))) == pytest.approx(30.0, abs=0.05)
    assert document.undo_stack.count() == 2


def test_angles_stay_as_they_were_typed_past_the_pole(studio):
    _, _, inspector = studio
    add(studio, "orientation")
    for axis, degrees in zip("XYZ", ("10", "120", "20"), strict=True):
        enter(inspector, f"Rotation {axis}", degrees)
    assert [field(inspector, f"Rotation {axis}").value() for axis in "XYZ"] == [10.0, 120.0, 20.0]


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
    choose(inspector, "Distance from", "Fixed position")
    assert isinstance(current(document).other, tuple)
    enter(inspector, "Position X", "0.5")
    assert current(document).other[0] == 0.5
    ankle = add(studio, "distance", "left ankle")
    assert (ankle.distance, isinstance(ankle.other, tuple)) == (0.0, True)


def test_a_point_has_no_distance_from_itself_and_the_form_says_so(studio, qtbot):
    _, document, inspector = studio
    before = add(studio, "distance")
    with qtbot.waitSignal(document.problem_reported) as told:
        choose(inspector, "Distance from", "Right wrist")
    assert "of a point from itself" in told.args[0]
    assert current(document) is before


def test_balance_is_fixed_where_the_centre_of_mass_is_now_and_moved_on_the_ground_alone(studio):
    viewport, document, inspector = studio
    assert add(studio, "balance").place is None
    assert viewport.gizmo() is None
    press(inspector, "Centre of mass: Position")
    pose = viewport.posed["performer 0"]
    expected = centre_of_mass(pose.motion)[pose.row, :2]
    assert current(document).place == pytest.approx(tuple(expected), abs=1e-9)
    settle(viewport)
    gizmo = viewport.gizmo()
    assert [gizmo.usable(part) for part in ("z", "yz", "zx", "xy")] == [False, False, False, True]
    enter(inspector, "Position Y", "0.07")
    assert current(document).place[1] == 0.07


def test_balance_recruits_free_arms_and_the_free_leg_until_they_are_locked_on_the_figure(studio):
    _, document, inspector = studio
    chain = add(studio, "balance").chain
    assert (chain.free_arms, chain.free_legs) == (1.0, 1.0)
    figure = inspector.editor.findChild(BodyFigure)
    for part, link in ((BodyPart.LEFT_FOREARM, "free_arms"), (BodyPart.RIGHT_THIGH, "free_legs")):
        QTest.mouseClick(figure, LEFT, pos=(BODY_FIGURE_SCALE * SEGMENT_SHAPES[part].center()).toPoint())
        assert getattr(current(document).chain, link) == 0.0
    enter(inspector, "Weight of Other arms", "0.4")
    assert current(document).chain.free_arms == 0.4
    add(studio, "position")
    assert "Weight of Other arms" not in [each.accessibleName() for each in visible_numbers(inspector)]


def test_the_tilt_of_an_area_is_keyed_by_its_checkbox_and_a_number_sets_the_key(studio):
    _, document, inspector = studio
    add(studio, "area")
    enter(inspector, "Tilt X", "20")
    press(inspector, "Tilt is animated")
    enter(inspector, "Tilt X", "30")
    assert len(current(document).tilt.times) == 1
    assert current(document).tilt.values[0] == pytest.approx(from_euler("X", np.radians([30.0])), abs=1e-6)
    press(inspector, "Tilt is animated")
    assert current(document).tilt == pytest.approx(tuple(from_euler("X", np.radians([30.0]))), abs=1e-6)


def test_a_table_reaches_up_to_the_wrist_and_its_shape_changes_with_its_numbers(studio):
    viewport, document, inspector = studio
    table = add(studio, "area")
    wrist = viewport.posed["performer 0"].points[viewport.posed["performer 0"].motion.morphology.layout.wrist_point(1)]
    assert table.centre[2] + table.size[2] / 2 == pytest.approx(wrist[2], abs=1e-6)
    assert table.centre[2] == pytest.approx(table.size[2] / 2)
    enter(inspector, "Heading", "30")
    assert np.degrees(current(document).heading) == pytest.approx(30.0)
    enter(inspector, "Tilt X", "20")
    enter(inspector, "Tilt Y", "-15")
    assert np.array(current(document).tilt) == pytest.approx(from_euler("YX", np.radians([-15.0, 20.0])), abs=1e-6)
    choose(inspector, "Shape", "Sphere")
    assert not {"Heading", "Tilt X"} & {each.accessibleName() for each in visible_numbers(inspector)}
    press(inspector, "Region: Inside")
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
    tip = gizmo.tips[GIZMO_AXES.index("z")]
    begin, end = (QPoint(*np.rint(gizmo.centre + share * (tip - gizmo.centre)).astype(int)) for share in (0.7, 1.5))
    drag(viewport, begin, end)
    way = np.array(fixed(studio, current(document))) - fixed(studio, before)
    assert way[2] > 0.02
    assert way[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert document.undo_stack.count() == 2


def test_a_place_that_is_written_is_read_again_and_what_has_none_stays_as_it_is(studio):
    for kind in CONSTRAINT_KINDS:
        constraint = add(studio, kind, "left ankle")
        place = fixed(studio, constraint)
        viewport, document, _ = studio
        moment = TargetContext(document.project, viewport.posed, viewport.posed["performer 0"])
        moved = moment.with_target_moved(constraint, (0.1, 0.2, 0.3))
        if place is None:
            assert moved is constraint
        else:
            now = handle_position(moment.with_targets_fixed(moved), floor=0.3)
            assert now == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)
        document.undo_stack.undo()


def fixed(studio, constraint):
    """Place at which it is held now."""
    viewport, document, _ = studio
    return handle_position(
        TargetContext(document.project, viewport.posed, viewport.posed["performer 0"]).with_targets_fixed(constraint)
    )


def keyed(studio, kind="position"):
    """A constraint whose place has a key at 0.1 s, before the playhead at 0.2 s."""
    viewport, document, _ = studio
    constraint = add(studio, kind)
    name = CONSTRAINT_KINDS[kind].value.shown.held_by
    place = fixed(studio, constraint)
    new = replace(constraint, **{name: KeyedPlace((0.1,), (place,))})
    document.replace("constraints", document.selection.current[1], new, "Key")
    viewport.frame_selection()
    settle(viewport)
    return new


@pytest.mark.parametrize("kind", ["position", "look_at", "area"])
def test_dragging_a_keyed_target_sets_a_key_at_the_playhead_and_escape_takes_it_back(studio, kind):
    viewport, document, _ = studio
    before = keyed(studio, kind)
    gizmo = viewport.gizmo()
    tip = gizmo.tips[GIZMO_AXES.index("z")]
    begin, end = (QPoint(*np.rint(gizmo.centre + share * (tip - gizmo.centre)).astype(int)) for share in (0.7, 1.5))
    QTest.mousePress(viewport, LEFT, Qt.KeyboardModifier.NoModifier, begin)
    QTest.mouseMove(viewport, (begin + end) / 2)
    QTest.mouseMove(viewport, end)
    QTest.keyClick(viewport, Qt.Key.Key_Escape)
    QTest.mouseRelease(viewport, LEFT, Qt.KeyboardModifier.NoModifier, end)
    assert current(document) == before
    drag(viewport, begin, end)
    target = getattr(current(document), CONSTRAINT_KINDS[kind].value.shown.held_by)
    assert target.times == (0.1, 0.2)
    assert target.values[0] == getattr(before, CONSTRAINT_KINDS[kind].value.shown.held_by).values[0]
    assert target.values[1][2] > target.values[0][2] + 0.02
    what = "centre" if kind == "area" else "target"
    assert document.undo_stack.undoText() == f"Key {what} of {before.name}"


def test_the_handle_of_a_target_that_follows_is_where_the_followed_is_and_a_drag_offsets_it(studio):
    viewport, document, _ = studio
    prop_id = document.add("props", Prop("Box", position=(0.4, 0.3, 0.9), heading=0.5), "Add box")
    constraint = add(studio, "position")
    new = replace(constraint, target=FollowProp(prop_id))
    document.replace("constraints", document.selection.current[1], new, "Follow")
    settle(viewport)
    [handle] = [one for one in viewport.handles() if one.is_primary]
    assert handle.target == pytest.approx([0.4, 0.3, 0.9])
    pose = viewport.posed["performer 0"]
    moved = TargetContext(document.project, viewport.posed, pose).with_target_moved(
        new, tuple(pose.placement.to_motion([0.5, 0.3, 1.0]))
    )
    assert moved.target.offset == pytest.approx((0.1 * np.cos(0.5), -0.1 * np.sin(0.5), 0.1))


def test_a_target_is_made_keyed_and_keys_are_typed_set_gone_to_and_deleted(studio):
    _, document, inspector = studio
    add(studio, "position")
    place = numbers_of(inspector, "Target")
    choose(inspector, "Target type", "Animated")
    assert current(document).target.times == pytest.approx([0.2])
    assert numbers_of(inspector, "Target") == pytest.approx(place, abs=1e-3)
    document.playhead.set_time(0.4)
    enter(inspector, "Target Z", "1.5")
    assert current(document).target.times == pytest.approx([0.2, 0.4])
    document.playhead.set_time(0.3)
    between = field(inspector, "Target Z").value()
    assert min(place[2], 1.5) < between < max(place[2], 1.5)
    press(inspector, "Set key")
    assert current(document).target.times == pytest.approx([0.2, 0.3, 0.4])
    press(inspector, "Previous key")
    assert document.playhead.time == pytest.approx(0.2)
    press(inspector, "Delete key")
    assert current(document).target.times == pytest.approx([0.3, 0.4])
    choose(inspector, "Target type", "Fixed")
    assert isinstance(current(document).target, tuple)


def test_a_target_moves_by_a_rule_its_way_is_drawn_and_a_drag_moves_it(studio):
    viewport, document, inspector = studio
    add(studio, "position")
    place = numbers_of(inspector, "Target")
    for words, number in (("Circle", "Radius"), ("Noise", "Amplitude X")):
        choose(inspector, "Target type", words)
        enter(inspector, number, "0.25")
        settle(viewport)
        [handle] = [one for one in viewport.handles() if one.is_primary]
        [way] = handle.figure.lines
        assert np.linalg.norm(way - handle.target, axis=1).min() < 1e-6
    assert current(document).target.reach == (0.25, 0.1, 0.1)
    enter(inspector, "Target Z", "1.5")
    assert field(inspector, "Target Z").value() == pytest.approx(1.5)
    choose(inspector, "Target type", "Fixed")
    assert len(current(document).target) == len(place)


@pytest.mark.parametrize("begin", ["Per character", "Follow own body"])
@pytest.mark.parametrize("words", ["Animated", "Circle", "Noise"])
def test_what_is_each_body_s_own_stays_so_as_keys_and_rules_and_is_shared_when_asked(studio, begin, words):
    viewport, document, inspector = studio
    add(studio, "position")
    choose(inspector, "Target type", begin)
    if begin == "Follow own body":
        choose(inspector, "Followed point", "Head")
    before = targets_of_all(studio)
    choose(inspector, "Target type", words)
    if words == "Animated":
        assert targets_of_all(studio) == pytest.approx(before, abs=1e-3)
    document.playhead.set_time(0.4)
    settle(viewport)
    before = targets_of_all(studio)
    assert np.linalg.norm(before[1] - before[0]) > 0.01
    enter(inspector, "Target Z", f"{field(inspector, 'Target Z').value() + 0.2:.2f}")
    settle(viewport)
    legs = [viewport.posed[key].motion.body.leg_length for key in ("performer 0", "performer 1")]
    moved = targets_of_all(studio)[:, 2] - before[:, 2]
    assert moved[1] == pytest.approx(moved[0] * legs[1] / legs[0], abs=0.002)
    before = targets_of_all(studio)
    press(inspector, "Relative to each character")
    settle(viewport)
    assert targets_of_all(studio)[0] == pytest.approx(before[0], abs=1e-6)
    assert np.ptp(targets_of_all(studio), axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    press(inspector, "Relative to each character")
    settle(viewport)
    assert targets_of_all(studio)[0] == pytest.approx(before[0], abs=1e-6)
    assert np.linalg.norm(np.diff(targets_of_all(studio), axis=0)) > 0.01


def targets_of_all(studio):
    """(P, 3) metres of the motion: where each performer has the target now."""
    viewport, document, _ = studio
    settle(viewport)
    moments = [TargetContext(document.project, viewport.posed, pose) for _, pose in sorted(viewport.posed.items())]
    return np.array([moment.with_targets_fixed(current(document)).target for moment in moments])


def test_a_target_is_made_to_follow_each_kind_of_thing_from_the_form(studio):
    _, document, inspector = studio
    told = []
    document.problem_reported.connect(told.append)
    target = add(studio, "position").target
    place = numbers_of(inspector, "Target")
    choose(inspector, "Target type", "Follow prop")
    assert "no prop" in told[-1]
    assert current(document).target == target
    prop_id = document.add("props", Prop("Box", position=(1.0, 0.0, 0.5)), "Add box")
    choose(inspector, "Target type", "Follow prop")
    assert current(document).target.prop_id == prop_id
    assert numbers_of(inspector, "Target") == pytest.approx(place, abs=1e-3)
    choose(inspector, "Target type", "Follow character")
    assert current(document).target.performer_id == "performer 1"
    choose(inspector, "Followed point", "Head")
    assert current(document).target.point.part is BodyPart.NECK
    choose(inspector, "Target type", "Follow own body")
    assert current(document).target.point == BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    choose(inspector, "Target type", "Follow source")
    assert current(document).target.joint == "RightForeArm"
    choose(inspector, "Follows", "LeftHand")
    assert current(document).target.joint == "LeftHand"
    count = document.undo_stack.count()
    for _ in range(count - 1):
        document.undo_stack.undo()
    assert current(document).target == target


def test_the_form_says_whether_each_body_has_its_own_place_and_who_has_an_offset_of_its_own(studio):
    _, document, inspector = studio
    add(studio, "position")
    place = numbers_of(inspector, "Target")
    assert chosen(inspector, "Target type") == "Per character"
    press(inspector, "Offset unique for Body 0")
    assert current(document).target.own == (("performer 0", (0.0, 0.0, 0.0)),)
    enter(inspector, "Target Z", f"{place[2] + 0.1:.2f}")
    assert numbers_of(inspector, "Target")[2] == pytest.approx(place[2] + 0.1, abs=0.006)
    assert current(document).target.offset == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    press(inspector, "Offset unique for Body 0")
    assert current(document).target.own == ()
    choose(inspector, "Target type", "Fixed")
    assert current(document).target == pytest.approx(place, abs=0.006)
    document.playhead.set_time(0.45)  # beyond the time of the constraint: it is told by where the body is within
    choose(inspector, "Target type", "Per character")
    assert current(document).target.time == pytest.approx(current(document).activation.full_end)
    assert numbers_of(inspector, "Target") == pytest.approx(place, abs=0.006)


def test_turns_distances_headings_and_balance_are_keyed_or_follow_from_their_forms(studio):
    _, document, inspector = studio
    add(studio, "orientation")
    choose(inspector, "Target type", "Animated")
    document.playhead.set_time(0.4)
    enter(inspector, "Rotation Z", "30")
    assert current(document).target.times == pytest.approx([0.2, 0.4])
    choose(inspector, "Target type", "Follow own body")
    enter(inspector, "Rotation Z", "30")
    assert current(document).target.turn != (0.0, 0.0, 0.0, 1.0)
    document.playhead.set_time(0.2)
    add(studio, "distance")
    press(inspector, "Distance is animated")
    document.playhead.set_time(0.4)
    enter(inspector, "Distance", "0.25")
    assert current(document).distance.values[1] == 0.25
    document.playhead.set_time(0.2)
    add(studio, "area")
    press(inspector, "Heading is animated")
    choose(inspector, "Target type", "Animated")
    document.playhead.set_time(0.4)
    enter(inspector, "Heading", "45")
    enter(inspector, "Centre X", "1.25")
    assert current(document).heading.values[1] == pytest.approx(np.pi / 4)
    assert current(document).centre.values[1][0] == 1.25
    add(studio, "balance")
    press(inspector, "Centre of mass: Support polygon")
    enter(inspector, "Margin", "3")
    assert current(document).place == Support(0.03)
    press(inspector, "Centre of mass: Position")
    choose(inspector, "Target type", "Animated")
    enter(inspector, "Position Y", "0.4")
    assert current(document).place.values[0][1] == 0.4
    press(inspector, "Constrain the height of the centre of mass too")
    assert current(document).vertical


def test_what_is_kept_upright_has_a_cone_a_direction_and_an_axis_taken_from_the_pose(studio):
    viewport, document, inspector = studio
    made = add(studio, "upright")
    assert made.point == BodyPoint(BodyPart.RIGHT_HAND)
    turn = viewport.posed["performer 0"].motion.rotations[viewport.posed["performer 0"].row]
    hand = turn[viewport.posed["performer 0"].motion.morphology.layout.segment_of_part(BodyPart.RIGHT_HAND)]
    assert np.allclose(hand @ made.axis, [0.0, 0.0, 1.0], atol=1e-9)
    enter(inspector, "Max. angle", "20")
    assert current(document).cone == pytest.approx(np.radians(20.0))
    enter(inspector, "Direction Y", "1")
    assert current(document).direction == pytest.approx((0.0, np.sqrt(0.5), np.sqrt(0.5)))
    settle(viewport)
    [take] = [each for each in inspector.findChildren(QAbstractButton) if each.text() == "Set axis from pose"]
    take.click()
    assert np.allclose(hand @ current(document).axis, current(document).direction, atol=0.2)
    document.undo_stack.undo()
    assert current(document).axis == made.axis
    assert viewport.handles()[0].figure.lines
