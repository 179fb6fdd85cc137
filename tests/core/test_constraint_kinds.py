"""Every kind of constraint does what it says, on every body, with the feet where they stood."""

import math
from collections.abc import Callable
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.kinds import CONSTRAINT_KINDS, ConstraintKind
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.quality.metrics import centre_of_mass, contact_quality
from studio.core.quality.report import report_of
from studio.core.rotations import from_matrix, to_matrix
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.area_rows import nearest_allowed_position
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

# Every kind of constraint does what it says, on every body, with the feet where they stood.


BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk()
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
ARM, ALL = Chain(trunk=0.5), Chain(trunk=1.0, root=1.0)
HEAD = Chain(1.0, 1.0, 1.0, 0.5, 0.0)
LEFT, RIGHT = (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True) for side in ("left", "right"))
MET = 2e-4


def ask(kind: Callable[..., Constraint], point: BodyPoint, chain: Chain = ARM, priority: int = 0, **more: Any) -> Any:
    return kind("walk", kind.__name__, point, chain, priority, ALWAYS, **more)


def solved(body: Morphology, *constraints: Constraint) -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, body, CONTACTS, constraints))


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("apart", [0.05, 0.3])
def test_two_hands_stay_as_far_apart_as_a_box_is_wide(body: Morphology, apart: float) -> None:
    adapted = solved(body, ask(DistanceConstraint, LEFT, other=RIGHT, distance=apart))
    between = np.linalg.norm(body_point_positions(LEFT, adapted) - body_point_positions(RIGHT, adapted), axis=1)
    assert between == pytest.approx(apart, abs=MET)
    assert contact_quality(adapted, CONTACTS, Ground()).slide < 1e-3


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_hand_keeps_its_distance_from_a_place_outside(body: Morphology) -> None:
    before = body_point_positions(RIGHT, solved(body))
    place = tuple(before[30] + [0.1, 0.0, 0.05])
    adapted = adapt(
        AdaptRequest(WALK, body, CONTACTS, (ask(DistanceConstraint, RIGHT, other=place, distance=0.08),)), 30, 30
    )
    assert np.linalg.norm(body_point_positions(RIGHT, adapted) - place, axis=1) == pytest.approx(0.08, abs=MET)


@pytest.mark.parametrize("part", [BodyPart.LEFT_HAND, BodyPart.RIGHT_FOREARM, BodyPart.HEAD, BodyPart.THORAX])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_segment_is_turned_as_it_is_asked(body: Morphology, part: BodyPart) -> None:
    wanted = np.array([0.1, 0.05, 0.1, 1.0])
    wanted /= np.linalg.norm(wanted)
    layout, before = body.layout, solved(body)
    target = to_matrix(wanted) @ before.rotations[30, layout.segment_of_part(part)]
    asked = ask(OrientationConstraint, BodyPoint(part), HEAD, target=tuple(from_matrix(target)))
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (asked,)), 30, 30)
    assert adapted.rotations[0, layout.segment_of_part(part)] == pytest.approx(target, abs=1e-3)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_hand_reaches_its_target_and_keeps_its_orientation_there(body: Morphology) -> None:
    point = BodyPoint(BodyPart.RIGHT_HAND, at_end=True)
    before = adapt(AdaptRequest(WALK, body, CONTACTS), 30, 30)
    target = tuple(body_point_positions(point, before)[0] + [0.05, 0.02, 0.1])
    turned = (
        to_matrix(np.array([0.0, -0.3, 0.2, 0.933]))
        @ before.rotations[0, body.layout.segment_of_part(BodyPart.RIGHT_HAND)]
    )
    asked = (
        ask(PositionConstraint, point, target=target),
        ask(OrientationConstraint, BodyPoint(BodyPart.RIGHT_HAND), priority=1, target=tuple(from_matrix(turned))),
    )
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, asked), 30, 30)
    assert adapted.residuals[:, 0] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_eyes_face_what_they_look_at(body: Morphology) -> None:
    target = np.array([2.0, 1.0, 1.2])
    adapted = adapt(
        AdaptRequest(WALK, body, CONTACTS, (ask(LookAtConstraint, EYES_POINT, HEAD, target=tuple(target)),)), 0, 9
    )
    gaze = adapted.rotations[:, body.layout.head_joint, :, 0]
    line = target - body_point_positions(EYES_POINT, adapted)
    assert np.sum(gaze * line, axis=1) == pytest.approx(np.linalg.norm(line, axis=1), rel=1e-4)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("first", ["balance", "reach"])
