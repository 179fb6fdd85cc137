"""Shoulders come no nearer to each other than the actor's do."""

import pytest

from studio.core.grounds.ground import Ground
from studio.core.quality.motion_quality import motion_quality
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

NEARER, FARTHER = -0.02, 0.15
"""Fraction of the distance at rest: what clavicles of other shares may add to it is more than what they may take."""


@pytest.mark.parametrize(
    "stem",
    [
        "box_lift", "cartwheel", "punch", "run",
        *outside(
        "accad_male2_A6_BoxLift", "accad_female1_D6_CartWheel", "accad_male2_E1_JabLeft", "assimp_Boxing_Toes",
        "accad_male2_E8_UppercutRight", "accad_male2_G11_RoundhouseLeadingRight", "accad_female1_C20_RunToJumpToWalk",
        ),
    ],
)  # fmt: skip
def test_shoulders_are_as_wide_as_the_actors(stem: str) -> None:
    capture, motion, actor = taken(named(stem))
    contacts, source = contacts_of(capture), source_motion(motion, actor)
    for character in bundled_characters().values():
        adapted = adapt(AdaptRequest(motion, character.morphology, contacts))
        found = motion_quality(adapted, source, contacts, Ground(), capture.first_frame)
        assert NEARER < found.shoulders < FARTHER, character.name
