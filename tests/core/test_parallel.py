"""Segments that are kept parallel stay so, whichever of both moves."""

import math

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.kinds import CONSTRAINT_KINDS, ConstraintKind
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import contact_quality
from studio.core.quality.report import report_of
from studio.core.rotations import from_matrix, to_matrix
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.stand import grounded_motion_of
from tests.core.test_constraint_kinds import ALL, BODIES, CONTACTS, HEAD, RIGHT, WALK, ask, solved

MET = math.radians(0.1)
WRIST = Chain(end_segment=1.0)
every_body = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
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
    assert angles(asked, adapted).max() <= cone + MET
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
    assert angles(second, both)[30] <= MET


@every_body
def test_a_lower_reach_does_not_turn_them_apart(body: Morphology) -> None:
    asked = parallel(body, BodyPart.THORAX, BodyPart.PELVIS, Chain(0.0, 0.0, 0.0, 1.0), cone=0.05)
    far = tuple(body_point_positions(RIGHT, solved(body))[30] + [0.5, 0.0, -0.3])
    alone, both = solved(body, asked), solved(body, asked, ask(PositionConstraint, RIGHT, ALL, 1, target=far))
    assert both.residuals[0] == pytest.approx(alone.residuals[0], abs=2e-4)
    assert angles(asked, both).max() <= 0.05 + MET


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
    assert report.misses.max() <= MET
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


@pytest.mark.parametrize(
    "wrong",
    [
        {"axis": (0.0, 0.0, 0.0)},
        {"other_axis": (0.0, 0.0, 0.0)},
        {"cone": -0.1},
        {"other": BodyPoint(BodyPart.RIGHT_HAND)},
    ],
)
def test_axes_that_point_nowhere_and_a_segment_with_itself_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"nowhere|cone|itself"):
        ask(ParallelConstraint, BodyPoint(BodyPart.RIGHT_HAND), WRIST, **wrong)


class PluggedParallel(ParallelConstraint):
    kind = "plugged_parallel"


def test_a_kind_that_a_plug_in_registers_by_its_value_and_task_is_solved_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    body, task = BODIES["tall_man"], CONSTRAINT_KINDS["parallel"].task
    asked = parallel(body, BodyPart.HEAD, BodyPart.PELVIS, HEAD)
    monkeypatch.setitem(CONSTRAINT_KINDS, PluggedParallel.kind, ConstraintKind(PluggedParallel, task))
    assert (solved(body, PluggedParallel(**vars(asked))).rotations == solved(body, asked).rotations).all()
