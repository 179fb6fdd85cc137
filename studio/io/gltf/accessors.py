"""Accessors: the typed arrays in the buffers of a glTF file, checked against the bytes of the file."""

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.gltf.container import GltfFile
from studio.io.json_record import Record

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_KINDS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_ABSURD = 1e12


class Accessors:
    """Arrays of one glTF file by index; each has the shape (count, width)."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._records = file.root.records("accessors")
        self._views = file.root.records("bufferViews")

    @property
    def count(self) -> int:
        """Number of accessors in the file."""
        return len(self._records)

    def numbers(self, index: int, width: int, missing: bool = False) -> FloatArray:
        """Finite numbers of an accessor, (count, ``width``); ``normalized`` integers become fractions of their largest.

        Missing numbers are NaN if ``missing`` is allowed, else StudioError is raised.
        """
        record = self._records[index]
        array = self._array(record, width)
        with np.errstate(invalid="ignore"):  # numbers that are none are refused below
            numbers = array.astype(np.float64)
        if record.flag("normalized") and array.dtype.kind in "iu":
            numbers = np.maximum(numbers / float(2 ** (8 * array.dtype.itemsize - (array.dtype.kind == "i")) - 1), -1.0)
        believable = np.isfinite(numbers) & (np.abs(numbers) <= _ABSURD)
        if missing:
            return np.where(believable, numbers, np.nan)
        if not believable.all():
            raise StudioError(f"{record.where}: it contains a number that is out of range. Export the file again.")
        return numbers

    def indices(self, index: int, width: int, below: int) -> IntArray:
        """Indices of an accessor, rows of ``width``, each in [0, ``below``). Raises StudioError otherwise."""
        record = self._records[index]
        array = self._array(record, width)
        if array.dtype.kind not in "iu":
            raise StudioError(f"{record.where}: it should hold whole numbers. Export the file again.")
        whole = array.astype(np.int64)
        if whole.size and not 0 <= whole.min() <= whole.max() < below:
            raise StudioError(
                f"{record.where}: it holds the index {whole.max() if whole.max() >= below else whole.min()}, and there"
                f" are only {below}. Export the file again."
            )
        return whole

    def view_bytes(self, index: int) -> bytes:
        """Bytes of a buffer view."""
        if not 0 <= index < len(self._views):
            raise StudioError(f"{self._file.path.name}: there is no bufferViews[{index}]. Export the file again.")
        view = self._views[index]
        buffer = view.index("buffer", len(self._file.buffers))
        if buffer is None:
            raise view.value_error("buffer", "the number of a buffer")
        start, length = view.whole("byteOffset", 0), view.whole("byteLength")
        content = self._file.buffers[buffer]
        if start + length > len(content):
            raise StudioError(
                f"{view.where}: it ends at byte {start + length} of a buffer of {len(content)}. Export the file again."
            )
        return content[start : start + length]

    def _array(self, record: Record, width: int) -> NDArray[np.generic]:
        if _WIDTHS.get(record.text("type")) != width:
            raise record.value_error("type", next(name for name, many in _WIDTHS.items() if many == width))
        count = record.whole("count")
        if count > max(self._file.size, 1):
            raise StudioError(f"{record.where}: it claims {count} entries, more than the file has bytes.")
        kind = self._kind(record)
        if "bufferView" in record:
            array = self._plain(record, kind, count, width)
        else:
            array = np.zeros((count, width), kind)
        if "sparse" in record:
            array = self._sparse(record, array.copy())
        return array

    def _kind(self, record: Record) -> np.dtype[np.generic]:
        code = record.whole("componentType")
        if code not in _KINDS:
            raise record.value_error("componentType", f"one of {', '.join(map(str, _KINDS))}")
        return np.dtype(_KINDS[code]).newbyteorder("<")

    def _plain(self, record: Record, kind: np.dtype[np.generic], count: int, width: int) -> NDArray[np.generic]:
        view = record.whole("bufferView")
        content = self.view_bytes(view)
        size = kind.itemsize * width
        stride = self._views[view].whole("byteStride", size) or size
        start = record.whole("byteOffset", 0)
        if stride < size or (count and start + stride * (count - 1) + size > len(content)):
            raise StudioError(
                f"{record.where}: its {count} entries end after its {len(content)} bytes. Export the file again."
            )
        array: NDArray[np.generic] = np.ndarray((count, width), kind, content, start, (stride, kind.itemsize))
        return array

    def _sparse(self, record: Record, array: NDArray[np.generic]) -> NDArray[np.generic]:
        sparse = record.inner("sparse")
        count = sparse.whole("count")
        places, values = sparse.inner("indices"), sparse.inner("values")
        if count > len(array):
            raise StudioError(f"{record.where}: it replaces {count} of {len(array)} entries. Export the file again.")
        at = self._plain(places, self._kind(places), count, 1)[:, 0].astype(np.int64)
        if count and not 0 <= at.min() <= at.max() < len(array):
            raise StudioError(f"{record.where}: it replaces an entry that is not there. Export the file again.")
        array[at] = self._plain(values, array.dtype, count, array.shape[1])
        return array
