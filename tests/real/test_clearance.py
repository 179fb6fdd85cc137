"""Real gestures and strikes on wide bodies: no hand in the belly, no arm that pops, and what touched still touches."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.kernels.limits.arm_clearance import MAX_INHERITED_CLEARANCE
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.source import source_motion
from studio.core.solver.task_assembly.clearance import arm_distances
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

ALWAYS = ActivationCurve(-1.0, -1.0, 1e4, 1e4)
CLEAR = ClearConstraint("motion", "Clear", BodyPoint(BodyPart.THORAX), Chain(), 0, ALWAYS)
SHOWN = (
    "accad_female1_D3_ConversationGestures", "accad_male2_E4_CrossRight", "accad_male2_E11_BlockLeftHigh",
    "accad_male2_E9_BodyHookLeft", "accad_male2_E1_JabLeft", "cmu_max_jumping_jacks",
)  # fmt: skip
DEEPEST = 0.02
"""Metres: what is kept of the depth that an actor has in a body whose girths are guessed."""


def _standing(stem: str, name: str) -> tuple[GroundedMotion, AdaptedMotion]:
    """A motion on a character, and the source."""
    capture, motion, actor = taken(named(stem))
    body, source = bundled_characters()[name], source_motion(motion, actor).frames(capture.first_frame, 10**6)
    return ground_motion(motion, body.morphology, contacts_of(capture), Ground(), body.volume, actor.morphology), source


def _cleared(stem: str, name: str) -> tuple[AdaptedMotion, AdaptedMotion, AdaptedMotion]:
    """The source, the motion on a character, and the same with its arms clear."""
    standing, source = _standing(stem, name)
    first = source.first_frame
    return source, solve_constraints(standing, (), first), solve_constraints(standing, (CLEAR,), first)


def _arm_peaks(motion: AdaptedMotion) -> np.ndarray:
    """(6,) peak angular acceleration of both arms' segments."""
    upper = motion.morphology.layout.segment_of_part(BodyPart.LEFT_UPPER_ARM)
    segments = [upper + 4 * side + bone for side in (0, 1) for bone in range(3)]
    return angular_acceleration(motion.rotations[:, segments], motion.frame_rate).max(axis=0)


@pytest.mark.parametrize("name", ["stocky_man", "giant"])
@pytest.mark.parametrize("stem", ["punch", "dance", *outside(*SHOWN)])
def test_arms_come_out_of_the_body_without_a_pop(stem: str, name: str) -> None:
    source, before, after = _cleared(stem, name)
    assert arm_distances(before).min() < MAX_INHERITED_CLEARANCE
    assert arm_distances(after).min() > max(arm_distances(before).min(), -DEEPEST)
    assert after.residuals.max() < 2e-3
    assert (_arm_peaks(after) / np.maximum(_arm_peaks(source), QUIET_PEAK)).max() < 3.0


@pytest.mark.parametrize("name", ["stocky_man", "giant"])
def test_what_touches_on_the_actor_touches_and_does_not_fly_off(captures: Path, name: str) -> None:
    source, before, after = _cleared("accad_female1_D3_ConversationGestures", name)
    own, sunk, now = (arm_distances(each)[..., 2:].min(axis=(1, 2)) for each in (source, before, after))
    touching = (own < 0.02) & (sunk < -0.03)
    assert touching.sum() > 10
    assert now[touching].max() < 0.03


@pytest.mark.parametrize("name", ["stocky_man", "adult_woman"])
def test_wrists_that_are_to_be_in_the_body_stay_out_of_it_without_a_pop(captures: Path, name: str) -> None:
    standing, source = _standing("cmu_salsa_10", name)
    within = FollowBody(BodyPoint(BodyPart.PELVIS, (0.05, -0.02, 0.1)))
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    wish = PositionConstraint("motion", "Wrist", wrist, Chain(), 1, ALWAYS, target=within)
    first, last = source.first_frame + 200, source.first_frame + 500
    alone, both = (
        solve_constraints(standing, (CLEAR,), first, last),
        solve_constraints(standing, (wish, CLEAR), first, last),
    )
    assert both.residuals[1] == pytest.approx(alone.residuals[0], abs=2e-4)
    assert both.residuals[0].min() > 0.02
    assert (_arm_peaks(both) / np.maximum(_arm_peaks(source), QUIET_PEAK)).max() < 3.0
    part = solve_constraints(standing, (CLEAR, wish), first + 100, first + 110)
    assert np.array_equal(part.positions, both.positions[100:111])
    assert np.array_equal(part.residuals[::-1], both.residuals[:, 100:111])
