"""Orbit camera as an immutable value, and projection between stage and image."""

import math
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.stage.saved_camera import CAMERA_AZIMUTH, CAMERA_ELEVATION, VIEW_ANGLE, CameraPlacement

FloatArray = NDArray[np.float64]

MOST_CAMERA_PITCH = math.pi / 2
LEAST_CAMERA_DISTANCE, MOST_CAMERA_DISTANCE = 0.15, 150.0
NAMED_VIEWS: dict[str, tuple[float, float]] = {
    "perspective": (CAMERA_AZIMUTH, CAMERA_ELEVATION),
    "front": (0.0, 0.0),
    "side": (-math.pi / 2, 0.0),
    "top": (-math.pi / 2, math.pi / 2),
}
"""Azimuth and elevation in radians of the named views; performers face X, which points right in the side view."""


@dataclass(frozen=True)
class OrbitCamera(CameraPlacement):
    """Camera placement that orbits a target, and projects between stage and image."""

    @classmethod
    def at(cls, placement: CameraPlacement) -> Self:
        """Camera at a placement."""
        return cls(*(getattr(placement, each.name) for each in fields(CameraPlacement)))

    @property
    def placement(self) -> CameraPlacement:
        """Placement of the camera, to be saved."""
        return CameraPlacement(*(getattr(self, each.name) for each in fields(CameraPlacement)))

    def orbited(self, azimuth: float, elevation: float) -> Self:
        """Camera orbited about its target by angles in radians, limited at top and bottom."""
        steep = min(max(self.elevation + elevation, -0.12), MOST_CAMERA_PITCH)
        return replace(self, azimuth=self.azimuth + azimuth, elevation=steep)

    def panned(self, right: float, up: float) -> Self:
        """Camera moved right and up by metres, measured at the depth of its target."""
        moved = np.asarray(self.target) + right * self.axes[0] + up * self.axes[1]
        return replace(self, target=tuple(moved.tolist()))

    def zoomed(self, factor: float) -> Self:
        """Camera at 1 / ``factor`` of its distance from the target."""
        return replace(self, distance=min(max(self.distance / factor, LEAST_CAMERA_DISTANCE), MOST_CAMERA_DISTANCE))

    def zoomed_at(self, factor: float, x: float, y: float, size: tuple[float, float]) -> Self:
        """Camera at 1 / ``factor`` of its distance from the target, keeping the point at pixel (x, y) and the target's
        depth in place.
        """
        nearer = self.zoomed(factor)
        gain = self.metres_per_pixel(size[1]) - nearer.metres_per_pixel(size[1])
        return nearer.panned((x - size[0] / 2) * gain, (size[1] / 2 - y) * gain)

    def metres_per_pixel(self, height: float, depth: float | None = None) -> float:
        """Size of a pixel in metres at ``depth`` metres in front of the eye, by default at the target, in an image
        ``height`` pixels high.
        """
        reach = self.distance if depth is None or self.parallel else max(depth, 1e-6)
        return 2.0 * reach * math.tan(VIEW_ANGLE / 2) / height

    def project(self, points: ArrayLike, size: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """Pixels (N, 2), y down, and depths (N,) in metres of stage ``points`` (N, 3).

        ``size`` is width and height of the image; a point behind the eye has a depth of zero or less.
        """
        local = (np.asarray(points, dtype=np.float64).reshape(-1, 3) - self.eye) @ self.axes.T
        depth = -local[:, 2]
        reach = np.full_like(depth, self.distance) if self.parallel else np.maximum(depth, 1e-6)
        scale = size[1] / (2.0 * math.tan(VIEW_ANGLE / 2) * reach)
        return np.stack([size[0] / 2 + local[:, 0] * scale, size[1] / 2 - local[:, 1] * scale], axis=1), depth

    def height(self, points: ArrayLike, size: tuple[float, float]) -> float:
        """Height in pixels of stage ``points`` (N, 3) in an image of ``size``."""
        return float(np.ptp(self.project(points, size)[0][:, 1]))

    def ray(self, x: float, y: float, size: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """Origin and unit direction, in stage space, of the view ray through pixel (x, y)."""
        step = 2.0 * math.tan(VIEW_ANGLE / 2) / size[1]
        right, up = (x - size[0] / 2) * step, (size[1] / 2 - y) * step
        if self.parallel:
            return self.eye + self.distance * (right * self.axes[0] + up * self.axes[1]), -self.axes[2]
        sight = right * self.axes[0] + up * self.axes[1] - self.axes[2]
        return self.eye, sight / np.linalg.norm(sight)

    def framing(self, points: ArrayLike, size: tuple[float, float], margin: float = 1.25) -> Self:
        """Camera with the same direction, moved so that all stage ``points`` (N, 3) are in view with a margin."""
        places = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        local = places @ self.axes.T
        tangent = math.tan(VIEW_ANGLE / 2) / margin
        spread = np.array([tangent * size[0] / max(size[1], 1.0), tangent])
        # Each side's sight line passes outside every point: the eye's place follows from the extremes.
        towards = 0.0 if self.parallel else local[:, 2:]
        high, low = (
            (local[:, :2] + spread * towards).max(axis=0),
            (local[:, :2] - spread * towards).min(axis=0),
        )
        centre = (high + low) / 2
        eye_depth = float(((high - low) / (2 * spread)).max())
        middle = float((local[:, 2].max() + local[:, 2].min()) / 2)
        nearest = float(local[:, 2].max())  # points in one line of sight have no spread to step back for
        distance = eye_depth if self.parallel else max(eye_depth, nearest + LEAST_CAMERA_DISTANCE) - middle
        target = np.array([centre[0], centre[1], middle]) @ self.axes
        return replace(
            self,
            target=tuple(target.tolist()),
            distance=min(max(distance, 4 * LEAST_CAMERA_DISTANCE), MOST_CAMERA_DISTANCE),
        )

    def towards(self, other: "OrbitCamera", share: float) -> "OrbitCamera":
        """Camera interpolated to ``other`` by ``share`` (0 to 1), rotating along the shorter arc."""
        turn = (other.azimuth - self.azimuth + math.pi) % (2 * math.pi) - math.pi
        target = np.asarray(self.target) * (1 - share) + np.asarray(other.target) * share
        return replace(
            other,
            target=tuple(target.tolist()),
            distance=self.distance ** (1 - share) * other.distance**share,
            azimuth=self.azimuth + share * turn,
            elevation=self.elevation + share * (other.elevation - self.elevation),
        )
