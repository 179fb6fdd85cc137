"""The viewport: what is turned and resized by the gizmo, in every space, by mouse and by key."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import UNTURNED
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.keyed import KeyedTurn
from studio.core.rotations import from_euler, to_euler, to_matrix
from studio.core.stage.prop import Prop
from studio.document.obstacles import set_obstacle
from studio.viewport.gizmo import Space
from tests.builders import make_constraint
from tests.gui.viewport_use import LEFT, NONE, chip, drag, on_ring, settle

HAND = BodyPoint(BodyPart.RIGHT_HAND)
TILTED = tuple(from_euler("ZYX", np.array([0.7, 0.4, -0.3])).tolist())
CTRL = Qt.KeyboardModifier.ControlModifier


def shown(studio, constraint, **placed):
    """The viewport with a constraint that is selected, and its id; the body stands elsewhere, turned."""
    viewport, document, _ = studio
    performer = replace(document.project.performers["performer 0"], **placed)
    document.replace("performers", "performer 0", performer, "Place")
    key = document.add("constraints", constraint, "Add")
    document.selection.set(("performers", "performer 0"), ("constraints", key))
    viewport.frame_selection()
    settle(viewport)
    document.undo_stack.clear()
    return viewport, document, key


def orientation(**changes):
    base = make_constraint()
    return OrientationConstraint(
        base.motion_id, "Turn of hand", HAND, Chain(end_segment=1.0), 5, base.activation,
        **{"target": TILTED, **changes},
    )  # fmt: skip


def on_front(viewport, part, degrees):
    """Two pixels of the near half of a ring, so many degrees from each other, of which the first grips it."""
    gizmo = viewport.gizmo()
    front, corners = gizmo.in_front(part), gizmo.ring(part)
    sides = [side for side in np.flatnonzero(front) if gizmo.part_at(*np.rint(corners[side])) == part]
    middle = sides[len(sides) // 2] * 5
    return on_ring(viewport, part, middle), on_ring(viewport, part, middle + degrees)


def target_axes(document, key, heading=0.0):
    """(3, 3) the target on the stage."""
    turned = from_euler("Z", np.array([heading]))
    return to_matrix(turned) @ to_matrix(np.array(document.project.constraints[key].target))


def about(rotation):
    """Axis and degrees of a rotation."""
    from scipy.spatial.transform import Rotation

    vector = Rotation.from_matrix(rotation).as_rotvec()
    angle = np.linalg.norm(vector)
    return vector / max(angle, 1e-12), np.degrees(angle)


@pytest.mark.parametrize("space", list(Space))
@pytest.mark.parametrize("part", ["x", "y", "z"])
def test_a_hand_target_is_turned_by_a_ring_about_that_axis_of_the_space_in_one_step(studio, space, part):
    viewport, document, key = shown(studio, orientation(), heading=0.6)
    before = target_axes(document, key, 0.6)
    viewport.set_tool("rotate")
    while viewport.gizmo_space is not space:
        viewport.next_gizmo_space()
    gizmo = viewport.gizmo()
    if abs(float(gizmo.axis(part) @ gizmo.sight)) < 0.25:
        pytest.skip("this ring is seen edge on in this view")
    drag(viewport, *on_front(viewport, part, 30))
    axis, degrees = about(target_axes(document, key, 0.6) @ before.T)
    expected = {
        Space.WORLD: np.eye(3), Space.LOCAL: before, Space.PARENT: to_matrix(from_euler("Z", np.array([0.6]))),
        Space.SCREEN: viewport.camera.axes.T,
    }[space]  # fmt: skip
    assert axis == pytest.approx(expected[:, "xyz".index(part)], abs=1e-6)
    assert degrees == pytest.approx(30.0, abs=3.0)
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert target_axes(document, key, 0.6) == pytest.approx(before, abs=1e-12)


def test_ctrl_snaps_to_15_degrees_and_shift_turns_a_fifth_as_far(studio):
    viewport, document, key = shown(studio, orientation())
    viewport.set_tool("rotate")
    before = target_axes(document, key)
    begin, end = on_front(viewport, "z", 35)
    drag(viewport, begin, end, modifiers=CTRL)
    assert about(target_axes(document, key) @ before.T)[1] == pytest.approx(30.0, abs=1e-6)
    document.undo_stack.undo()
    drag(viewport, begin, end, modifiers=Qt.KeyboardModifier.ShiftModifier)
    assert about(target_axes(document, key) @ before.T)[1] == pytest.approx(7.0, abs=1.0)


def test_the_trackball_turns_freely_and_esc_takes_it_back(studio):
    viewport, document, key = shown(studio, orientation())
    viewport.set_tool("rotate")
    before = target_axes(document, key)
    gizmo = viewport.gizmo()
    free = next(
        QPoint(x, y)
        for x in range(round(gizmo.centre[0]) - 40, round(gizmo.centre[0]) + 40, 4)
        for y in range(round(gizmo.centre[1]) - 40, round(gizmo.centre[1]) + 40, 4)
        if gizmo.part_at(x, y) == "trackball"
    )
    drag(viewport, free, free + QPoint(30, 0), release=False)
    axis, degrees = about(target_axes(document, key) @ before.T)
    assert axis == pytest.approx(viewport.camera.axes[1], abs=1e-6)
    assert degrees == pytest.approx(np.degrees(30.0 / gizmo.radius), rel=1e-6)
    assert viewport.gesture.words == f"{degrees:.1f}°"
    QTest.keyClick(viewport, Qt.Key.Key_Escape)
    assert target_axes(document, key) == pytest.approx(before, abs=0)
    assert document.undo_stack.count() == 0


def test_a_keyed_orientation_gets_a_key_at_the_playhead(studio):
    viewport, document, key = shown(studio, orientation(target=KeyedTurn((0.0,), (TILTED,))))
    viewport.set_tool("rotate")
    drag(viewport, *on_front(viewport, "z", 30))
    keyed = document.project.constraints[key].target
    assert keyed.times == pytest.approx((0.0, 0.2))
    assert keyed.values[0] == pytest.approx(TILTED)
    assert document.undo_stack.undoText().startswith("Key")


def test_keys_alone_turn_by_a_step_about_the_axis_that_is_chosen(studio):
    viewport, document, key = shown(studio, orientation())
    before = target_axes(document, key)
    viewport.set_tool("rotate")
    for pressed in (Qt.Key.Key_X, Qt.Key.Key_Plus, Qt.Key.Key_Plus, Qt.Key.Key_Minus):
        QTest.keyClick(viewport, pressed)
    axis, degrees = about(target_axes(document, key) @ before.T)
    assert axis == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert degrees == pytest.approx(15.0)
    assert document.undo_stack.count() == 3


def test_a_look_at_target_goes_round_the_eyes(studio):
    base = make_constraint()
    made = LookAtConstraint(base.motion_id, "Look", EYES_POINT, Chain(), 5, base.activation, target=(3.0, 0.5, 1.5))
    viewport, document, key = shown(studio, made)
    viewport.set_tool("rotate")
    viewport.frame_all()
    settle(viewport)
    eyes = viewport.movable().pivot
    before = np.array(made.target) - eyes
    drag(viewport, *on_front(viewport, "z", 35), modifiers=CTRL)
    after = np.array(document.project.constraints[key].target) - eyes
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    assert after[2] == pytest.approx(before[2])
    assert np.degrees(np.arctan2(after[1], after[0]) - np.arctan2(before[1], before[0])) == pytest.approx(30.0)


def test_a_direction_that_is_kept_is_turned(studio):
    base = make_constraint()
    made = UprightConstraint(base.motion_id, "Tray", HAND, Chain(end_segment=1.0), 5, base.activation)
    viewport, document, key = shown(studio, made)
    viewport.set_tool("rotate")
    for pressed in (Qt.Key.Key_X, Qt.Key.Key_Plus):
        QTest.keyClick(viewport, pressed)
    step = np.radians(15.0)
    assert document.project.constraints[key].direction == pytest.approx((0.0, -np.sin(step), np.cos(step)))


def area(shape, **changes):
    base = make_constraint()
    return AreaConstraint(
        base.motion_id, "Table", HAND, Chain(), 5, base.activation,
        **{"shape": shape, "centre": (0.5, 0.0, 0.4), "size": (0.8, 0.6, 0.8), **changes},
    )  # fmt: skip


def test_a_table_is_turned_about_the_vertical_and_made_broader_by_its_handles(studio):
    viewport, document, key = shown(studio, area(AreaShape.TABLE))
    viewport.set_tool("rotate")
    drag(viewport, *on_front(viewport, "z", 35), modifiers=CTRL)
    assert document.project.constraints[key].heading == pytest.approx(np.radians(30.0))
    viewport.set_tool("scale")
    gizmo = viewport.gizmo()
    begin, end = (QPoint(*np.rint(gizmo.pixels_of(way * np.eye(3)[1:2])[0]).astype(int)) for way in (0.6, 0.9))
    drag(viewport, begin, end, modifiers=CTRL)
    size = document.project.constraints[key].size
    assert (size[0], size[2]) == (0.8, 0.8)
    assert size[1] == pytest.approx(0.9, abs=0.07)
    assert size[1] / 0.06 == pytest.approx(round(size[1] / 0.06))
    drag(viewport, begin, end, release=False)
    assert document.project.constraints[key].size != size
    viewport.cancel_gesture()
    assert document.project.constraints[key].size == size
    assert document.undo_stack.count() == 2


@pytest.mark.parametrize("shape", [AreaShape.TABLE, AreaShape.BOX, AreaShape.CYLINDER])
def test_an_area_is_tilted_by_the_rings_of_x_and_y_and_undone_exactly(studio, shape):
    viewport, document, key = shown(studio, area(shape, heading=0.4), heading=0.5)
    viewport.set_tool("rotate")
    before, now = document.project, Rotation.from_rotvec([0.0, 0.0, 0.9])
    assert viewport.movable().own_axes == pytest.approx(now.as_matrix())
    for ring, axis in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0))):
        begin, end = on_front(viewport, ring, 35)
        drag(viewport, begin, end, modifiers=CTRL)
        settle(viewport)
        turned = Rotation.from_matrix(viewport.movable().own_axes)
        by = (turned * now.inv()).as_rotvec()
        assert by == pytest.approx(np.sign(by @ axis) * np.radians(30.0) * np.array(axis), abs=1e-6)
        now = turned
    tilted = document.project.constraints[key]
    assert to_euler("ZYX", np.array(tilted.tilt))[0] == pytest.approx(0.0, abs=1e-9)  # all about Z is its heading
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert document.project.constraints == before.constraints


def test_a_keyed_tilt_gets_a_key_at_the_playhead(studio):
    viewport, document, key = shown(studio, area(AreaShape.BOX, tilt=KeyedTurn((0.0,), (UNTURNED,))))
    viewport.set_tool("rotate")
    for pressed in (Qt.Key.Key_X, Qt.Key.Key_Plus):
        QTest.keyClick(viewport, pressed)
    keys = document.project.constraints[key].tilt
    assert keys.values[-1] == pytest.approx(from_euler("X", np.radians([15.0])))
    assert len(keys.times) == (1 if document.playhead.time == 0.0 else 2)


def test_a_plane_tilts_every_way_and_has_no_size(studio):
    viewport, document, key = shown(studio, area(AreaShape.HALF_SPACE, size=(0.0, 0.0, 1.0)), heading=0.5)
    viewport.set_tool("rotate")
    for pressed in (Qt.Key.Key_Y, Qt.Key.Key_Plus):
        QTest.keyClick(viewport, pressed)
    step = np.radians(15.0)
    there = to_matrix(from_euler("Z", np.array([0.5]))) @ document.project.constraints[key].size
    assert there == pytest.approx((np.sin(step), 0.0, np.cos(step)))
    viewport.set_tool("scale")
    assert viewport.gizmo() is None


def test_a_prop_is_turned_about_all_three_axes_and_resized_with_what_keeps_bodies_out(studio):
    viewport, document, _ = studio
    prop_id = document.add("props", Prop("Box", position=(0.6, 0.6, 0.4), heading=0.3), "Add a box")
    set_obstacle(document, prop_id, True)
    document.selection.set(("props", prop_id))
    viewport.frame_selection()
    settle(viewport)
    before = document.project
    steps = document.undo_stack.count()
    viewport.set_tool("rotate")
    for pressed in (Qt.Key.Key_X, Qt.Key.Key_Plus, Qt.Key.Key_Y, Qt.Key.Key_Plus):
        QTest.keyClick(viewport, pressed)
    settle(viewport)
    turned = viewport.props[prop_id].axes
    step = np.radians(15.0)
    expected = to_matrix(from_euler("Y", np.array([step]))) @ to_matrix(from_euler("X", np.array([step])))
    assert turned == pytest.approx(expected @ to_matrix(from_euler("Z", np.array([0.3]))), abs=1e-9)
    viewport.set_tool("scale")
    gizmo = viewport.gizmo()
    centre = QPoint(*np.rint(gizmo.centre).astype(int))
    drag(viewport, centre, centre + QPoint(60, 0))
    size = document.project.props[prop_id].size
    assert min(size) > 0.5
    assert {each.size for each in document.project.constraints.values() if isinstance(each, AreaConstraint)} == {size}
    assert document.undo_stack.count() == steps + 3
    while document.undo_stack.count() and document.undo_stack.index() > steps:
        document.undo_stack.undo()
    assert document.project.props == before.props
    assert document.project.constraints == before.constraints


def test_a_box_on_the_ground_is_resized_upwards(studio):
    viewport, document, _ = studio
    prop_id = document.add("props", Prop("Box", position=(0.6, 0.6, 0.2), heading=0.3), "Add a box")
    document.selection.set(("props", prop_id))
    viewport.frame_selection()
    viewport.set_tool("scale")
    settle(viewport)
    centre = QPoint(*np.rint(viewport.gizmo().centre).astype(int))
    drag(viewport, centre, centre + QPoint(60, 0))
    prop = document.project.props[prop_id]
    assert prop.size[2] > 0.5
    assert prop.position == pytest.approx((0.6, 0.6, prop.size[2] / 2))


def test_a_target_is_moved_along_the_axes_of_its_parent(studio):
    viewport, document, key = shown(
        studio, make_constraint(name="Reach", priority=3, target=(0.5, -0.3, 1.2)), heading=0.6, position=(0.3, 0.1)
    )
    viewport.set_tool("move")
    before = np.array(document.project.constraints[key].target)
    viewport.next_gizmo_space()
    viewport.next_gizmo_space()
    for pressed in (Qt.Key.Key_X, Qt.Key.Key_Plus):
        QTest.keyClick(viewport, pressed)
    assert viewport.gizmo_space is Space.PARENT
    assert np.array(document.project.constraints[key].target) - before == pytest.approx([0.01, 0.0, 0.0])


def test_the_chip_says_whose_axes_and_goes_to_the_next_ones(studio):
    viewport, *_ = studio
    space = chip(viewport, "axes_of_the_gizmo:_world,_local,_parent_or_screen")
    assert space.text() == "World axes"
    QTest.mouseClick(space, LEFT, NONE)
    assert space.text() == "Local axes"
    assert viewport.gizmo_space is Space.LOCAL
    viewport.set_tool("select")
    assert not space.isVisible()
