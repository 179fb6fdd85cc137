"""Feet moved out of the ground by the least amount: tipped about their free end (METHOD 5).

Contacts stay: a foot whose heel penetrates is tipped about its ball, and the other way round.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.grounds.ground import Ground
from studio.core.kernels.support.swing_foot_clearance import TOE_BEND_LEAD_SECONDS, smooth_toe_bends
from studio.core.solver.grounding.held_foot import FootPath, sole_arms
from studio.core.solver.grounding.swing_foot_path import SOLE_TOLERANCE

FloatArray = NDArray[np.float64]


def heights_of(foot: FootPath, measures: FloatArray, ground: Ground) -> FloatArray:
    """Heights (2, F) in metres above the ground of a foot's heel, and of the lower one of ball and tip.

    ``measures`` (F or 1, 6) of the foot (``kernels.support.sole``).
    """
    arms = sole_arms(measures)
    ball = foot.ankles + _turned(foot.feet, arms.joint)
    lows = np.array(
        [
            foot.ankles + _turned(foot.feet, arms.heel),
            ball - _turned(foot.feet, arms.thickness),
            ball - _turned(foot.toes, arms.thickness),
            ball + _turned(foot.toes, arms.tip),
        ]
    )
    heights = lows[..., 2] - ground.height_at(lows)
    return np.stack([heights[0], heights[1:].min(axis=0)])


def depths_of(foot: FootPath, measures: FloatArray, ground: Ground) -> FloatArray:
    """Penetrations (2, F) in metres of a foot's heel, and of its ball or tip."""
    return np.maximum(-heights_of(foot, measures, ground), 0.0)


def raised_out_of_ground(foot: FootPath, measures: FloatArray, depths: FloatArray) -> FootPath:
    """``foot`` raised by ``depths`` (2, F) metres at its heel and its ball; toes keep their world rotations."""
    if not depths.any():
        return foot
    heel, joint, _, _ = sole_arms(measures)
    heels, balls = (foot.ankles + _turned(foot.feet, each) for each in (heel, joint))
    arms, tips = balls - heels, depths[1] - depths[0]
    tips = tips * (arms[:, :2] ** 2).sum(axis=1) / np.maximum((arms**2).sum(axis=1), 1e-9)  # a steep foot is raised
    feet = tip_rotations(arms, tips) @ foot.feet
    about_heel = (tips > 0.0)[:, None]
    ankles = np.where(about_heel, heels - _turned(feet, heel), balls - _turned(feet, joint))
    ankles[:, 2] += depths.max(axis=0) - np.abs(tips)
    return FootPath(ankles, feet, foot.toes)


def ankle_tip_rotations(foot: FootPath, measures: FloatArray, heights: FloatArray, rises: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) of a foot about its ankle that raise the lower one of heel and ball by ``rises`` (2, F)
    metres.

    ``heights`` (2, F) are those of heel and ball before. A foot is tipped at most until it is level.
    """
    heel, joint, _, _ = sole_arms(measures)
    pitch, extent = heights[0] - heights[1], joint[:, 0] - heel[:, 0]
    up = np.clip(rises[1] * extent / joint[:, 0], 0.0, np.maximum(pitch, 0.0))
    down = np.clip(-rises[0] * extent / heel[:, 0], 0.0, np.maximum(-pitch, 0.0))
    return tip_rotations(_turned(foot.feet, joint - heel), up - down)


def early_envelope(depths: FloatArray, stands: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """Smooth upper envelope (N, F) of penetrations ``depths`` (N, F) in metres, which begins before each penetration.

    It is zero where the foot ``stands`` (F,), and in the first frame.
    """
    surely = stands | (np.arange(len(stands)) == 0)
    raised, early = depths - SOLE_TOLERANCE * (1.0 - np.exp(-depths / SOLE_TOLERANCE)), np.empty_like(depths)
    for each, out in zip(raised, early, strict=True):
        smooth_toe_bends(surely, round(TOE_BEND_LEAD_SECONDS * frame_rate), each, out)
    return early


def _turned(rotation_matrices: FloatArray, arms: FloatArray) -> FloatArray:
    """Vectors ``arms`` (F, 3) rotated by ``rotation_matrices`` (F, 3, 3)."""
    return np.asarray((rotation_matrices @ arms[..., None])[..., 0])


def tip_rotations(arms: FloatArray, rises: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) about level axes that raise the ends of ``arms`` (F, 3) by ``rises`` (F,) metres, as far as
    possible.
    """
    lengths = np.maximum(np.linalg.norm(arms, axis=1), 1e-9)
    slopes = [np.arcsin(np.clip(height / lengths, -1.0, 1.0)) for height in (arms[:, 2], arms[:, 2] + rises)]
    axes = np.column_stack([arms[:, 1], -arms[:, 0], np.zeros(len(arms))])
    axes /= np.maximum(np.linalg.norm(axes, axis=1, keepdims=True), 1e-9)
    return np.asarray(Rotation.from_rotvec((slopes[1] - slopes[0])[:, None] * axes).as_matrix())
