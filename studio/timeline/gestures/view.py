"""Drags that only change where one looks: the playhead and the stretch of time that is shown."""

from collections.abc import Callable

from PySide6.QtCore import QPointF

from studio.document.playhead import Playhead
from studio.timeline.axis import TimeAxis
from studio.timeline.gestures.gesture import TimelineGesture


class Scrub(TimelineGesture):
    """The playhead goes to the frame under the mouse, at once; Esc brings it back."""

    def __init__(self, playhead: Playhead, axis: TimeAxis) -> None:
        self.playhead, self.axis = playhead, axis
        self._before = playhead.time
        playhead.pause()

    def update(self, position: QPointF, free: bool) -> None:
        """Whole frames within what there is; between frames when ``free``."""
        time = min(max(self.axis.time_at(position.x()), self.axis.begin), self.axis.end)
        if free:
            self.playhead.set_time(time)
        else:
            self.playhead.set_frame(round(time * self.axis.frame_rate))

    def cancel(self) -> None:
        """Back to where it was."""
        self.playhead.set_time(self._before)


class Pan(TimelineGesture):
    """The rows follow the mouse, sideways and upright."""

    def __init__(self, axis: TimeAxis, scroll: Callable[[float], None], press: QPointF) -> None:
        """``scroll`` moves what is shown by so many pixels, downwards."""
        self.axis, self._scroll, self._last = axis, scroll, press

    def update(self, position: QPointF, free: bool) -> None:
        """Scroll by the pixels that the mouse moved since the last event."""
        step = self._last - position
        self._last = position
        self.axis.scroll(step.x())
        self._scroll(step.y())
