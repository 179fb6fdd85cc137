"""Arrays out of ``.npy`` and ``.npz`` files that anybody may have written: no header is believed, none is evaluated."""

import math
import re
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from studio.io.zipped import unpacked

Array = NDArray[Any]

_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '([^']{1,20})', 'fortran_order': (True|False), "
    rb"'shape': \(((?:[0-9]{1,12}, ?)*[0-9]{0,12})\), *\} *\n",
    re.DOTALL,
)


def array_of(content: bytes) -> Array:
    """A read-only array over the bytes of an ``.npy`` file. Raises ValueError when they are not one."""
    header = _HEADER.match(content)
    if header is None:
        raise ValueError("it is not a plain array")
    kind, fortran, sizes = (group.decode("ascii", "replace") for group in header.groups())
    if re.fullmatch(r"\|[biu]1|<[iuf][248]", kind) is None:
        raise ValueError(f"its numbers are '{kind}', which are not read")
    dtype = np.dtype(kind)
    shape = tuple(int(size) for size in sizes.split(",") if size.strip())
    if len(shape) > 8 or math.prod(shape) * dtype.itemsize != len(content) - header.end():
        raise ValueError("its header does not fit its content")
    order: Literal["F", "C"] = "F" if fortran == "True" else "C"
    return np.frombuffer(content, dtype, offset=header.end()).reshape(shape, order=order)


def arrays_of(content: bytes, most: int) -> dict[str, Array]:
    """The arrays of an ``.npz`` file by name, which unpack to ``most`` bytes together. Raises ValueError."""
    return {name.removesuffix(".npy"): array_of(member) for name, member in unpacked(content, most).items()}
