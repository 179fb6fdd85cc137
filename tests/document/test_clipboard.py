"""Constraints, contacts and keys are copied as readable JSON and pasted elsewhere, mirrored if asked."""

import json
from dataclasses import replace

import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.curves.tangents import Tangent, TangentMode, Tangents
from studio.core.errors import StudioError
from studio.core.stage.correction import PoseOffsets, new_correction
from studio.core.stage.prop import Prop
from studio.document.clipboard import paste_json, selection_as_json
from studio.document.document import Document
from studio.document.keyed_fields import KeyedField, KeyRef
from tests.builders import make_constraint, make_contact, make_project

SIDE = Tangent(TangentMode.FREE, (0.0, 1.0, 0.5))
KEYS = KeyedPlace((0.1, 0.2, 0.3), ((0.4, -0.3, 1.2), (0.5, -0.2, 1.3), (0.4, -0.1, 1.2)))
BENT = KEYS.with_tangents(1, Tangents(SIDE, SIDE))
FIELD = KeyedField("constraints", "reach", "target")


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0, contacts=0, frames=61)
    project = project.with_entity("constraints", "reach", make_constraint(name="Right reach", target=BENT))
    project = project.with_entity("contacts", "heel", make_contact(point=ContactPoint.LEFT_HEEL, first=3, last=12))
    document = Document(project)
    document.selection.set(("constraints", "reach"))
    yield document
    document.close()


def new_constraint(document, before):
    [key] = set(document.project.constraints) - before
    return document.project.constraints[key]


def test_what_is_copied_is_json_that_a_person_can_read(document):
    document.selection.set(("constraints", "reach"), ("contacts", "heel"))
    text = selection_as_json(document)
    record = json.loads(text)
    assert record["constraints"][0]["name"] == "Right reach"
    assert record["contacts"] == [
        {"point": "left_heel", "first": 3, "last": 12, "scope": record["contacts"][0]["scope"]}
    ]
    assert "[0.4, -0.3, 1.2]" in text
    assert "motion_id" not in record["constraints"][0]


def test_a_constraint_pasted_where_it_was_begins_at_the_playhead(document):
    text, before = selection_as_json(document), set(document.project.constraints)
    rate = document.project.captures["capture"].frame_rate
    document.playhead.set_time(0.5)
    start = round(0.5 * rate) / rate
    paste_json(document, text)
    new = new_constraint(document, before)
    assert new.activation.start == pytest.approx(start)
    assert new.target.times == pytest.approx([time + start for time in KEYS.times])
    assert new.target.tangents == BENT.tangents
    assert new.name != "Right reach"
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert set(document.project.constraints) == before


def test_undo_of_a_paste_selects_what_was_selected_before_and_redo_what_was_pasted(document):
    text, before = selection_as_json(document), document.selection.items
    document.playhead.set_time(0.5)
    paste_json(document, text)
    pasted = document.selection.items
    assert pasted != before
    document.undo_stack.undo()
    assert document.selection.items == before
    document.undo_stack.redo()
    assert document.selection.items == pasted


def test_a_constraint_pasted_on_another_body_is_of_it_alone_and_keeps_its_times(document):
    text, before = selection_as_json(document), set(document.project.constraints)
    document.selection.set(("performers", "performer 1"))
    document.playhead.set_time(0.5)
    paste_json(document, text)
    new = new_constraint(document, before)
    assert new.scope == Scope(performer_id="performer 1")
    assert new.activation == make_constraint().activation
    assert ("performers", "performer 1") in document.selection


def test_a_constraint_is_pasted_mirrored_and_its_name_says_the_other_side(document):
    text, before = selection_as_json(document), set(document.project.constraints)
    paste_json(document, text, mirrored=True)
    new = new_constraint(document, before)
    assert new.name == "Left reach"
    assert new.point.part.value == "left_forearm"
    assert new.target.values[0] == pytest.approx((0.4, 0.3, 1.2))
    assert new.target.tangents[1].leaving.rate == pytest.approx((0.0, -1.0, 0.5))
    assert new.activation == make_constraint().activation


