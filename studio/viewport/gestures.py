"""Gestures of the mouse: each begins when made, follows the mouse, and is finished or cancelled."""

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from studio.document.document import Document
from studio.engine.live import Live
from studio.viewport.camera import OrbitCamera
from studio.viewport.gizmo import RING_HANDLE, Gizmo, moved_axes
from studio.viewport.movables import Movable

FINE_DRAG = 0.2
SNAP_METRES, SNAP_TURN = 0.01, math.radians(15.0)
ORBIT_PER_PIXEL = math.radians(0.4)
ZOOM_PER_PIXEL = 1.006


class ViewportGesture(Protocol):
    """A drag from press to release."""

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """The mouse is at pixel (x, y)."""

    def finish(self) -> None:
        """The button was let go."""

    def cancel(self) -> None:
        """Esc: everything is as it was before."""


class CameraDrag:
    """Orbits, pans or zooms the camera; ``show`` takes every new camera."""

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
        """Turn or move by the way from the press."""
        right, down = x - self._x, y - self._y
        if self._kind == "orbit":
            self._show(self._begin.orbited(-right * ORBIT_PER_PIXEL, down * ORBIT_PER_PIXEL))
        elif self._kind == "pan":
            scale = self._begin.metres_per_pixel(self._height)
            self._show(self._begin.panned(-right * scale, down * scale))
        else:
            self._show(self._begin.zoomed(ZOOM_PER_PIXEL ** (right - down)))

    def finish(self) -> None:
        """The camera stays where it is."""

    def cancel(self) -> None:
        """The camera goes back."""
        self._show(self._begin)


class TurnDrag:
    """Turns a thing by the gizmo's ring; one undo step, and none at all when cancelled."""

    part = RING_HANDLE

    def __init__(self, document: Document, live: Live, movable: Movable, gizmo: Gizmo, x: float, y: float) -> None:
        self._live, self._movable, self._gizmo = live, movable, gizmo
        self._number = document.new_gesture()
        self._seen, self._angle = self._bearing(x, y), 0.0
        live.interactive = True

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Follow the mouse round the middle: ``fine`` a fifth of the way, ``snap`` to fifteen degrees."""
        seen = self._bearing(x, y)
        self._angle += math.remainder(seen - self._seen, 2.0 * math.pi) * (FINE_DRAG if fine else 1.0)
        self._seen = seen
        self._movable.turn(round(self._angle / SNAP_TURN) * SNAP_TURN if snap else self._angle, self._number)

    def finish(self) -> None:
        """The edit stays."""
        self._live.interactive = False

    def cancel(self) -> None:
        """The thing turns back, and the edit vanishes from the history."""
        self._movable.put_back(self._number)
        self._live.interactive = False

    def _bearing(self, x: float, y: float) -> float:
        right, ahead, _ = self._gizmo.axes @ (self._gizmo.grip(RING_HANDLE, x, y) - self._gizmo.origin)
        return math.atan2(ahead, right)


class GizmoDrag:
    """Moves a thing by a part of the gizmo; one undo step, and none at all when cancelled."""

    def __init__(
        self, document: Document, live: Live, movable: Movable, gizmo: Gizmo, part: str, x: float, y: float
    ) -> None:
        self._live, self._movable, self._gizmo, self.part = live, movable, gizmo, part
        self._number = document.new_gesture()
        self._begin = movable.place
        self._moved = np.zeros(3)
        self._grip = gizmo.grip(part, x, y)
        live.interactive = True

    def update(self, x: float, y: float, fine: bool, snap: bool) -> None:
        """Follow the mouse along the part's axes: ``fine`` a fifth of the way, ``snap`` to centimetres."""
        grip = self._gizmo.grip(self.part, x, y)
        step = self._gizmo.axes @ (grip - self._grip)
        self._grip = grip
        free = np.array(moved_axes(self.part))
        self._moved += np.where(free, step * (FINE_DRAG if fine else 1.0), 0.0)
        place = self._begin + self._moved
        if snap:
            place = np.where(free, np.round(place / SNAP_METRES) * SNAP_METRES, place)
        self._movable.move(place, self._number)

    def finish(self) -> None:
        """The edit stays."""
        self._live.interactive = False

    def cancel(self) -> None:
        """The thing goes back, and the edit vanishes from the history."""
        self._movable.put_back(self._number)
        self._live.interactive = False
