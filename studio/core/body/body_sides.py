"""Detection of limbs whose names contradict the side shown by their position and motion."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.body_shape import knees_bend_backwards
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]

LIMB_PARTS = {"legs": ("THIGH", "SHANK", "FOOT", "TOE"), "arms": ("CLAVICLE", "UPPER_ARM", "FOREARM", "HAND")}
"""Parts of the limbs whose sides may be exchanged, without their side."""
_OPPOSITE, _MOSTLY = -0.5, 0.9
"""Cosine between hips and shoulders, from right to left, to which no trunk twists, and the part of the frames."""
_BACKWARDS = -0.3
"""Mean cosine of feet with the front of the body that only feet on the wrong sides have."""


def exchanged_limbs(body_map: BodyMap, points: FloatArray) -> tuple[str, ...]:
    """Names (``legs``, ``arms``) of the limbs whose left and right are exchanged; ``points`` (F, J, 3) in any axes.

    Legs are exchanged if knees bend backwards and feet point backwards; arms if the line of the shoulders opposes that
    of the hips.
    """

    def pair(part: str) -> FloatArray:
        return points[:, [body_map[BodyPart[f"{side}_{part}"]] for side in ("LEFT", "RIGHT")]]

    hips, shoulders = pair("THIGH"), pair("UPPER_ARM")
    left = normalized(hips[:, 0] - hips[:, 1])
    legs = feet_point_backwards(body_map, points) and knees_bend_backwards(body_map, points)
    across = np.einsum("fi,fi->f", normalized(shoulders[:, 0] - shoulders[:, 1]), left * (-1.0 if legs else 1.0))
    arms = bool((across < _OPPOSITE).mean() > _MOSTLY)
    return tuple(name for name, exchanged in (("legs", legs), ("arms", arms)) if exchanged)


def feet_point_backwards(body_map: BodyMap, points: FloatArray) -> bool:
    """True if the feet of ``points`` (F, J, 3), in any axes, point backwards by the sides of the hips; False without
    toes.
    """
    if not all(BodyPart[f"{side}_TOE"] in body_map.parts for side in ("LEFT", "RIGHT")):
        return False

    def pair(part: str) -> FloatArray:
        return points[:, [body_map[BodyPart[f"{side}_{part}"]] for side in ("LEFT", "RIGHT")]]

    hips = pair("THIGH")
    front = np.cross(hips[:, 0] - hips[:, 1], pair("UPPER_ARM").mean(axis=1) - hips.mean(axis=1))
    ahead = np.einsum("fsi,fi->fs", normalized(pair("TOE") - pair("FOOT")), normalized(front))
    return bool(ahead.mean() < _BACKWARDS)
