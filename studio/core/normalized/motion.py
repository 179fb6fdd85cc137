"""The morphology-independent motion: channels without any body's measures."""

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

HEADING_SMOOTHING = 0.25
"""Seconds, standard deviation of the low-pass on where pelvis and feet look."""


@dataclass(frozen=True, eq=False)
class Girdle:
    """Proportions of the actor's shoulders, hips and limbs.

    A motion holds rotations of clavicles, pelvis and limbs, whose effect depends on their rest directions, their
    breadth, and the ratio of a limb's bones.
    """

    length: float
    """Reach of the clavicles relative to half the breadth of the shoulders (``realize.clavicle_proportions``)."""
    rest: FloatArray
    """(2, 3) direction of each clavicle at rest, thorax axes."""
    hips: float
    """Distance of the hip joints in leg lengths."""
    limbs: FloatArray
    """(4,) parts of both arms and both legs that are upper arm and thigh."""

    def __post_init__(self) -> None:
        for name in ("rest", "limbs"):
            object.__setattr__(self, name, frozen_array(getattr(self, name)))


@dataclass(frozen=True)
class Change:
    """Change of clips in frame ``first``: the new clip continues from the pose of the body, in ``seconds``, or in the
    time that it needs if that is 0; if it is ``cut`` it plays at once. In a ``planned`` change feet in the air step
    over the ground to where they land; an unplanned one, or one of given seconds, has no time for that.
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
    """The actor's: where other clavicles are longer they turn by less, so that shoulders go as far, and they come no
    nearer to each other than the actor's do; wider hips turn by less. None where it is not known: all turn alike."""
    changes: tuple[Change, ...] = ()
    """Jumps of channels as one clip of a row takes over from another: each stands by itself, led on from the last."""

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
        return len(self.channels)

    @cached_property
    def times(self) -> FloatArray:
        """(F,) seconds."""
        return frozen_array(np.arange(self.frame_count) / self.frame_rate)

    @cached_property
    def across(self) -> FloatArray:
        """(F, 2) horizontal leftward axis of the feet in the motion's space: the sum of both, low-passed.

        A pelvis rotates over standing feet; this is its heading if it did not.
        """
        yaw, pelvis = self.channels[:, channel.YAW], self.channels[:, channel.PELVIS : channel.PELVIS + 4]
        feet = self.channels[:, channel.FOOT : channel.FOOT + 8].reshape(-1, 2, 4)
        x, y, _ = rotate(multiply(pelvis[:, None], feet), np.array([0.0, 1.0, 0.0])).sum(axis=1).T
        level = np.column_stack([np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y])
        return frozen_array(bell_average(level, HEADING_SMOOTHING * self.frame_rate))

    @property
    def parts(self) -> tuple[slice, ...]:
        """Frames of the motion between its changes."""
        ends = [0, *(each.first for each in self.changes), self.frame_count]
        return tuple(slice(*each) for each in pairwise(ends))

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frame_count - 1) / self.frame_rate
