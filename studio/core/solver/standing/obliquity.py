"""The pelvis dips to the side where the feet of a motion stand at other heights than it has them (METHOD section 4)."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.pelvic_obliquity import tilt_pelvis
from studio.core.solver.standing.blends import AVERAGED, GOES_ALONG, averaged, freedom

FloatArray = NDArray[np.float64]

MOST = np.radians(2.0)
"""By which the pelvis dips at most, and never quite. People dip it by twice that; then hips rode over 5 mm off."""


def dip_pelvis(
    off: FloatArray,
    states: NDArray[np.int64],
    body: AnyMorphology,
    frame_rate: float,
    positions: FloatArray,
    rotations: FloatArray,
) -> FloatArray:
    """(2, F, 3) metres by which hips move where the pelvis alone is turned about its heading, in place, trunk upright.

    Feet that stand ``off`` (2, F, 3) want their hips at different heights; two straight legs have no other way to both.
    ``positions`` (F, P, 3), ``rotations`` (F, S, 3, 3).
    """
    stands, moved = states != 0, np.zeros_like(off)
    if not stands.any(axis=1).all():
        return moved
    wanted = off.copy()
    for side in range(2):
        interpolate_gaps(wanted[side], stands[side])
    apart = averaged(wanted[0, :, 2:] - wanted[1, :, 2:], AVERAGED, frame_rate)[:, 0]
    for each in stands:
        apart *= 1.0 - freedom(each, frame_rate, GOES_ALONG)
    hips = body.layout.hip(0), body.layout.hip(1)
    tilt_pelvis(hips, apart, MOST, positions, rotations, moved)
    return moved
