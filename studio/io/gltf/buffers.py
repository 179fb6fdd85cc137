"""Binary data of a glTF file to write: arrays in succession, with their views and accessors."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

ARRAY_BUFFER_TARGET, ELEMENT_BUFFER_TARGET = 34962, 34963
"""Targets of buffer views for a graphics card: ARRAY_BUFFER and ELEMENT_ARRAY_BUFFER."""
_COMPONENTS = {np.dtype("u1"): 5121, np.dtype("<u2"): 5123, np.dtype("<u4"): 5125, np.dtype("<f4"): 5126}
_TYPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


class Buffers:
    """Binary data that grow by ``add``; finally ``views``, ``accessors`` and ``content`` are those of the file."""

    def __init__(self) -> None:
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.content = bytearray()

    def add(self, array: NDArray[Any], kind: str, target: int | None = None, *, bounds: bool = False) -> int:
        """Add ``array`` (count, ...), stored as ``kind`` (``f4``, ``u2`` ...), and return its accessor; ``bounds`` adds
        its range.
        """
        stored = np.ascontiguousarray(array, dtype=np.dtype(kind).newbyteorder("<"))
        view = self.add_bytes(stored.tobytes())
        if target is not None:
            self.views[view]["target"] = target
        accessor = {
            "bufferView": view,
            "componentType": _COMPONENTS[stored.dtype],
            "count": len(stored),
            "type": _TYPES[stored.shape[1:]],
        }
        if bounds:
            accessor |= {"min": np.atleast_1d(stored.min(0)).tolist(), "max": np.atleast_1d(stored.max(0)).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def add_bytes(self, content: bytes) -> int:
        """Add ``content`` unchanged, at a multiple of four bytes, and return its view."""
        self.content += b"\0" * (-len(self.content) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.content), "byteLength": len(content)})
        self.content += content
        return len(self.views) - 1
