"""The ground stands above all constraints: no part of a body is led into it, and targets below it are missed."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds import Slope
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import point_heights
from studio.core.quality.report import BLOCKED_BY_GROUND, report_of
from studio.core.solver.adapt import hold, place_of
from studio.core.solver.asking.releasing import contact_release
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.stand import Standing, stand
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
GROUNDS = {"level": Ground(), "slope": Slope(0.0, 0.2)}


@cache
def standing_on(body: str, ground: str = "level") -> Standing:
    return stand(WALK, bundled_characters()[body].morphology, CONTACTS, GROUNDS[ground])


def depths(solved: AdaptedMotion, standing: Standing) -> NDArray[np.float64]:
    """(F, N) metres of each point below the ground, or below where it was without constraints."""
    before = point_heights(hold(standing, ()), standing.ground)
    return np.minimum(before, 0.0) - point_heights(solved, standing.ground)


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(PULLED), st.sampled_from(["child", "giant"]), st.sampled_from(list(GROUNDS)), st.integers(0, 119),
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 1.0)), st.booleans(),
)  # fmt: skip
def test_no_target_however_far_leads_any_part_into_the_ground(
    part: BodyPart, body: str, ground: str, frame: int, away: tuple[float, float, float], eased: bool
) -> None:
    standing, now = standing_on(body, ground), frame / WALK.frame_rate
    place = place_of(BodyPoint(part, at_end=True), hold(standing, ()))[frame] + away
    times = ActivationCurve(now - 0.5, now - 0.2, now + 0.2, now + 0.5)
    solved = hold(standing, (target(part, place, WHOLE_CHAIN, activation=times),), eased=eased)
    assert depths(solved, standing).max() < DEEPEST


@pytest.mark.parametrize("body", ["child", "tall_man", "giant"])
def test_a_target_below_the_ground_is_missed_by_what_it_is_below(body: str) -> None:
    standing = standing_on(body)
    point = BodyPoint(BodyPart.RIGHT_SHANK, at_end=True)
    path, asked = place_of(point, hold(standing, ())), target("right_shank", (0.0, 0.0, 0.0), Chain())
    frame = int(np.where(contact_release((asked,), standing)[0] == 1.0, path[:, 2], 0.0).argmax())
    place = path[frame] * [1.0, 1.0, 0.0] - [0.0, 0.0, 0.05]
    asked = replace(asked, target=tuple(place))
    solved = hold(standing, (asked,))
    assert depths(solved, standing)[frame].max() < DEEPEST
    missed = np.linalg.norm(place_of(point, solved)[frame] - place)
    assert missed > 0.05
    assert solved.residuals[0, frame] == pytest.approx(missed, abs=1e-6)
    named = report_of(standing, request_of(standing, asked), solved).winners[0]
    assert named[frame] == BLOCKED_BY_GROUND


def test_an_elbow_leaves_the_ground_and_the_wrist_still_meets_its_target() -> None:
    standing = standing_on("giant")
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    elbow = standing.morphology.layout.wrist(1) - 1
    below = place_of(wrist, hold(standing, ()))[60] * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.04]
    low = target("pelvis", place_of(BodyPoint(BodyPart.PELVIS), hold(standing, ()))[60] * [1.0, 1.0, 0.0] + [0, 0, 0.3],
                 Chain(limb=0.0, root=1.0), 0, at_end=False)  # fmt: skip
    solved = hold(standing, (low, target("right_forearm", below, Chain(), 1)))
    assert depths(solved, standing)[:, elbow].max() < DEEPEST
    missed = np.linalg.norm(place_of(wrist, solved) - below, axis=1)
    assert missed == pytest.approx(solved.residuals[1], abs=DEEPEST)


def request_of(standing: Standing, *constraints: Constraint) -> AdaptRequest:
    return AdaptRequest(WALK, standing.morphology, CONTACTS, constraints, standing.ground)
