"""TimeAxis: the mapping between seconds on the stage and pixels, for everything drawn over time."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

FloatArray = NDArray[np.float64]
MAX_PIXELS_PER_FRAME = 80.0
FAR_PIXELS = 1e6
AXIS_MARGIN = 10
"""Pixels before the first and after the last moment when everything is shown."""


class TimeAxis(QObject):
    """Mapping in which ``start`` seconds are at pixel ``left``; ``scale`` pixels a second, over ``width`` pixels."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.left, self.width = 0.0, 1000.0
        self.begin, self.end = 0.0, 1.0
        self.frame_rate = 30.0
        self.start, self.scale = 0.0, 1000.0
        self._fitted = True

    def x_of_time(self, seconds: float) -> float:
        """Pixel of a time, at most ``FAR_PIXELS`` outside the view, because painting uses 32 bits."""
        x = self.left + (seconds - self.start) * self.scale
        return min(max(x, self.left - FAR_PIXELS), self.right + FAR_PIXELS)

    def xs_of_times(self, seconds: FloatArray) -> FloatArray:
        """Horizontal positions (N,) in pixels of the times (N,) in seconds."""
        return np.clip(self.left + (seconds - self.start) * self.scale, self.left - FAR_PIXELS, self.right + FAR_PIXELS)

    def time_at(self, x: float) -> float:
        """Seconds at a pixel."""
        return self.start + (x - self.left) / self.scale

    def x_of_frame(self, frame: float) -> float:
        """Pixel of a frame of the stage."""
        return self.x_of_time(frame / self.frame_rate)

    def frame_at(self, x: float) -> float:
        """Frame of the stage at a pixel, with a fraction."""
        return self.time_at(x) * self.frame_rate

    @property
    def right(self) -> float:
        """Pixel of the axis' end."""
        return self.left + self.width

    @property
    def pixels_per_frame(self) -> float:
        """Pixels from one frame to the next."""
        return self.scale / self.frame_rate

    def set_position(self, left: float, width: float) -> None:
        """Use ``width`` pixels from ``left`` on; a fitted view stays fitted, another one keeps its start."""
        if (left, width) != (self.left, self.width):
            self.left, self.width = left, max(width, 1.0)
            self._settle()

    def set_extent(self, begin: float, end: float, frame_rate: float, keeps_scale: bool = False) -> None:
        """Set the extent from ``begin`` to ``end`` seconds, in frames of ``frame_rate``.

        A fitted view is fitted again; one that ``keeps_scale``, as during a trim, only if the extent has grown.
        """
        end = max(end, begin + 1.0 / frame_rate)
        if (begin, end, frame_rate) != (self.begin, self.end, self.frame_rate):
            self.begin, self.end, self.frame_rate = begin, end, frame_rate
            self._settle(min(self.scale, self._whole) if keeps_scale else None)

    def fit(self) -> None:
        """Show everything."""
        self._fitted = True
        self._settle()

    def show(self, begin: float, end: float) -> None:
        """Show a range of time, with a tenth of it on either side."""
        length = max(end - begin, 2.0 / self.frame_rate)
        wanted = self.width / (1.2 * length)
        self.scale = min(max(wanted, self._whole), MAX_PIXELS_PER_FRAME * self.frame_rate)
        self._fitted = self.scale <= self._whole
        self.start = (begin + end) / 2.0 - self.width / self.scale / 2.0
        self._settle()

    def zoom(self, factor: float, x: float) -> None:
        """Scale by ``factor`` about the time at pixel ``x``."""
        fixed = self.time_at(x)
        scale = min(max(self.scale * factor, self._whole), MAX_PIXELS_PER_FRAME * self.frame_rate)
        self._fitted = scale <= self._whole
        self.start = fixed - (x - self.left) / scale
        self.scale = scale
        self._settle()

    def scroll(self, pixels: float) -> None:
        """Move the view ``pixels`` towards later times."""
        self.start += pixels / self.scale
        self._settle()

    def reveal(self, seconds: float) -> None:
        """Scroll by a page if a time has left the view."""
        if not self.left <= self.x_of_time(seconds) <= self.right:
            self.start = seconds - AXIS_MARGIN / self.scale
            self._settle()

    @property
    def _whole(self) -> float:
        """Scale at which everything fits."""
        return max(self.width - 2 * AXIS_MARGIN, 1.0) / (self.end - self.begin)

    def _settle(self, scale: float | None = None) -> None:
        """Clamp the view to the extent, at the scale that fits it or another one."""
        if self._fitted:
            self.scale = scale or self._whole
        margin = AXIS_MARGIN / self.scale
        latest = self.end + margin - self.width / self.scale
        self.start = max(min(self.start, latest), self.begin - margin)
        self.changed.emit()