def test_contacts_are_pasted_in_the_place_of_those_they_cover(document):
    document.selection.set(("contacts", "heel"))
    text = selection_as_json(document)
    rate = document.project.captures["capture"].frame_rate
    document.playhead.set_time(8 / rate)
    paste_json(document, text)
    spans = [(each.first, each.last) for each in document.project.contacts.values()]
    assert spans == [(8, 17)]
    document.selection.set(*(("contacts", key) for key in document.project.contacts))
    paste_json(document, selection_as_json(document), mirrored=True)
    assert {each.point for each in document.project.contacts.values()} == {
        ContactPoint.LEFT_HEEL,
        ContactPoint.RIGHT_HEEL,
    }


def test_what_is_pasted_before_its_clip_begins_at_the_begin_of_the_motion(document):
    performer_id = document.active_performer_id
    performer = document.project.performers[performer_id]
    later = replace(performer, clips=(replace(performer.clips[0], start=1.0),))
    document.replace("performers", performer_id, later, "Move clip")
    document.selection.set(("constraints", "reach"), ("contacts", "heel"))
    text, before = selection_as_json(document), set(document.project.constraints)
    document.playhead.set_time(0.5)
    paste_json(document, text)
    [contact] = [each for key, each in document.project.contacts.items() if key != "heel"]
    assert new_constraint(document, before).activation.start == 0.0
    assert (contact.first, contact.last) == (3, 12)


def test_a_paste_in_another_project_gives_the_same_constraint(document):
    text = selection_as_json(document)
    other = Document(make_project(characters=1, constraints=0, contacts=0, frames=40))
    paste_json(other, text)
    [new] = other.project.constraints.values()
    assert new.target == BENT.moved(0.0)
    assert new.point == make_constraint().point
    other.close()


def test_keys_are_pasted_at_the_playhead_with_their_tangents(document):
    document.keys.set([KeyRef(FIELD, 0), KeyRef(FIELD, 1)])
    text = selection_as_json(document)
    document.playhead.set_time(0.5)
    paste_json(document, text)
    target = document.project.constraints["reach"].target
    assert target.times == pytest.approx((0.1, 0.2, 0.3, 0.5, 0.6))
    assert target.values[3:] == KEYS.values[:2]
    assert target.tangents[4] == BENT.tangents[1]
    assert {key.place for key in document.keys.items} == {3, 4}
    assert document.undo_stack.undoText() == "Paste 2 keys"


def test_keys_are_pasted_on_other_constraints_and_props_mirrored_if_asked(document):
    document.keys.set([KeyRef(FIELD, 0), KeyRef(FIELD, 2)])
    text = selection_as_json(document)
    other = document.add("constraints", make_constraint(name="Left", priority=1), "Add")
    ball = document.add("props", Prop("Ball", position=(0.0, 0.0, 0.5)), "Add")
    document.playhead.set_time(0.0)
    document.selection.set(("constraints", other), ("props", ball))
    paste_json(document, text, mirrored=True)
    for value in (document.project.constraints[other].target, document.project.props[ball].position):
        assert value.times == pytest.approx((0.0, 0.2))
        assert value.values[0] == pytest.approx((0.4, 0.3, 1.2))
    document.undo_stack.undo()
    assert document.project.props[ball].position == (0.0, 0.0, 0.5)


def test_keys_of_a_weight_are_pasted_on_the_weight_of_another_constraint(document):
    crossing = KeyedNumber((0.1, 0.3), (0.0, 1.0))
    document.replace("constraints", "reach", replace(document.project.constraints["reach"], weight=crossing), "Key")
    weight = KeyedField("constraints", "reach", "weight")
    document.keys.set([KeyRef(weight, 0), KeyRef(weight, 1)])
    text = selection_as_json(document)
    other = document.add("constraints", make_constraint(name="Left", priority=1), "Add")
    document.playhead.set_time(0.0)
    document.selection.set(("constraints", other))
    paste_json(document, text)
    pasted = document.project.constraints[other]
    assert pasted.weight.times == pytest.approx((0.0, 0.2))
    assert pasted.weight.values == (0.0, 1.0)


