"""Frames of reference footage, read in the background and kept in a cache of limited size."""

import threading
from collections import OrderedDict
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from studio.core.errors import StudioError
from studio.engine.background_tasks import CLOSE_WAIT_SECONDS, join_threads
from studio.io.media.footage_file import footage_frames

Picture = NDArray[np.uint8]

CACHED_BYTES = 192 * 2**20
"""Memory for cached frames in bytes: at least three seconds of video."""
READ_AHEAD_FRAMES = 24
"""Number of frames read ahead in the direction of playback."""
MAX_READ_ON_FRAMES = 60
"""Number of frames up to which reading on is faster than seeking."""


@dataclass(frozen=True)
class FootageFrame:
    """Frame ``index`` of a video or image sequence with ``count`` frames at ``file_rate`` fps."""

    path: Path
    file_rate: float
    count: int
    index: int


class FootageFrames(QObject):
    """Cache of frames; its thread reads the latest requested frame first, then reads ahead."""

    frame_ready = Signal()
    """Emitted when the frame that was requested last is cached."""
    failed = Signal(str, str)
    """Emitted with the path of a file that cannot be read, and a sentence."""

    def __init__(self, parent: QObject | None = None, cached_bytes: int = CACHED_BYTES) -> None:
        super().__init__(parent)
        self._kept: OrderedDict[tuple[Path, int], Picture] = OrderedDict()
        self._bytes, self._most_bytes = 0, cached_bytes
        self._wanted: FootageFrame | None = None
        self._refused: set[Path] = set()
        self._changed = threading.Condition()
        self._closed = False
        self._thread: threading.Thread | None = None
        self._reading: Generator[Picture, None, None] | None = None
        self._place: tuple[Path, int] | None = None
        """File that is being read, and the index of the frame that comes next."""

    @property
    def bytes_kept(self) -> int:
        """Size in bytes of the cached frames."""
        return self._bytes

    def picture(self, frame: FootageFrame) -> Picture | None:
        """Image of a frame; None until it is read, after which ``frame_ready`` is emitted."""
        with self._changed:
            self._wanted = frame
            self._changed.notify()
            found = self._kept.get((frame.path, frame.index))
            if found is not None:
                self._kept.move_to_end((frame.path, frame.index))
        if self._thread is None and not self._closed:
            self._thread = threading.Thread(target=self._serve, name="footage", daemon=True)
            self._thread.start()
        return found

    def try_again(self, path: Path) -> None:
        """Read a file again that has changed or could not be read."""
        with self._changed:
            self._refused.discard(path)
            self._bytes -= sum(self._kept.pop(key).nbytes for key in [key for key in self._kept if key[0] == path])
            self._changed.notify()

    def close(self) -> None:
        """End the thread and the decoder process."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            join_threads((self._thread,), CLOSE_WAIT_SECONDS)

    def _serve(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or self._missing() is not None)
                frame, missing = self._wanted, self._missing()
            if self._closed or frame is None or missing is None:
                break
            try:
                self._read(frame, missing)
            except StudioError as error:
                self._refused.add(frame.path)
                self.failed.emit(str(frame.path), str(error))
        self._let_go()

    def _missing(self) -> int | None:
        """Index of the next frame to be read; None if there is none."""
        wanted = self._wanted
        if wanted is None or wanted.path in self._refused:
            return None
        first, last = wanted.index, min(wanted.index + READ_AHEAD_FRAMES, wanted.count - 1)
        if (wanted.path, first + 1) in self._kept and (wanted.path, first) not in self._kept:
            first, last = max(first - READ_AHEAD_FRAMES, 0), first  # played backwards
        return next((k for k in range(first, last + 1) if (wanted.path, k) not in self._kept), None)

    def _read(self, frame: FootageFrame, index: int) -> None:
        """Read the next frame on the way to ``index``; seek to ``index`` if that is faster."""
        if self._place is None or self._place[0] != frame.path or not 0 <= index - self._place[1] <= MAX_READ_ON_FRAMES:
            self._let_go()
            self._reading, self._place = footage_frames(frame.path, frame.file_rate, index), (frame.path, index)
        assert self._reading is not None
        _, k = self._place
        picture = next(self._reading, None)
        if picture is None:  # the film has fewer frames than it says: the last one stays
            picture = self._kept.get((frame.path, k - 1), np.zeros((1, 1, 3), np.uint8))
        self._place = frame.path, k + 1
        with self._changed:
            replaced = self._kept.pop((frame.path, k), None)
            self._kept[frame.path, k] = picture
            self._bytes += picture.nbytes - (replaced.nbytes if replaced is not None else 0)
            while self._bytes > self._most_bytes and len(self._kept) > 1:
                self._bytes -= self._kept.popitem(last=False)[1].nbytes
            shown = self._wanted is not None and (self._wanted.path, self._wanted.index) == (frame.path, k)
        if shown:
            self.frame_ready.emit()

    def _let_go(self) -> None:
        """End the decoder process."""
        if self._reading is not None:
            self._reading.close()
        self._reading = self._place = None
