"""The morphology-independent motion: numbers without any body's measures."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.frozen_array import unwritten
from studio.core.kernels import layout
from studio.core.rotations import multiply, rotate
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]

HEADING_SMOOTHING = 0.25
"""Seconds, standard deviation of the low-pass on where pelvis and feet look."""


@dataclass(frozen=True, eq=False)
class Girdle:
    """The actor's shoulders, hips and limbs: a motion holds how clavicles, pelvis and limbs turn, and what that does
    depends on how they lie at rest, how broad they are, and how bones share their limb's length.
    """

    length: float
    """Reach of the clavicles in parts of half the breadth of the shoulders, as ``realize.girdles`` has it."""
    rest: FloatArray
    """(2, 3) direction of each clavicle at rest, thorax axes."""
    hips: float
    """Distance of the hip joints in leg lengths."""
    limbs: FloatArray
    """(4,) parts of both arms and both legs that are upper arm and thigh."""

    def __post_init__(self) -> None:
        for name in ("rest", "limbs"):
            object.__setattr__(self, name, unwritten(getattr(self, name)))


@dataclass(frozen=True)
class Change:
    """Another clip takes over in frame ``first``: it goes on from where the body is then, in ``seconds``, 0 in as many
    as it needs; where it is ``cut`` it is where it is at once. Where it is ``planned``, feet in the air step over the
    ground to where they land; one that comes by chance, or in seconds that are given, has no time for that.
    """

    first: int
    seconds: float = 0.0
    cut: bool = False
    planned: bool = False


@dataclass(frozen=True, eq=False)
class NormalizedMotion:
    """A motion free of any body's measures: angles, and lengths as parts of the body's own.

    ``channels`` (F, 89 + 4 K) are laid out in ``kernels.layout``; ``spine_places`` (K,) says where along the trunk
    each of the K spine segments begins, 0 the pelvis to 1 the thorax. The motion's space has its origin on the
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
            object.__setattr__(self, name, unwritten(getattr(self, name)))
        if self.channels.ndim != 2 or self.channels.shape[1] != layout.SPINE + 4 * (len(self.spine_places) - 1):
            raise ValueError(
                f"Channels of shape {self.channels.shape} do not fit {len(self.spine_places)} spine segments."
            )

    @property
    def frame_count(self) -> int:
        return len(self.channels)

    @cached_property
    def times(self) -> FloatArray:
        """(F,) seconds."""
        return unwritten(np.arange(self.frame_count) / self.frame_rate)

    @cached_property
    def across(self) -> FloatArray:
        """(F, 2) how the feet lie across, to the left, in the motion's space: what of both is level, added, low-passed.

        A pelvis turns over feet that stand; this says where it would be if it did not.
        """
        yaw, pelvis = self.channels[:, layout.YAW], self.channels[:, layout.PELVIS : layout.PELVIS + 4]
        feet = self.channels[:, layout.FOOT : layout.FOOT + 8].reshape(-1, 2, 4)
        x, y, _ = rotate(multiply(pelvis[:, None], feet), np.array([0.0, 1.0, 0.0])).sum(axis=1).T
        level = np.column_stack([np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y])
        return unwritten(bell_average(level, HEADING_SMOOTHING * self.frame_rate))

    @property
    def parts(self) -> tuple[slice, ...]:
        """Its frames from change to change."""
        ends = [0, *(each.first for each in self.changes), self.frame_count]
        return tuple(slice(*each) for each in pairwise(ends))

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frame_count - 1) / self.frame_rate