def test_balance_and_reach_hold_together_or_by_their_priority(body: Morphology, first: str) -> None:
    before = solved(body)
    shoulder = before.positions[30, body.layout.collar_point(1) + 1]
    far = tuple(shoulder + 1.05 * body.arm[1].sum() * np.array([0.9, -0.3, -0.3]))
    rank = {"balance": 0, "reach": 1} if first == "balance" else {"balance": 1, "reach": 0}
    reach = ask(PositionConstraint, RIGHT, ALL, rank["reach"], target=far)
    balance = ask(BalanceConstraint, BodyPoint(BodyPart.PELVIS), Chain(0, 0, 0, 1, 1), rank["balance"])
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (reach, balance)), 30, 30)
    misses = {"reach": adapted.residuals[0, 0], "balance": adapted.residuals[1, 0]}
    assert misses[first] < MET
    drift = centre_of_mass(adapted)[0, :2] - centre_of_mass(before)[30, :2]
    assert np.linalg.norm(drift) == pytest.approx(misses["balance"], abs=1e-6)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize(
    ("shape", "size", "inside"),
    [
        (AreaShape.HALF_SPACE, (0.2, 0.0, 1.0), False),
        (AreaShape.BOX, (0.2, 0.2, 0.2), True),
        (AreaShape.SPHERE, (0.25, 1.0, 1.0), False),
        (AreaShape.SPHERE, (0.15, 1.0, 1.0), True),
        (AreaShape.CYLINDER, (0.2, 0.2, 0.4), True),
        (AreaShape.TABLE, (2.0, 2.0, 0.5), False),
    ],
    ids=str,
)
def test_a_wrist_is_only_where_it_may_be(body: Morphology, shape: AreaShape, size: Any, inside: bool) -> None:
    before = body_point_positions(RIGHT, solved(body))[30]
    area = ask(
        AreaConstraint,
        RIGHT,
        ALL,
        shape=shape,
        centre=tuple(before + np.array([0.0, 0.0, 0.05])),
        size=size,
        inside=inside,
    )
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (area,)), 30, 30)
    wrist = body_point_positions(RIGHT, adapted)[0]
    assert np.linalg.norm(nearest_allowed_position(area, wrist) - wrist) < MET


@pytest.mark.parametrize("size", [(0.8, 0.8, 0.7), (1.2, 0.6, 0.04), (0.1, 0.5, 0.3)], ids=str)
def test_a_table_leaves_no_point_in_it_and_pushes_neighbours_alike(size: tuple[float, float, float]) -> None:
    random, half = np.random.default_rng(2), 0.5 * np.array(size)
    table = ask(AreaConstraint, RIGHT, ARM, shape="table", centre=(0.0, 0.0, 0.0), size=size)
    for _ in range(2000):
        point = random.uniform(-half, half)
        place = nearest_allowed_position(table, point)
        assert (np.abs(place) / half).max() == pytest.approx(1.0)
        if point[2] + half[2] > 1.001 * min(0.1, half[2]):  # below it goes back down
            apart = np.linalg.norm(nearest_allowed_position(table, point + np.array([1e-7, -1e-7, 1e-7])) - place)
            assert apart < 2e-4


def test_a_wrist_at_the_edge_of_a_table_goes_little_farther_than_out_of_it() -> None:
    table = ask(AreaConstraint, RIGHT, ARM, shape="table", centre=(0.0, 0.0, 0.0), size=(0.8, 0.8, 0.7))
    for within in (0.005, 0.01, 0.02, 0.04):
        point = np.array([0.4 - within, 0.0, 0.25])
        assert np.linalg.norm(nearest_allowed_position(table, point) - point) < 3.0 * within


def _distance_to(shape: AreaShape, size: tuple[float, float, float], point: Any) -> float:
    """Distance in metres of a point to a shape about 0, 0 inside."""
    away = np.abs(point) - 0.5 * np.array(size)
    match shape:
        case AreaShape.HALF_SPACE:
            return max(float(point @ np.array(size)) / float(np.linalg.norm(size)), 0.0)
        case AreaShape.SPHERE:
            return max(float(np.linalg.norm(point)) - 0.5 * size[0], 0.0)
        case AreaShape.CYLINDER:
            beyond = [float(np.hypot(*point[:2])) - 0.5 * size[0], away[2]]
            return float(np.linalg.norm(np.maximum(beyond, 0.0)))
    return float(np.linalg.norm(np.maximum(away, 0.0)))


