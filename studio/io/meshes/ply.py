"""PLY, as text or binary: a header that describes the data, vertices, and faces as lists of them."""

import struct
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.triangle_mesh import MOST_TRIANGLES
from studio.io.meshes.triangles import Corners, MeshError, Points, Triangles, checked_index

_TYPES = {
    "char": "b",
    "uchar": "B",
    "short": "h",
    "ushort": "H",
    "int": "i",
    "uint": "I",
    "float": "f",
    "double": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "float32": "f",
    "float64": "d",
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_HEADER = 1 << 16
_LISTS = ("vertex_indices", "vertex_index")


@dataclass
class Element:
    """Declaration of ``count`` rows of ``properties``, each a name and its type; a list has the types of its length and
    items.
    """

    name: str
    count: int
    properties: list[tuple[str, tuple[str, ...]]] = field(default_factory=list)

    @property
    def is_plain(self) -> bool:
        """True if no property is a list."""
        return all(len(types) == 1 for _, types in self.properties)


def read_ply(content: bytes) -> tuple[Points, Triangles]:
    """Points (V, 3) and triangles (T, 3). Raises MeshError."""
    order, elements, start = _header(content)
    body = _TextNumbers(content[start:]) if order == "" else _BinaryNumbers(content, start, order)
    points, corners = np.zeros((0, 3)), Corners()
    for element in elements:
        if element.count > body.most_rows:
            raise MeshError(
                f"it says that it has {element.count} of '{element.name}', more than there is: it is cut off"
            )
        if not element.is_plain and element.count > MOST_TRIANGLES:
            raise MeshError(f"it has more than {MOST_TRIANGLES} of '{element.name}'. Reduce it first")
        if element.name == "vertex" and element.is_plain:
            points = _places(element, body.table(element))
        elif element.name == "face":
            _add_faces(element, body, corners)
        elif element.is_plain:
            body.table(element)
        else:
            for _ in range(element.count):
                body.row(element)
    return points, corners.triangles


def _header(content: bytes) -> tuple[str, list[Element], int]:
    """Byte order ("" for text), elements, and the offset of the data."""
    end = content.find(b"end_header", 0, _LONGEST_HEADER)
    start = content.find(b"\n", end) + 1
    if not content.startswith(b"ply") or end < 0 or start == 0:
        raise MeshError("it has no PLY header")
    order, elements = None, list[Element]()
    for line in content[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", kind, *_] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 16:
                elements.append(Element(name, int(count)))
            case ["property", "list", length, item, name] if elements and {length, item} <= _TYPES.keys():
                elements[-1].properties.append((name, (_TYPES[length], _TYPES[item])))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, (_TYPES[kind],)))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise MeshError(f"its header has '{line[:40]}', which cannot be read")
    if order is None:
        raise MeshError("its header does not name a format")
    if any(not element.properties for element in elements):
        raise MeshError("its header has an element without a property")
    return order, elements, start


def _places(element: Element, table: NDArray[np.float64]) -> Points:
    names = [name for name, _ in element.properties]
    if not {"x", "y", "z"} <= set(names):
        raise MeshError("its vertices have no x, y and z")
    return table[:, [names.index(axis) for axis in "xyz"]]


def _add_faces(element: Element, body: "_TextNumbers | _BinaryNumbers", corners: Corners) -> None:
    names = [name for name, _ in element.properties]
    place = next((names.index(name) for name in _LISTS if name in names), None)
    for _ in range(element.count):
        row = body.row(element)
        if place is not None:
            corners.add([checked_index(value) for value in row[place]])


class _TextNumbers:
    """Reader of numbers in text form."""

    def __init__(self, content: bytes) -> None:
        try:
            self._numbers = array("d", map(float, content.split()))
        except ValueError as error:
            raise MeshError(f"it holds something that is not a number ({error})") from error
        self._at = 0

    @property
    def most_rows(self) -> int:
        """Maximum number of rows that can remain: a row has at least one number."""
        return len(self._numbers) - self._at

    def table(self, element: Element) -> NDArray[np.float64]:
        """Values (count, properties) of an element without lists."""
        taken = self._take(element.count * len(element.properties))
        return np.array(taken).reshape(element.count, len(element.properties))

    def row(self, element: Element) -> list[Sequence[float]]:
        """Values of each property of the next row."""
        return [
            self._take(1 if len(types) == 1 else checked_index(self._take(1)[0])) for _, types in element.properties
        ]

    def _take(self, count: int) -> Sequence[float]:
        begin, self._at = self._at, self._at + count
        if count < 0 or self._at > len(self._numbers):
            raise MeshError("it is cut off")
        return self._numbers[begin : self._at]


class _BinaryNumbers:
    """Reader of numbers in binary form."""

    def __init__(self, content: bytes, start: int, order: str) -> None:
        self._content, self._at, self._order = content, start, order

    @property
    def most_rows(self) -> int:
        """Maximum number of rows that can remain: a row has at least one byte."""
        return len(self._content) - self._at

    def table(self, element: Element) -> NDArray[np.float64]:
        """Values (count, properties) of an element without lists."""
        kind = np.dtype([(str(index), self._order + types[0]) for index, (_, types) in enumerate(element.properties)])
        begin = self._move(element.count * kind.itemsize)
        rows = np.frombuffer(self._content, kind, element.count, begin)
        return np.stack([rows[name].astype(np.float64) for name in kind.names or ()], axis=1)

    def row(self, element: Element) -> list[Sequence[float]]:
        """Values of each property of the next row."""
        values: list[Sequence[float]] = []
        for _, types in element.properties:
            count = 1 if len(types) == 1 else checked_index(self._take(1, types[0])[0])
            values.append(self._take(count, types[-1]))
        return values

    def _take(self, count: int, kind: str) -> tuple[float, ...]:
        if count < 0:
            raise MeshError("a list has fewer than zero items")
        begin = self._move(count * struct.calcsize(f"={kind}"))
        return struct.unpack_from(f"{self._order}{count}{kind}", self._content, begin)

    def _move(self, size: int) -> int:
        begin, self._at = self._at, self._at + size
        if self._at > len(self._content):
            raise MeshError("it is cut off")
        return begin
