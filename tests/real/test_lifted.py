"""A ground that goes up or down carries bodies with it, as if they had been set on it there."""

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

from studio.core.compact_array import CompactArray
from studio.core.grounds import Bumps, Slope, Steps
from studio.core.grounds.ground import Ground
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.grounding.moved_ground import moved_to_height
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.captures import outside
from tests.real.taken import contacts_of, named, taken

GIANT = bundled_characters()["giant"].morphology
GROUNDS = (Ground(0.2), Slope(0.2, 0.2), Steps(0.2, 0.17, 0.3, 6), Bumps(0.2))
STEMS = (
    "accad_female1_B03_Walk1", "accad_female1_A11_CrawlForward", "accad_female1_D6_CartWheel",
    "accad_female1_A08_CrouchToLie", "accad_female1_A05_PickUpBox",
)  # fmt: skip
ALIKE = 1e-6
"""Metres, radians and parts: rounding, where a foot is put a little otherwise for it."""


@pytest.mark.parametrize("stem", ["crawl", "cartwheel", *outside(*STEMS)])
@pytest.mark.parametrize("ground", GROUNDS, ids=lambda ground: ground.kind)
def test_a_body_on_a_ground_that_is_raised_stands_as_if_set_on_it_there(stem: str, ground: Ground) -> None:
    capture, motion, actor = taken(named(stem))
    request = AdaptRequest(motion, GIANT, contacts_of(capture), (), ground, actor=actor.morphology, clears=True)
    there = grounded_motion_of(replace(request, ground=ground.at_height(-0.35)))
    assert_alike(moved_to_height(grounded_motion_of(request), -0.35), there)


def assert_alike(one: Any, other: Any) -> None:
    """Every number of two values, however deep inside."""
    if is_dataclass(one) and not isinstance(one, type):
        for field in fields(one):
            assert_alike(getattr(one, field.name), getattr(other, field.name))
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for mine, theirs in zip(one, other, strict=True):
            assert_alike(mine, theirs)
    elif isinstance(one, np.ndarray | CompactArray | float):
        np.testing.assert_allclose(one[:] if isinstance(one, CompactArray) else one, other, atol=ALIKE, rtol=0.0)
    else:
        assert one == other
