"""Every kind of constraint does what it says, on every body, with the feet where they stood."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import EYES, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import centre_of_mass, contact_quality
from studio.core.rotations import from_matrix, to_matrix
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.asking.area_rows import nearest_allowed_position
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

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
        AdaptRequest(WALK, body, CONTACTS, (ask(LookAtConstraint, EYES, HEAD, target=tuple(target)),)), 0, 9
    )
    gaze = adapted.rotations[:, body.layout.head_joint, :, 0]
    line = target - body_point_positions(EYES, adapted)
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


@pytest.mark.parametrize("side", ["inside", "on_surface"])
def test_a_margin_is_kept_outside_alone(side: str) -> None:
    with pytest.raises(ValueError, match="outside"):
        ask(AreaConstraint, RIGHT, ARM, margin=0.1, **{side: True})


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_an_area_above_a_target_keeps_the_wrist_out_and_as_near_as_may_be(body: Morphology) -> None:
    wrist = body_point_positions(RIGHT, solved(body))[30]
    above = wrist + np.array([0.0, 0.0, 0.1])
    table = ask(AreaConstraint, RIGHT, ARM, shape="half_space", centre=tuple(above), size=(0.0, 0.0, 1.0))
    below = ask(PositionConstraint, RIGHT, ARM, 1, target=tuple(wrist))
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (table, below)), 30, 30)
    assert body_point_positions(RIGHT, adapted)[0] == pytest.approx(above, abs=MET)


@pytest.mark.parametrize(
    ("kind", "more", "sentence"),
    [
        (DistanceConstraint, {"other": LEFT, "distance": 0.1}, "no distance from itself"),
        (DistanceConstraint, {"distance": -0.1}, "zero or more"),
        (DistanceConstraint, {"other": (0.0, np.nan, 0.0)}, "finite"),
        (AreaConstraint, {"size": (0.0, 1.0, 1.0), "shape": "box"}, "size above zero"),
        (AreaConstraint, {"size": (0.0, 0.0, 0.0), "shape": "half_space"}, "size above zero"),
        (OrientationConstraint, {"target": (0.0, 0.0, 0.0, 0.0)}, "not all zero"),
        (LookAtConstraint, {"target": (np.inf, 0.0, 0.0)}, "finite"),
        (BalanceConstraint, {"place": (np.nan, 0.0)}, "finite"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(kind: Any, more: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ValueError, match=rf"'{kind.__name__}'.*{sentence}"):
        ask(kind, LEFT, **more)
