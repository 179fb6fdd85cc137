"""VMC output of performers, in bundles of at most 1,500 bytes, with each bone once per frame."""

import socket
import threading
from dataclasses import dataclass
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_poses import FingerPoses
from studio.core.body.morphology import Morphology
from studio.core.errors import StudioError
from studio.live import vmc
from studio.live.osc import bundles, encode_message
from studio.live.tracker import LOOPBACK

FloatArray = NDArray[np.float64]

LARGEST_BUNDLE = 1_500


def packets_of(
    positions: FloatArray,
    rotations: FloatArray,
    body: Morphology,
    seconds: float,
    fingers: FingerPoses | None = None,
) -> list[bytes]:
    """Datagrams of one frame of a body: positions (K+23, 3) in metres, rotations (K+18, 3, 3), and ``fingers`` of that
    frame.
    """
    root = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    messages = [
        encode_message(vmc.OK_ADDRESS, [1]),
        encode_message(vmc.TIME_ADDRESS, [float(seconds)]),
        encode_message(vmc.ROOT_ADDRESS, ["root", *root]),
    ]
    for name, bone in vmc.bones_of(positions, rotations, body, fingers).items():
        place, turn = vmc.to_unity(bone)
        messages.append(encode_message(vmc.BONE_ADDRESS, [name, *place.tolist(), *turn.tolist()]))
    return list(bundles(messages, LARGEST_BUNDLE))


@dataclass(frozen=True, eq=False)
class StreamedPose:
    """Pose of a body to be sent to ``port``: positions (K+23, 3) in metres and rotations (K+18, 3, 3)."""

    port: int
    positions: FloatArray
    rotations: FloatArray
    body: Morphology
    fingers: FingerPoses | None = None
    """Finger poses of one frame; None leaves the receiver's fingers unchanged."""


class Broadcast:
    """Sender of the bodies displayed last, in its own thread: ``show`` never waits, and late frames are dropped.

    ``problem`` is a sentence that tells why nothing can be sent; empty otherwise. ``close`` does not wait either, since
    resolving the host ``address`` may take seconds.
    """

    def __init__(self, address: str = LOOPBACK) -> None:
        self.problem, self.sent, self._address = "", 0, address
        self._newest: tuple[float, list[StreamedPose]] | None = None
        self._waiting, self._stopped = threading.Event(), False
        self._thread = threading.Thread(target=self._send, name="live-output", daemon=True)
        self._thread.start()

    def show(self, bodies: list[StreamedPose], seconds: float) -> None:
        """Send ``bodies`` next."""
        self._newest = seconds, bodies
        self._waiting.set()

    def close(self) -> None:
        """Stop the thread."""
        self._stopped = True
        self._waiting.set()

    def _send(self) -> None:
        host = ""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while True:
                self._waiting.wait()
                self._waiting.clear()
                if self._stopped:
                    return
                try:
                    host = host or socket.gethostbyname(self._address)
                    self._send_all(out, host)
                except (OSError, OverflowError, UnicodeError) as error:
                    self.problem = str(unreachable(self._address, error))
                else:
                    self.problem = ""

    def _send_all(self, out: socket.socket, host: str) -> None:
        seconds, bodies = self._newest or (0.0, [])
        for body in bodies:
            for packet in packets_of(body.positions, body.rotations, body.body, seconds, body.fingers):
                out.sendto(packet, (host, body.port))
            self.sent += 1


class Streamer:
    """Sender of frames to one address; a context manager. Raises StudioError if the address cannot be found."""

    def __init__(self, port: int, address: str = LOOPBACK) -> None:
        try:
            self._to = socket.gethostbyname(address), port
        except (OSError, UnicodeError) as error:
            raise unreachable(address, error) from error
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> "Streamer":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def send(self, positions: FloatArray, rotations: FloatArray, body: Morphology, seconds: float) -> None:
        """Send one frame. Raises StudioError if the system refuses it."""
        try:
            for packet in packets_of(positions, rotations, body, seconds):
                self._socket.sendto(packet, self._to)
        except OSError as error:
            raise unreachable(self._to[0], error) from error


def unreachable(address: str, error: Exception) -> StudioError:
    """Error for an address that cannot be found or sent to."""
    reason = getattr(error, "strerror", None) or error
    return StudioError(f"Nothing can be sent to {address}: {reason}. Choose another address.")
