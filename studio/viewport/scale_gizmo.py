"""Scale gizmo: a line with a box along each axis, and a box in the middle for all axes."""

from dataclasses import dataclass

import numpy as np

from studio.viewport.gizmo import BALL_GRAB_PIXELS, BALL_HANDLE, GIZMO_AXES, GizmoFrame, nearest_axis

SCALE_DRAG_PIXELS = 120.0
"""Pixels to the right over which dragging the middle box scales an object by 2.7."""
MIN_SCALE_FACTOR = 0.01


@dataclass(frozen=True, eq=False)
class ScaleGizmo(GizmoFrame):
    """Gizmo that resizes an object along the axes in which it has a size."""

    scales: tuple[bool, bool, bool] = (True, True, True)

    def usable(self, part: str) -> bool:
        """False for an axis without a size or seen end-on."""
        if part == BALL_HANDLE:
            return True
        axis = GIZMO_AXES.index(part)
        return bool(self.scales[axis] and self.facing[axis] < 0.985)

    def part_at(self, x: float, y: float) -> str | None:
        """Part at pixel (x, y), the middle before the axes; None if there is none."""
        mouse = np.array([x, y])
        if np.hypot(*(mouse - self.centre)) <= BALL_GRAB_PIXELS:
            return BALL_HANDLE
        return nearest_axis(self, mouse, [self.usable(axis) for axis in GIZMO_AXES])

    def factor(self, part: str, grip: tuple[float, float], x: float, y: float) -> float:
        """Scale factor if ``part``, grabbed at the pixel ``grip``, is dragged to pixel (x, y)."""
        if part == BALL_HANDLE:
            return float(np.exp((x - grip[0] - (y - grip[1])) / SCALE_DRAG_PIXELS))
        axis = GIZMO_AXES.index(part)
        begin, end = (float((self.along_axis(axis, *at) - self.origin) @ self.axes[axis]) for at in (grip, (x, y)))
        return max(end / begin if abs(begin) > 1e-6 else 1.0, MIN_SCALE_FACTOR)
