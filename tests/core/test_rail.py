"""A point on a rail slides along a line or over a plane that may move."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.follow import FollowBody, FollowProp
from studio.core.constraints.kinds import CONSTRAINT_KINDS, ConstraintKind
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.rail import RailConstraint, RailShape
from studio.core.constraints.target import Place
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality
from studio.core.quality.report import report_of
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptRequest
from tests.core.test_constraint_kinds import ALL, BODIES, CONTACTS, LEFT, RIGHT, WALK, ask, solved

MET = 2e-4
SHAPES = pytest.mark.parametrize("shape", list(RailShape))
every_body = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)


def beside_hand(body: Morphology, shape: RailShape, priority: int = 0, centre: Place | None = None) -> RailConstraint:
    """A rail in reach of the right hand in every frame: a line along the walk, a plane across the hand's height."""
    places = body_point_positions(RIGHT, solved(body))
    middle = tuple((places.mean(axis=0) + np.array([0.0, -0.05, 0.05])).tolist())
    along = (1.0, 0.02, 0.05) if shape is RailShape.LINE else (0.05, 0.1, 1.0)
    placed = middle if centre is None else centre
    return ask(RailConstraint, RIGHT, ALL, priority, shape=shape, centre=placed, direction=along, length=9.0)


def distances(rail: RailConstraint, places: np.ndarray) -> np.ndarray:
    """Distance (F,) from a rail at rest, computed without the product."""
    along, offsets = np.array(rail.direction), places - np.array(rail.centre)
    heights = offsets @ along
    return np.abs(heights) if rail.shape is RailShape.PLANE else np.linalg.norm(np.cross(offsets, along), axis=1)


@SHAPES
@every_body
def test_a_hand_slides_on_a_rail_in_every_frame(body: Morphology, shape: RailShape) -> None:
    rail = beside_hand(body, shape)
    adapted = solved(body, rail)
    places = body_point_positions(RIGHT, adapted)
    assert distances(rail, places).max() <= MET
    assert adapted.residuals[0] == pytest.approx(distances(rail, places), abs=1e-9)
    own = body_point_positions(RIGHT, solved(body))
    assert np.ptp(places[:, 0]) == pytest.approx(np.ptp(own[:, 0]), rel=0.2)
    assert contact_quality(adapted, CONTACTS, Ground()).slide < 1e-3


@every_body
def test_a_line_has_ends_where_the_hand_stays(body: Morphology) -> None:
    places = body_point_positions(RIGHT, solved(body))
    centre = places[30] + [-0.2, 0.0, 0.0]
    rail = ask(RailConstraint, RIGHT, ALL, centre=tuple(centre), direction=(1.0, 0.0, 0.0), length=0.2)
    adapted = solved(body, rail)
    assert body_point_positions(RIGHT, adapted)[30] == pytest.approx(centre + np.array([0.1, 0.0, 0.0]), abs=MET)


@SHAPES
@every_body
def test_a_lower_constraint_takes_the_hand_off_no_rail(body: Morphology, shape: RailShape) -> None:
    rail = beside_hand(body, shape)
    aside = tuple(body_point_positions(RIGHT, solved(body, rail))[30] + [0.1, 0.0, 0.1])
    adapted = solved(body, rail, ask(PositionConstraint, RIGHT, ALL, 1, target=aside))
    assert distances(rail, body_point_positions(RIGHT, adapted)).max() <= MET


@SHAPES
def test_a_rail_that_moves_takes_the_hand_along(shape: RailShape) -> None:
    body = BODIES["tall_man"]
    begin = np.array(beside_hand(body, shape).centre)
    path = KeyedPlace((0.0, 1.0), (tuple(begin), tuple(begin + np.array([0.0, -0.05, 0.05]))))
    rail = beside_hand(body, shape, centre=path)
    adapted = solved(body, rail)
    places = body_point_positions(RIGHT, adapted)
    for frame in (0, 20, 40):
        here = np.array(path.at(np.array([frame / WALK.frame_rate]))[0])
        along, offset = np.array(rail.direction), places[frame] - here
        off = offset @ along if shape is RailShape.PLANE else np.linalg.norm(np.cross(offset, along))
        assert abs(off) <= MET


