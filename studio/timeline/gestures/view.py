"""Drags that only change the view: the playhead and the visible time range."""

from collections.abc import Callable

from PySide6.QtCore import QPointF

from studio.document.playhead import Playhead
from studio.timeline.axis import TimeAxis
from studio.timeline.gestures.gesture import TimelineGesture


class Scrub(TimelineGesture):
    """Drag of the playhead to the frame under the mouse; Esc restores it."""

    def __init__(self, playhead: Playhead, axis: TimeAxis) -> None:
        self.playhead, self.axis = playhead, axis
        self._before = playhead.time
        playhead.pause()

    def update(self, position: QPointF, free: bool) -> None:
        """Move the playhead to a whole frame within the extent, or between frames if ``free``."""
        time = min(max(self.axis.time_at(position.x()), self.axis.begin), self.axis.end)
        if free:
            self.playhead.set_time(time)
        else:
            self.playhead.set_frame(round(time * self.axis.frame_rate))

    def cancel(self) -> None:
        """Restore the playhead."""
        self.playhead.set_time(self._before)


class Pan(TimelineGesture):
    """Drag that scrolls the tracks in both directions."""

    def __init__(self, axis: TimeAxis, scroll: Callable[[float], None], press: QPointF) -> None:
        """``scroll`` is called with the number of pixels by which the content moves down."""
        self.axis, self._scroll, self._last = axis, scroll, press

    def update(self, position: QPointF, free: bool) -> None:
        """Scroll by the mouse's displacement since the last event."""
        step = self._last - position
        self._last = position
        self.axis.scroll(step.x())
        self._scroll(step.y())
