"""Every kind of constraint comes back from a project file as it went in."""

from pathlib import Path

import pytest

from studio.core.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import EYES, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.io.entity_json import CONSTRAINT_KINDS
from studio.io.project_file import read_project, write_project
from tests.builders import make_project

WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
COMMON = (Chain(trunk=0.25), 2, ActivationCurve(0.0, 0.5, 1.0, 1.5))
CONSTRAINTS: tuple[Constraint, ...] = (
    PositionConstraint("motion", "Reach", WRIST, *COMMON, target=(0.1, 0.2, 0.3)),
    OrientationConstraint("motion", "Palm", BodyPoint(BodyPart.LEFT_HAND), *COMMON, target=(0.6, 0.0, 0.8, 0.0)),
    LookAtConstraint("motion", "Look", EYES, *COMMON, target=(1.0, 2.0, 1.5)),
    DistanceConstraint("motion", "Clap", WRIST, *COMMON, other=BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)),
    DistanceConstraint("motion", "Rod", WRIST, *COMMON, other=(0.5, 0.0, 1.0), distance=0.4),
    BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), *COMMON),
    BalanceConstraint("motion", "Lean", BodyPoint(BodyPart.PELVIS), *COMMON, place=(0.1, -0.1)),
    AreaConstraint("motion", "Table", WRIST, *COMMON, centre=(0.4, 0.0, 0.7), size=(1.0, 1.5, 0.1), heading=0.3),
    AreaConstraint("motion", "Cage", WRIST, *COMMON, shape="sphere", inside=True),
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
