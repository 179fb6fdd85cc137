"""Morphology-independent motion: channels without any body's measures."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.frozen_array import frozen_array
from studio.core.kernels import channel_columns as channel
from studio.core.rotations import multiply, rotate
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]

HEADING_SMOOTHING_SECONDS = 0.25
"""Standard deviation in seconds of the low-pass filter on the headings of pelvis and feet."""


@dataclass(frozen=True, eq=False)
class Girdle:
    """Proportions of the actor's shoulders, hips and limbs.

    A motion holds rotations of clavicles, pelvis and limbs, whose effect depends on their rest directions, their
    breadth, and the ratio of a limb's bones.
    """

    length: float
    """Length of the clavicles relative to half the breadth of the shoulders (``realize.clavicle_proportions``)."""
    rest: FloatArray
    """Directions (2, 3) of the clavicles at rest, in thorax axes."""
    hips: float
    """Distance between the hip joints in leg lengths."""
    limbs: FloatArray
    """Lengths (4,) of both upper arms and both thighs as fractions of their limbs."""

    def __post_init__(self) -> None:
        for name in ("rest", "limbs"):
            object.__setattr__(self, name, frozen_array(getattr(self, name)))


@dataclass(frozen=True)
class Change:
    """Change of clips in frame ``first``, in which the new clip continues from the pose of the body.

    The transition takes ``seconds`` or, if that is 0, as long as it needs; if it is ``cut``, the new clip plays at
    once. In a ``planned`` change feet in the air step over the ground to their landing positions; an unplanned one, or
    one of given seconds, has no time for that.
    """

    first: int
    seconds: float = 0.0
    cut: bool = False
    planned: bool = False


@dataclass(frozen=True, eq=False)
class NormalizedMotion:
    """Motion without any body's measures: angles, and lengths as fractions of the body's own.

    ``channels`` (F, 89 + 4 K) have the columns of ``kernels.channel_columns``; ``spine_places`` (K,) is the begin of
    each of the K spine segments along the trunk, 0 the pelvis to 1 the thorax. The motion's space has its origin on the
    ground under the root of the first frame.
    """

    name: str
    frame_rate: float
    channels: FloatArray
    spine_places: FloatArray
    girdle: Girdle | None = None
    """Proportions of the actor, by which rotations are adapted: longer clavicles rotate less, so that shoulders move as
    far, and come no nearer to each other than the actor's; wider hips rotate less. None if they are unknown: all rotate
    alike.
    """
    changes: tuple[Change, ...] = ()
    """Changes of clips in a row, at which channels jump; each clip is continued from the last pose of the
    one before.
    """

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame_rate", float(self.frame_rate))  # kernels are compiled once more for an int
        for name in ("channels", "spine_places"):
            object.__setattr__(self, name, frozen_array(getattr(self, name)))
        if self.channels.ndim != 2 or self.channels.shape[1] != channel.SPINE + 4 * (len(self.spine_places) - 1):
            raise ValueError(
                f"Channels of shape {self.channels.shape} do not fit {len(self.spine_places)} spine segments."
            )

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.channels)

    @cached_property
    def times(self) -> FloatArray:
        """Times (F,) of the frames in seconds."""
        return frozen_array(np.arange(self.frame_count) / self.frame_rate)

    @cached_property
    def across(self) -> FloatArray:
        """Horizontal leftward axis (F, 2) of the feet in the motion's space: the sum of both, low-pass filtered.

        A pelvis rotates over standing feet; this is its heading without that rotation.
        """
        yaw, pelvis = self.channels[:, channel.YAW], self.channels[:, channel.PELVIS : channel.PELVIS + 4]
        feet = self.channels[:, channel.FOOT : channel.FOOT + 8].reshape(-1, 2, 4)
        x, y, _ = rotate(multiply(pelvis[:, None], feet), np.array([0.0, 1.0, 0.0])).sum(axis=1).T
        level = np.column_stack([np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y])
        return frozen_array(bell_average(level, HEADING_SMOOTHING_SECONDS * self.frame_rate))

    @property
    def parts(self) -> tuple[slice, ...]:
        """Ranges of frames between the changes of the motion."""
        ends = [0, *(each.first for each in self.changes), self.frame_count]
        return tuple(slice(*each) for each in pairwise(ends))

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frame_count - 1) / self.frame_rate