@pytest.mark.parametrize("margin", [0.02, 0.13])
@pytest.mark.parametrize("shape", [each for each in AreaShape if each is not AreaShape.MESH], ids=str)
def test_a_margin_is_as_far_from_every_shape_at_its_edges_as_at_its_faces(shape: AreaShape, margin: float) -> None:
    """A wrist before and above the edge of a table counted as 4 cm in it: the table grew by square edges."""
    random, size = np.random.default_rng(3), (0.3, 0.5, 0.2)
    area = ask(AreaConstraint, RIGHT, ARM, shape=shape, centre=(0.0, 0.0, 0.0), size=size, margin=margin)
    left = 0
    for point in random.uniform(-0.5, 0.5, (3000, 3)):
        place = nearest_allowed_position(area, point)
        assert _distance_to(shape, size, place) >= margin - 1e-9
        if _distance_to(shape, size, point) >= margin:
            assert place == pytest.approx(point)
            left += 1
        else:
            assert _distance_to(shape, size, place) == pytest.approx(margin, abs=1e-7)
    assert 100 < left < 2990


@pytest.mark.parametrize("margin", [0.05, 0.2])
def test_a_table_with_a_margin_pushes_neighbours_alike(margin: float) -> None:
    random, half = np.random.default_rng(4), np.array([0.4, 0.4, 0.35])
    table = ask(
        AreaConstraint, RIGHT, ARM, shape="table", centre=(0.0, 0.0, 0.0), size=tuple(2.0 * half), margin=margin
    )
    for _ in range(1000):
        point = random.uniform(-half - margin, half + margin)
        if point[2] + half[2] + margin > 0.101:  # below it goes back down
            apart = nearest_allowed_position(table, point + 1e-7) - nearest_allowed_position(table, point)
            assert np.linalg.norm(apart) < 2e-4


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_an_area_above_a_target_keeps_the_wrist_out_and_as_near_as_may_be(body: Morphology) -> None:
    wrist = body_point_positions(RIGHT, solved(body))[30]
    above = wrist + np.array([0.0, 0.0, 0.1])
    table = ask(AreaConstraint, RIGHT, ARM, shape="half_space", centre=tuple(above), size=(0.0, 0.0, 1.0))
    below = ask(PositionConstraint, RIGHT, ARM, 1, target=tuple(wrist))
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (table, below)), 30, 30)
    assert body_point_positions(RIGHT, adapted)[0] == pytest.approx(above, abs=MET)


# A part kept upright leans no further than it may, and turns freely about the vertical.


TRAY = BodyPoint(BodyPart.RIGHT_HAND)
WRIST = Chain(end_segment=1.0)
MET_ANGLE = math.radians(0.1)
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
    assert leans.max() <= MET_ANGLE
    assert adapted.residuals[0] == pytest.approx(leans, abs=1e-9)


@pytest.mark.parametrize("cone", [0.0, 0.1, 0.5])
@every_body
def test_a_head_that_is_kept_upright_looks_round_for_a_lower_constraint(body: Morphology, cone: float) -> None:
    head = ask(UprightConstraint, BodyPoint(BodyPart.HEAD), HEAD, cone=cone)
    eyes = body_point_positions(EYES_POINT, solved(body))[30]
    aside = ask(LookAtConstraint, EYES_POINT, HEAD, 1, target=(eyes[0] + 1.5, eyes[1] + 1.5, eyes[2]))
    alone, both = solved(body, head), solved(body, head, aside)
    segment = body.layout.segment_of_part(BodyPart.HEAD)
    assert head.lean(both.rotations[:, segment]).max() <= MET_ANGLE
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
    assert tray.lean(adapted.rotations[:, body.layout.segment_of_part(TRAY.part)]).max() <= MET_ANGLE
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
    assert trunk.lean(both.rotations[:, body.layout.segment_of_part(BodyPart.THORAX)]).max() <= MET_ANGLE


def test_a_report_tells_the_lean_and_names_nobody_where_it_is_met() -> None:
    body = BODIES["tall_man"]
    request = AdaptRequest(WALK, body, CONTACTS, (tilted(body, TRAY, 0.0),))
    adapted = adapt(request)
    report = report_of(grounded_motion_of(request), request, adapted)
    assert report.misses.max() <= MET_ANGLE
    assert (report.winners == -1).all()


