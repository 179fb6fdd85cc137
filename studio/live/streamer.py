"""Performers streamed out as VMC: bundles of at most 1,500 bytes, each bone of each frame once."""

import socket
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from studio.core.morphology import Morphology
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
