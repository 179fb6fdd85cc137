"""Pelvic obliquity for feet at heights other than in the motion (METHOD section 4)."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.pelvic_obliquity import tilt_pelvis
from studio.core.solver.grounding.contact_blending import (
    DISPLACEMENT_RETURN_SECONDS,
    ROOT_AVERAGE_SECONDS,
    hann_average,
    release_weight,
)

FloatArray = NDArray[np.float64]

MAX_OBLIQUITY = np.radians(2.0)
"""Greatest obliquity in radians, approached softly. People tilt the pelvis by twice this, but then hips would be
displaced by over 5 mm.
"""


def tilt_pelvis_to_feet(
    off: FloatArray,
    states: NDArray[np.int64],
    body: AnyMorphology,
    frame_rate: float,
    positions: FloatArray,
    rotations: FloatArray,
) -> FloatArray:
    """Tilt the pelvis about its heading under an upright trunk, in place; returns the displacements (2, F, 3) of the
    hips in metres.

    Feet displaced by ``off`` (2, F, 3) need hips at different heights; for two straight legs there is no other
    solution. ``positions`` (F, P, 3), ``rotations`` (F, S, 3, 3).
    """
    stands, moved = states != 0, np.zeros_like(off)
    if not stands.any(axis=1).all():
        return moved
    target = off.copy()
    for side in range(2):
        interpolate_gaps(target[side], stands[side])
    apart = hann_average(target[0, :, 2:] - target[1, :, 2:], ROOT_AVERAGE_SECONDS, frame_rate)[:, 0]
    for each in stands:
        apart *= 1.0 - release_weight(each, frame_rate, DISPLACEMENT_RETURN_SECONDS)
    hips = body.layout.hip_point(0), body.layout.hip_point(1)
    tilt_pelvis(hips, apart, MAX_OBLIQUITY, positions, rotations, moved)
    return moved
