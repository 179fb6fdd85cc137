"""Performers streamed out as VMC: bundles of at most 1,500 bytes, each bone of each frame once."""

import socket
import threading
from dataclasses import dataclass
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.live import vmc
from studio.live.osc import bundles, encode_message
from studio.live.tracker import LOOPBACK

FloatArray = NDArray[np.float64]

LARGEST_BUNDLE = 1_500


def packets_of(positions: FloatArray, rotations: FloatArray, body: Morphology, seconds: float) -> list[bytes]:
    """One frame of a body, (K+23, 3) and (K+18, 3, 3), as datagrams."""
    root = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    messages = [
        encode_message(vmc.OK, [1]),
        encode_message(vmc.TIME, [float(seconds)]),
        encode_message(vmc.ROOT, ["root", *root]),
    ]
    for name, bone in vmc.bones_of(positions, rotations, body).items():
        place, turn = vmc.to_unity(bone)
        messages.append(encode_message(vmc.BONE, [name, *place.tolist(), *turn.tolist()]))
    return list(bundles(messages, LARGEST_BUNDLE))


@dataclass(frozen=True, eq=False)
class Shown:
    """A body as a picture shows it, to be sent to ``port``: positions (K+23, 3) and rotations (K+18, 3, 3)."""

    port: int
    positions: FloatArray
    rotations: FloatArray
    body: Morphology


class Broadcast:
    """Sends the newest picture's bodies from a thread of its own: ``show`` never waits, and what is late is left out.

    ``problem`` is why nothing arrives, in a sentence; empty while all goes well.
    """

    def __init__(self, address: str = LOOPBACK) -> None:
        self.address, self.problem, self.sent = address, "", 0
        self._newest: tuple[float, list[Shown]] | None = None
        self._waiting, self._stopped = threading.Event(), False
        self._thread = threading.Thread(target=self._send, name="live-output", daemon=True)
        self._thread.start()

    def show(self, bodies: list[Shown], seconds: float) -> None:
        """Send these next."""
        self._newest = seconds, bodies
        self._waiting.set()

    def close(self) -> None:
        """Send no more."""
        self._stopped = True
        self._waiting.set()
        self._thread.join()

    def _send(self) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while not self._stopped:
                self._waiting.wait()
                self._waiting.clear()
                seconds, bodies = self._newest or (0.0, [])
                for each in bodies:
                    self._send_one(out, each, seconds)

    def _send_one(self, out: socket.socket, body: Shown, seconds: float) -> None:
        try:
            for packet in packets_of(body.positions, body.rotations, body.body, seconds):
                out.sendto(packet, (self.address, body.port))
        except (OSError, OverflowError) as error:
            self.problem = f"Nothing can be sent to {self.address}:{body.port}: {error}."
            return
        self.problem, self.sent = "", self.sent + 1


class Streamer:
    """Sends frames to one address; use it in a ``with``."""

    def __init__(self, port: int, address: str = LOOPBACK) -> None:
        self._to = address, port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> "Streamer":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Send no more."""
        self._socket.close()

    def send(self, positions: FloatArray, rotations: FloatArray, body: Morphology, seconds: float) -> None:
        """Send one frame."""
        for packet in packets_of(positions, rotations, body, seconds):
            self._socket.sendto(packet, self._to)
