"""Raw datagrams in a file, with the seconds at which they came: recorded while a session goes on, and played again."""

import math
import struct
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path

from studio.core.errors import StudioError
from studio.io.beside import read_bytes
from studio.live.osc import LARGEST
from studio.live.tracker import Inbox

LONGEST_PAUSE, LEAST_PAUSE = 5.0, 0.02
"""Seconds for which a replay is silent at most, and from its end to its beginning."""
_RECORD = struct.Struct("<dI")
_MAGIC = b"MSOSC1\0\0"


def write_recording(path: Path, packets: Iterable[tuple[float, bytes]]) -> None:
    """Raw datagrams with the seconds at which they came."""
    path.write_bytes(_MAGIC + b"".join(_RECORD.pack(seconds, len(packet)) + packet for seconds, packet in packets))


def read_recording(path: Path) -> Iterator[tuple[float, bytes]]:
    """The datagrams of a recording, in order. Raises StudioError naming the byte at which it is damaged."""
    data, at = read_bytes(path), len(_MAGIC)
    if not data.startswith(_MAGIC):
        raise StudioError(f"{path.name} is not a recording of datagrams.")
    while at < len(data):
        if at + _RECORD.size > len(data):
            raise StudioError(f"{path.name}, byte {at}: the recording is cut off.")
        seconds, size = _RECORD.unpack_from(data, at)
        at += _RECORD.size
        if not math.isfinite(seconds) or size > LARGEST or at + size > len(data):
            raise StudioError(f"{path.name}, byte {at}: the recording is damaged or cut off.")
        yield seconds, data[at : at + size]
        at += size


class Recorder:
    """Writes datagrams as they come, from any threads, until it is closed. StudioError when it cannot write."""

    def __init__(self, path: Path) -> None:
        self.path, self.count, self.problem = path, 0, ""
        self._first: float | None = None
        self._lock = threading.Lock()
        try:
            self._file = path.open("wb")
            self._file.write(_MAGIC)
        except OSError as error:
            raise StudioError(f"{path} cannot be written: {error.strerror}. Choose another place.") from error

    def keep(self, seconds: float, packet: bytes) -> None:
        """One datagram; the first one is the beginning. A disk that is full ends it, and is told as ``problem``."""
        with self._lock:
            if self._file.closed:
                return
            self._first = seconds if self._first is None else self._first
            try:
                self._file.write(_RECORD.pack(max(seconds - self._first, 0.0), len(packet)) + packet)
            except OSError as error:
                self.problem = f"{self.path.name} ends after {self.count} packets: {error.strerror}."
                self._file.close()
                return
            self.count += 1

    def close(self) -> None:
        """All is on disk."""
        with self._lock:
            self._file.close()


class Replay:
    """Feeds an inbox with recorded datagrams at the pace at which they came, again and again, until it is closed.

    Raises StudioError where the file is none or damaged, before anything is fed.
    """

    def __init__(self, path: Path, inbox: Inbox) -> None:
        self.path, self.inbox = path, inbox
        self._packets = list(read_recording(path))
        if not self._packets:
            raise StudioError(f"{path.name} holds no datagrams.")
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._play, name="live-replay", daemon=True)
        self._thread.start()

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return self._packets[-1][0]

    def close(self) -> None:
        """Feed no more."""
        self._stopped.set()
        self._thread.join()

    def _play(self) -> None:
        while not self._stopped.is_set():
            before = 0.0
            for seconds, packet in self._packets:
                if seconds > before and self._stopped.wait(min(seconds - before, LONGEST_PAUSE)):
                    return
                before = max(before, seconds)
                self.inbox.feed(packet)
            self._stopped.wait(LEAST_PAUSE)