def test_in_a_mirror_the_other_hand_holds_the_same_axis() -> None:
    tray = ask(UprightConstraint, TRAY, WRIST, axis=(0.6, 0.0, 0.8), direction=(0.0, 0.6, 0.8))
    mirrored = constraint_on_clip(tray, ClipTransform(0.0, 1.0, 0.0, (0.0, 0.0), True, -10.0, 200.0))
    assert mirrored.point.part is BodyPart.LEFT_HAND
    assert mirrored.axis == pytest.approx((-0.6, 0.0, 0.8))
    assert mirrored.direction == pytest.approx((0.0, -0.6, 0.8))


# Segments that are kept parallel stay so, whichever of both moves.


PAIRS = [
    (BodyPart.RIGHT_HAND, BodyPart.LEFT_HAND, WRIST),
    (BodyPart.RIGHT_FOREARM, BodyPart.LEFT_FOREARM, ALL),
    (BodyPart.RIGHT_HAND, BodyPart.PELVIS, WRIST),
    (BodyPart.HEAD, BodyPart.PELVIS, HEAD),
    (BodyPart.HEAD, BodyPart.THORAX, HEAD),
    (BodyPart.THORAX, BodyPart.PELVIS, Chain(0.0, 0.0, 0.0, 1.0)),
    (BodyPart.HEAD, BodyPart.RIGHT_HAND, HEAD),
]
pairs = pytest.mark.parametrize(
    ("part", "other", "chain"), PAIRS, ids=[f"{one.value} to {other.value}" for one, other, _ in PAIRS]
)


def parallel(
    body: Morphology, part: BodyPart, other: BodyPart, chain: Chain, cone: float = 0.0, priority: int = 0
) -> ParallelConstraint:
    """x of the other segment, and what is 15 degrees beside it in the middle of the walk."""
    rotations = solved(body).rotations[30]
    beside = to_matrix(np.array([0.0, 0.0, math.sin(math.radians(7.5)), math.cos(math.radians(7.5))]))
    axis = rotations[body.layout.segment_of_part(part)].T @ rotations[body.layout.segment_of_part(other)] @ beside[:, 0]
    return ask(
        ParallelConstraint, BodyPoint(part), chain, priority, axis=tuple(axis), other=BodyPoint(other), cone=cone
    )


def angles(asked: ParallelConstraint, adapted: AdaptedMotion) -> np.ndarray:
    """Angle (F,) between both axes, computed without the product."""
    layout = adapted.morphology.layout
    one = adapted.rotations[:, layout.segment_of_part(asked.point.part)] @ np.array(asked.axis)
    two = adapted.rotations[:, layout.segment_of_part(asked.other.part)] @ np.array(asked.other_axis)
    return 2.0 * np.arcsin(np.clip(np.linalg.norm(one - two, axis=1) / 2.0, 0.0, 1.0))


@pytest.mark.parametrize("cone", [0.0, 0.1])
@pairs
@every_body
def test_two_segments_stay_parallel_within_the_cone(
    body: Morphology, part: BodyPart, other: BodyPart, chain: Chain, cone: float
) -> None:
    asked = parallel(body, part, other, chain, cone)
    adapted = solved(body, asked)
    assert angles(asked, adapted).max() <= cone + MET_ANGLE
    assert adapted.residuals[0] == pytest.approx(np.maximum(angles(asked, adapted) - cone, 0.0), abs=1e-7)
    assert contact_quality(adapted, CONTACTS, Ground()).slide < 1e-3


@every_body
def test_a_segment_follows_the_other_one_where_a_higher_constraint_turns_it(body: Morphology) -> None:
    left = BodyPoint(BodyPart.LEFT_HAND)
    turn = to_matrix(np.array([0.1, 0.05, 0.1, 1.0]) / np.linalg.norm([0.1, 0.05, 0.1, 1.0]))
    turned = turn @ solved(body).rotations[30, body.layout.segment_of_part(left.part)]
    first = ask(OrientationConstraint, left, WRIST, target=tuple(from_matrix(turned)))
    second = parallel(body, BodyPart.RIGHT_HAND, left.part, WRIST, priority=1)
    alone, both = solved(body, first), solved(body, first, second)
    assert both.residuals[0] == pytest.approx(alone.residuals[0], abs=2e-4)
    assert angles(second, both)[30] <= MET_ANGLE


@every_body
def test_a_lower_reach_does_not_turn_them_apart(body: Morphology) -> None:
    asked = parallel(body, BodyPart.THORAX, BodyPart.PELVIS, Chain(0.0, 0.0, 0.0, 1.0), cone=0.05)
    far = tuple(body_point_positions(RIGHT, solved(body))[30] + [0.5, 0.0, -0.3])
    alone, both = solved(body, asked), solved(body, asked, ask(PositionConstraint, RIGHT, ALL, 1, target=far))
    assert both.residuals[0] == pytest.approx(alone.residuals[0], abs=2e-4)
    assert angles(asked, both).max() <= 0.05 + MET_ANGLE


