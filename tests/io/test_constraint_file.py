"""Constraints in a file: one format with projects, and errors that name the member."""

import json

import pytest

from studio.core.canonical import BodyPart
from studio.core.constraints.activation import EaseShape
from studio.core.contacts import ContactInterval, FootPoint
from studio.core.errors import StudioError
from studio.io.constraint_file import read_constraints
from studio.io.entity_json import entity_record
from tests.architecture.sources import ROOT
from tests.builders import make_constraint

WRIST = {
    "kind": "position",
    "name": "Right wrist",
    "point": {"part": "right_forearm", "at_end": True},
    "target": [0.4, -0.3, 1.2],
    "activation": {"start": 0, "full": 0.1, "full_end": 0.3, "end": 0.4, "shape": "smooth"},
}


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


def test_contacts_are_read_by_foot(tmp_path):
    file = read_constraints(written(tmp_path, {"contacts": {"left_toe": [[3, 12]], "right_heel": []}}), "m")
    assert file.constraints == ()
    assert file.contacts == (ContactInterval("m", FootPoint.LEFT_TOE, 3, 12),)


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
        ({"constraints": [3]}, r"constraints\[0\], kind"),
        ({"constraints": [WRIST, {**WRIST, "kind": "magnet"}]}, r"constraints\[1\], kind: expected one of position"),
        ({"constraints": [{**WRIST, "chain": {"arm": 1}}]}, r"constraints\[0\]: 'chain.arm' is not known"),
        ({"constraints": [{**WRIST, "chain": {"limb": 7}}]}, r"constraints\[0\], chain: .*limb is 7"),
        ({"constraints": [{**WRIST, "point": {"part": "tail"}}]}, "'tail' is no part of a body. Parts are pelvis"),
        ({"constraints": [{**WRIST, "target": [1, 2]}]}, r"constraints\[0\], target: a list of 3"),
        ({"constraints": [{**WRIST, "target": [1, 2, "x"]}]}, r"constraints\[0\], target: a number"),
        ({"constraints": [{**WRIST, "activation": {"start": 0}}]}, r"constraints\[0\], activation: .*missing"),
        (
            {"constraints": [{**WRIST, "activation": {**WRIST["activation"], "full": 9}}]},
            r"constraints\[0\], activation: .*in order",
        ),
        ({"constraints": [{**WRIST, "priority": -1}]}, r"constraints\[0\], .*priority"),
        ({"constraints": [{k: v for k, v in WRIST.items() if k != "name"}]}, r"constraints\[0\], name missing"),
        ('{"constraints": [], "contacts": NaN}', "NaN is no number"),
        ({"contacts": []}, "contacts: expected a record"),
        ({"contacts": {"left_knee": []}}, "left_knee: expected lists .* by left_heel"),
        ({"contacts": {"left_toe": [[1, 2, 3]]}}, r"left_toe\[0\]: expected two frames"),
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
