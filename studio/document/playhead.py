"""Playhead: the current stage time, and playback driven by a monotonic clock."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QObject, Qt, QTimer, Signal

from studio.core.stage.playback_run import PlaybackRun

TICK_MILLISECONDS = 8


@dataclass(frozen=True)
class PlayheadState:
    """State of the playhead: time in seconds, frame rate in Hz, and play range in frames."""

    time: float
    frame_rate: float
    first: int
    last: int


INITIAL_PLAYHEAD = PlayheadState(0.0, 60.0, 0, 300)
"""State of the playhead in an empty project."""


class Playhead(QObject):
    """Current time of a project. During playback it is read from a clock, so late frames are skipped."""

    changed = Signal(float)
    playing_changed = Signal(bool)
    range_changed = Signal()

    def __init__(self, parent: QObject | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(parent)
        self._clock = clock
        self._timer: QTimer | None = None
        self._time = 0.0
        self._frame_rate = INITIAL_PLAYHEAD.frame_rate
        self._first, self._last = INITIAL_PLAYHEAD.first, INITIAL_PLAYHEAD.last
        self._speed = 1.0
        self._anchor = (0.0, 0.0)
        self.loop = True

    @property
    def time(self) -> float:
        """Seconds on the stage."""
        return self._time

    @property
    def frame_rate(self) -> float:
        """Frame rate in Hz."""
        return self._frame_rate

    @frame_rate.setter
    def frame_rate(self, value: float) -> None:
        if not value > 0.0:
            raise ValueError(f"A frame rate must be greater than zero, not {value}.")
        if value != self._frame_rate:
            self._frame_rate = float(value)
            self.range_changed.emit()

    @property
    def frame(self) -> int:
        """Frame nearest to ``time``."""
        return round(self._time * self._frame_rate)

    @property
    def first(self) -> int:
        """First frame of the play range."""
        return self._first

    @property
    def last(self) -> int:
        """Last frame of the play range, inclusive."""
        return self._last

    @property
    def speed(self) -> float:
        """Playback speed: 1 is real time, negative values play backwards."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._speed = float(value)
        self._anchor = (self._clock(), self._time)

    @property
    def playing(self) -> bool:
        """True during playback."""
        return self._timer is not None

    @property
    def run(self) -> PlaybackRun:
        """Mapping from clock time to stage time of the current playback."""
        started, start = self._anchor
        begin, end = self._range_times()
        return PlaybackRun(started, start, self._speed, begin, end, 1.0 / self._frame_rate, self.loop)

    @property
    def state(self) -> PlayheadState:
        """State to be stored for recovery."""
        return PlayheadState(self._time, self._frame_rate, self._first, self._last)

    def restore(self, state: PlayheadState) -> None:
        """Restore a ``state``. Raises ValueError for an invalid frame rate or range."""
        self.frame_rate = state.frame_rate
        self.set_range(state.first, state.last)
        self.set_time(state.time)

    def set_time(self, seconds: float) -> None:
        """Move to the stage time ``seconds``; playback continues from there."""
        self._anchor = (self._clock(), seconds)
        self._move(seconds)

    def set_frame(self, frame: int) -> None:
        """Move to a frame."""
        self.set_time(frame / self._frame_rate)

    def step(self, frames: int) -> None:
        """Pause and move by whole frames, within the play range."""
        self.pause()
        self.set_frame(min(max(self.frame + frames, self._first), self._last))

    def set_range(self, first: int, last: int) -> None:
        """Set the play range to the frames ``first`` to ``last``. Raises ValueError if they are not in order."""
        if not first <= last:
            raise ValueError(f"A range must end after it starts, not run from {first} to {last}.")
        if (first, last) != (self._first, self._last):
            self._first, self._last = int(first), int(last)
            self.range_changed.emit()

    def play(self) -> None:
        """Start playback; at the end of the play range, or outside it, from its start."""
        if self.playing:
            return
        begin, end = self._range_times()
        at_end = self._time >= end if self._speed >= 0 else self._time <= begin
        if at_end or not begin <= self._time <= end:
            self._move(begin if self._speed >= 0 else end)
        self._anchor = (self._clock(), self._time)
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._follow_clock)
        self._timer.start(TICK_MILLISECONDS)
        self.playing_changed.emit(True)

    def pause(self) -> None:
        """Stop playback and its timer."""
        if self._timer is None:
            return
        self._timer.stop()
        self._timer.deleteLater()
        self._timer = None
        self.playing_changed.emit(False)

    def toggle(self) -> None:
        """Start or stop playback."""
        if self.playing:
            self.pause()
        else:
            self.play()

    def _range_times(self) -> tuple[float, float]:
        return self._first / self._frame_rate, self._last / self._frame_rate

    def _move(self, seconds: float) -> None:
        if seconds != self._time:
            self._time = float(seconds)
            self.changed.emit(self._time)

    def _follow_clock(self) -> None:
        run, clock = self.run, np.asarray(self._clock())
        seconds = float(run.stage_seconds(clock))
        if math.isnan(seconds):
            self._move(run.end if float(run.unbounded_seconds(clock)) > run.end else run.begin)
            self.pause()
        else:
            self._move(min(seconds, run.end))
