"""Hands that are in the air kept above the floor: on bodies with longer arms they would sink into it (METHOD 4)."""

import numpy as np
from numpy.typing import NDArray

from studio.core.contacts import spans_of
from studio.core.ground import Ground
from studio.core.kernels import layout as at
from studio.core.kernels.support.carrying import place_arms
from studio.core.morphology import AnyMorphology
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.carrying import lengths_of, reach_of
from studio.core.solver.footing import freedom, smooth_drops
from studio.core.solver.settling import Arms

FloatArray = NDArray[np.float64]

ROOM = 0.03
"""Parts of the leg's length above the ground below which wrist and finger tips begin to be raised; 3/16 is kept."""


def raise_hands(
    motion: NormalizedMotion,
    body: AnyMorphology,
    ground: Ground,
    arms: Arms | None,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Raise wrists of a standing body, (F, P, 3) and (F, S, 3, 3), in place, whose hands would be in level ground.

    Hands keep how they lie in the world; those that stand, as ``arms`` tells, stay where they are.
    """
    sides = [side for side in range(2) if _lowest(side, body, ground, positions).min() < ROOM * body.leg_length]
    if not sides or not ground.is_level:
        return
    layout = body.layout
    wrists = np.stack([positions[:, layout.wrist(side)] for side in range(2)])
    hands = np.stack([rotations[:, layout.spine_count + 5 + 4 * side] for side in range(2)])
    bends, comforts = np.ones(wrists.shape[:2]), np.zeros(wrists.shape[:2])
    for side in sides:
        lacks = lacking(_lowest(side, body, ground, positions), ROOM * body.leg_length)
        raises = smooth_drops(lacks, motion.frame_rate)
        if arms is not None:
            raises *= freedom(arms.standing[side], motion.frame_rate)
        wrists[side, :, 2] += raises
        stretch = reach_of(motion, body, side) / lengths_of(body, at.M_ARM + 2 * side).sum(axis=1)
        comforts[side] = np.where(raises > 0.0, stretch, 0.0)
        for first, last in spans_of(
            raises > 0.0
        ):  # an elbow that is nearly straight may change sides; a bent one snaps
            usual = motion.channels[first : last + 1, at.LIMB_BEND + side].sum()
            bends[side, first : last + 1] = 1.0 if usual >= 0.0 else -1.0
    place_arms(motion.channels, body.rows, wrists, hands, bends, comforts, positions, rotations)


def _lowest(side: int, body: AnyMorphology, ground: Ground, positions: FloatArray) -> FloatArray:
    """(F,) metres of the lower one of wrist and finger tips above the ground."""
    wrist = body.layout.wrist(side)
    return np.asarray(positions[:, wrist : wrist + 2, 2].min(axis=1) - ground.height)


def lacking(heights: FloatArray, room: float) -> FloatArray:
    """(F,) by how much to raise what is at ``heights`` (F,) so that it keeps above 0: METHOD (7)."""
    share = np.clip(heights / room, -1.0, 1.0)
    return np.asarray(room * (1.0 - share) ** 3 * (3.0 + share) / 16.0 + np.maximum(-heights - room, 0.0))
