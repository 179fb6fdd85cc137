"""Constraints in a file: one format with projects, and errors that name the member."""

import json

import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.curves.activation import EaseShape
from studio.core.errors import StudioError
from studio.io.project.constraint_file import constraint_record, read_constraints
from studio.io.project.entity_json import entity_record
from tests.architecture.sources import ROOT
from tests.builders import make_constraint

WRIST = {
    "kind": "position",
    "name": "Right wrist",
    "point": {"part": "right_forearm", "at_end": True},
    "target": [0.4, -0.3, 1.2],
    "activation": {"start": 0, "full": 0.1, "full_end": 0.3, "end": 0.4, "shape": "smooth"},
}


NAN, INFINITY = float("nan"), float("inf")


def written(folder, record):
    path = folder / "targets.json"
    path.write_text(record if isinstance(record, str) else json.dumps(record))
    return path


def test_a_constraint_needs_only_what_cannot_be_guessed(tmp_path):
    file = read_constraints(written(tmp_path, {"constraints": [WRIST]}), "m")
    [constraint] = file.constraints
    assert (constraint.motion_id, constraint.name, constraint.priority) == ("m", "Right wrist", 0)
    assert constraint.point.part is BodyPart.RIGHT_FOREARM
    assert constraint.activation.shape is EaseShape.SMOOTH
    assert (constraint.chain.limb, constraint.chain.trunk) == (1.0, 0.0)
    assert file.contacts is None


def test_a_record_copied_out_of_a_project_is_read_as_it_is(tmp_path):
    constraint = make_constraint("m")
    record = entity_record("constraints", "some id", constraint, {})
    file = read_constraints(written(tmp_path, {"constraints": [record]}), "m")
    assert file.constraints == (constraint,)


def test_constraints_come_as_they_stand_in_the_file(tmp_path):
    asked = [("late", 7), ("first", 0), ("middle", 2), ("second", 0)]
    record = {
        "constraints": [
            {**WRIST, "name": name, "priority": priority, "point": {"part": part}}
            for (name, priority), part in zip(asked, ("head", "left_foot", "right_hand", "left_hand"), strict=True)
        ]
    }
    names = [constraint.name for constraint in read_constraints(written(tmp_path, record), "m").constraints]
    assert names == ["late", "first", "middle", "second"]


def test_contacts_are_read_by_foot(tmp_path):
    file = read_constraints(written(tmp_path, {"contacts": {"left_toe": [[3, 12]], "right_heel": []}}), "m")
    assert file.constraints == ()
    assert file.contacts == (ContactInterval("m", ContactPoint.LEFT_TOE, 3, 12),)


def test_the_example_in_the_guide_is_read(tmp_path):
    guide = (ROOT / "docs" / "headless.md").read_text(encoding="utf-8")
    example = guide.split("```json\n")[1].split("```")[0]
    file = read_constraints(written(tmp_path, example), "m")
    assert (len(file.constraints), len(file.contacts)) == (1, 2)


