"""A chain that changes over time: by the activations of two constraints of one point."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

WRIST, SHOULDER = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), BodyPoint(BodyPart.RIGHT_UPPER_ARM)
ARM, WITH_TRUNK = Chain(), Chain(limb=0.3, trunk=1.0)
ALWAYS = ActivationCurve(-9.0, -9.0, 99.0, 99.0)
BEGIN, END = 1.0, 1.5
"""Seconds between which the second chain takes over."""
WALK, CONTACTS = walk()
BODY = bundled_characters()["tall_man"].morphology


def test_the_trunk_comes_in_smoothly_where_a_constraint_with_it_is_full_before_the_one_of_the_arm_fades_out() -> None:
    free = adapt(AdaptRequest(WALK, BODY, CONTACTS))
    places = body_point_positions(SHOULDER, free) + np.array([0.35, -0.1, 0.1])
    target = KeyedPlace(tuple(WALK.times.tolist()), tuple(map(tuple, places.tolist())))

    def asked(chain: Chain, activation: ActivationCurve, priority: int = 0) -> PositionConstraint:
        return PositionConstraint("walk", "Reach", WRIST, chain, priority, activation, target=target)

    def adapted(*constraints: PositionConstraint) -> AdaptedMotion:
        return adapt(AdaptRequest(WALK, BODY, CONTACTS, constraints))

    def lean(motion: AdaptedMotion) -> np.ndarray:
        """(F,) degrees between the upper body and that without constraints."""
        trunk = motion.morphology.layout.segment_of_part(BodyPart.THORAX)
        turn = np.einsum("fij,fij->f", motion.rotations[:, trunk], free.rotations[:, trunk])
        return np.degrees(np.arccos(np.clip((turn - 1.0) / 2.0, -1.0, 1.0)))

    first = asked(ARM, ActivationCurve(-9.0, -9.0, BEGIN, END))
    second = asked(WITH_TRUNK, ActivationCurve(BEGIN - 0.3, BEGIN, 99.0, 99.0), priority=1)
    both, whole = adapted(first, second), lean(adapted(asked(WITH_TRUNK, ALWAYS)))
    missed = np.linalg.norm(body_point_positions(WRIST, both) - places, axis=1)
    assert missed.max() < 2e-4
    leaning, frame = lean(both), np.round(np.array([BEGIN, END]) * WALK.frame_rate).astype(int)
    assert leaning[: frame[0]].max() < 0.1
    assert leaning[frame[1] :] == pytest.approx(whole[frame[1] :], abs=0.1)
    assert np.abs(np.diff(leaning)).max() < 2.5 * whole.max() / (frame[1] - frame[0])
