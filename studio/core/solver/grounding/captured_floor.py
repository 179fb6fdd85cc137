"""Floor of a captured motion, found from its own footprints: captured floors are tilted and drift by centimetres
(METHOD 5).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, sole_rows
from studio.core.captures.contacts import ContactInterval
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.sole import SOLE_STANDS
from studio.core.solver.grounding.contact_blending import release_weight
from studio.core.solver.grounding.footing import foot_states
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]

FLOOR_SMOOTHING_SECONDS = 0.05
"""Standard deviation in seconds of the smoothing of the floor between footprints."""
SWING_FOOT_WEIGHT = 0.01
"""Weight of a swing foot in the floor's mean height, relative to a standing foot."""


def captured_floor(
    contacts: Sequence[ContactInterval], positions: FloatArray, body: AnyMorphology, frame_rate: float
) -> FloatArray:
    """Floor heights (F,) in metres under a retargeted motion with ``positions`` (F, P, 3), from its standing soles.

    The floor under each foot is interpolated between footprints; the floor under the body is the low-passed mean over
    the standing feet. 0 without any flat foot.
    """
    flat = foot_states(contacts, len(positions)) == SOLE_STANDS
    soles = np.array(
        [positions[:, body.layout.ankle_point(side), 2] - sole_rows(body, side)[:, 3] for side in range(2)]
    )
    if not flat.any():
        return np.zeros(len(positions))
    sides = [side for side in range(2) if flat[side].any()]
    floors = np.array([_passed_on(soles[side], flat[side]) for side in sides])
    floors -= np.median(floors - floors.mean(axis=0), axis=1, keepdims=True)
    weights = np.array([1.0 - release_weight(flat[side], frame_rate) for side in sides]) + SWING_FOOT_WEIGHT
    floor = np.average(floors, axis=0, weights=weights)
    return bell_average(floor, FLOOR_SMOOTHING_SECONDS * frame_rate)


def _passed_on(heights: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """``heights`` (F,), given where ``known``, interpolated between."""
    filled = np.repeat(heights[:, None], 3, axis=1)
    interpolate_gaps(filled, known)
    return filled[:, 0]
