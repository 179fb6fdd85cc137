"""Legs under a body: how far it must come down, and a leg set on its ankle."""

from typing import NamedTuple

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.kernels import channel_columns as channel
from tests.core.twins.limb import place_limb, soft_reach
from tests.core.twins.rotation import from_quaternion, shortest_arc


def drop(body: Morphology, pelvis: np.ndarray, ankles: np.ndarray, comforts: np.ndarray, states: np.ndarray) -> float:
    """Metres for one frame; ``ankles`` (2, 3) relative to the root."""
    drops = [0.0]
    for side in np.flatnonzero(states):
        apart = ankles[side] - pelvis @ body.hip_offset[side]
        reach = comforts[side] * body.leg[side].sum()
        drops.append(-apart[2] - np.sqrt(max(reach**2 - apart[0] ** 2 - apart[1] ** 2, 0.0)))
    return max(drops)


class Stance(NamedTuple):
    """Pose of one leg in one frame: its soft-IK threshold, its ankle (3,), foot and toe (3, 3)."""

    comfort: float
    ankle: np.ndarray
    foot: np.ndarray
    toe: np.ndarray


def place_leg(
    row: np.ndarray, body: Morphology, side: int, stance: Stance, root: np.ndarray, pelvis: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points hip, knee, ankle, toe, toe end (5, 3) and rotations thigh, shank, foot, toe (4, 3, 3)."""
    hip = root + pelvis @ body.hip_offset[side]
    apart = stance.ankle - hip
    distance, length = np.linalg.norm(apart), body.leg[side].sum()
    limb = 2 + side
    frame = pelvis @ from_quaternion(row[channel.LIMB_FRAME + 4 * limb : channel.LIMB_FRAME + 4 * limb + 4])
    aimed = shortest_arc(frame[:, 2], apart / distance) @ frame
    stretch = max(
        length * soft_reach(distance / length, stance.comfort), abs(body.leg[side, 0] - body.leg[side, 1]) + 1e-6
    )
    knee, reached, thigh, shank = place_limb(
        hip,
        aimed,
        stretch,
        (body.leg[side, 0], body.leg[side, 1]),
        row[channel.LIMB_OFF_PLANE + limb] * length,
        1.0,
        row[channel.LIMB_TWIST + 2 * limb : channel.LIMB_TWIST + 2 * limb + 2],
    )
    ball = reached + stance.foot @ body.foot[side]
    points = np.array([hip, knee, reached, ball, ball + stance.toe @ body.toe[side]])
    return points, np.array([thigh, shank, stance.foot, stance.toe])