def test_keys_of_an_angle_are_not_pasted_as_metres(document):
    heading = document.add("props", Prop("Box", heading=KeyedNumber((0.1, 0.3), (0.2, 0.4))), "Add")
    apart = DistanceConstraint(
        "motion", "Apart", BodyPoint(BodyPart.LEFT_FOREARM), Chain(), 1, ActivationCurve(0.0, 0.1, 0.3, 0.4),
        other=BodyPoint(BodyPart.RIGHT_FOREARM), distance=KeyedNumber((0.1, 0.3), (0.2, 0.4)),
    )  # fmt: skip
    distance = document.add("constraints", apart, "Add")
    document.keys.set([KeyRef(KeyedField("props", heading, "heading"), 1)])
    text = selection_as_json(document)
    document.selection.set(("constraints", distance))
    with pytest.raises(StudioError):
        paste_json(document, text)
    assert document.project.constraints[distance] == apart


@pytest.mark.parametrize(
    "text",
    [
        "",
        "hello",
        "[1, 2]",
        '{"format": "something else"}',
        '{"format": "morpho-studio clipboard", "version": 9}',
        '{"format": "morpho-studio clipboard", "version": 1}',
        '{"format": "morpho-studio clipboard", "version": 1, "constraints": [{"kind": "no"}]}',
        '{"format": "morpho-studio clipboard", "version": 1, "contacts": [{"point": "left_heel"}]}',
        '{"format": "morpho-studio clipboard", "version": 1, "keys": [{"kind": "places", "keys": {"times": []}}]}',
        '{"format": "morpho-studio clipboard", "version": 1, "keys": 3}',
    ],
)
def test_anything_else_on_the_clipboard_is_refused_in_a_sentence_and_changes_nothing(document, text):
    before = document.project
    with pytest.raises(StudioError):
        paste_json(document, text)
    assert document.project is before


def test_a_constraint_of_a_body_that_is_not_there_is_pasted_for_all(document):
    reach = document.project.constraints["reach"]
    document.replace("constraints", "reach", replace(reach, scope=Scope(performer_id="performer 1")), "Scope")
    text = selection_as_json(document)
    other = Document(make_project(characters=1, constraints=0, contacts=0, frames=40))
    paste_json(other, text)
    [new] = other.project.constraints.values()
    assert not new.scope.is_narrow
    other.close()


def test_a_correction_is_pasted_at_the_playhead_on_another_body_and_mirrored(document):
    turn = ((BodyPart.LEFT_FOREARM, (0.4, 0.0, 0.0)),)
    first, second = document.project.performers
    key = document.add("corrections", new_correction("Left elbow", first, 0.5, PoseOffsets(turn)), "")
    document.selection.set(("corrections", key))
    text = selection_as_json(document)
    pose = {"turns": [["left_forearm", [0.4, 0.0, 0.0]]], "hips": [0.0, 0.0, 0.0]}
    keys = json.loads(text)["corrections"][0]["keys"]
    assert keys == {"kind": "keyed", "times": [0.5], "values": [pose]}
    document.playhead.set_time(0.8)
    here = document.playhead.time
    paste_json(document, text)
    [(_, pasted)] = [each for each in document.selection.items if each != ("corrections", key)]
    assert document.project.corrections[pasted].keys.times[0] == pytest.approx(here)
    assert document.project.corrections[pasted].name != "Left elbow"
    before = set(document.project.corrections)
    document.selection.set(("performers", second))
    paste_json(document, text, mirrored=True)
    [new] = set(document.project.corrections) - before
    other = document.project.corrections[new]
    assert (other.name, other.performer_id, other.keys.times[0]) == ("Right elbow", second, 0.5)
    assert other.keys.parts == (BodyPart.RIGHT_FOREARM,)
    document.undo_stack.undo()
    assert set(document.project.corrections) == before
