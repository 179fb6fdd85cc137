"""What comes in over the network: bones and trackers by OSC and VMC, the newest value of each.

Off until it is asked for; it binds loopback unless told otherwise, and takes packets of the senders that are listed.
What is no OSC, no number or too much is counted, not told one by one. No path or address in a packet is followed.
"""

import math
import select
import socket
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.live import vmc
from studio.live.osc import LARGEST_PACKET, Argument, BadPacket, Message, decode

FloatArray = NDArray[np.float64]

PORT, LOOPBACK = 39_539, "127.0.0.1"
TRACKED_RANGE = 100.0
"""Metres to which places are clamped."""
MOST_NAMES = 256
"""Bones and trackers that are kept: more names are refused, so that nobody fills the memory."""
MOST_SENDERS = 16
"""Senders that are remembered beside those that are listed."""
MOST_A_SLICE, SLICE = 250, 0.05
"""Packets that are taken in so many seconds: more are left to the system, which drops them, so that nobody's window
waits for a thread that decodes.
"""


@dataclass
class Counts:
    """Packets that were taken, and those that were not: ``bad`` ones, those of ``strangers``; and refused values."""

    taken: int = 0
    bad: int = 0
    strangers: int = 0
    refused_values: int = 0


@dataclass
class Inbox:
    """The newest value of every bone and tracker; any thread may feed it and read it."""

    counts: Counts = field(default_factory=Counts)
    _bones: dict[str, vmc.Bone] = field(default_factory=dict)
    _trackers: dict[str, vmc.Bone] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def feed(self, packet: bytes) -> None:
        """Take one datagram, whatever it is."""
        try:
            messages = decode(packet)
        except BadPacket:
            self.counts.bad += 1
            return
        self.counts.taken += 1
        with self._lock:
            for message in messages:
                self._take(message)

    def bones(self) -> dict[str, vmc.Bone]:
        """The newest value of every bone."""
        with self._lock:
            return dict(self._bones)

    def place(self, names: Sequence[str]) -> FloatArray | None:
        """(3,) the mean of the trackers or the bone of these names, in the world; None while one has not come."""
        with self._lock:
            found = [self._trackers.get(name) for name in names]
            bones = dict(self._bones)
        if names and all(each is not None for each in found):
            return np.asarray(np.mean([each.place for each in found if each is not None], axis=0))
        return bone_place(bones, names[0]) if len(names) == 1 else None

    def _take(self, message: Message) -> None:
        into = {
            vmc.BONE_ADDRESS: self._bones,
            vmc.TRACKER_ADDRESS: self._trackers,
            vmc.HMD_ADDRESS: self._trackers,
        }.get(message.address)
        if into is None:
            return
        name, bone = _named_bone(message.arguments)
        if bone is None or (name not in into and len(into) >= MOST_NAMES):
            self.counts.refused_values += 1
        else:
            into[name] = bone


def bone_place(bones: dict[str, vmc.Bone], name: str) -> FloatArray | None:
    """(3,) where a bone is in the world; None while it or a bone above it is missing."""
    found = vmc.posed(bones)
    if found is None:
        return None
    positions, _, body = found
    segments = {each.name: each.segment for each in vmc.bone_segments(body.layout)}
    return positions[body.layout.proximal_points()[segments[name]]] if name in segments else None


def _named_bone(arguments: tuple[Argument, ...]) -> tuple[str, vmc.Bone | None]:
    if len(arguments) < 8 or not isinstance(arguments[0], str):
        return "", None
    numbers = [float(each) for each in arguments[1:8] if isinstance(each, float | int)]
    turn = math.hypot(*numbers[3:])
    if len(numbers) < 7 or not all(math.isfinite(each) for each in numbers) or not 1e-6 < turn < 1e6:
        return arguments[0], None
    place = [min(max(each, -TRACKED_RANGE), TRACKED_RANGE) for each in numbers[:3]]
    return arguments[0], vmc.from_unity(place, [each / turn for each in numbers[3:]])


@dataclass
class Sender:
    """Who sends to a port: whether it is listened to, how many packets came, and when the last one (``monotonic``)."""

    on: bool
    packets: int = 0
    heard: float = -math.inf


class UdpInput:
    """Listens until it is closed, in a thread of its own; StudioError when the address cannot be had.

    ``senders`` by their addresses may be switched on and off at any time; who else sends is noted, and off.
    ``kept`` hears every datagram that is taken, with the seconds since it began to listen.
    """

    def __init__(
        self, inbox: Inbox, port: int = PORT, address: str = LOOPBACK, senders: Iterable[str] = (LOOPBACK,)
    ) -> None:
        self.inbox, self.address = inbox, address
        self.senders = {sender: Sender(True) for sender in senders}
        self.kept: Callable[[float, bytes], object] | None = None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((address, port))
        except (OSError, OverflowError, UnicodeError) as error:
            self._socket.close()
            reason = getattr(error, "strerror", None) or error
            sentence = f"Nothing can listen at {address}:{port}: {reason}. Choose another port or address."
            raise StudioError(sentence) from error
        self._begun = time.monotonic()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="live-input", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """Where it listens; the one it was given when asked for port 0."""
        return int(self._socket.getsockname()[1])

    def close(self) -> None:
        """Listen no more."""
        self._stopped.set()
        self._thread.join()
        self._socket.close()

    def _listen(self) -> None:
        until, taken = 0.0, 0
        while not self._stopped.is_set():
            if not select.select([self._socket], [], [], 0.1)[0]:
                continue
            now = time.monotonic()
            if now >= until:
                until, taken = now + SLICE, 0
            elif taken >= MOST_A_SLICE:
                self._stopped.wait(until - now)
                continue
            taken += 1
            packet, sender = self._socket.recvfrom(LARGEST_PACKET)
            self._take(packet, sender[0], now)

    def _take(self, packet: bytes, address: str, now: float) -> None:
        sender = self.senders.get(address)
        if sender is None and len(self.senders) < MOST_SENDERS:
            sender = self.senders[address] = Sender(False)
        if sender is not None:
            sender.packets, sender.heard = sender.packets + 1, now
        if sender is None or not sender.on:
            self.inbox.counts.strangers += 1
            return
        self.inbox.feed(packet)
        kept = self.kept
        if kept is not None:
            kept(now - self._begun, packet)
