"""The pelvis dips to the side where the feet of a motion stand at other heights than it has them (METHOD section 4)."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import AnyMorphology
from studio.core.kernels.support.gaps import fill_gaps
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
    hips, legs = [body.layout.hip(side) for side in range(2)], body.layout.hip(0)
    stands = states != 0
    if not stands.any(axis=1).all():
        return np.zeros_like(off)
    wanted = off.copy()
    for side in range(2):
        fill_gaps(wanted[side], stands[side])
    apart = positions[:, hips[0]] - positions[:, hips[1]]
    gain = np.linalg.norm(apart, axis=1) ** 2
    level = np.hypot(apart[:, 0], apart[:, 1])
    both = np.prod([1.0 - freedom(each, frame_rate, GOES_ALONG) for each in stands], axis=0)
    angles = averaged((wanted[0] - wanted[1])[:, 2:], AVERAGED, frame_rate)[:, 0] * both * level / gain
    angles = MOST * np.tanh(angles / MOST)
    ahead = np.column_stack([apart[:, 1], -apart[:, 0], 0.0 * level]) / np.maximum(level, 1e-9)[:, None]
    turns = Rotation.from_rotvec(angles[:, None] * ahead).as_matrix()
    before, root = positions[:, hips].copy(), positions[:, :1]
    lumbar = positions[:, 1] - positions[:, 0]
    positions[:, 1:legs] += (np.einsum("fij,fj->fi", turns, lumbar) - lumbar)[:, None]
    rotations[:, 0] = turns @ rotations[:, 0]
    moved = root + np.einsum("fij,fpj->fpi", turns, before - root) - before
    for side, hip in enumerate(hips):
        positions[:, hip : hip + 5] += moved[:, side, None]
    return np.asarray(moved.transpose(1, 0, 2))