@SHAPES
def test_a_rail_on_the_own_pelvis_goes_and_turns_with_it(shape: RailShape) -> None:
    body = BODIES["tall_man"]
    fixed_to = FollowBody(BodyPoint(BodyPart.PELVIS, (0.25, -0.3, 0.1)))
    rail = beside_hand(body, shape, centre=fixed_to)
    adapted = solved(body, rail)
    assert adapted.residuals[0].max() <= MET
    centre = body_point_positions(fixed_to.point, adapted)
    turn = adapted.rotations[:, body.layout.segment_of_part(BodyPart.PELVIS)]
    yaw = np.arctan2(turn[:, 1, 0] - turn[:, 0, 1], turn[:, 0, 0] + turn[:, 1, 1])
    x, y, z = rail.direction
    along = np.stack([x * np.cos(yaw) - y * np.sin(yaw), x * np.sin(yaw) + y * np.cos(yaw), np.full(len(yaw), z)], 1)
    offsets = body_point_positions(RIGHT, adapted) - centre
    heights = np.abs(np.sum(offsets * along, axis=1))
    off = heights if shape is RailShape.PLANE else np.linalg.norm(np.cross(offsets, along), axis=1)
    assert off.max() <= MET


@SHAPES
def test_activation_brings_the_hand_by_degrees(shape: RailShape) -> None:
    body = BODIES["tall_man"]
    rail = beside_hand(body, shape)
    ramp = ActivationCurve(0.2, 0.8, 5.0, 5.0)
    partly = RailConstraint(**{**vars(rail), "activation": ramp})
    own, adapted = body_point_positions(RIGHT, solved(body)), solved(body, partly)
    places = body_point_positions(RIGHT, adapted)
    alphas = ramp.at(np.arange(len(places)) / WALK.frame_rate)
    wanted = (1.0 - alphas) * distances(rail, own)
    assert distances(rail, places)[alphas < 1e-3] == pytest.approx(wanted[alphas < 1e-3], abs=1e-3)
    assert distances(rail, places)[alphas > 0.999].max() <= MET
    assert np.abs(distances(rail, places) - wanted).max() < 0.02


def test_two_hands_slide_on_one_rail() -> None:
    body = BODIES["tall_man"]
    places = (body_point_positions(RIGHT, solved(body)) + body_point_positions(LEFT, solved(body))) / 2
    centre = tuple(places.mean(axis=0) + np.array([0.2, 0.0, 0.1]))
    rails = [
        ask(RailConstraint, hand, ALL, centre=centre, direction=(0.0, 1.0, 0.0), length=3.0) for hand in (LEFT, RIGHT)
    ]
    adapted = solved(body, *rails)
    assert adapted.residuals[:, 30].max() <= MET


def test_a_report_names_nobody_where_a_rail_is_met() -> None:
    body = BODIES["tall_man"]
    request = AdaptRequest(WALK, body, CONTACTS, (beside_hand(body, RailShape.LINE),))
    report = report_of(grounded_motion_of(request), request, solved(body, *request.constraints))
    assert report.misses.max() <= MET
    assert (report.winners == -1).all()


def test_in_a_mirror_the_other_hand_slides_on_the_mirrored_rail() -> None:
    rail = ask(RailConstraint, RIGHT, ALL, centre=(0.5, -0.2, 1.0), direction=(0.6, 0.8, 0.0))
    carry = ClipTransform(0.0, 1.0, 0.0, (0.0, 0.0), True, -10.0, 200.0)
    mirrored = constraint_on_clip(rail, carry)
    assert mirrored.point.part is BodyPart.LEFT_FOREARM
    assert mirrored.centre == pytest.approx((0.5, 0.2, 1.0))
    assert mirrored.direction == pytest.approx((0.6, -0.8, 0.0))
    held = ask(RailConstraint, RIGHT, ALL, centre=FollowProp("bar"), direction=(0.6, 0.8, 0.0))
    assert constraint_on_clip(held, carry).direction == pytest.approx((0.6, 0.8, 0.0))


class PluggedRail(RailConstraint):
    kind = "plugged_rail"


def test_a_rail_that_a_plug_in_registers_by_its_value_and_task_is_solved_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    body = BODIES["tall_man"]
    rail = beside_hand(body, RailShape.LINE)
    monkeypatch.setitem(CONSTRAINT_KINDS, PluggedRail.kind, ConstraintKind(PluggedRail, CONSTRAINT_KINDS["rail"].task))
    assert (solved(body, PluggedRail(**vars(rail))).positions == solved(body, rail).positions).all()
