"""Translation of a grounded body with its ground, to another height."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from studio.core.solver.grounding.grounded_motion import GroundedMotion

FloatArray = NDArray[np.float64]

_PLACE, _KNEE_FACES = 2, 5
"""Columns of an ankle target with the heights of the ankle and of the knee target (``Footing.ankles``)."""


def moved_to_height(standing: "GroundedMotion", height: float) -> "GroundedMotion":
    """Grounded motion moved up or down with its ground to ``height`` metres."""
    rise = height - standing.ground.height
    positions, ankles = standing.positions.copy(), standing.footing.ankles.copy()
    positions[..., 2] = positions[..., 2] + rise
    for heights in range(_PLACE, ankles.shape[2], _KNEE_FACES - _PLACE):
        ankles[..., heights] += rise
    arms = standing.arms
    return replace(
        standing,
        ground=standing.ground.at_height(height),
        footing=replace(standing.footing, ankles=ankles),
        holds=tuple(replace(each, places=_raised(each.places, rise)) for each in standing.holds),
        arms=None if arms is None else replace(arms, wrists=_raised(arms.wrists, rise)),
        positions=positions,
    )


def _raised(positions: FloatArray, rise: float) -> FloatArray:
    """Positions (..., 3) raised by ``rise`` metres."""
    return np.asarray(positions + np.array([0.0, 0.0, rise]))
