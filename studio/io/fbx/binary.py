"""Binary FBX 7.4 as a tree of elements with values and, in blocks, inner elements.

An element is the offset of its end, the number and size of its values, its name, its values, and the inner elements,
ended by an empty element. A value is one letter for its type and its bytes; arrays may be deflated.
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError


class Int64(int):
    """Integer of eight bytes, for times and the ids of objects."""


Value = bool | int | float | str | bytes | NDArray[Any]

FBX_VERSION = 7400
FILE_ID = bytes.fromhex("28b32aebb624ccc2bfc8b02aa92bfcf1")
CREATION_TIME = "1970-01-01 10:00:00:000"
"""Moment that ``FILE_ID`` encodes; it is the same in every file, so that equal motions give equal files."""

_HEAD = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", FBX_VERSION)
_FOOT_ID = bytes.fromhex("fabcab09d0c8d466b176fb831cf7267e")
_FOOT_END = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
_END = bytes(13)
"""The empty element behind the last one of a block."""
_DEFLATED_FROM = 128
"""Bytes from which an array is worth deflating."""
_LETTERS = {"int32": b"i", "int64": b"l", "float32": b"f", "float64": b"d"}


@dataclass(frozen=True, eq=False)
class FbxElement:
    """Element of an FBX file: name, values and children; ``children`` is None for an element that is no block."""

    name: str
    values: tuple[Value, ...] = ()
    children: Sequence["FbxElement"] | None = None


def element(name: str, *values: Value) -> FbxElement:
    """Element without a block."""
    return FbxElement(name, values)


def block(name: str, *values: Value, children: Sequence[FbxElement] = ()) -> FbxElement:
    """Element with a block of ``children``."""
    return FbxElement(name, values, children)


def encode_document(elements: Sequence[FbxElement]) -> Iterator[bytes]:
    """Bytes of a whole file, one piece for each element. Raises StudioError if it exceeds 4 GB."""
    yield _HEAD
    end = len(_HEAD)
    for each in elements:
        piece = _encoded(each, end)
        end += len(piece)
        yield piece
    end += len(_END) + len(_FOOT_ID)
    yield _END + _FOOT_ID + bytes(-end % 16) + bytes(4) + struct.pack("<I", FBX_VERSION) + bytes(120) + _FOOT_END


def _encoded(item: FbxElement, begin: int) -> bytes:
    """Bytes of an element that begins at byte ``begin`` of the file."""
    name, values = item.name.encode(), b"".join(map(_value, item.values))
    content = [name, values]
    end = begin + len(_END) + len(name) + len(values)
    if item.children is not None:
        for child in item.children:
            content.append(_encoded(child, end))
            end += len(content[-1])
        content.append(_END)
        end += len(_END)
    try:
        head = struct.pack("<IIIB", end, len(item.values), len(values), len(name))
    except struct.error as error:
        raise StudioError("An FBX file holds at most 4 GB. Export fewer frames or fewer characters.") from error
    return b"".join([head, *content])


def _value(value: Value) -> bytes:
    match value:
        case bool():
            return struct.pack("<cB", b"C", value)
        case Int64():
            return struct.pack("<cq", b"L", value)
        case int():
            return struct.pack("<ci", b"I", value)
        case float():
            return struct.pack("<cd", b"D", value)
        case str():
            text = value.encode()
            return struct.pack("<cI", b"S", len(text)) + text
        case bytes():
            return struct.pack("<cI", b"R", len(value)) + value
        case _:
            return _array(value)


def _array(array: NDArray[Any]) -> bytes:
    content = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
    is_deflated = len(content) >= _DEFLATED_FROM
    stored = zlib.compress(content, 1) if is_deflated else content
    return struct.pack("<cIII", _LETTERS[array.dtype.name], array.size, is_deflated, len(stored)) + stored