def test_activation_turns_the_segment_by_degrees() -> None:
    body = BODIES["tall_man"]
    asked = parallel(body, BodyPart.RIGHT_HAND, BodyPart.LEFT_HAND, WRIST)
    ramp = ActivationCurve(0.2, 0.8, 5.0, 5.0)
    own, partly = angles(asked, solved(body)), ParallelConstraint(**{**vars(asked), "activation": ramp})
    now = angles(asked, solved(body, partly))
    alphas = ramp.at(np.arange(len(now)) / WALK.frame_rate)
    assert now == pytest.approx((1.0 - alphas) * own, abs=math.radians(1.0))


def test_a_report_names_nobody_where_segments_are_parallel() -> None:
    body = BODIES["tall_man"]
    request = AdaptRequest(WALK, body, CONTACTS, (parallel(body, BodyPart.HEAD, BodyPart.PELVIS, HEAD),))
    report = report_of(grounded_motion_of(request), request, solved(body, *request.constraints))
    assert report.misses.max() <= MET_ANGLE
    assert (report.winners == -1).all()


def test_in_a_mirror_the_other_segments_are_parallel() -> None:
    asked = ask(
        ParallelConstraint, BodyPoint(BodyPart.RIGHT_HAND), WRIST, axis=(0.6, 0.0, 0.8),
        other=BodyPoint(BodyPart.LEFT_FOOT), other_axis=(0.0, 0.6, 0.8),
    )  # fmt: skip
    mirrored = constraint_on_clip(asked, ClipTransform(0.0, 1.0, 0.0, (0.0, 0.0), True, -10.0, 200.0))
    assert (mirrored.point.part, mirrored.other.part) == (BodyPart.LEFT_HAND, BodyPart.RIGHT_FOOT)
    assert mirrored.axis == pytest.approx((-0.6, 0.0, 0.8))
    assert mirrored.other_axis == pytest.approx((0.0, -0.6, 0.8))


class PluggedParallel(ParallelConstraint):
    kind = "plugged_parallel"


def test_a_kind_that_a_plug_in_registers_by_its_value_and_task_is_solved_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    body, task = BODIES["tall_man"], CONSTRAINT_KINDS["parallel"].task
    asked = parallel(body, BodyPart.HEAD, BodyPart.PELVIS, HEAD)
    monkeypatch.setitem(CONSTRAINT_KINDS, PluggedParallel.kind, ConstraintKind(PluggedParallel, task))
    assert (solved(body, PluggedParallel(**vars(asked))).rotations == solved(body, asked).rotations).all()


# Areas bounded by a mesh: points are kept out, in, or on the surface, smoothly.


WRIST_POINT = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
seeds = st.integers(0, 2**32 - 1)


