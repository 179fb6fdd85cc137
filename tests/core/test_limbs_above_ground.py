"""The ground stands above constraints: limbs are not led into it, and targets below it are missed."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import point_heights
from studio.core.quality.report import BLOCKED_BY_GROUND, report_of
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.asking.ground_limit import target_above_ground
from studio.core.solver.asking.releasing import contact_release
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.stand import GroundedMotion, stand
from studio.io.project.character_file import bundled_characters
from tests.core.motions import target, walk

WALK, CONTACTS = walk(120)
WHOLE_CHAIN = Chain(clavicle=1.0, trunk=0.4, root=0.5)
PULLED = tuple(
    BodyPart(f"{side}_{part}")
    for side in ("left", "right")
    for part in ("forearm", "hand", "upper_arm", "thigh", "shank", "foot")
)
DEEPEST = 0.005


@cache
def standing_on(body: str) -> GroundedMotion:
    return stand(WALK, bundled_characters()[body].morphology, CONTACTS, Ground())


def depths(solved: AdaptedMotion, standing: GroundedMotion) -> NDArray[np.float64]:
    """(F, N) metres of each point below the ground, or below where it was without constraints."""
    before = point_heights(solve_constraints(standing, ()), standing.ground)
    return np.minimum(before, 0.0) - point_heights(solved, standing.ground)


@pytest.mark.parametrize("eased", [False, True])
@pytest.mark.parametrize("part", [BodyPart.LEFT_THIGH, BodyPart.RIGHT_SHANK, BodyPart.LEFT_FOREARM])
def test_a_limb_pulled_far_below_the_ground_stays_above_it(part: BodyPart, eased: bool) -> None:
    standing, frame = standing_on("giant"), 60
    now = frame / WALK.frame_rate
    place = body_point_positions(BodyPoint(part, at_end=True), solve_constraints(standing, ()))[frame] + [
        0.2,
        0.1,
        -2.0,
    ]
    times = ActivationCurve(now - 0.5, now - 0.2, now + 0.2, now + 0.5)
    solved = solve_constraints(standing, (target(part, place, Chain(root=0.6), activation=times),), eased=eased)
    assert depths(solved, standing).max() < DEEPEST


@pytest.mark.parametrize("body", ["child", "tall_man", "giant"])
def test_a_target_below_the_ground_is_missed_by_what_it_is_below(body: str) -> None:
    standing = standing_on(body)
    point = BodyPoint(BodyPart.RIGHT_SHANK, at_end=True)
    path, asked = (
        body_point_positions(point, solve_constraints(standing, ())),
        target("right_shank", (0.0, 0.0, 0.0), Chain()),
    )
    frame = int(np.where(contact_release((asked,), standing)[0] == 1.0, path[:, 2], 0.0).argmax())
    place = path[frame] * [1.0, 1.0, 0.0] - [0.0, 0.0, 0.05]
    asked = replace(asked, target=tuple(place))
    solved = solve_constraints(standing, (asked,))
    assert depths(solved, standing)[frame].max() < DEEPEST
    left = np.linalg.norm(body_point_positions(point, solved)[frame] - raised_place(asked, standing))
    assert solved.residuals[0, frame] == pytest.approx(
        np.hypot(left, raised_place(asked, standing)[2] - place[2]), abs=1e-6
    )
    named = report_of(standing, request_of(standing, asked), solved).winners[0]
    assert named[frame] == BLOCKED_BY_GROUND


def test_an_elbow_leaves_the_ground_and_the_wrist_still_meets_its_target() -> None:
    standing = standing_on("giant")
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    elbow = standing.morphology.layout.wrist_point(1) - 1
    below = body_point_positions(wrist, solve_constraints(standing, ()))[60] * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.04]
    pelvis = body_point_positions(BodyPoint(BodyPart.PELVIS), solve_constraints(standing, ()))[60]
    low = target("pelvis", pelvis * [1.0, 1.0, 0.0] + [0, 0, 0.3], Chain(limb=0.0, root=1.0), 0, at_end=False)
    solved = solve_constraints(standing, (low, target("right_forearm", below, Chain(), 1)))
    assert depths(solved, standing)[:, elbow].max() < DEEPEST
    missed = np.linalg.norm(body_point_positions(wrist, solved) - below, axis=1)
    assert missed == pytest.approx(solved.residuals[1], abs=DEEPEST)


def raised_place(asked: PositionConstraint, standing: GroundedMotion) -> NDArray[np.float64]:
    """Target (3,) on the ground, from where the point is highest."""
    raised = target_above_ground(asked, np.array([asked.target]), standing, slice(None))
    return raised[int(body_point_positions(asked.point, solve_constraints(standing, ()))[:, 2].argmax())]


def request_of(standing: GroundedMotion, *constraints: Constraint) -> AdaptRequest:
    return AdaptRequest(WALK, standing.morphology, CONTACTS, constraints, standing.ground)
