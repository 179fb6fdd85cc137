"""Drags that change only the view: the playhead and the visible range of time."""

from collections.abc import Callable

from PySide6.QtCore import QPointF

from studio.document.playhead import Playhead
from studio.timeline.axis import TimeAxis
from studio.timeline.gestures.gesture import TimelineGesture


class Scrub(TimelineGesture):
    """Drag of the playhead to the frame under the mouse; Esc returns it."""

    def __init__(self, playhead: Playhead, axis: TimeAxis) -> None:
        self.playhead, self.axis = playhead, axis
        self._before = playhead.time
        playhead.pause()

    def update(self, position: QPointF, free: bool) -> None:
        """Move by whole frames within the extent; between frames if ``free``."""
        time = min(max(self.axis.time_at(position.x()), self.axis.begin), self.axis.end)
        if free:
            self.playhead.set_time(time)
        else:
            self.playhead.set_frame(round(time * self.axis.frame_rate))

    def cancel(self) -> None:
        """Return to the former time."""
        self.playhead.set_time(self._before)


class Pan(TimelineGesture):
    """Drag that scrolls the rows in both directions."""

    def __init__(self, axis: TimeAxis, scroll: Callable[[float], None], press: QPointF) -> None:
        """``scroll`` moves the content down by a number of pixels."""
        self.axis, self._scroll, self._last = axis, scroll, press

    def update(self, position: QPointF, free: bool) -> None:
        """Scroll by the mouse's displacement since the last event."""
        step = self._last - position
        self._last = position
        self.axis.scroll(step.x())
        self._scroll(step.y())
