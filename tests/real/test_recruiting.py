"""Real kicks and walks balance with free arms and the free leg: feet stay, the balance is met, nothing pops."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.quality.motion_quality import motion_quality
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.core.motions import ALWAYS
from tests.real.taken import contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
STANDING = ["punch", *outside("accad_female1_D3_ConversationGestures")]
ALONE = Chain(0.0, 0.0, 0.0, 0.0, 0.0, free_arms=1.0, free_legs=1.0)
WHOLE = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0, free_arms=1.0, free_legs=1.0)


@pytest.mark.parametrize("name", ["adult_woman", "child", "giant"])
@pytest.mark.parametrize(
    "stem", ["kick", "walk", *outside("mass_kick", "accad_male2_G2_FrontKick", "accad_female1_B03_Walk1")]
)
def test_free_limbs_help_to_balance(stem: str, name: str) -> None:
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    standing = ground_motion(motion, BODIES[name], contacts, Ground())
    first = capture.first_frame
    for chain in (WHOLE, ALONE):  # limbs alone are thrown out for much that is out of reach
        wish = BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), chain, 0, ALWAYS, place=Support())
        solved = solve_constraints(standing, (wish,), first)
        assert chain is ALONE or np.nanmax(solved.residuals) < 5e-4
        assert contact_quality(solved, contacts, Ground()).slide < 1e-6
        assert acceleration_ratio(solved, solve_constraints(standing, (), first)) < (3.0 if chain is WHOLE else 10.0)


@pytest.mark.parametrize("name", ["adult_woman", "tall_man", "giant", "stocky_man"])
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("stem", STANDING)
def test_a_reach_with_balance_lets_no_joint_jump(stem: str, name: str, side: str) -> None:
    """The other arm is flung out level meanwhile, where it helps as much turned up as turned down."""
    capture, motion, actor = taken(named(stem))
    contacts, wrist = contacts_of(capture), BodyPoint(BodyPart(f"{side}_forearm"), at_end=True)
    reach = Chain(trunk=1.0, root=1.0)
    wishes = (
        PositionConstraint("motion", "Wrist", wrist, reach, 0, ALWAYS, target=(0.75, -0.2, 1.0)),
        BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), WHOLE, 0, ALWAYS, place=Support()),
    )
    solved = solve_constraints(ground_motion(motion, BODIES[name], contacts, Ground()), wishes, eased=True)
    found = motion_quality(solved, source_motion(motion, actor), contacts, Ground(), capture.first_frame)
    assert found.jump < 2.0
    assert found.peak < 3.0


@pytest.mark.parametrize("priorities", [(0, 1), (1, 0)])
@pytest.mark.parametrize("stem", STANDING)
def test_a_level_that_is_given_up_lets_the_hips_down_by_degrees(stem: str, priorities: tuple[int, int]) -> None:
    """Though a hand of the motion is flicked much more sharply than hips may be."""
    capture, motion, _ = taken(named(stem))
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    wishes = (
        PositionConstraint("motion", "Wrist", wrist, Chain(trunk=1.0), priorities[0], ALWAYS, target=(0.75, -0.2, 1.0)),
        BalanceConstraint(
            "motion", "Balance", BodyPoint(BodyPart.PELVIS), WHOLE, priorities[1], ALWAYS, place=Support()
        ),
    )
    standing = ground_motion(motion, BODIES["stocky_man"], contacts_of(capture), Ground())
    solved = solve_constraints(standing, wishes, eased=True)
    steps = np.abs(np.diff(solved.positions[:, 0, 2]))
    assert steps.max() < 0.05
