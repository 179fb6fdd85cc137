"""The gizmo: three arrows, three small planes, a ball and a ring, hit and dragged by numpy alone."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from studio.viewport.camera import FloatArray, OrbitCamera

ARROW_PIXELS, SHORTEST_ARROW = 90.0, 44.0
PLANE_NEAR, PLANE_FAR = 0.30, 0.48
"""A plane handle's square, in parts of an arrow."""
LINE_REACH, BALL_REACH = 8.0, 10.0
GIZMO_AXES = ("x", "y", "z")
PLANES = {"yz": 0, "zx": 1, "xy": 2}
"""Each plane handle and the axis it stands across."""
BALL_HANDLE, RING_HANDLE = "view", "ring"
GIZMO_RING_RADIUS = 0.8
"""Of the ring by which a thing is turned about Z, in parts of an arrow."""
_ROUND = np.linspace(0.0, 2.0 * np.pi, 49)


def arrow_pixels(body_height: float) -> float:
    """An arrow beside a body that is so many pixels high: never longer than a third of it, if it can be gripped."""
    return min(max(body_height / 3, SHORTEST_ARROW), ARROW_PIXELS)


def moved_axes(part: str) -> list[bool]:
    """Which of the gizmo's axes a drag of ``part`` may change."""
    return [True] * 3 if part == BALL_HANDLE else [axis in part for axis in GIZMO_AXES]


@dataclass(frozen=True, eq=False)
class Gizmo:
    """A gizmo at ``origin`` (stage) along the rows of ``axes`` (3, 3), as ``camera`` sees it."""

    origin: FloatArray
    axes: FloatArray
    camera: OrbitCamera
    size: tuple[float, float]
    pixels: float = ARROW_PIXELS
    """Of an arrow."""
    flat: bool = False
    """Whether what it moves stays on the ground."""
    turns: bool = False
    """Whether it can be turned about Z."""

    @cached_property
    def length(self) -> float:
        """Metres of an arrow: the same on the screen at any distance."""
        depth = float(self.camera.project(self.origin, self.size)[1][0])
        return self.pixels * self.camera.metres_per_pixel(self.size[1], depth)

    @property
    def in_sight(self) -> bool:
        """Whether the origin is before the camera."""
        return bool(self.camera.project(self.origin, self.size)[1][0] > 0.02)

    @cached_property
    def centre(self) -> FloatArray:
        """(2,) pixel of the origin."""
        return self._pixels(np.zeros((1, 3)))[0]

    @cached_property
    def tips(self) -> FloatArray:
        """(3, 2) pixels of the arrows' tips."""
        return self._pixels(np.eye(3))

    @cached_property
    def squares(self) -> dict[str, FloatArray]:
        """(4, 2) pixels of each plane handle's corners."""
        corners = {}
        for name, across in PLANES.items():
            first, second = np.delete(np.eye(3), across, axis=0)
            steps = (
                (PLANE_NEAR, PLANE_NEAR),
                (PLANE_FAR, PLANE_NEAR),
                (PLANE_FAR, PLANE_FAR),
                (PLANE_NEAR, PLANE_FAR),
            )
            corners[name] = self._pixels(np.array([a * first + b * second for a, b in steps]))
        return corners

    @cached_property
    def ring(self) -> FloatArray:
        """(49, 2) pixels of the ring, closed."""
        return self._pixels(
            GIZMO_RING_RADIUS * np.column_stack([np.cos(_ROUND), np.sin(_ROUND), np.zeros(len(_ROUND))])
        )

    def usable(self, part: str) -> bool:
        """An arrow seen end on, or a plane or the ring seen edge on, cannot be dragged and is not shown."""
        if part == BALL_HANDLE:
            return True
        if part == RING_HANDLE:
            return self.turns and self.usable("xy")
        if self.flat and "z" in part:
            return False
        sight = self.origin - self.camera.eye if not self.camera.parallel else -self.camera.axes[2]
        sight = sight / max(float(np.linalg.norm(sight)), 1e-9)
        facing = np.abs(self.axes @ sight)
        return bool(facing[GIZMO_AXES.index(part)] < 0.985 if part in GIZMO_AXES else facing[PLANES[part]] > 0.12)

    def part_at(self, x: float, y: float) -> str | None:
        """The part under pixel (x, y): ball before planes before arrows before the ring."""
        mouse = np.array([x, y])
        if np.hypot(*(mouse - self.centre)) <= BALL_REACH:
            return BALL_HANDLE
        for name, corners in self.squares.items():
            if self.usable(name) and _inside(mouse, corners):
                return name
        away = [
            _distance(mouse, self.centre, tip) if self.usable(axis) else np.inf
            for axis, tip in zip(GIZMO_AXES, self.tips, strict=True)
        ]
        nearest = int(np.argmin(away))
        if away[nearest] <= LINE_REACH:
            return GIZMO_AXES[nearest]
        on_ring = (
            self.usable(RING_HANDLE) and min(_distance(mouse, *side) for side in pairwise(self.ring)) <= LINE_REACH
        )
        return RING_HANDLE if on_ring else None

    def grip(self, part: str, x: float, y: float) -> FloatArray:
        """(3,) stage point that pixel (x, y) holds when ``part`` is dragged: on its axis or in its plane."""
        begin, sight = self.camera.ray(x, y, self.size)
        away = self.origin - begin
        if part in GIZMO_AXES:
            axis = self.axes[GIZMO_AXES.index(part)]
            lean = float(axis @ sight)
            along = (lean * (sight @ away) - axis @ away) / max(1.0 - lean * lean, 1e-6)
            return self.origin + along * axis
        level = part == RING_HANDLE or (part == BALL_HANDLE and self.flat)
        normal = self.axes[2] if level else self.camera.axes[2] if part == BALL_HANDLE else self.axes[PLANES[part]]
        slant = float(normal @ sight)
        slant = np.copysign(max(abs(slant), 1e-3), slant)
        return begin + (float(normal @ away) / slant) * sight

    def _pixels(self, steps: FloatArray) -> FloatArray:
        return self.camera.project(self.origin + self.length * steps @ self.axes, self.size)[0]


def _distance(point: FloatArray, begin: FloatArray, end: FloatArray) -> float:
    along = end - begin
    share = np.clip((point - begin) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
    return float(np.hypot(*(point - begin - share * along)))


def _inside(point: FloatArray, corners: FloatArray) -> bool:
    edges = np.roll(corners, -1, axis=0) - corners
    away = point - corners
    turn = edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0]
    return bool((turn >= 0).all() or (turn <= 0).all())
