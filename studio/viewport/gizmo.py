"""Move gizmo: three arrows, three small planes and a ball; hit tests and drags use only numpy."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np

from studio.viewport.camera import FloatArray, OrbitCamera

ARROW_PIXELS, MIN_ARROW_PIXELS = 90.0, 44.0
PLANE_NEAR, PLANE_FAR = 0.30, 0.48
"""Near and far edge of a plane handle's square, as fractions of an arrow's length."""
LINE_GRAB_PIXELS, BALL_GRAB_PIXELS = 8.0, 10.0
GIZMO_AXES = ("x", "y", "z")
PLANE_NORMAL_AXES = {"yz": 0, "zx": 1, "xy": 2}
"""Plane handles, each with the axis normal to it."""
BALL_HANDLE = "view"


class Space(StrEnum):
    """Orientation of a gizmo's axes: the stage, the object, its parent, or the screen."""

    WORLD = "world"
    LOCAL = "local"
    PARENT = "parent"
    SCREEN = "screen"


def arrow_pixels(body_height: float) -> float:
    """Length in pixels of an arrow for a body ``body_height`` pixels high: at most a third, but long enough to be
    grabbed.
    """
    return min(max(body_height / 3, MIN_ARROW_PIXELS), ARROW_PIXELS)


def moved_axes(part: str) -> list[bool]:
    """True for each axis (x, y, z) that a drag of ``part`` may change."""
    return [True] * 3 if part == BALL_HANDLE else [axis in part for axis in GIZMO_AXES]


