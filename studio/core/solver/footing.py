"""Ground adaptation: where the ankles stand, how the feet lie, and how far the root comes down (METHOD 4)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from studio.core.constraints.activation import EaseShape, ease
from studio.core.contacts import ContactInterval
from studio.core.ground import Ground
from studio.core.kernels import feet as kernel
from studio.core.kernels.layout import LIMB_SLACK
from studio.core.kernels.legs import hip_heights
from studio.core.morphology import Morphology
from studio.core.normalized.motion import NormalizedMotion

FloatArray = NDArray[np.float64]

STANDING_REACH = 0.985
"""Part of its length to which a standing leg may always stretch, however bent the motion's own leg is."""
SWINGING_REACH = 0.97
"""The same of a leg in the air, beyond which it stretches ever less."""
FREED_AFTER = 0.15
"""Seconds after a foot has left the ground (or before it lands) in which it becomes free."""
LOOK_AHEAD = 0.15
"""Seconds over which the root comes down before it must, and stays down after."""


@dataclass(frozen=True, eq=False)
class Footing:
    """What the ground asks of one body: ``states`` (2, F) bit 1 heel, bit 2 toe; ``comforts`` (2, F) part of its
    length to which each leg stretches freely; ``ankles`` (2, F, 3) targets; ``feet``, ``toes`` (2, F, 3, 3) world
    rotations; ``drops`` (F,) metres by which the root is lowered.
    """

    states: NDArray[np.int64]
    comforts: FloatArray
    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray
    drops: FloatArray


def foot_states(contacts: Sequence[ContactInterval], frame_count: int) -> NDArray[np.int64]:
    """(2, F) of bits: 1 where the heel stands, 2 where the toe does."""
    states = np.zeros((2, frame_count), dtype=np.int64)
    for contact in contacts:
        bit = kernel.HEEL if contact.point.is_heel else kernel.TOE
        states[contact.point.side, contact.first : contact.last + 1] |= bit
    return states


def find_footing(
    motion: NormalizedMotion,
    morphology: Morphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    positions: FloatArray,
    rotations: FloatArray,
) -> Footing:
    """Plan the feet of a whole clip from its retargeted pose, raised to the ground's height."""
    layout, count = morphology.layout, motion.frame_count
    states = foot_states(contacts, count)
    ankles = np.empty((2, count, 3))
    feet, toes = np.empty((2, count, 3, 3)), np.empty((2, count, 3, 3))
    for side in range(2):
        segment = layout.spine_count + 12 + 4 * side
        source = np.ascontiguousarray(rotations[:, segment])
        sole = (morphology.foot[side], morphology.ankle_height[side], morphology.heel_length[side])
        kernel.level_soles(source, states[side], feet[side])
        kernel.keep_pitch_on_ground(*sole, states[side], feet[side])
        local_toes = np.swapaxes(source, 1, 2) @ rotations[:, segment + 1]
        kernel.level_toes(feet[side], local_toes, states[side], toes[side])
        kernel.plant_ankles(
            np.ascontiguousarray(positions[:, layout.ankle(side)]),
            feet[side],
            states[side],
            *sole,
            ground.height_at(positions[:, layout.ankle(side)]),
            ankles[side],
        )
    comforts = leg_comforts(motion, states)
    drops = np.empty(count)
    relative = ankles - positions[:, 0]
    hip_heights(motion.channels, morphology.packed[None], rotations, relative, comforts, states, drops)
    return Footing(states, comforts, ankles, feet, toes, smooth_drops(drops, motion.frame_rate))


def leg_comforts(motion: NormalizedMotion, states: NDArray[np.int64]) -> FloatArray:
    """(2, F) part of its length to which each leg stretches freely: standing, as far as the motion's own leg does."""
    own = 1.0 - motion.channels[:, LIMB_SLACK + 2 : LIMB_SLACK + 4].T
    standing = np.clip(own, STANDING_REACH, 1.0 - 1e-9)
    free = np.array([freedom(foot != 0, motion.frame_rate) for foot in states])
    return standing + free * (SWINGING_REACH - standing)


def freedom(planted: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """(F,) 0 while a foot stands, eased to 1 within ``FREED_AFTER`` seconds of the nearest frame that does."""
    frames = np.arange(len(planted))
    standing = frames[planted]
    if not len(standing):
        return np.ones(len(planted))
    after = np.searchsorted(standing, frames)
    gap = np.minimum(
        np.abs(standing[np.minimum(after, len(standing) - 1)] - frames),
        np.abs(frames - standing[np.maximum(after - 1, 0)]),
    )
    return ease(gap / (FREED_AFTER * frame_rate), EaseShape.QUINTIC)


def smooth_drops(drops: FloatArray, frame_rate: float) -> FloatArray:
    """At least ``drops`` (F,) everywhere, and smooth: their moving maximum, averaged over the same support.

    The paper's plain minimum of three heights jolts the root (accelerations 3 to 27 times the source's).
    """
    half = max(1, round(LOOK_AHEAD * frame_rate))
    peaks = maximum_filter1d(np.maximum(drops, 0.0), 2 * half + 1, mode="nearest")
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.pad(peaks, half, mode="edge")
    return np.convolve(padded, window / window.sum(), mode="valid")