@pytest.mark.parametrize(
    ("record", "member"),
    [
        ("{", "line 1"),
        ("[]", "'constraints'"),
        ({"constraints": {}}, "'constraints'"),
        ({"constrains": []}, "'constrains' is not known"),
        ({"constraints": [3]}, r"constraints\[0\]: expected a record, not '3'"),
        (
            {"constraints": [WRIST, {**WRIST, "kind": "magnet"}]},
            r"constraints\[1\] \('Right wrist'\), kind: expected one of position.*not 'magnet'",
        ),
        ({"constraints": [{**WRIST, "chain": {"arm": 1}}]}, r"'Right wrist'\): 'chain.arm' is not known"),
        ({"constraints": [{**WRIST, "chain": {"limb": 7}}]}, r"'Right wrist'\), chain: .*limb is 7"),
        ({"constraints": [{**WRIST, "chain": {"segments": [["thorax", 7]]}}]}, "chain: .*thorax is 7"),
        ({"constraints": [{**WRIST, "chain": {"segments": [["left_hand", 0]]}}]}, "hand cannot have a weight override"),
        ({"constraints": [{**WRIST, "chain": {"segments": [["tail", 0]]}}]}, "chain: segments: one of pelvis"),
        (
            {"constraints": [{**WRIST, "weight": -1}]},
            r"'Right wrist'\), the weight must be a finite number of 0 or more, not -1",
        ),
        (
            {"constraints": [{**WRIST, "point": {"part": "tail"}}]},
            "'Right wrist'.*point: part: one of pelvis.* expected, not 'tail'",
        ),
        ({"constraints": [{**WRIST, "target": [1, 2]}]}, r"'Right wrist'\), target: a list of 3"),
        ({"constraints": [{**WRIST, "target": [1, 2, "x"]}]}, r"'Right wrist'\), target: a number"),
        ({"constraints": [{**WRIST, "activation": {"start": 0}}]}, r"'Right wrist'\), activation: .*missing"),
        (
            {"constraints": [{**WRIST, "activation": {**WRIST["activation"], "full": 9}}]},
            r"'Right wrist'\), activation: .*in order",
        ),
        (
            {"constraints": [{**WRIST, "priority": -1}]},
            r"'Right wrist'\), the priority must be 0 \(highest\) or more, not -1",
        ),
        ({"constraints": [{**WRIST, "priority": 0.5}]}, r"'Right wrist'\), priority: a whole number expected"),
        ({"constraints": [{**WRIST, "priority": NAN}]}, r"'Right wrist'\), priority: a whole number expected"),
        (
            {"constraints": [{**WRIST, "target": [0, NAN, 0]}]},
            r"'Right wrist'\), a target must be three finite numbers",
        ),
        ({"constraints": [{**WRIST, "target": [0, 0, -INFINITY]}]}, r"'Right wrist'\), a target must be three finite"),
        ({"constraints": [{**WRIST, "target": NAN}]}, r"'Right wrist'\), target: a list expected, not 'nan'"),
        ({"constraints": [{**WRIST, "chain": {"limb": NAN}}]}, r"'Right wrist'\), chain: .*limb is nan"),
        (
            {"constraints": [{**WRIST, "point": {"part": "head", "offset": [0, 0, NAN]}}]},
            r"'Right wrist'\), point: A point's offset must be three finite",
        ),
        (
            {"constraints": [{**WRIST, "activation": {**WRIST["activation"], "end": INFINITY}}]},
            r"'Right wrist'\), activation: .*four finite times",
        ),
        (
            {"constraints": [{**WRIST, "activation": {**WRIST["activation"], "shape": "bouncy"}}]},
            r"'Right wrist'\), activation: shape: one of linear, smooth, quintic expected, not 'bouncy'",
        ),
        ({"constraints": [{**WRIST, "target": [0, 1e300, 0]}]}, r"'Right wrist'\), target, 1: 1e\+300 is out of range"),
        (
            {"constraints": [{**WRIST, "priority": 10**400}]},
            r"'Right wrist'\), priority: 10000000000000000000 is out of range",
        ),
        ({"constraints": [{k: v for k, v in WRIST.items() if k != "kind"}]}, "'Right wrist'.* kind: .* it says none"),
        ({"constraints": [{**WRIST, "colour": NAN}]}, "'Right wrist'.*'colour' is not known"),
        ({"constraints": [{k: v for k, v in WRIST.items() if k != "name"}]}, r"constraints\[0\], name missing"),
        ('{"constraints": [], "contacts": NaN}', "contacts: expected a record"),
        ({"contacts": []}, "contacts: expected a record"),
        ({"contacts": {"left_elbow": []}}, "left_elbow: expected lists .* by left_heel"),
        ({"contacts": {"left_toe": [[1, 2, 3]]}}, r"left_toe\[0\]: expected two frames"),
        ({"contacts": {"left_toe": [[NAN, 2]]}}, r"left_toe\[0\]: expected two frames"),
        ({"contacts": {"left_toe": [[9, 2]]}}, r"left_toe\[0\]: A contact runs"),
    ],
)
def test_what_is_wrong_is_named_with_file_and_member(tmp_path, record, member):
    path = written(tmp_path, record)
    with pytest.raises(StudioError, match=member) as error:
        read_constraints(path, "m")
    assert str(path) in str(error.value)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(StudioError, match=r"targets\.json"):
        read_constraints(tmp_path / "targets.json", "m")


def test_contradictions_and_doubles_are_named_with_their_place_in_the_file(tmp_path):
    other = {**WRIST, "name": "Other wrist", "target": [0.0, 0.0, 1.0]}
    with pytest.raises(StudioError, match=r"constraints\[1\]: 'Other wrist' conflicts with 'Right wrist'"):
        read_constraints(written(tmp_path, {"constraints": [WRIST, other]}), "motion")
    with pytest.raises(StudioError, match=r"constraints\[1\]: 'Again' duplicates 'Right wrist'"):
        read_constraints(written(tmp_path, {"constraints": [WRIST, {**WRIST, "name": "Again"}]}), "motion")
    assert (
        len(read_constraints(written(tmp_path, {"constraints": [WRIST, {**other, "priority": 1}]}), "m").constraints)
        == 2
    )


def test_a_mesh_may_be_a_file_beside_or_stand_in_the_record(tmp_path):
    (tmp_path / "rock.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n")
    asked = {**WRIST, "kind": "area", "shape": "mesh", "mesh": "rock.obj"}
    del asked["target"]
    [named] = read_constraints(written(tmp_path, {"constraints": [asked]}), "m").constraints
    assert len(named.mesh.triangles) == 4
    [inline] = read_constraints(written(tmp_path, {"constraints": [constraint_record(named)]}), "m").constraints
    assert inline == named
    with pytest.raises(
        StudioError, match=r"targets.json, constraints\[0\], mesh: .*sand.obj could not be read: there is no such file"
    ):
        read_constraints(written(tmp_path, {"constraints": [{**asked, "mesh": "sand.obj"}]}), "m")
