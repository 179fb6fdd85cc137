"""Every kind of constraint comes back from a project file as it went in."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace, NoisePlace, PendulumPlace
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.errors import StudioError
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.stage.prop import Prop
from studio.io.project.constraint_file import constraint_of, constraint_record, read_constraints
from studio.io.project.entity_json import entity_record, project_json, project_of
from studio.io.project.project_file import read_project, write_project
from tests.builders import make_project

WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
COMMON = (Chain(trunk=0.25), 2, ActivationCurve(0.0, 0.5, 1.0, 1.5))
STIFF = Chain(trunk=0.5, segments=((BodyPart.ABDOMEN, 0.1), (BodyPart.PELVIS, 1.0)))
ROCK = TriangleMesh(np.random.default_rng(0).normal(size=(40, 3)), np.arange(36).reshape(-1, 3))
CONSTRAINTS: tuple[Constraint, ...] = (
    PositionConstraint("motion", "Reach", WRIST, *COMMON, target=(0.1, 0.2, 0.3)),
    OrientationConstraint("motion", "Palm", BodyPoint(BodyPart.LEFT_HAND), *COMMON, target=(0.6, 0.0, 0.8, 0.0)),
    LookAtConstraint("motion", "Look", EYES_POINT, *COMMON, target=(1.0, 2.0, 1.5)),
    UprightConstraint("motion", "Tray", BodyPoint(BodyPart.LEFT_HAND), *COMMON, axis=(0.0, 0.6, 0.8), cone=0.2),
    DistanceConstraint("motion", "Clap", WRIST, *COMMON, other=BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)),
    DistanceConstraint("motion", "Rod", WRIST, *COMMON, other=(0.5, 0.0, 1.0), distance=0.4),
    ParallelConstraint("motion", "Soles", BodyPoint(BodyPart.LEFT_FOOT), *COMMON, other=BodyPoint(BodyPart.RIGHT_FOOT)),
    RailConstraint("motion", "Banister", WRIST, *COMMON, centre=(0.4, 0.0, 0.7), direction=(0.6, 0.0, 0.8), length=3.0),
    RailConstraint("motion", "Wall", WRIST, *COMMON, shape="plane", direction=(0.0, 1.0, 0.0)),
    BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), *COMMON),
    BalanceConstraint("motion", "Lean", BodyPoint(BodyPart.PELVIS), *COMMON, place=(0.1, -0.1)),
    AreaConstraint("motion", "Table", WRIST, *COMMON, centre=(0.4, 0.0, 0.7), size=(1.0, 1.5, 0.1), heading=0.3),
    AreaConstraint("motion", "Ramp", WRIST, *COMMON, shape="box", heading=0.3, tilt=(0.6, 0.0, 0.0, 0.8)),
    AreaConstraint("motion", "Cage", WRIST, *COMMON, shape="sphere", inside=True),
    AreaConstraint("motion", "Rock", WRIST, *COMMON, shape="mesh", mesh=ROCK, on_surface=True),
    ClearConstraint("motion", "Clear", WRIST, *COMMON, arms="left", margin=0.02),
    PositionConstraint("motion", "Switch", WRIST, *COMMON, weight=KeyedNumber((0.1, 0.5), (0.0, 1.0))),
    PositionConstraint("motion", "Off", WRIST, *COMMON, weight=0.0),
    PositionConstraint("motion", "Heavy", WRIST, STIFF, *COMMON[1:], weight=2.5, target=(0.1, 0.2, 0.3)),
)


def test_every_kind_that_can_be_stored_is_tried_here() -> None:
    assert {constraint.kind for constraint in CONSTRAINTS} == set(CONSTRAINT_KINDS)


@pytest.mark.parametrize("constraint", CONSTRAINTS, ids=lambda constraint: constraint.name)
def test_a_constraint_comes_back_as_it_went_in(constraint: Constraint, tmp_path: Path) -> None:
    path = tmp_path / "kinds.studio"
    write_project(path, make_project().with_entity("constraints", "asked", constraint), "document")
    opened = read_project(path)
    assert opened.problems == ()
    assert opened.project.constraints["asked"] == constraint


@pytest.mark.parametrize("constraint", CONSTRAINTS, ids=lambda constraint: constraint.name)
def test_a_record_of_a_constraint_file_or_of_s4d_describes_the_same_constraint(constraint: Constraint) -> None:
    record = json.loads(json.dumps(constraint_record(constraint)))
    assert constraint_of(record, "motion", "asked.json") == constraint


KEYED = KeyedPlace((0.1, 0.5), ((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)))
HAND = BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.1, 0.0))
APART = (("performer 1", (0.0, 0.0, 0.3)),)
TARGETS: tuple[Constraint, ...] = (
    PositionConstraint("motion", "Keyed", WRIST, *COMMON, target=KEYED),
    PositionConstraint("motion", "Own place", WRIST, *COMMON, target=OwnPlace(WRIST, 0.4, (0.0, 0.1, 0.2), APART)),
    PositionConstraint("motion", "Own", WRIST, *COMMON, target=FollowBody(HAND)),
    PositionConstraint("motion", "Other", WRIST, *COMMON, target=FollowPerformer("performer 1", HAND, awaits=True)),
    LookAtConstraint("motion", "Prop", EYES_POINT, *COMMON, target=FollowProp("box", (0.0, 0.1, 0.2))),
    LookAtConstraint("motion", "Tracked", EYES_POINT, *COMMON, target=FollowTracked("LeftHand")),
    OrientationConstraint(
        "motion", "Turns", HAND, *COMMON, target=KeyedTurn((0.0, 1.0), ((0.0, 0.0, 0.0, 1.0), (0.6, 0.0, 0.8, 0.0)))
    ),
    OrientationConstraint("motion", "As prop", HAND, *COMMON, target=FollowProp("box", turn=(0.6, 0.0, 0.8, 0.0))),
    DistanceConstraint("motion", "Rope", WRIST, *COMMON, other=KEYED, distance=KeyedNumber((0.0, 1.0), (0.1, 0.2))),
    DistanceConstraint("motion", "Lead", WRIST, *COMMON, other=FollowProp("box"), distance=0.4),
    BalanceConstraint("motion", "Path", HAND, *COMMON, place=KEYED, vertical=True),
    BalanceConstraint("motion", "Support", HAND, *COMMON, place=Support(0.01)),
    AreaConstraint("motion", "Tray", WRIST, *COMMON, centre=FollowProp("box"), heading=KeyedNumber((0.0,), (0.5,))),
    AreaConstraint(
        "motion", "Seesaw", WRIST, *COMMON, tilt=KeyedTurn((0.0, 1.0), ((0.0, 0.0, 0.0, 1.0), (0.6, 0.0, 0.0, 0.8)))
    ),
    RailConstraint("motion", "Pole", WRIST, *COMMON, centre=FollowProp("box"), direction=(0.0, 0.6, 0.8)),
    PositionConstraint("motion", "Own keys", WRIST, *COMMON, target=OwnPlace(WRIST, 0.4, own=APART).keyed(0.5)),
    PositionConstraint(
        "motion", "Own circle", WRIST, *COMMON, target=CirclePlace(origin=OwnPlace(WRIST, 0.4, (0.0, 0.1, 0.2), APART))
    ),
    PositionConstraint("motion", "Circle", WRIST, *COMMON, target=CirclePlace(centre=(0.1, 0.2, 0.3), tilt=0.5)),
    LookAtConstraint("motion", "Swing", EYES_POINT, *COMMON, target=PendulumPlace(length=0.7, since=0.3)),
    DistanceConstraint("motion", "Fly", WRIST, *COMMON, other=NoisePlace(reach=(0.1, 0.0, 0.2), seed=5), distance=0.4),
)


@pytest.mark.parametrize("constraint", TARGETS, ids=lambda constraint: constraint.name)
def test_every_kind_of_target_comes_back_as_it_went_in(constraint: Constraint, tmp_path: Path) -> None:
    path = tmp_path / "targets.studio"
    project = make_project().with_entity("props", "box", Prop("Box")).with_entity("constraints", "asked", constraint)
    write_project(path, project, "document")
    opened = read_project(path)
    assert opened.problems == ()
    assert opened.project.constraints["asked"] == constraint


def test_a_target_in_a_constraint_file_is_written_as_in_a_project_and_misspelt_members_are_named(
    tmp_path: Path,
) -> None:
    path = tmp_path / "asked.json"
    record = entity_record("constraints", "", TARGETS[3], {})
    path.write_text(json.dumps({"constraints": [record]}))
    assert read_constraints(path, "motion").constraints == (TARGETS[3],)
    for change, sentence in (
        (
            {"kind": "follow_wind"},
            "target: kind: one of keyed, keyed_own_place, circle, pendulum, noise, own_place, follow_body",
        ),
        ({"performer": "x"}, "'target.performer' is not known here"),
        ({"point": {"part": "tail"}}, "target: point: part"),
    ):
        path.write_text(json.dumps({"constraints": [{**record, "target": {**record["target"], **change}}]}))
        with pytest.raises(StudioError, match=re.escape(sentence)):
            read_constraints(path, "motion")


def test_what_a_newer_version_wrote_into_a_target_is_kept(tmp_path: Path) -> None:
    record = entity_record("constraints", "asked", TARGETS[0], {})
    record["target"]["tension"] = 0.5
    record["point"]["stickiness"] = 2
    root = json.loads(project_json(make_project(), {}))
    root["constraints"].append(record)
    arrays: dict = {}
    project_json(make_project(), arrays)
    newer = {**record, "id": "newer", "target": {"kind": "follow_wind", "gust": 3}}
    root["constraints"].append(newer)
    read = project_of(root, arrays.__getitem__)
    assert read.losses == []
    assert "newer" not in read.project.constraints
    again = json.loads(project_json(read.project, {}))
    assert again["constraints"][-2:] == [record, newer]