def ball(radius: float, rows: int = 24) -> TriangleMesh:
    """A sphere of triangles."""
    tilt, turn = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    vertices = radius * np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
    wide = 2 * rows + 1
    quads = [(i * wide + j, (i + 1) * wide + j, (i + 1) * wide + j + 1, i * wide + j + 1)
             for i, j in product(range(rows), range(2 * rows))]  # fmt: skip
    return TriangleMesh(vertices.reshape(-1, 3), [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def block(x: float, y: float, z: float) -> TriangleMesh:
    """A box of twelve triangles about 0."""
    corners = np.array(list(product((-x / 2, x / 2), (-y / 2, y / 2), (-z / 2, z / 2))))
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return TriangleMesh(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


BALL, BLOCK = ball(0.3), block(0.6, 0.4, 0.5)


def area(mesh: TriangleMesh, **more: object) -> AreaConstraint:
    return AreaConstraint(
        "walk", "Rock", WRIST_POINT, Chain(trunk=0.5), 0, ALWAYS, shape=AreaShape.MESH, mesh=mesh, **more
    )  # type: ignore[arg-type]


@given(seed=seeds)
def test_places_are_those_of_the_ball(seed: int) -> None:
    centre = np.array([1.0, -2.0, 0.5])
    random = np.random.default_rng(seed)
    way = random.normal(size=3)
    way /= np.linalg.norm(way)
    away = random.uniform(0.2, 0.6)
    point, surface = centre + away * way, centre + 0.3 * way
    found = {
        side: nearest_allowed_position(area(BALL, centre=tuple(centre), heading=0.7, **more), point)
        for side, more in (("out", {}), ("in", {"inside": True}), ("on", {"on_surface": True}))
    }
    # From beyond the grid the nearest place is found by turns: on the surface, but a little aside.
    near = 0.012 if away < 0.34 else 0.06
    assert found["on"] == pytest.approx(surface, abs=near)
    assert np.linalg.norm(found["on"] - centre) == pytest.approx(0.3, abs=2e-3)
    assert found["out"] == (pytest.approx(point, abs=1e-12) if away > 0.305 else pytest.approx(surface, abs=near))
    assert found["in"] == (pytest.approx(point, abs=1e-12) if away < 0.293 else pytest.approx(surface, abs=near))


@given(seed=seeds)
def test_what_was_put_on_the_surface_stays_there(seed: int) -> None:
    point = np.random.default_rng(seed).uniform(-0.45, 0.45, 3)
    for mesh in (BALL, BLOCK):
        once = nearest_allowed_position(area(mesh, on_surface=True), point)
        assert nearest_allowed_position(area(mesh, on_surface=True), once) == pytest.approx(once, abs=1e-5)


def test_a_point_of_a_block_goes_to_the_nearest_face_as_with_a_box() -> None:
    box = AreaConstraint("walk", "Box", WRIST_POINT, Chain(), 0, ALWAYS, shape="box", size=(0.6, 0.4, 0.5))
    for point in ((0.25, 0.02, 0.01), (0.0, -0.15, 0.05), (0.05, 0.0, 0.2), (0.4, 0.1, 0.0)):
        assert nearest_allowed_position(area(BLOCK), point) == pytest.approx(
            nearest_allowed_position(box, point), abs=1e-3
        )


def test_a_place_on_the_surface_moves_smoothly_over_edges() -> None:
    path = np.stack([np.linspace(-0.4, 0.4, 801), np.full(801, 0.05), np.full(801, 0.27)], axis=1)
    places = np.array([nearest_allowed_position(area(BLOCK, on_surface=True), point) for point in path])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.max() < 0.006


@pytest.mark.parametrize("name", ["child", "giant"])
@pytest.mark.parametrize("on_surface", [False, True])
def test_a_wrist_is_kept_out_of_or_on_a_mesh(name: str, on_surface: bool) -> None:
    body = bundled_characters()[name].morphology
    before = body_point_positions(WRIST_POINT, adapt(AdaptRequest(WALK, body, CONTACTS), 30, 30))[0]
    rock = area(ball(0.1), centre=tuple(before + np.array([0.03, 0.0, 0.05])), on_surface=on_surface)
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (rock,)), 30, 30)
    wrist = body_point_positions(WRIST_POINT, adapted)[0]
    assert np.linalg.norm(nearest_allowed_position(rock, wrist) - wrist) < 2e-4
    assert np.linalg.norm(wrist - np.array(rock.centre)) == pytest.approx(0.1, abs=2e-3)


def test_vertices_at_one_place_are_one_and_flat_triangles_are_none() -> None:
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 2, 0]]
    mesh = TriangleMesh(corners, [[0, 1, 2], [3, 5, 4], [0, 5, 6]])
    assert (len(mesh.vertices), len(mesh.triangles)) == (4, 2)
    assert mesh == TriangleMesh(mesh.vertices, mesh.triangles)
    assert hash(mesh) == hash(TriangleMesh(mesh.vertices, mesh.triangles))


def test_sides_of_a_ball_are_told_apart_everywhere() -> None:
    for first, second in pairwise((0.05, 0.28, 0.32, 0.6)):
        a, b = (nearest_allowed_position(area(BALL), (0.0, r, 0.0))[1] - r for r in (first, second))
        assert (a > 0.0) == (first < 0.3)
        assert (b > 0.0) == (second < 0.3)


@pytest.mark.parametrize("margin", [0.02, 0.1])
def test_a_point_keeps_its_margin_from_a_mesh(margin: float) -> None:
    random, kept = np.random.default_rng(5), area(BALL, margin=margin)
    radius = float(np.linalg.norm(BALL.vertices, axis=1).mean())
    for point in random.uniform(-1.5 * radius, 1.5 * radius, (60, 3)):
        place, away = nearest_allowed_position(kept, point), float(np.linalg.norm(point))
        assert np.linalg.norm(place) == pytest.approx(max(away, radius + margin), abs=0.02 * radius)
