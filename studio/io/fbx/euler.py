"""Rotations as the Euler angles of FBX: one order of axes for each joint, degrees that do not jump between frames."""

import numpy as np
from numpy.typing import NDArray

from studio.core.rotations import to_euler

FloatArray = NDArray[np.float64]

FBX_ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")
"""Orders of axes at the index that the format uses; the rotations act in this order about the parent's axes."""
_NEAR_LOCK = np.radians(70.0)
"""The second angle beyond which another order is looked for: at 90 degrees the first and third are one."""
_DIGITS = 9
"""Decimals of a radian beyond which angles are alike, so that ties are decided the same way on every machine."""


def euler_curves(rotations: FloatArray) -> tuple[int, FloatArray]:
    """Index of an order in ``FBX_ORDERS``, and angles (F, 3) in degrees about X, Y and Z, of unit quaternions (F, 4).

    The order is the first one that stays away from gimbal lock, or else the one that stays farthest away.
    """
    best = np.inf
    for number, order in enumerate(FBX_ORDERS):
        angles = to_euler(order[::-1], rotations)[:, ::-1]  # acting one after the other is intrinsic from the last
        nearest = float(np.abs(angles[:, 1]).max())
        if nearest < best:
            best, found, chosen = nearest, number, angles
        if best < _NEAR_LOCK:
            break
    axes = ["XYZ".index(axis) for axis in FBX_ORDERS[found]]
    by_axis = np.empty((len(rotations), 3))
    by_axis[:, axes] = _continuous(chosen)
    return found, np.degrees(by_axis)


def _continuous(angles: FloatArray) -> FloatArray:
    """Angles (F, 3) of the same rotations, nearest to those of the previous frame.

    (a, b, c) and (a + pi, pi - b, c + pi) are one rotation: after the nearer one is chosen, only whole turns are added.
    """
    rough: FloatArray = np.round(angles, _DIGITS)
    other = rough * [1.0, -1.0, 1.0] + np.pi
    stays, leaves = (np.abs(_wrapped(each[1:] - rough[:-1])).sum(axis=1) for each in (rough, other))
    is_other = np.concatenate([[False], np.cumsum(leaves < stays) % 2 == 1])
    chosen: FloatArray = np.where(is_other[:, None], angles * [1.0, -1.0, 1.0] + np.pi, angles)
    rough = np.round(chosen, _DIGITS)
    return np.asarray(chosen + 2.0 * np.pi * np.round((np.unwrap(rough, axis=0) - rough) / (2.0 * np.pi)))


def _wrapped(angles: FloatArray) -> FloatArray:
    """Angles from -pi to pi."""
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)
