"""Recording of raw datagrams with their arrival times: written to a file during a session, and replayed."""

import contextlib
import struct
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from studio.core.errors import StudioError
from studio.io.referenced_files import read_bytes
from studio.live.osc import LARGEST_PACKET
from studio.live.tracker import MAX_PACKETS_PER_SLICE, SLICE_SECONDS, Inbox

MAX_DATAGRAM_SECONDS = 1e6
"""Maximum arrival time of a datagram in seconds after the start of its recording."""
MAX_PAUSE_SECONDS, LOOP_PAUSE_SECONDS = 5.0, 0.02
"""Maximum silence of a replay in seconds, and pause between its end and the next start."""
_RECORD = struct.Struct("<dI")
_MAGIC = b"MSOSC1\0\0"


def write_recording(path: Path, packets: Iterable[tuple[float, bytes]]) -> None:
    """Write raw datagrams with their arrival times in seconds."""
    path.write_bytes(_MAGIC + b"".join(_RECORD.pack(seconds, len(packet)) + packet for seconds, packet in packets))


@dataclass(frozen=True)
class PacketRecording:
    """Complete datagrams of a file, in order, with their arrival times in seconds."""

    packets: tuple[tuple[float, bytes], ...]
    problem: str = ""
    """Sentence that tells from which byte on the file is damaged or cut off; empty if it is complete."""

    def __iter__(self) -> Iterator[tuple[float, bytes]]:
        return iter(self.packets)


def read_recording(path: Path) -> PacketRecording:
    """Recording up to the byte where it is damaged or cut off. Raises StudioError if the file is no recording."""
    data, at = read_bytes(path), len(_MAGIC)
    if not data.startswith(_MAGIC):
        raise StudioError(f"{path.name} is not a recording of datagrams.")
    packets = []
    while at + _RECORD.size <= len(data):
        seconds, size = _RECORD.unpack_from(data, at)
        end = at + _RECORD.size + size
        if not 0.0 <= seconds <= MAX_DATAGRAM_SECONDS or size > LARGEST_PACKET or end > len(data):
            break
        packets.append((seconds, data[at + _RECORD.size : end]))
        at = end
    problem = ""
    if at < len(data):
        problem = f"{path.name} is damaged or cut off at byte {at}; the {len(packets)} packets before it are played."
    return PacketRecording(tuple(packets), problem)


class Recorder:
    """Writer of datagrams as they arrive, from any thread, until it is closed. Raises StudioError if the file cannot be
    written.

    If the disk is full, the recording ends after the last complete datagram, and ``problem`` tells so.
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

    def record_packet(self, seconds: float, packet: bytes) -> None:
        """Write one datagram; times are counted from the first one."""
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
        """Close the file; either all datagrams are written, or ``problem`` tells why not."""
        with self._lock:
            self._close()

    def _write(self, content: bytes) -> None:
        """Write all of it or nothing. Raises OSError."""
        whole = self._file.tell()
        try:
            written = self._file.write(content) or 0
            while written < len(content):  # writing the rest raises the reason
                written += self._file.write(content[written:]) or 0
        except OSError:
            with contextlib.suppress(OSError):
                self._file.truncate(whole)
            raise

    def _close(self) -> None:
        try:
            self._file.close()
        except OSError as error:
            self.problem = self.problem or f"{self.path.name} may be incomplete: {error.strerror}."


class Replay:
    """Replay of recorded datagrams into an inbox at their original pace, repeated until it is closed.

    It feeds no more datagrams at a time than are taken from the network. Raises StudioError if the file holds none;
    ``problem`` says so if only its beginning is whole.
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
        """Length of the recording in seconds."""
        return self._packets[-1][0]

    def close(self) -> None:
        """Stop the replay and wait for its thread."""
        self._stopped.set()
        self._thread.join()

    def _play(self) -> None:
        while not self._stopped.is_set():
            before, until, fed = 0.0, 0.0, 0
            for seconds, packet in self._packets:
                if self._stopped.wait(min(max(seconds - before, 0.0), MAX_PAUSE_SECONDS)):
                    return
                now, before = time.monotonic(), max(before, seconds)
                if now >= until:
                    until, fed = now + SLICE_SECONDS, 0
                elif fed >= MAX_PACKETS_PER_SLICE:
                    if self._stopped.wait(until - now):
                        return
                    until, fed = until + SLICE_SECONDS, 0
                fed += 1
                self.inbox.receive(packet)
            self._stopped.wait(LOOP_PAUSE_SECONDS)
