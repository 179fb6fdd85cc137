"""Preview of a motion: sticks that play over the picture in a loop."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget

from studio.viewport.camera import FloatArray
from studio.viewport.overlay import Overlay

PREVIEW_MILLISECONDS = 33
"""Milliseconds a picture."""
PREVIEW_PICTURES, PREVIEW_HELD_PICTURES = 24, 18
"""Seconds of the way there, and those for which the end is held."""


class Preview:
    """Paints over ``widget`` without redrawing the stage."""

    def __init__(self, widget: QWidget) -> None:
        self._widget, self._tick = widget, 0
        self._points: FloatArray | None = None
        self._pairs: NDArray[np.intp] | None = None
        self._timer = QTimer(widget, interval=PREVIEW_MILLISECONDS)
        self._timer.timeout.connect(self._go_on)

    @property
    def points(self) -> FloatArray | None:
        """(N, 3) painted points; None without a preview."""
        if self._points is None:
            return None
        share = min(self._tick / PREVIEW_PICTURES, 1.0)
        return np.asarray(self._points[round(share * (len(self._points) - 1))])

    def show(self, points: FloatArray | None, pairs: NDArray[np.intp] | None = None) -> None:
        """Play (T, N, 3) joined by ``pairs``, from the beginning; None ends it."""
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
