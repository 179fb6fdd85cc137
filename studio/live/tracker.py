"""Network input by OSC and VMC: the newest value of each bone and tracker.

It is off until it is switched on, binds loopback unless another address is given, and accepts packets only from listed
senders. Invalid packets, invalid numbers and excess values are counted, not reported one by one. No path or address in
a packet is followed.
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
TRACKED_RANGE_METRES = 100.0
"""Metres to which the coordinates of received positions are clamped, in both directions."""
MAX_NAMES = 256
"""Maximum number of bones, and of trackers: more names are refused, which limits the memory used."""
MAX_SENDERS = 16
"""Number of senders, including listed ones, beyond which unknown senders are not remembered."""
MAX_PACKETS_PER_SLICE, SLICE_SECONDS = 250, 0.05
"""Maximum number of packets taken per slice of time, and length of a slice in seconds; further packets are dropped, so
that decoding never blocks the window.
"""


@dataclass
class Counts:
    """Numbers of accepted and malformed packets, of packets from senders that are switched off, and of refused
    values.
    """

    accepted: int = 0
    malformed: int = 0
    unknown_senders: int = 0
    refused_values: int = 0


@dataclass
class Inbox:
    """Newest value of every bone and tracker; any thread may write and read it."""

    counts: Counts = field(default_factory=Counts)
    _bones: dict[str, vmc.Bone] = field(default_factory=dict)
    _trackers: dict[str, vmc.Bone] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def receive(self, packet: bytes) -> None:
        """Decode one datagram, valid or not, and store its values."""
        try:
            messages = decode(packet)
        except BadPacket:
            self.counts.malformed += 1
            return
        self.counts.accepted += 1
        with self._lock:
            for message in messages:
                self._take(message)

    def bones(self) -> dict[str, vmc.Bone]:
        """Newest value of every bone, by name."""
        with self._lock:
            return dict(self._bones)

    def position_of(self, names: Sequence[str]) -> FloatArray | None:
        """Mean world position (3,) in metres of the trackers with these ``names``, or the position of a single named
        bone; None while one is missing.
        """
        with self._lock:
            found = [self._trackers.get(name) for name in names]
            bones = dict(self._bones)
        if names and all(each is not None for each in found):
            return np.asarray(np.mean([each.position for each in found if each is not None], axis=0))
        return bone_position(bones, names[0]) if len(names) == 1 else None

    def _take(self, message: Message) -> None:
        into = {
            vmc.BONE_ADDRESS: self._bones,
            vmc.TRACKER_ADDRESS: self._trackers,
            vmc.HMD_ADDRESS: self._trackers,
        }.get(message.address)
        if into is None:
            return
        name, bone = _named_bone(message.arguments)
        if bone is None or (name not in into and len(into) >= MAX_NAMES):
            self.counts.refused_values += 1
        else:
            into[name] = bone


def bone_position(bones: dict[str, vmc.Bone], name: str) -> FloatArray | None:
    """World position (3,) in metres of a bone; None if the body is incomplete or has no such bone."""
    found = vmc.posed_body(bones)
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
    place = [min(max(each, -TRACKED_RANGE_METRES), TRACKED_RANGE_METRES) for each in numbers[:3]]
    return arguments[0], vmc.from_unity(place, [each / turn for each in numbers[3:]])


@dataclass
class Sender:
    """State of a sender: ``on`` if its packets are accepted, number of packets, and clock time ``heard`` of the last
    one.
    """

    on: bool
    packets: int = 0
    heard: float = -math.inf


class UdpInput:
    """UDP listener in a thread of its own, until it is closed. Raises StudioError if the address cannot be bound.

    ``senders`` by their addresses may be switched on and off at any time; any other sender is added, switched off.
    ``kept`` is called with each datagram that is taken and the seconds since listening began.
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
        """Port that is listened on; the one assigned by the system if port 0 was requested."""
        return int(self._socket.getsockname()[1])

    def close(self) -> None:
        """Stop listening, and wait for the thread."""
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
                until, taken = now + SLICE_SECONDS, 0
            elif taken >= MAX_PACKETS_PER_SLICE:
                self._stopped.wait(until - now)
                continue
            taken += 1
            packet, sender = self._socket.recvfrom(LARGEST_PACKET)
            self._take(packet, sender[0], now)

    def _take(self, packet: bytes, address: str, now: float) -> None:
        sender = self.senders.get(address)
        if sender is None and len(self.senders) < MAX_SENDERS:
            sender = self.senders[address] = Sender(False)
        if sender is not None:
            sender.packets, sender.heard = sender.packets + 1, now
        if sender is None or not sender.on:
            self.inbox.counts.unknown_senders += 1
            return
        self.inbox.receive(packet)
        kept = self.kept
        if kept is not None:
            kept(now - self._begun, packet)
