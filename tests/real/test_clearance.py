"""Real gestures and strikes on wide bodies: no hand in the belly, no arm that pops, and what touched still touches."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.clear import ClearConstraint
from studio.core.ground import Ground
from studio.core.metrics import QUIET, angular_acceleration
from studio.core.solver.adapt import hold, stand
from studio.core.solver.clearance import rooms
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.source import source_motion
from studio.io.character_file import bundled_characters
from tests.real.taken import contacts_of, named, taken

ALWAYS = ActivationCurve(-1.0, -1.0, 1e4, 1e4)
CLEAR = ClearConstraint("motion", "Clear", BodyPoint(BodyPart.THORAX), Chain(), 0, ALWAYS)
SHOWN = (
    "accad_female1_D3_ConversationGestures", "accad_male2_E4_CrossRight", "accad_male2_E11_BlockLeftHigh",
    "accad_male2_E9_BodyHookLeft", "accad_male2_E1_JabLeft", "cmu_max_jumping_jacks", "accad_female1_B03_Walk1",
)  # fmt: skip
DEEPEST = 0.02
"""Metres: what is kept of the depth that an actor has in a body whose girths are guessed."""


def _cleared(stem: str, name: str) -> tuple[AdaptedMotion, AdaptedMotion, AdaptedMotion]:
    """The source, the motion on a character, and the same with its arms clear."""
    capture, motion, actor = taken(named(stem))
    character, source = bundled_characters()[name], source_motion(motion, actor)
    standing = stand(motion, character.morphology, contacts_of(capture), Ground(), character.volume, actor.morphology)
    first = capture.first_frame
    return source.frames(first, 10**6), hold(standing, (), first), hold(standing, (CLEAR,), first)


def _arm_peaks(motion: AdaptedMotion) -> np.ndarray:
    """(6,) peak angular acceleration of both arms' segments."""
    upper = motion.morphology.layout.segment(BodyPart.LEFT_UPPER_ARM)
    segments = [upper + 4 * side + bone for side in (0, 1) for bone in range(3)]
    return angular_acceleration(motion.rotations[:, segments], motion.frame_rate).max(axis=0)


@pytest.mark.parametrize("name", ["stocky_man", "giant"])
@pytest.mark.parametrize("stem", SHOWN)
def test_arms_come_out_of_the_body_without_a_pop(captures: Path, stem: str, name: str) -> None:
    source, before, after = _cleared(stem, name)
    assert rooms(before).min() < -0.005
    assert rooms(after).min() > max(rooms(before).min(), -DEEPEST)
    assert after.residuals.max() < 2e-3
    assert (_arm_peaks(after) / np.maximum(_arm_peaks(source), QUIET)).max() < 3.0


@pytest.mark.parametrize("name", ["stocky_man", "giant"])
def test_what_touches_on_the_actor_touches_and_does_not_fly_off(captures: Path, name: str) -> None:
    source, before, after = _cleared("accad_female1_D3_ConversationGestures", name)
    own, sunk, now = (rooms(each)[..., 2:].min(axis=(1, 2)) for each in (source, before, after))
    touching = (own < 0.02) & (sunk < -0.03)
    assert touching.sum() > 10
    assert now[touching].max() < 0.03
