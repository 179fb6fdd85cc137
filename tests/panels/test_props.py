"""Props in their form, on the menu and in the file."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QCheckBox, QComboBox, QPushButton

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.procedural import PendulumPlace
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.prop import Carried, InHand, Prop, PropShape
from studio.document.document import Document
from studio.document.obstacles import obstacles_of, set_obstacle
from studio.engine.posed_performer import posed_performers
from studio.engine.prop_places import moved_prop, prop_at, turned_prop
from studio.io.project.entity_json import entity_record
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from studio.viewport.prop_figures import unit_mesh
from studio.viewport.rotate_gizmo import rotation_about
from tests.builders import make_constraint, make_project
from tests.viewport.standing import StandingLive

SECOND = "performer 1"
WAY = np.array([0.1, 0.2, 0.3])
TETRAHEDRON = TriangleMesh(
    np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 4.0]]),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0).with_entity("props", "box", Prop("Box", heading=0.4))
    document = Document(project)
    document.selection.set(("props", "box"))
    yield document
    document.close()


@pytest.fixture
def live(document):
    return StandingLive(document)


@pytest.fixture
def form(document, live, qtbot):
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    yield inspector.current_form()
    inspector.deleteLater()  # which the form would not outlive


def choose(form, name, text):
    field = next(each for each in form.findChildren(QComboBox) if each.accessibleName() == name)
    field.setCurrentIndex(field.findText(text))
    field.activated.emit(field.currentIndex())


def at(document, live, time):
    posed = posed_performers(document.project, live.result, time)
    return prop_at(document.project, posed, "box", time)


def test_a_prop_swings_from_where_it_is_and_a_drag_moves_its_whole_way(document, form, live):
    choose(form, "Placement", "Pendulum")
    [length] = [each for each in form.findChildren(NumberField) if each.accessibleName() == "Length"]
    length.edited.emit(0.5)
    swing = document.project.props["box"].position
    assert (swing.kind, swing.centre, swing.length) == ("pendulum", (0.0, 0.0, 0.2), 0.5)
    here = at(document, live, 0.3)
    moved = moved_prop(here, here.place + WAY)
    assert moved.position.at([0.3, 0.9]) == pytest.approx(swing.at([0.3, 0.9]) + WAY)
    document.undo_stack.undo()
    document.undo_stack.undo()
    assert document.project.props["box"].position == (0.0, 0.0, 0.2)


def test_a_prop_is_keyed_where_it_is_and_gets_keys_at_the_playhead(document, form, live):
    choose(form, "Placement", "Animated")
    document.playhead.set_time(0.3)
    form._position.fields[0].setValue(1.5)
    prop = document.project.props["box"]
    assert prop.position.times == (0.0, pytest.approx(0.3))
    assert at(document, live, 0.3).place[0] == pytest.approx(1.5)
    assert at(document, live, 0.0).place[0] == pytest.approx(0.0)
    next(each for each in form.findChildren(QPushButton) if each.text() == "Delete key").click()
    assert len(document.project.props["box"].position.times) == 1
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert document.project.props["box"] == Prop("Box", heading=0.4)


def test_a_prop_in_a_hand_moves_with_it_and_is_let_go_where_it_is(document, form, live):
    choose(form, "Placement", "Attached to a body point")
    choose(form, "Carried by", document.project.performers[SECOND].name)
    held = document.project.props["box"].held
    assert isinstance(held, InHand)
    assert held.performer_id == SECOND
    begin, end = (at(document, live, time).place for time in (0.0, 0.3))
    assert end[0] - begin[0] > 0.1  # the body slides forward
    document.playhead.set_time(0.3)
    choose(form, "Placement", "Fixed")
    prop = document.project.props["box"]
    assert prop.held is None
    assert prop.position == pytest.approx(end)
    assert prop.heading == pytest.approx(0.4)


@pytest.mark.parametrize("placement", ["Attached to a body point", "Fixed"])
def test_hands_leave_a_box_that_they_carry_no_longer_in_one_step(document, form, placement):
    choose(form, "Placement", "Carried in both hands")
    held = document.project.props["box"].held
    grips = tuple(document.project.constraints.values())
    assert len(grips) == 4
    steps = document.undo_stack.count()
    choose(form, "Carried by", document.project.performers[held.performer_id].name)
    assert tuple(document.project.constraints.values()) == grips  # the same hands carry it
    document.undo_stack.setIndex(steps)
    choose(form, "Placement", placement)
    assert not document.project.constraints
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert tuple(document.project.constraints.values()) == grips
    assert document.project.props["box"].held == held


def test_a_prop_is_where_the_picture_has_it_while_its_holder_plays_a_motion_that_is_gone(document, form, live):
    choose(form, "Placement", "Attached to a body point")
    choose(form, "Carried by", document.project.performers[SECOND].name)
    posed = posed_performers(document.project, live.result, 0.0)
    here = at(document, live, 0.0).place
    without = replace(document.project, motions={})
    assert prop_at(without, posed, "box", 0.0).place == pytest.approx(here)


def test_dragging_a_prop_that_is_held_moves_it_in_the_hand(document, form, live):
    for held in (InHand(SECOND, BodyPoint(BodyPart.RIGHT_HAND), (0.1, 0.2, 0.3, 0.9)), Carried(SECOND)):
        document.replace("props", "box", replace(document.project.props["box"], held=held), "")
        pose = at(document, live, 0.2)
        document.replace("props", "box", moved_prop(pose, pose.place + WAY), "")
        assert at(document, live, 0.2).place == pytest.approx(pose.place + WAY)


PLACES = {
    "lying": {},
    "tilted": {"tilt": (0.1, 0.2, 0.3, 0.9)},
    "keyed heading": {"heading": KeyedNumber((0.0, 1.0), (0.2, 7.0))},
    "keyed tilt": {"tilt": KeyedTurn((0.0, 1.0), ((0.0, 0.0, 0.0, 1.0), (0.4, 0.1, 0.2, 0.8)))},
    "in a hand": {"held": InHand(SECOND, BodyPoint(BodyPart.RIGHT_HAND), (0.1, 0.2, 0.3, 0.9))},
    "carried": {"held": Carried(SECOND, heading=0.3, tilt=(0.2, 0.0, 0.1, 0.9))},
}


@pytest.mark.parametrize("where", PLACES)
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.48, -0.6, 0.64)])
def test_a_prop_turns_about_any_axis_through_its_centre_wherever_it_is(document, live, where, axis, tmp_path):
    document.replace("props", "box", replace(document.project.props["box"], **PLACES[where]), "")
    pose = at(document, live, 0.2)
    rotation = rotation_about(np.array(axis), 0.5)
    document.replace("props", "box", turned_prop(pose, rotation), "")
    turned = at(document, live, 0.2)
    assert turned.place == pytest.approx(pose.place)
    assert turned.axes == pytest.approx(rotation @ pose.axes, abs=1e-9)
    write_project(tmp_path / "turned.studio", document.project, new_document_id())
    assert read_project(tmp_path / "turned.studio").project.props == document.project.props


def test_a_keyed_heading_that_is_turned_keeps_its_whole_turns(document, live):
    keyed = KeyedNumber((0.0, 1.0), (0.0, 4.0 * np.pi))
    document.replace("props", "box", replace(document.project.props["box"], heading=keyed), "")
    turned = turned_prop(at(document, live, 1.0), rotation_about(np.array([0.0, 0.0, 1.0]), 0.5))
    assert turned.heading.values == pytest.approx((0.0, 4.0 * np.pi + 0.5))


def test_a_tilted_prop_is_stored_with_a_schema_of_its_own_and_a_level_one_as_before():
    level, tilted = Prop("Box"), Prop("Box", tilt=(0.1, 0.0, 0.0, 0.9))
    records = [entity_record("props", "box", prop, {}) for prop in (level, tilted, replace(level, held=Carried("one")))]
    assert [record["schema"] for record in records] == [2, 5, 2]
    assert "tilt" not in records[0]
    assert "tilt" not in records[2]["held"]


def test_what_an_older_version_would_misread_has_a_higher_schema():
    steady = Prop("Box", held=Carried("one", (0.4, 0.0, 0.3), steady=True))
    wrist, curve = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), ActivationCurve(0.0, 0.1, 0.3, 0.4)
    plain = AreaConstraint("motion", "Table", wrist, Chain(), 0, curve)
    areas = [entity_record("constraints", "area", replace(plain, margin=margin), {}) for margin in (0.0, 0.1)]
    assert entity_record("props", "box", steady, {})["schema"] == 6
    assert [record["schema"] for record in areas] == [3, 5]
    assert "margin" not in areas[0]


def test_a_prop_that_is_let_go_of_stays_as_it_was_in_the_hand(document, live, form):
    held = InHand(SECOND, BodyPoint(BodyPart.RIGHT_HAND), (0.1, 0.2, 0.3, 0.9))
    document.replace("props", "box", replace(document.project.props["box"], held=held), "")
    before = at(document, live, document.playhead.time)
    choose(form, "Placement", "Fixed")
    after = at(document, live, document.playhead.time)
    assert document.project.props["box"].held is None
    assert after.place == pytest.approx(before.place)
    assert after.axes == pytest.approx(before.axes, abs=1e-9)


def test_a_target_is_given_a_place_on_the_prop_that_goes_with_its_size(document, live, qtbot):
    constraint = document.add("constraints", make_constraint(target=FollowProp("box", (0.1, 0.0, 0.0))), "")
    document.selection.set(("performers", "performer 0"), ("constraints", constraint))
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    choose(inspector.current_form(), "Position on the prop", "Left side")
    assert document.project.constraints[constraint].target == FollowProp("box", share=(0.0, 1.0, 0.0))


def test_who_is_removed_lets_go_of_what_it_held_and_undo_gives_it_back(document):
    document.replace("props", "box", replace(document.project.props["box"], held=Carried(SECOND)), "")
    before = document.project
    document.remove("performers", SECOND, "Remove")
    assert document.project.props["box"].held is None
    document.undo_stack.undo()
    assert document.project.props == before.props


@pytest.mark.parametrize("shape", PropShape)
def test_every_shape_fills_its_size(shape):
    mesh = unit_mesh(Prop("Thing", shape=shape, mesh=TETRAHEDRON if shape is PropShape.MESH else None))
    assert np.array(mesh.bounds) == pytest.approx([-0.5, 0.5] * 3, abs=0.01)


def test_props_of_every_kind_are_saved_and_read_again(tmp_path):
    project = make_project(characters=1)
    hand = BodyPoint(BodyPart.LEFT_HAND, (0.0, 0.1, 0.0))
    keyed = KeyedPlace((0.0, 1.0), ((0, 0, 0), (1, 2, 3)))
    props = {
        "keyed": Prop("Ball", position=keyed, heading=KeyedNumber((0.5,), (1.0,)), shape=PropShape.BALL),
        "stick": Prop("Stick", shape=PropShape.STICK, held=InHand("performer 0", hand, (0.0, 0.0, 0.6, 0.8))),
        "box": Prop("Box", held=Carried("performer 0", (0.4, 0.0, 0.3), begin=0.5, end=1.5)),
        "swing": Prop("Bob", position=PendulumPlace(centre=(1.0, 0.0, 0.5), angle=0.3)),
        "mesh": Prop("Chair", (2.0, 1.0, 4.0), shape=PropShape.MESH, mesh=TETRAHEDRON),
    }
    for key, prop in props.items():
        project = project.with_entity("props", key, prop)
    write_project(tmp_path / "props.studio", project, new_document_id())
    assert dict(read_project(tmp_path / "props.studio").project.props) == props


def test_how_a_prop_is_held_is_changed_while_when_stays(document, form, live):
    prop = document.project.props["box"]
    document.replace("props", "box", replace(prop, held=Carried(SECOND, begin=0.1, end=0.3)), "Hold")
    assert form._held.text() == "0.10 s to 0.30 s"
    choose(form, "Placement", "Attached to a body point")
    held = document.project.props["box"].held
    assert (held.kind, held.begin, held.end) == ("in_hand", 0.1, 0.3)
    form._always.click()
    assert document.project.props["box"].held.is_always


@pytest.mark.parametrize("size", [0.1, 0.6])
def test_what_hands_that_hang_carry_is_before_the_body_and_not_in_it(document, live, form, size):
    """Its middle was between the hands, inside the hips."""
    document.replace("props", "box", Prop("Box", (size, size, size)), "Resize")
    form.document.selection.set(("performers", SECOND), ("props", "box"))
    choose(form, "Placement", "Carried in both hands")
    holder = posed_performers(document.project, live.result, 0.0)[SECOND]
    root, chest = holder.points[0], holder.placement.rotation @ holder.motion.rotations[0, 0, :, 0]
    way = at(document, live, 0.0).place - root
    leg = holder.motion.morphology.leg_length
    assert way @ chest - size / 2 > 0.2 * leg
    assert way[2] > 0.1 * leg


def test_a_prop_that_collides_keeps_whole_bodies_out_at_any_size_and_lets_them_through_again(document, form, qtbot):
    [collides] = [each for each in form.findChildren(QCheckBox) if each.text() == "Collide with characters"]
    collides.click()
    [(key, area)] = obstacles_of(document.project, "box").items()
    assert (area.shape, area.centre, area.size, area.whole) == ("box", FollowProp("box"), (0.4, 0.4, 0.4), True)
    parts = {each.constraint.point.part.value for each in constraints_of_performer(document.project, "performer 0")}
    assert {"left_forearm", "right_upper_arm", "left_thigh", "pelvis", "thorax", "neck"} <= parts
    assert {each.constraint_id for each in constraints_of_performer(document.project, "performer 0")} == {key}
    for axis, side in enumerate((0.5, 0.6, 0.7)):
        form._size._set(axis, side)
    assert document.project.constraints[key].size == document.project.props["box"].size == (0.5, 0.6, 0.7)
    document.undo_stack.undo()
    assert document.project.constraints[key].size == document.project.props["box"].size == (0.5, 0.6, 0.4)
    assert collides.isChecked()
    collides.click()
    assert not document.project.constraints


def test_an_area_has_a_margin_while_its_point_stays_outside(document, live, qtbot):
    area = AreaConstraint(
        "motion",
        "Table",
        BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True),
        Chain(),
        0,
        ActivationCurve(0.0, 0.1, 0.3, 0.4),
    )
    key = document.add("constraints", area, "Add")
    document.selection.set(("constraints", key))
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    inspector.show()
    form = inspector.current_form()
    [margin] = [each for each in form.findChildren(NumberField) if each.accessibleName() == "Margin"]
    margin.setValue(0.05)
    assert document.project.constraints[key].margin == 0.05
    form._set_side("inside")
    assert document.project.constraints[key].margin == 0.0
    assert not margin.isVisible()
    document.undo_stack.undo()
    assert document.project.constraints[key].margin == 0.05


def type_height(form, metres):
    field = next(each for each in form.findChildren(NumberField) if each.accessibleName() == "Size Z")
    QTest.mouseClick(field.lineEdit(), Qt.MouseButton.LeftButton)
    field.lineEdit().selectAll()
    QTest.keyClicks(field, str(metres))
    QTest.keyClick(field, Qt.Key.Key_Return)


def test_a_prop_that_is_made_higher_stays_on_the_ground(form, document):
    before = document.project.props["box"]
    type_height(form, 1.0)
    prop = document.project.props["box"]
    assert (prop.size, prop.position) == ((0.4, 0.4, 1.0), (0.0, 0.0, 0.5))
    document.undo_stack.undo()
    assert document.project.props["box"] == before


def test_a_keyed_prop_that_is_made_higher_stays_on_the_ground_at_every_key(form, document):
    keyed = KeyedPlace((0.0, 1.0), ((0.0, 0.0, 0.2), (1.0, 0.0, 0.7)))
    document.replace("props", "box", replace(document.project.props["box"], position=keyed), "Key")
    type_height(form, 1.0)
    assert document.project.props["box"].position.values == ((0.0, 0.0, 0.5), (1.0, 0.0, 1.0))


def test_a_prop_in_the_air_is_resized_about_its_centre(form, document):
    document.replace("props", "box", replace(document.project.props["box"], position=(0.0, 0.0, 1.2)), "Move")
    type_height(form, 1.0)
    assert document.project.props["box"].position == (0.0, 0.0, 1.2)


def test_props_that_are_resized_together_keep_their_other_sides_and_take_their_obstacles_along(form, document):
    document.add("props", Prop("Shelf", size=(1.0, 0.3, 0.4), position=(2.0, 0.0, 0.2)), "Add")
    (shelf,) = set(document.project.props) - {"box"}
    set_obstacle(document, shelf, True)
    document.selection.set(("props", shelf), ("props", "box"))
    type_height(form, 1.0)
    assert document.project.props[shelf].size == (1.0, 0.3, 1.0)
    assert document.project.props[shelf].position == (2.0, 0.0, 0.5)
    assert {each.size for each in obstacles_of(document.project, shelf).values()} == {(1.0, 0.3, 1.0)}
