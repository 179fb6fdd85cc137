"""Mouse drags in the 3D view: each starts when it is created, and is finished or cancelled."""

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from studio.document.document import Document
from studio.document.length_units import length_text
from studio.engine.live_interface import Live
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.gizmo import GIZMO_AXES, Gizmo, moved_axes
from studio.viewport.movables import Movable
from studio.viewport.rotate_gizmo import TRACKBALL, RotateGizmo, rotation_about
from studio.viewport.scale_gizmo import ScaleGizmo
from studio.viewport.selected_movable import AnyGizmo
from studio.viewport.snap_steps import DEFAULT_STEPS, SnapSteps

FINE_DRAG = 0.2
ORBIT_PER_PIXEL = math.radians(0.4)
ZOOM_PER_PIXEL = 1.006


class ViewportGesture(Protocol):
    """Drag from the press to the release of a button."""

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Handle the mouse at pixel (x, y); ``fine`` slows the drag, ``snap`` uses steps."""

    def finish(self) -> None:
        """Finish the drag after the button is released."""

    def cancel(self) -> None:
        """Restore the state before the drag, after Esc."""


class CameraDrag:
    """Drag that orbits, pans or zooms the camera; ``show`` is called with every new camera."""

    def __init__(
        self,
        kind: str,
        camera: OrbitCamera,
        height: float,
        x: float,
        y: float,
        show: Callable[[OrbitCamera], None],
    ) -> None:
        self._kind, self._begin, self._height, self._show = kind, camera, height, show
        self._x, self._y = x, y

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Move the camera by the displacement since the press."""
        right, down = x - self._x, y - self._y
        if self._kind == "orbit":
            self._show(self._begin.orbited(-right * ORBIT_PER_PIXEL, down * ORBIT_PER_PIXEL))
        elif self._kind == "pan":
            scale = self._begin.metres_per_pixel(self._height)
            self._show(self._begin.panned(-right * scale, down * scale))
        else:
            self._show(self._begin.zoomed(ZOOM_PER_PIXEL ** (right - down)))

    def finish(self) -> None:
        """Keep the camera."""

    def cancel(self) -> None:
        """Restore the camera."""
        self._show(self._begin)


class EditDrag:
    """Base of drags of a gizmo's part, which edit an object as one undo step."""

    def __init__(self, document: Document, live: Live, movable: Movable, part: str, steps: SnapSteps) -> None:
        self._live, self._movable, self.part, self._steps = live, movable, part, steps
        self._number = document.new_gesture()
        live.interactive = True

    words = ""
    """Text beside the gizmo: the amount of the drag."""

    def finish(self) -> None:
        """Keep the edit."""
        self._movable.finish(self._number)
        self._live.interactive = False

    def cancel(self) -> None:
        """Restore the object, and drop the undo step."""
        self._movable.restore(self._number)
        self._live.interactive = False


