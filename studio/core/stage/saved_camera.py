"""Cameras of the stage: the placement of a camera relative to its target, and saved cameras with names."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Vector, finite_vector
from studio.core.plausible import PLACE_RANGE, TURN_RANGE, Range

FloatArray = NDArray[np.float64]

VIEW_ANGLE = math.radians(30.0)
"""Vertical angle of view of every camera."""
CAMERA_ASPECT, CAMERA_NEAR_METRES, CAMERA_FAR_METRES = 16 / 9, 0.02, 1000.0
"""Aspect ratio (width by height), near plane and far plane in metres of cameras in exported files."""
CAMERA_AZIMUTH, CAMERA_ELEVATION = math.radians(-52.0), math.radians(13.0)
"""Azimuth and elevation in radians of a new camera."""
CAMERA_DISTANCE_RANGE = Range("The distance of a camera", 1e5, least=1e-3)
CAMERA_SLOTS = (1, 2, 3, 4)
"""Numbers of the keys that recall a saved camera."""


@dataclass(frozen=True)
class CameraPlacement:
    """Camera that looks at ``target`` (stage, metres) from ``distance`` metres, at ``azimuth`` and ``elevation`` in
    radians.

    ``parallel`` is True for a parallel projection.
    """

    target: tuple[float, float, float] = (0.0, 0.0, 0.9)
    distance: float = 6.0
    azimuth: float = CAMERA_AZIMUTH
    elevation: float = CAMERA_ELEVATION
    parallel: bool = False

    @cached_property
    def axes(self) -> FloatArray:
        """Axes of the camera as rows (3, 3) in stage space: right, up, and towards the viewer."""
        ca, sa = math.cos(self.azimuth), math.sin(self.azimuth)
        ce, se = math.cos(self.elevation), math.sin(self.elevation)
        return np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])

    @cached_property
    def eye(self) -> FloatArray:
        """Position (3,) of the camera in stage space."""
        eye: FloatArray = np.asarray(self.target) + self.distance * self.axes[2]
        return eye

    @property
    def half_height(self) -> float:
        """Half of the height in metres that the picture shows at the distance of the target."""
        return self.distance * math.tan(VIEW_ANGLE / 2)


@dataclass(frozen=True)
class SavedCamera:
    """Named camera placement, recalled by the number key ``slot`` if it has one."""

    name: str
    placement: CameraPlacement
    slot: int | None = None

    def __post_init__(self) -> None:
        placement = self.placement
        target: Vector = finite_vector(placement.target, f"The target of the camera '{self.name}'")
        numbers = (placement.distance, placement.azimuth, placement.elevation)
        if not all(map(math.isfinite, numbers)):
            raise ValueError(f"The position of the camera '{self.name}' needs finite numbers.")
        PLACE_RANGE.check(target)
        CAMERA_DISTANCE_RANGE.check(placement.distance)
        TURN_RANGE.check((placement.azimuth, placement.elevation))
        if self.slot is not None and self.slot not in CAMERA_SLOTS:
            raise ValueError(
                f"The camera '{self.name}' has slot {self.slot}. Choose a slot from 1 to {CAMERA_SLOTS[-1]}."
            )
