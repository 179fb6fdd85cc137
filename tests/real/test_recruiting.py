"""Real kicks and walks balance with free arms and the free leg: feet stay, the balance is met, nothing pops."""

from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.grounds.ground import Ground
from studio.core.quality.metrics import acceleration_ratio, contact_quality
from studio.core.solver.adapt import hold, stand
from studio.io.character_file import bundled_characters
from tests.core.motions import ALWAYS
from tests.real.taken import contacts_of, named, taken

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
ALONE = Chain(0.0, 0.0, 0.0, 0.0, 0.0, free_arms=1.0, free_legs=1.0)
WHOLE = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0, free_arms=1.0, free_legs=1.0)


@pytest.mark.parametrize("name", ["adult_woman", "child", "giant"])
@pytest.mark.parametrize("stem", ["mass_kick", "accad_male2_G2_FrontKick", "accad_female1_B03_Walk1"])
def test_free_limbs_help_to_balance(captures: Path, stem: str, name: str) -> None:
    capture, motion, _ = taken(named(stem))
    contacts = contacts_of(capture)
    standing = stand(motion, BODIES[name], contacts, Ground())
    first = capture.first_frame
    for chain in (WHOLE, ALONE):  # limbs alone are thrown out for much that is out of reach
        wish = BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), chain, 0, ALWAYS, place=Support())
        solved = hold(standing, (wish,), first)
        assert chain is ALONE or np.nanmax(solved.residuals) < 5e-4
        assert contact_quality(solved, contacts, Ground()).slide < 1e-6
        assert acceleration_ratio(solved, hold(standing, (), first)) < (3.0 if chain is WHOLE else 10.0)