@dataclass(frozen=True, eq=False)
class GizmoFrame:
    """Base of all gizmos: ``origin`` (3,) on the stage, axes as rows of ``axes`` (3, 3), camera, and size of the
    image.
    """

    origin: FloatArray
    axes: FloatArray
    camera: OrbitCamera
    size: tuple[float, float]
    pixels: float = ARROW_PIXELS
    """Length of an arrow in pixels."""

    @cached_property
    def length(self) -> float:
        """Length of an arrow in metres, so that it is constant on the screen."""
        depth = float(self.camera.project(self.origin, self.size)[1][0])
        return self.pixels * self.camera.metres_per_pixel(self.size[1], depth)

    @property
    def in_sight(self) -> bool:
        """True if the origin is in front of the camera."""
        return bool(self.camera.project(self.origin, self.size)[1][0] > 0.02)

    @cached_property
    def centre(self) -> FloatArray:
        """(2,) pixel of the origin."""
        centre: FloatArray = self.pixels_of(np.zeros((1, 3)))[0]
        return centre

    @cached_property
    def tips(self) -> FloatArray:
        """(3, 2) pixels of the ends of the axes."""
        return self.pixels_of(np.eye(3))

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Minimum and maximum pixel (2,) of all visible parts."""
        pixels = np.vstack([self.centre, self.tips])
        return pixels.min(axis=0) - BALL_GRAB_PIXELS, pixels.max(axis=0) + BALL_GRAB_PIXELS

    @cached_property
    def sight(self) -> FloatArray:
        """(3,) unit direction from the eye to the origin, stage space."""
        sight = -self.camera.axes[2] if self.camera.parallel else self.origin - self.camera.eye
        return np.asarray(sight / max(float(np.linalg.norm(sight)), 1e-9))

    @cached_property
    def facing(self) -> FloatArray:
        """(3,) absolute cosines of the angles between the axes and the view direction."""
        return np.abs(self.axes @ self.sight)

    def along_axis(self, axis: int, x: float, y: float) -> FloatArray:
        """(3,) stage point on an axis nearest to the view ray through pixel (x, y)."""
        begin, sight = self.camera.ray(x, y, self.size)
        away, direction = self.origin - begin, self.axes[axis]
        lean = float(direction @ sight)
        along = (lean * (sight @ away) - direction @ away) / max(1.0 - lean * lean, 1e-6)
        return np.asarray(self.origin + along * direction)

    def in_plane(self, normal: FloatArray, x: float, y: float) -> FloatArray:
        """(3,) stage point at pixel (x, y), in the plane with ``normal`` (3,) through the origin."""
        begin, sight = self.camera.ray(x, y, self.size)
        slant = float(normal @ sight)
        slant = np.copysign(max(abs(slant), 1e-3), slant)
        return np.asarray(begin + (float(normal @ (self.origin - begin)) / slant) * sight)

    def pixels_of(self, steps: FloatArray) -> FloatArray:
        """(N, 2) pixels of points at ``steps`` (N, 3) arrow lengths from the origin along the axes."""
        return self.camera.project(self.origin + self.length * steps @ self.axes, self.size)[0]


@dataclass(frozen=True, eq=False)
class Gizmo(GizmoFrame):
    """Move gizmo."""

    flat: bool = False
    """True if the moved object stays on the ground."""

    @cached_property
    def squares(self) -> dict[str, FloatArray]:
        """(4, 2) corner pixels of each plane handle."""
        corners = {}
        for name, across in PLANE_NORMAL_AXES.items():
            first, second = np.delete(np.eye(3), across, axis=0)
            steps = (
                (PLANE_NEAR, PLANE_NEAR),
                (PLANE_FAR, PLANE_NEAR),
                (PLANE_FAR, PLANE_FAR),
                (PLANE_NEAR, PLANE_FAR),
            )
            corners[name] = self.pixels_of(np.array([a * first + b * second for a, b in steps]))
        return corners

    def usable(self, part: str) -> bool:
        """False for an arrow seen end-on or a plane seen edge-on, which is hidden."""
        if part == BALL_HANDLE:
            return True
        if self.flat and "z" in part:
            return False
        if part in GIZMO_AXES:
            return bool(self.facing[GIZMO_AXES.index(part)] < 0.985)
        return bool(self.facing[PLANE_NORMAL_AXES[part]] > 0.12)

    def part_at(self, x: float, y: float) -> str | None:
        """Part at pixel (x, y), ball before planes before arrows; None if there is none."""
        mouse = np.array([x, y])
        if np.hypot(*(mouse - self.centre)) <= BALL_GRAB_PIXELS:
            return BALL_HANDLE
        for name, corners in self.squares.items():
            if self.usable(name) and _inside(mouse, corners):
                return name
        return nearest_axis(self, mouse, [self.usable(axis) for axis in GIZMO_AXES])

    def grip(self, part: str, x: float, y: float) -> FloatArray:
        """(3,) stage point at which ``part`` is grabbed at pixel (x, y): on its axis or in its plane."""
        if part in GIZMO_AXES:
            return self.along_axis(GIZMO_AXES.index(part), x, y)
        level = part == BALL_HANDLE and self.flat
        return self.in_plane(
            self.axes[2]
            if level
            else self.camera.axes[2]
            if part == BALL_HANDLE
            else self.axes[PLANE_NORMAL_AXES[part]],
            x,
            y,
        )


def nearest_axis(frame: GizmoFrame, mouse: FloatArray, usable: list[bool]) -> str | None:
    """Usable axis whose line is at the pixel ``mouse`` (2,); None if there is none."""
    away = [_distance(mouse, frame.centre, tip) if use else np.inf for use, tip in zip(usable, frame.tips, strict=True)]
    nearest = int(np.argmin(away))
    return GIZMO_AXES[nearest] if away[nearest] <= LINE_GRAB_PIXELS else None


def _distance(point: FloatArray, begin: FloatArray, end: FloatArray) -> float:
    """Distance in pixels from ``point`` (2,) to the line segment between two other pixels."""
    along = end - begin
    part = np.clip((point - begin) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
    return float(np.hypot(*(point - begin - part * along)))


def _inside(point: FloatArray, corners: FloatArray) -> bool:
    edges = np.roll(corners, -1, axis=0) - corners
    away = point - corners
    turn = edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0]
    return bool((turn >= 0).all() or (turn <= 0).all())
