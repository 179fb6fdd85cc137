"""OSC 1.0 packets in and out. Received data is not trusted: every size is checked against the bytes that exist."""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

Argument = int | float | str | bytes | bool | None

BUNDLE_HEADER = b"#bundle\0"
IMMEDIATE_TIME = b"\0\0\0\0\0\0\0\1"
LARGEST_PACKET, DEEPEST_BUNDLE, MOST_MESSAGES, MOST_ARGUMENTS, LONGEST_TEXT = 65_507, 4, 1_024, 64, 256
"""Limits: bytes of a packet, depth of nested bundles, messages of a packet, arguments of a message, bytes of a text."""
_FIXED = {"i": ">i", "f": ">f", "h": ">q", "d": ">d"}
_ALONE: dict[str, Argument] = {"T": True, "F": False, "N": None}


class BadPacket(ValueError):  # noqa: N818 - it names what is the matter
    """Packet that is not OSC, or exceeds a limit."""


@dataclass(frozen=True)
class Message:
    """One OSC message."""

    address: str
    arguments: tuple[Argument, ...]


def decode(packet: bytes) -> list[Message]:
    """The messages of a packet, in order. Raises BadPacket."""
    if len(packet) > LARGEST_PACKET:
        raise BadPacket("too long")
    found: list[Message] = []
    for message in _messages(packet, 0):
        found.append(message)
        if len(found) > MOST_MESSAGES:
            raise BadPacket("too many messages")
    return found


def encode_message(address: str, arguments: Sequence[Argument]) -> bytes:
    """Encoded message; numbers are written with 32 bits."""
    types, values = ",", b""
    for value in arguments:
        match value:
            case bool() | None:
                types += {True: "T", False: "F", None: "N"}[value]
            case int():
                types, values = types + "i", values + struct.pack(">i", value)
            case float():
                types, values = types + "f", values + struct.pack(">f", value)
            case bytes():
                types, values = types + "b", values + struct.pack(">i", len(value)) + _padded(value)
            case _:
                types, values = types + "s", values + _text(value)
    return _text(address) + _text(types) + values


def bundles(messages: Sequence[bytes], largest: int) -> Iterator[bytes]:
    """Bundles of encoded messages, in order and as few as possible, of at most ``largest`` bytes unless one message is
    longer.
    """
    begin = BUNDLE_HEADER + IMMEDIATE_TIME
    packet = begin
    for message in messages:
        element = struct.pack(">i", len(message)) + message
        if len(packet) > len(begin) and len(packet) + len(element) > largest:
            yield packet
            packet = begin
        packet += element
    if len(packet) > len(begin):
        yield packet


def _messages(packet: bytes, depth: int) -> Iterator[Message]:
    if not packet.startswith(BUNDLE_HEADER):
        yield _message(packet)
        return
    if depth == DEEPEST_BUNDLE:
        raise BadPacket("bundles too deep")
    at = len(BUNDLE_HEADER) + 8
    if len(packet) < at:
        raise BadPacket("a bundle without a time")
    while at < len(packet):
        size = int(_unpacked(">i", packet, at)[0])
        at += 4
        if size < 4 or size % 4 or at + size > len(packet):
            raise BadPacket("an element of a bundle of a wrong size")
        yield from _messages(packet[at : at + size], depth + 1)
        at += size


def _message(packet: bytes) -> Message:
    address, at = _read_text(packet, 0)
    if not address.startswith("/"):
        raise BadPacket("no address")
    types, at = _read_text(packet, at)
    if not types.startswith(",") or len(types) > MOST_ARGUMENTS + 1:
        raise BadPacket("no types, or too many")
    arguments: list[Argument] = []
    for kind in types[1:]:
        value: Argument
        if kind in _FIXED:
            (value,) = _unpacked(_FIXED[kind], packet, at)
            at += struct.calcsize(_FIXED[kind])
        elif kind == "s":
            value, at = _read_text(packet, at)
        elif kind == "b":
            value, at = _read_blob(packet, at)
        elif kind in _ALONE:
            value = _ALONE[kind]
        else:
            raise BadPacket("a type that is not known")
        arguments.append(value)
    return Message(address, tuple(arguments))


def _unpacked(form: str, packet: bytes, at: int) -> tuple[int | float, ...]:
    if at + struct.calcsize(form) > len(packet):
        raise BadPacket("cut off")
    return struct.unpack_from(form, packet, at)


def _read_text(packet: bytes, at: int) -> tuple[str, int]:
    end = packet.find(b"\0", at, at + LONGEST_TEXT)
    if end < 0:
        raise BadPacket("a text without an end")
    after = at + (end - at) // 4 * 4 + 4
    if after > len(packet):
        raise BadPacket("cut off")
    try:
        return packet[at:end].decode("utf-8"), after
    except UnicodeDecodeError as error:
        raise BadPacket("a text that is none") from error


def _read_blob(packet: bytes, at: int) -> tuple[bytes, int]:
    (size,) = _unpacked(">i", packet, at)
    after = at + 4 + (int(size) + 3) // 4 * 4
    if size < 0 or after > len(packet):
        raise BadPacket("cut off")
    return packet[at + 4 : at + 4 + int(size)], after


def _text(text: object) -> bytes:
    return _padded(str(text).encode("utf-8") + b"\0")


def _padded(data: bytes) -> bytes:
    return data + b"\0" * (-len(data) % 4)
