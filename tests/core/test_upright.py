"""A part kept upright leans no further than it may, and turns freely about the vertical."""

import math

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.look_at import EYES, LookAtConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality
from studio.core.quality.report import report_of
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptRequest
from studio.core.solver.standing.stand import grounded_motion_of
from tests.core.test_constraint_kinds import ALL, BODIES, CONTACTS, HEAD, RIGHT, WALK, ask, solved

TRAY = BodyPoint(BodyPart.RIGHT_HAND)
WRIST = Chain(end_segment=1.0)
MET = math.radians(0.1)
PARTS = (TRAY, BodyPoint(BodyPart.LEFT_FOREARM), BodyPoint(BodyPart.HEAD), BodyPoint(BodyPart.THORAX))
every_body = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)


def tilted(body: Morphology, point: BodyPoint, cone: float, priority: int = 0) -> UprightConstraint:
    """An axis of a segment that leans 15 degrees in the middle of the walk is to be upright."""
    turn = solved(body).rotations[30, body.layout.segment_of_part(point.part)]
    axis = turn.T @ [math.sin(math.radians(15)), 0.0, math.cos(math.radians(15))]
    chain = WRIST if point is TRAY else HEAD
    return ask(UprightConstraint, point, chain, priority, axis=tuple(axis), cone=cone)


@pytest.mark.parametrize("cone", [0.0, 0.1])
@pytest.mark.parametrize("point", PARTS, ids=lambda point: point.part.value)
@every_body
def test_an_axis_stays_within_its_cone_in_every_frame(body: Morphology, point: BodyPoint, cone: float) -> None:
    asked = tilted(body, point, cone)
    adapted = solved(body, asked)
    leans = asked.lean(adapted.rotations[:, body.layout.segment_of_part(point.part)])
    assert leans.max() <= MET
    assert adapted.residuals[0] == pytest.approx(leans, abs=1e-9)


@pytest.mark.parametrize("cone", [0.0, 0.1, 0.5])
@every_body
def test_a_head_that_is_kept_upright_looks_round_for_a_lower_constraint(body: Morphology, cone: float) -> None:
    head = ask(UprightConstraint, BodyPoint(BodyPart.HEAD), HEAD, cone=cone)
    eyes = body_point_positions(EYES, solved(body))[30]
    aside = ask(LookAtConstraint, EYES, HEAD, 1, target=(eyes[0] + 1.5, eyes[1] + 1.5, eyes[2]))
    alone, both = solved(body, head), solved(body, head, aside)
    segment = body.layout.segment_of_part(BodyPart.HEAD)
    assert head.lean(both.rotations[:, segment]).max() <= MET
    assert np.abs(both.residuals[0] - alone.residuals[0]).max() <= 2e-4
    gaze, before = (each.rotations[30, segment, :, 0] for each in (both, alone))
    assert math.degrees(math.atan2(gaze[1], gaze[0]) - math.atan2(before[1], before[0])) > 15.0


@pytest.mark.parametrize("priorities", [(0, 1), (1, 0)], ids=["tray first", "reach first"])
@every_body
def test_a_tray_stays_level_in_a_hand_that_reaches(body: Morphology, priorities: tuple[int, int]) -> None:
    first, second = priorities
    tray = tilted(body, TRAY, 0.05, first)
    place = tuple(body_point_positions(RIGHT, solved(body))[30] + [0.1, 0.0, 0.1])
    reach = ask(PositionConstraint, RIGHT, ALL, second, target=place)
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (tray, reach)), 25, 35)
    assert tray.lean(adapted.rotations[:, body.layout.segment_of_part(TRAY.part)]).max() <= MET
    assert adapted.residuals[1].max() <= 2e-4
    assert contact_quality(adapted, CONTACTS, Ground()).slide < 1e-3


@every_body
def test_lower_places_do_not_tilt_a_trunk_that_is_upright(body: Morphology) -> None:
    chest = BodyPoint(BodyPart.THORAX)
    trunk = ask(UprightConstraint, chest, Chain(0.0, 0.0, 0.0, 1.0), cone=0.1)
    far = tuple(body_point_positions(RIGHT, solved(body))[30] + [0.6, 0.0, -0.4])
    reach = ask(PositionConstraint, RIGHT, ALL, 1, target=far)
    alone, both = solved(body, trunk), solved(body, trunk, reach)
    assert both.residuals[0] == pytest.approx(alone.residuals[0], abs=2e-4)
    assert trunk.lean(both.rotations[:, body.layout.segment_of_part(BodyPart.THORAX)]).max() <= MET


def test_a_report_tells_the_lean_and_names_nobody_where_it_is_met() -> None:
    body = BODIES["tall_man"]
    request = AdaptRequest(WALK, body, CONTACTS, (tilted(body, TRAY, 0.0),))
    adapted = adapt(request)
    report = report_of(grounded_motion_of(request), request, adapted)
    assert report.misses.max() <= MET
    assert (report.winners == -1).all()


def test_in_a_mirror_the_other_hand_holds_the_same_axis() -> None:
    tray = ask(UprightConstraint, TRAY, WRIST, axis=(0.6, 0.0, 0.8), direction=(0.0, 0.6, 0.8))
    mirrored = constraint_on_clip(tray, ClipTransform(0.0, 1.0, 0.0, (0.0, 0.0), True, -10.0, 200.0))
    assert mirrored.point.part is BodyPart.LEFT_HAND
    assert mirrored.axis == pytest.approx((-0.6, 0.0, 0.8))
    assert mirrored.direction == pytest.approx((0.0, -0.6, 0.8))


@pytest.mark.parametrize("wrong", [{"axis": (0.0, 0.0, 0.0)}, {"direction": (0.0, 0.0, 0.0)}, {"cone": -0.1}])
def test_what_points_nowhere_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"nowhere|cone"):
        ask(UprightConstraint, TRAY, WRIST, **wrong)
