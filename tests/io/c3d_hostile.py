"""Ways to spoil a C3D file: what a header says, what a parameter says, and where the bytes end."""

import struct
from collections.abc import Callable

from studio.io.c3d.writer import c3d_bytes
from tests.io.trials import make_trial

GOOD = c3d_bytes(make_trial())
Spoil = Callable[[bytearray], bytes | bytearray | None]


def header(word: int, value: int | float) -> Spoil:
    """A number of the header, counted in words of 16 bits from 0; floats take two."""

    def spoil(content: bytearray) -> None:
        struct.pack_into("<f" if isinstance(value, float) else "<H", content, 2 * word, value)

    return spoil


def record_of(content: bytes | bytearray, group: str, name: str) -> int:
    """Byte of the length of the name of a parameter, the way its record begins."""
    numbers: dict[str, int] = {}
    at = 512 + 4
    while content[at]:
        length, number = abs(struct.unpack_from("b", content, at)[0]), struct.unpack_from("b", content, at + 1)[0]
        label = bytes(content[at + 2 : at + 2 + length]).decode()
        if number < 0:
            numbers[label] = -number
        elif label == name and number == numbers.get(group):
            return at
        at += 2 + length + struct.unpack_from("<H", content, at + 2 + length)[0]
    raise KeyError(f"{group}:{name}")


def value_of(content: bytes | bytearray, group: str, name: str) -> int:
    """Byte of the type of a parameter; then come the number of dimensions, the dimensions, the values."""
    at = record_of(content, group, name)
    return at + 2 + abs(struct.unpack_from("b", content, at)[0]) + 2


def parameter(group: str, name: str, data: bytes, skip: int = 2) -> Spoil:
    """Bytes of a parameter's value, ``skip`` after its type."""

    def spoil(content: bytearray) -> None:
        at = value_of(content, group, name) + skip
        content[at : at + len(data)] = data

    return spoil


def deeper(group: str, name: str) -> Spoil:
    """A parameter with a further dimension of 1, in the place of a byte that fills the section up."""

    def spoil(content: bytearray) -> None:
        at = value_of(content, group, name)
        end, dimensions = data_start(content), content[at + 1]
        assert content[end - 1] == 0
        content[at + 1] += 1
        step = struct.unpack_from("<H", content, at - 2)[0]
        struct.pack_into("<H", content, at - 2, step + 1)
        content.insert(at + 2 + dimensions, 1)
        del content[end]

    return spoil


def renamed(group: str, name: str) -> Spoil:
    """A parameter that is not there."""

    def spoil(content: bytearray) -> None:
        content[record_of(content, group, name) + 2] = ord("Q")

    return spoil


def step(group: str, name: str, value: int) -> Spoil:
    """The way from a parameter to the next one."""

    def spoil(content: bytearray) -> None:
        struct.pack_into("<H", content, value_of(content, group, name) - 2, value)

    return spoil


def cut(length: int) -> Spoil:
    return lambda content: content[:length]


def byte(at: int, value: int) -> Spoil:
    def spoil(content: bytearray) -> None:
        content[at] = value

    return spoil


def data_start(content: bytes | bytearray) -> int:
    return (struct.unpack_from("<H", content, 16)[0] - 1) * 512


def point(frame: int, index: int, axis: int, value: float) -> Spoil:
    """A coordinate, or with ``axis`` 3 the word of residual and cameras."""

    def spoil(content: bytearray) -> None:
        a_frame = 4 * 4 + 24
        struct.pack_into("<f", content, data_start(content) + 4 * (frame * a_frame + 4 * index + axis), value)

    return spoil


def both(*spoils: Spoil) -> Spoil:
    def spoil(content: bytearray) -> bytes | bytearray | None:
        for each in spoils:
            answer = each(content)
            content = content if answer is None else bytearray(answer)
        return content

    return spoil


def spoiled(spoil: Spoil) -> bytes:
    content = bytearray(GOOD)
    answer = spoil(content)
    return bytes(content if answer is None else answer)
