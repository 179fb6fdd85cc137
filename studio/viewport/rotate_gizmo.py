"""Rotate gizmo: a ring about each axis, a ring about the view axis, and a trackball inside."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.viewport.camera import FloatArray
from studio.viewport.gizmo import GIZMO_AXES, LINE_GRAB_PIXELS, GizmoFrame

ROTATE_RING, SCREEN_RING, TRACKBALL = 0.86, 1.06, "trackball"
"""Radii of the axis rings and of the view ring as fractions of an arrow's length, and the name of the trackball."""
SCREEN_PART = "screen"
EDGE_ON_COSINE = 0.2
"""Cosine of the angle between a ring's axis and the view direction below which the ring is dragged along its
tangent.
"""
RING_SIDES = 72
_ROUND = np.linspace(0.0, 2.0 * np.pi, RING_SIDES + 1)


@dataclass(frozen=True, eq=False)
class RotateGizmo(GizmoFrame):
    """Gizmo that rotates an object about the rows of ``axes``, or with ``heading_only`` only about the stage's Z."""

    heading_only: bool = False

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the rings."""
        return ("z",) if self.heading_only else (*GIZMO_AXES, SCREEN_PART)

    def ring(self, part: str) -> FloatArray:
        """(RING_SIDES + 1, 2) pixels of a closed ring; angles increase with positive rotation about its axis."""
        return self._rings[part]

    @cached_property
    def _rings(self) -> dict[str, FloatArray]:
        """Pixels of all rings by name."""
        rings = {}
        for part in self.parts:
            first, second, _ = self._basis(part)
            radius = self.length * (SCREEN_RING if part == SCREEN_PART else ROTATE_RING)
            points = np.outer(np.cos(_ROUND), first) + np.outer(np.sin(_ROUND), second)
            rings[part] = self.camera.project(self.origin + radius * points, self.size)[0]
        return rings

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Minimum and maximum pixel (2,) of the rings."""
        pixels = np.vstack([self.ring(part) for part in self.parts])
        return pixels.min(axis=0) - LINE_GRAB_PIXELS, pixels.max(axis=0) + LINE_GRAB_PIXELS

    def in_front(self, part: str) -> NDArray[np.bool_]:
        """(RING_SIDES,) True for the sides of a ring on the half towards the viewer; all of them if it is seen along
        its axis.
        """
        first, second, axis = self._basis(part)
        if part == SCREEN_PART or self.heading_only or abs(float(axis @ self.sight)) > 0.985:
            return np.ones(RING_SIDES, dtype=np.bool_)
        middles = (_ROUND[:-1] + _ROUND[1:]) / 2
        return np.asarray(np.cos(middles) * (first @ self.sight) + np.sin(middles) * (second @ self.sight) <= 0.0)

    @cached_property
    def radius(self) -> float:
        """Radius in pixels of an axis ring seen along its axis."""
        return ROTATE_RING * self.pixels

    def axis(self, part: str) -> FloatArray:
        """(3,) unit axis of a ring, stage space."""
        return self._basis(part)[2]

    def part_at(self, x: float, y: float) -> str | None:
        """Part at pixel (x, y): front halves of rings, then the view ring, then the trackball. None if there is
        none.
        """
        mouse = np.array([x, y])
        away = {part: self._distance(part, mouse) for part in self.parts}
        nearest = min(away, key=lambda part: away[part])
        if away[nearest] <= LINE_GRAB_PIXELS:
            return nearest
        inside = not self.heading_only and np.hypot(*(mouse - self.centre)) < self.radius
        return TRACKBALL if inside else None

    def bearing(self, part: str, x: float, y: float, grip: tuple[float, float]) -> float:
        """Angle in radians about a ring's axis at pixel (x, y); relative to ``grip`` if the ring is seen edge-on."""
        first, second, axis = self._basis(part)
        if abs(float(axis @ self.sight)) >= EDGE_ON_COSINE:
            away = self.in_plane(axis, x, y) - self.origin
            return float(np.arctan2(away @ second, away @ first))
        sides = self.ring(part)
        front = np.flatnonzero(self.in_front(part))
        nearest = front[np.argmin(np.hypot(*(sides[front] - np.array(grip)).T))]
        tangent = sides[nearest + 1] - sides[nearest]
        tangent = tangent / max(float(np.hypot(*tangent)), 1e-9)
        return float((np.array([x, y]) - np.array(grip)) @ tangent / self.radius)

    def sector(self, part: str, begin: float, angle: float) -> FloatArray:
        """(N, 2) pixels of the sector of a ring from bearing ``begin`` over ``angle`` radians, starting at the
        centre.
        """
        first, second, _ = self._basis(part)
        radius = self.length * (SCREEN_RING if part == SCREEN_PART else ROTATE_RING)
        angles = begin + np.linspace(0.0, angle, 2 + int(abs(angle) * RING_SIDES / (2.0 * np.pi)))
        points = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
        return self.camera.project(self.origin + radius * np.concatenate([np.zeros((1, 3)), points]), self.size)[0]

    def _basis(self, part: str) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Two axes in the plane of a ring, and its normal, stage space."""
        if part == SCREEN_PART:
            right, up, back = self.camera.axes
            return right, up, back
        axis = GIZMO_AXES.index(part)
        axes = np.eye(3) if self.heading_only else self.axes
        return axes[(axis + 1) % 3], axes[(axis + 2) % 3], axes[axis]

    def _distance(self, part: str, mouse: FloatArray) -> float:
        corners, front = self.ring(part), self.in_front(part)
        begin, along = corners[:-1][front], np.diff(corners, axis=0)[front]
        away = mouse - begin
        parts = np.einsum("nk,nk->n", away, along) / np.maximum(np.einsum("nk,nk->n", along, along), 1e-9)
        distances = np.linalg.norm(away - np.clip(parts, 0.0, 1.0)[:, None] * along, axis=1)
        return float(distances.min(initial=np.inf))


def rotation_about(axis: FloatArray, angle: float) -> FloatArray:
    """Rotation matrix (3, 3) about a unit ``axis`` (3,) by ``angle`` radians (Rodrigues)."""
    x, y, z = axis.tolist()
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)
