"""The floor that a motion's own footprints show: captured floors are tilted, and drift by centimetres (METHOD 4)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, sole_rows
from studio.core.captures.contacts import ContactInterval
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.sole import SOLE_STANDS
from studio.core.solver.standing.blends import freedom
from studio.core.solver.standing.footing import foot_states
from studio.core.windows import smoothed

FloatArray = NDArray[np.float64]

SMOOTHING = 0.05
"""Seconds, standard deviation, over which the floor under the body goes from one footprint to the next one."""
FAINT = 0.01
"""The weight of a foot in the air beside one that stands."""


def shown_floor(
    contacts: Sequence[ContactInterval], positions: FloatArray, body: AnyMorphology, frame_rate: float
) -> FloatArray:
    """(F,) metres of the floor under a retargeted motion, ``positions`` (F, P, 3), as its standing heels show it.

    Under each foot it is where the sole is while the heel stands, and passes on to the next footprint in between; the
    body's floor is that of the feet that stand, low-passed. 0 where no heel ever stands.
    """
    flat = foot_states(contacts, len(positions)) == SOLE_STANDS
    soles = np.array([positions[:, body.layout.ankle(side), 2] - sole_rows(body, side)[:, 3] for side in range(2)])
    if not flat.any():
        return np.zeros(len(positions))
    sides = [side for side in range(2) if flat[side].any()]
    floors = np.array([_passed_on(soles[side], flat[side]) for side in sides])
    floors -= np.median(floors - floors.mean(axis=0), axis=1, keepdims=True)
    weights = np.array([1.0 - freedom(flat[side], frame_rate) for side in sides]) + FAINT
    floor = np.average(floors, axis=0, weights=weights)
    return smoothed(floor, SMOOTHING * frame_rate)


def _passed_on(heights: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """(F,) ``heights`` where ``known``, eased from one known one to the next."""
    filled = np.repeat(heights[:, None], 3, axis=1)
    interpolate_gaps(filled, known)
    return filled[:, 0]
