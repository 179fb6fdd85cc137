"""Preview of a motion: stick figures that play in a loop over the 3D image."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget

from studio.viewport.camera import FloatArray
from studio.viewport.overlay import Overlay

PREVIEW_MILLISECONDS = 33
"""Milliseconds per image."""
PREVIEW_PICTURES, PREVIEW_HELD_PICTURES = 24, 18
"""Number of images from start to end, and for which the end is held."""


class Preview:
    """Loop of stick figures painted over ``widget`` without rendering the stage again."""

    def __init__(self, widget: QWidget) -> None:
        self._widget, self._tick = widget, 0
        self._points: FloatArray | None = None
        self._pairs: NDArray[np.intp] | None = None
        self._timer = QTimer(widget, interval=PREVIEW_MILLISECONDS)
        self._timer.timeout.connect(self._go_on)

    @property
    def points(self) -> FloatArray | None:
        """(N, 3) currently painted points; None without a preview."""
        if self._points is None:
            return None
        share = min(self._tick / PREVIEW_PICTURES, 1.0)
        return np.asarray(self._points[round(share * (len(self._points) - 1))])

    def show(self, points: FloatArray | None, pairs: NDArray[np.intp] | None = None) -> None:
        """Play points (T, N, 3), joined by ``pairs`` (B, 2), from the start; None ends the preview."""
        self._points, self._pairs, self._tick = points, pairs, 0
        if points is None:
            self._timer.stop()
        else:
            self._timer.start()
        self._widget.update()

    def paint(self, overlay: Overlay) -> None:
        """Paint the preview, if there is one."""
        if self.points is not None and self._pairs is not None:
            overlay.ghost(self.points, self._pairs)

    def _go_on(self) -> None:
        self._tick = (self._tick + 1) % (PREVIEW_PICTURES + PREVIEW_HELD_PICTURES)
        self._widget.update()
