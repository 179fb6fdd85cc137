"""Feet and hands that constraints take into the ground rotate out of it; ankle and wrist still meet their targets."""

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import sole_rows
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.grounds.ground import Ground
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.asking.releasing import contact_release
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.held_foot import FootPath
from studio.core.solver.standing.stand import GroundedMotion, stand
from studio.core.solver.standing.tipping import heights_of
from studio.io.project.character_file import bundled_characters
from tests.core.motions import target, walk

WALK, CONTACTS = walk(120)
WHOLE_CHAIN = Chain(trunk=1.0, root=1.0)


def standing_on(body: str) -> GroundedMotion:
    return stand(WALK, bundled_characters()[body].morphology, CONTACTS, Ground())


def sole_heights(solved: AdaptedMotion, side: int) -> NDArray[np.float64]:
    layout = solved.morphology.layout
    foot = FootPath(
        solved.positions[:, layout.ankle_point(side)],
        solved.rotations[:, layout.foot_segment(side)],
        solved.rotations[:, layout.toe_segment(side)],
    )
    return np.asarray(heights_of(foot, sole_rows(solved.morphology, side), Ground()).min(axis=0))


@pytest.mark.parametrize("body", ["child", "giant"])
@pytest.mark.parametrize("aside", [-0.1, 0.05])
def test_a_foot_led_low_over_the_ground_stays_above_it_and_its_ankle_is_met(body: str, aside: float) -> None:
    standing = standing_on(body)
    before, ankle = solve_constraints(standing, ()), BodyPoint(BodyPart.LEFT_SHANK, at_end=True)
    path = body_point_positions(ankle, before)
    place = path[int(path[:, 2].argmax())] + [0.0, aside, 0.0]
    place[2] = 0.15 * standing.morphology.leg_length
    wanted = target("left_shank", place, Chain(), 0)
    solved = solve_constraints(standing, (wanted,))
    lower = np.minimum(sole_heights(before, 0), 0.0) - sole_heights(solved, 0)
    assert lower.max() < 0.002
    released = contact_release((wanted,), standing)[0] == 1.0
    residuals = solved.residuals[0][released]
    assert np.linalg.norm(body_point_positions(ankle, solved) - place, axis=1)[released] == pytest.approx(
        residuals, abs=1e-6
    )
    assert residuals.min() < 1e-4


def test_a_hand_led_low_over_the_ground_bends_up_at_its_wrist() -> None:
    standing = standing_on("child")
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    before = solve_constraints(standing, ())
    place = body_point_positions(wrist, before)[60]
    place[2] = 0.03
    solved = solve_constraints(standing, (target("left_forearm", place, WHOLE_CHAIN, 0),))
    tips = solved.positions[:, standing.morphology.layout.wrist_point(0) + 1, 2]
    met = solved.residuals[0] < 1e-3
    assert met.any()
    assert tips[met].min() > -0.001


def test_a_foot_with_a_target_of_its_own_below_the_ground_is_brought_to_the_ground() -> None:
    standing = standing_on("child")
    toes = BodyPoint(BodyPart.LEFT_TOE, at_end=True)
    before = solve_constraints(standing, ())
    frame = int(body_point_positions(BodyPoint(BodyPart.LEFT_SHANK, at_end=True), before)[:, 2].argmax())
    place = body_point_positions(toes, before)[frame]
    place[2] = -0.03
    solved = solve_constraints(standing, (target("left_toe", place, Chain(), 0),))
    assert body_point_positions(toes, solved)[frame] == pytest.approx([place[0], place[1], 0.0], abs=2e-4)
