"""Time axis: the mapping between stage time and pixels, shared by everything that is drawn over time."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

FloatArray = NDArray[np.float64]
MAX_PIXELS_PER_FRAME = 80.0
FAR_PIXELS = 1e6
AXIS_MARGIN = 10
"""Pixels before the start and after the end of the extent if all of it is shown."""


class TimeAxis(QObject):
    """Mapping of stage time to pixels: ``start`` seconds are at pixel ``left``, ``scale`` is in pixels per second, and
    ``width`` in pixels.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.left, self.width = 0.0, 1000.0
        self.begin, self.end = 0.0, 1.0
        self.frame_rate = 30.0
        self.start, self.scale = 0.0, 1000.0
        self._fitted = True

    def x_of_time(self, seconds: float) -> float:
        """Pixel of a stage time in seconds, at most ``FAR_PIXELS`` outside of the view, because painting uses 32
        bits.
        """
        x = self.left + (seconds - self.start) * self.scale
        return min(max(x, self.left - FAR_PIXELS), self.right + FAR_PIXELS)

    def xs_of_times(self, seconds: FloatArray) -> FloatArray:
        """(N,) pixels of stage times (N,) in seconds."""
        return np.clip(self.left + (seconds - self.start) * self.scale, self.left - FAR_PIXELS, self.right + FAR_PIXELS)

    def time_at(self, x: float) -> float:
        """Stage time in seconds at a pixel."""
        return self.start + (x - self.left) / self.scale

    def x_of_frame(self, frame: float) -> float:
        """Pixel of a stage frame."""
        return self.x_of_time(frame / self.frame_rate)

    def frame_at(self, x: float) -> float:
        """Stage frame at a pixel, as a fractional number."""
        return self.time_at(x) * self.frame_rate

    @property
    def right(self) -> float:
        """Pixel of the right end of the axis."""
        return self.left + self.width

    @property
    def pixels_per_frame(self) -> float:
        """Pixels per stage frame."""
        return self.scale / self.frame_rate

    def set_position(self, left: float, width: float) -> None:
        """Use ``width`` pixels from ``left`` on. A view that shows everything still does; any other keeps its start
        time.
        """
        if (left, width) != (self.left, self.width):
            self.left, self.width = left, max(width, 1.0)
            self._settle()

    def set_extent(self, begin: float, end: float, frame_rate: float, keeps_scale: bool = False) -> None:
        """Set the extent to ``begin`` to ``end`` seconds, and the frame rate in Hz.

        A view that shows everything is fitted again; with ``keeps_scale``, as during a trim, only if the extent has
        grown.
        """
        end = max(end, begin + 1.0 / frame_rate)
        if (begin, end, frame_rate) != (self.begin, self.end, self.frame_rate):
            self.begin, self.end, self.frame_rate = begin, end, frame_rate
            self._settle(min(self.scale, self._whole) if keeps_scale else None)

    def fit(self) -> None:
        """Show the whole extent."""
        self._fitted = True
        self._settle()

    def show(self, begin: float, end: float) -> None:
        """Show the time from ``begin`` to ``end`` seconds, with a tenth of it on either side."""
        length = max(end - begin, 2.0 / self.frame_rate)
        wanted = self.width / (1.2 * length)
        self.scale = min(max(wanted, self._whole), MAX_PIXELS_PER_FRAME * self.frame_rate)
        self._fitted = self.scale <= self._whole
        self.start = (begin + end) / 2.0 - self.width / self.scale / 2.0
        self._settle()

    def zoom(self, factor: float, x: float) -> None:
        """Magnify the scale by ``factor`` about the time at pixel ``x``."""
        fixed = self.time_at(x)
        scale = min(max(self.scale * factor, self._whole), MAX_PIXELS_PER_FRAME * self.frame_rate)
        self._fitted = scale <= self._whole
        self.start = fixed - (x - self.left) / scale
        self.scale = scale
        self._settle()

    def scroll(self, pixels: float) -> None:
        """Scroll the view by ``pixels`` to later times."""
        self.start += pixels / self.scale
        self._settle()

    def reveal(self, seconds: float) -> None:
        """Scroll by a page if the stage time ``seconds`` is out of view."""
        if not self.left <= self.x_of_time(seconds) <= self.right:
            self.start = seconds - AXIS_MARGIN / self.scale
            self._settle()

    @property
    def _whole(self) -> float:
        """Scale in pixels per second at which the whole extent is visible."""
        return max(self.width - 2 * AXIS_MARGIN, 1.0) / (self.end - self.begin)

    def _settle(self, scale: float | None = None) -> None:
        """Clamp the view to the extent, at the given scale or at the one that shows everything."""
        if self._fitted:
            self.scale = scale or self._whole
        margin = AXIS_MARGIN / self.scale
        latest = self.end + margin - self.width / self.scale
        self.start = max(min(self.start, latest), self.begin - margin)
        self.changed.emit()
