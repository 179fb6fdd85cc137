"""Parameter section of a C3D file: named values by group, read without trusting any size in it.

Layout by the C3D user guide (c3d.org): records of a group or parameter, each with the offset of the next one.
"""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError

BLOCK_BYTES = 512
Value = tuple[str, ...] | NDArray[np.float64]
Order = Literal["Intel", "DEC", "MIPS"]

_PROCESSORS: dict[int, Order] = {84: "Intel", 85: "DEC", 86: "MIPS"}
_SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}
_MOST_RECORDS = 16384
_MOST_DIMENSIONS = 7


@dataclass(frozen=True)
class Numbers:
    """Number format of the machine that wrote the file."""

    order: Order

    def integers(self, content: bytes | memoryview) -> NDArray[np.int16]:
        """16-bit integers."""
        return np.frombuffer(content, ">i2" if self.order == "MIPS" else "<i2")

    def floats(self, content: bytes | memoryview) -> NDArray[np.float32]:
        """32-bit floats; those of DEC have their halves swapped and an exponent two larger."""
        if self.order != "DEC":
            return np.frombuffer(content, ">f4" if self.order == "MIPS" else "<f4")
        words = np.frombuffer(content, "<u2").reshape(-1, 2)
        swapped = (words[:, 0].astype(np.uint32) << 16) | words[:, 1]
        with np.errstate(invalid="ignore"):  # signalling NaN
            return np.asarray(swapped.view(np.float32) * np.float32(0.25))


@dataclass
class Parameters:
    """Parameters of a C3D file, by group and name in capitals.

    A value is an array of numbers (d1, d2, ...), the first index running fastest in the file, or a tuple of words.
    """

    numbers: Numbers
    groups: dict[str, dict[str, Value]] = field(default_factory=dict)
    repairs: list[str] = field(default_factory=list)

    def words(self, group: str, name: str) -> tuple[str, ...]:
        """Words of a parameter; none if it is missing or holds numbers."""
        value = self.groups.get(group, {}).get(name, ())
        return value if isinstance(value, tuple) else ()

    def array(self, group: str, name: str) -> NDArray[np.float64]:
        """Numbers of a parameter; none if it is missing or holds words."""
        value = self.groups.get(group, {}).get(name, ())
        return np.zeros(0) if isinstance(value, tuple) else value

    def columns(self, group: str, name: str, *shape: int) -> NDArray[np.float64]:
        """Numbers of a parameter as an array (*shape, N), whatever dimensions the file gives it; a remainder is
        dropped.
        """
        flat = self.array(group, name).ravel(order="F")
        size = math.prod(shape)
        count = len(flat) // size
        return flat[: size * count].reshape((*shape, count), order="F")

    def number(self, group: str, name: str) -> float | None:
        """First number of a parameter; None if it is missing or not finite."""
        value = self.array(group, name)
        return float(value.flat[0]) if value.size and np.isfinite(value.flat[0]) else None

    def continued_words(self, group: str, name: str) -> tuple[str, ...]:
        """Words of a parameter and of its continuations ``LABELS2``, ``LABELS3`` ..., for lists of more than 255."""
        found, place = self.words(group, name), 2
        while more := self.words(group, f"{name}{place}"):
            found, place = found + more, place + 1
        return found

    def continued_array(self, group: str, name: str) -> NDArray[np.float64]:
        """Numbers of a parameter and of its continuations ``NAME2``, ``NAME3`` ..., flat."""
        found, place = [self.array(group, name).ravel(order="F")], 2
        while (more := self.array(group, f"{name}{place}")).size:
            found.append(more.ravel(order="F"))
            place += 1
        return np.concatenate(found)


def read_parameters(name: str, content: bytes) -> Parameters:
    """Parameter section of the C3D file ``content``; raises StudioError with the byte at which it is damaged."""
    start = (content[0] - 1) * BLOCK_BYTES
    if content[0] < 2 or start + 4 > len(content):
        raise StudioError(
            f"{name}, byte 0: its parameters should begin in block {content[0]}, which is not in the file. "
            "It is damaged or cut off; export it again."
        )
    processor = content[start + 3]
    if processor not in _PROCESSORS:
        raise StudioError(
            f"{name}, byte {start + 3}: {processor} is not a kind of processor; C3D knows 84 (Intel), 85 (DEC) and "
            "86 (MIPS). It is damaged; export it again."
        )
    found = Parameters(Numbers(_PROCESSORS[processor]))
    _read_records(name, content, start, found)
    return found


def _read_records(name: str, content: bytes, start: int, found: Parameters) -> None:
    """Read records one after another; each must begin after the previous one, so that nothing is read twice."""
    at, names = start + 4, {}
    waiting: list[tuple[int, str, Value]] = []
    for _ in range(_MOST_RECORDS):
        if at + 2 > len(content) or content[at] == 0:
            break
        length, group = abs(_signed(content[at])), _signed(content[at + 1])
        title, body = at + 2, at + 2 + length + 2
        if body > len(content):
            raise _cut(name, at)
        label = _text(content[title : body - 2]).upper()
        step = int(found.numbers.integers(content[body - 2 : body])[0]) & 0xFFFF
        following = body - 2 + step
        if step and following < body + (1 if group < 0 else 2):
            raise StudioError(f"{name}, byte {at}: parameter '{label[:20]}' is part of a loop. Export it again.")
        if group < 0:
            names[-group] = label
        elif group > 0:
            end = min(following, len(content)) if step else len(content)
            waiting.append((group, label, _value(name, label, content, body, end, found)))
        if step == 0:
            break
        at = following
    for group, label, value in waiting:
        found.groups.setdefault(names.get(group, f"GROUP {group}"), {}).setdefault(label, value)


def _value(name: str, label: str, content: bytes, body: int, end: int, found: Parameters) -> Value:
    """Value of one parameter; anything that exceeds its record is left out and reported."""
    if body + 2 > end:
        raise _cut(name, body)
    kind, dimensions = _signed(content[body]), content[body + 1]
    start = body + 2 + dimensions
    shape = tuple(content[body + 2 : start])
    size = _SIZES.get(kind)
    count = math.prod(shape) if dimensions <= _MOST_DIMENSIONS else 0
    if size is None or dimensions > _MOST_DIMENSIONS or start > end or start + count * size > end:
        found.repairs.append(
            f"{name}, byte {body}: parameter '{label[:20]}' does not fit into the bytes it has and was left out."
        )
        return ()
    data = content[start : start + count * size]
    if kind == -1:
        return _words(data, shape)
    match kind:
        case 1:
            flat = np.frombuffer(data, np.uint8).astype(np.float64)
        case 2:
            flat = found.numbers.integers(data).astype(np.float64)
        case _:
            with np.errstate(invalid="ignore"):  # signalling NaN
                flat = found.numbers.floats(data).astype(np.float64)
    return flat.reshape(shape or (1,), order="F")


def _words(data: bytes, shape: tuple[int, ...]) -> tuple[str, ...]:
    if len(shape) < 2:
        return (_text(data),)
    length = shape[0]
    return tuple(_text(data[at : at + length]) for at in range(0, len(data), length)) if length else ()


def _text(data: bytes) -> str:
    """Words of a parameter without the blanks that pad them."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return "".join(letter for letter in text if letter.isprintable()).strip()


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _cut(name: str, at: int) -> StudioError:
    return StudioError(f"{name}, byte {at}: the file ends within its parameters. It is cut off; export it again.")
