"""A foot that is to kick a target near by: bodies step back from what hip and knee do not bend to, and hold it."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.normalized.normalize import detected_contacts, normalize_capture
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.request import AdaptRequest
from studio.core.solver.standing.stand import GroundedMotion, grounded_motion_of
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder

KICK = load_capture(example_captures_folder() / "front_kick.bvh")
MOTION, ACTOR = normalize_capture(KICK)
CONTACTS = detected_contacts(KICK, "kick")
BALL, CHAIN = BodyPoint(BodyPart.RIGHT_FOOT, at_end=True), Chain(clavicle=0.0, root=0.6)
TOP = 154
HOLD = slice(TOP - 6, TOP + 7)
"""Frames in which it is asked in full."""
CURVE = ActivationCurve(*((TOP + step) / MOTION.frame_rate for step in (-24.0, -6.0, 6.0, 24.0)))
STEPS = np.arange(0.02, 0.51, 0.04)
"""Metres by which the target is raised above where the child kicks."""


def _standing(name: str) -> GroundedMotion:
    body = bundled_characters()[name].morphology
    return grounded_motion_of(AdaptRequest(MOTION, body, CONTACTS, actor=ACTOR.morphology))


CHILD = _standing("child")
PLACE = body_point_positions(BALL, solve_constraints(CHILD, ()))[TOP]


def _missed(standing: GroundedMotion, raised: float, eased: bool = True) -> np.ndarray:
    target = (PLACE[0], PLACE[1], PLACE[2] + raised)
    kick = PositionConstraint("kick", "Ball", BALL, CHAIN, 0, CURVE, target=target)
    return solve_constraints(standing, (kick,), HOLD.start, HOLD.stop - 1, eased=eased).residuals[0]


@pytest.mark.parametrize("name", ["adult_woman", "tall_man", "stocky_man", "giant"])
def test_nobody_who_is_taller_fails_before_the_child_or_leaves_the_target_while_holding_it(name: str) -> None:
    """Frame by frame, and where moments between are eased: low targets are too near for long legs."""
    standing = _standing(name)
    for raised in STEPS:  # by then the child has failed by far
        assert _missed(standing, raised, eased=False).max() < 0.001, raised
        assert _missed(standing, raised).max() < 0.02, raised


def test_the_child_is_the_first_who_cannot_reach_it() -> None:
    missed = [_missed(CHILD, raised).max() for raised in STEPS]
    assert missed[0] < 1e-3
    assert missed[-1] > 0.2
    assert np.all(np.diff(missed) > -1e-3)  # what is met is met within less


@pytest.mark.parametrize("height", [0.9, 1.0, 1.2, 1.3])
@pytest.mark.parametrize("name", ["adult_woman", "tall_man", "stocky_man", "giant"])
def test_a_root_that_may_help_a_kick_never_makes_it_miss_by_more(name: str, height: float) -> None:
    """In every frame of the kick, those included in which the foot would have to turn far past its ankle's limit."""
    standing, throughout = _standing(name), ActivationCurve(2.0, 2.2, 2.8, 3.1)
    alone, helped = (
        solve_constraints(
            standing, (PositionConstraint("kick", "Ball", BALL, chain, 0, throughout, target=(1.0, 0.1, height)),)
        ).residuals[0]
        for chain in (Chain(), CHAIN)
    )
    assert np.nanmax(helped - alone) < 0.001