class MoveDrag(EditDrag):
    """Drag that moves an object along axes of a gizmo; snapping counts from ``zero`` (3,), stage space."""

    def __init__(
        self, document: Document, live: Live, movable: Movable, gizmo: Gizmo, part: str, x: float, y: float,
        steps: SnapSteps = DEFAULT_STEPS, zero: FloatArray | None = None,
    ) -> None:  # fmt: skip
        super().__init__(document, live, movable, part, steps)
        self._gizmo = gizmo
        self._begin = movable.placement.to_stage(movable.place)
        self._zero = self._begin if zero is None else zero
        self._moved = np.zeros(3)
        self._grip = gizmo.grip(part, x, y)

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Follow the mouse along the axes of the part: at a fifth of the distance if ``fine``, in steps if ``snap``."""
        axes, free = self._gizmo.axes, np.array(moved_axes(self.part))
        grip = self._gizmo.grip(self.part, x, y)
        self._moved += np.where(free, axes @ (grip - self._grip) * (FINE_DRAG if fine else 1.0), 0.0)
        self._grip = grip
        begin = axes @ (self._begin - self._zero)
        place, step = begin + self._moved, self._steps.metres
        if snap:
            place = np.where(free, np.round(place / step) * step, place)
        changes = zip(GIZMO_AXES, (place - begin).tolist(), free, strict=True)
        self.words = "   ".join(
            f"{axis.upper()} {length_text(change, 'cm', 1, '+')}" for axis, change, is_free in changes if is_free
        )
        stage = self._zero + axes.T @ place
        self._movable.move(self._movable.placement.to_motion(stage), self._number)


class RotateDrag(EditDrag):
    """Drag that rotates an object by a ring, or freely by the trackball."""

    def __init__(
        self, document: Document, live: Live, movable: Movable, gizmo: RotateGizmo, part: str, x: float, y: float,
        steps: SnapSteps = DEFAULT_STEPS,
    ) -> None:  # fmt: skip
        super().__init__(document, live, movable, part, steps)
        self.gizmo, self._grip = gizmo, (x, y)
        self.begin = 0.0 if part == TRACKBALL else gizmo.bearing(part, x, y, self._grip)
        self._seen, self._dragged = self.begin, 0.0
        self._rolled, self._mouse = np.zeros(2), np.array([x, y])
        self.angle = 0.0
        """Radians by which the thing is rotated."""

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Follow the mouse around the centre: at a fifth of the angle if ``fine``, in steps if ``snap``."""
        pace = FINE_DRAG if fine else 1.0
        if self.part == TRACKBALL:
            self._roll(x, y, pace, snap)
            return
        seen = self.gizmo.bearing(self.part, x, y, self._grip)
        self._dragged += math.remainder(seen - self._seen, 2.0 * math.pi) * pace
        self._seen = seen
        self.angle = _stepped(self._dragged, self._steps.radians) if snap else self._dragged
        self.words = f"{self.part.capitalize()} {math.degrees(self.angle):+.1f}°"
        self._movable.rotate(rotation_about(self.gizmo.axis(self.part), self.angle), self._number)

    def _roll(self, x: float, y: float, pace: float, snap: bool) -> None:
        """Rotate about the screen's axes, like a trackball."""
        self._rolled += (np.array([x, y]) - self._mouse) / self.gizmo.radius * pace
        self._mouse = np.array([x, y])
        across, down = (_stepped(each, self._steps.radians) if snap else each for each in self._rolled.tolist())
        vector = across * self.gizmo.camera.axes[1] + down * self.gizmo.camera.axes[0]
        self.angle = float(np.linalg.norm(vector))
        self.words = f"{math.degrees(self.angle):.1f}°"
        axis = vector / self.angle if self.angle > 0.0 else self.gizmo.camera.axes[1]
        self._movable.rotate(rotation_about(axis, self.angle), self._number)


class ScaleDrag(EditDrag):
    """Drag that resizes an object along one of its axes, or all of them."""

    def __init__(
        self, document: Document, live: Live, movable: Movable, gizmo: ScaleGizmo, part: str, x: float, y: float,
        steps: SnapSteps = DEFAULT_STEPS,
    ) -> None:  # fmt: skip
        super().__init__(document, live, movable, part, steps)
        self._gizmo, self._grip, self._mouse = gizmo, (x, y), np.array([x, y])

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Follow the mouse: at a fifth of the distance if ``fine``, in steps of the factor if ``snap``."""
        factor = self._gizmo.factor(self.part, self._grip, x, y)
        if fine:
            factor = 1.0 + FINE_DRAG * (factor - 1.0)
        if snap:
            factor = max(_stepped(factor, self._steps.factor), self._steps.factor)
        self.words = f"× {factor:.2f}"
        self._movable.scale(np.where(moved_axes(self.part), factor, 1.0), self._number)


def nudge(document: Document, movable: Movable, gizmo: AnyGizmo, axis: str, sign: float, steps: SnapSteps) -> None:
    """Move, rotate or resize an object by one snapping step along or about an ``axis`` of its gizmo, as one undo
    step.
    """
    number, place = document.new_gesture(), GIZMO_AXES.index(axis)
    if isinstance(gizmo, RotateGizmo):
        if axis in gizmo.parts:
            movable.rotate(rotation_about(gizmo.axis(axis), sign * steps.radians), number)
    elif isinstance(gizmo, ScaleGizmo):
        if gizmo.scales[place]:
            movable.scale(1.0 + sign * steps.factor * np.eye(3)[place], number)
    elif not (gizmo.flat and axis == "z"):
        stage = movable.placement.to_stage(movable.place) + sign * steps.metres * gizmo.axes[place]
        movable.move(movable.placement.to_motion(stage), number)
    movable.finish(number)


def _stepped(value: float, step: float) -> float:
    return round(value / step) * step
