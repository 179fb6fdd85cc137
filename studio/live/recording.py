"""Raw datagrams in a file, with the seconds at which they came: recorded while a session goes on, and played again."""

import contextlib
import struct
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from studio.core.errors import StudioError
from studio.io.beside import read_bytes
from studio.live.osc import LARGEST_PACKET
from studio.live.tracker import MOST_A_SLICE, SLICE, Inbox

LATEST_DATAGRAM = 1e6
"""Seconds after its beginning at which a datagram can have come."""
LONGEST_PAUSE, LEAST_PAUSE = 5.0, 0.02
"""Seconds for which a replay is silent at most, and from its end to its beginning."""
_RECORD = struct.Struct("<dI")
_MAGIC = b"MSOSC1\0\0"


def write_recording(path: Path, packets: Iterable[tuple[float, bytes]]) -> None:
    """Raw datagrams with the seconds at which they came."""
    path.write_bytes(_MAGIC + b"".join(_RECORD.pack(seconds, len(packet)) + packet for seconds, packet in packets))


@dataclass(frozen=True)
class PacketRecording:
    """The whole datagrams of a file, in order, with the seconds at which they came."""

    packets: tuple[tuple[float, bytes], ...]
    problem: str = ""
    """The sentence that tells from where on the file is damaged or cut off; empty where all of it is whole."""

    def __iter__(self) -> Iterator[tuple[float, bytes]]:
        return iter(self.packets)


def read_recording(path: Path) -> PacketRecording:
    """A recording up to where it is damaged or cut off. Raises StudioError where the file is no recording."""
    data, at = read_bytes(path), len(_MAGIC)
    if not data.startswith(_MAGIC):
        raise StudioError(f"{path.name} is not a recording of datagrams.")
    packets = []
    while at + _RECORD.size <= len(data):
        seconds, size = _RECORD.unpack_from(data, at)
        end = at + _RECORD.size + size
        if not 0.0 <= seconds <= LATEST_DATAGRAM or size > LARGEST_PACKET or end > len(data):
            break
        packets.append((seconds, data[at + _RECORD.size : end]))
        at = end
    problem = ""
    if at < len(data):
        problem = f"{path.name} is damaged or cut off at byte {at}; the {len(packets)} packets before it are played."
    return PacketRecording(tuple(packets), problem)


class Recorder:
    """Writes datagrams as they come, from any threads, until it is closed. StudioError when it cannot write.

    A disk that is full ends the recording after the last whole datagram, and ``problem`` tells it.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.count, self.problem = path, 0, ""
        self._first: float | None = None
        self._lock = threading.Lock()
        try:
            self._file = path.open("wb", buffering=0)  # else an error might come with a later datagram, or at the end
            self._write(_MAGIC)
        except OSError as error:
            raise StudioError(f"{path} cannot be written: {error.strerror}. Choose another place.") from error

    def keep(self, seconds: float, packet: bytes) -> None:
        """Write one datagram; the first one is the beginning."""
        with self._lock:
            if self._file.closed:
                return
            self._first = seconds if self._first is None else self._first
            try:
                self._write(_RECORD.pack(max(seconds - self._first, 0.0), len(packet)) + packet)
            except OSError as error:
                self.problem = f"{self.path.name} ends after {self.count} packets: {error.strerror}."
                self._close()
                return
            self.count += 1

    def close(self) -> None:
        """All is on disk, or ``problem`` tells why not."""
        with self._lock:
            self._close()

    def _write(self, content: bytes) -> None:
        """Write all of it or nothing. Raises OSError."""
        whole = self._file.tell()
        try:
            written = self._file.write(content) or 0
            while written < len(content):  # the rest says why
                written += self._file.write(content[written:]) or 0
        except OSError:
            with contextlib.suppress(OSError):
                self._file.truncate(whole)
            raise

    def _close(self) -> None:
        try:
            self._file.close()
        except OSError as error:
            self.problem = self.problem or f"{self.path.name} may not be whole: {error.strerror}."


class Replay:
    """Feeds an inbox with recorded datagrams at the pace at which they came, again and again, until it is closed.

    It feeds no more datagrams at a time than come over the network. Raises StudioError where the file holds none;
    ``problem`` tells where only its beginning is whole.
    """

    def __init__(self, path: Path, inbox: Inbox) -> None:
        self.path, self.inbox = path, inbox
        recording = read_recording(path)
        self._packets, self.problem = recording.packets, recording.problem
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
            before, until, fed = 0.0, 0.0, 0
            for seconds, packet in self._packets:
                if self._stopped.wait(min(max(seconds - before, 0.0), LONGEST_PAUSE)):
                    return
                now, before = time.monotonic(), max(before, seconds)
                if now >= until:
                    until, fed = now + SLICE, 0
                elif fed >= MOST_A_SLICE:
                    if self._stopped.wait(until - now):
                        return
                    until, fed = until + SLICE, 0
                fed += 1
                self.inbox.feed(packet)
            self._stopped.wait(LEAST_PAUSE)
