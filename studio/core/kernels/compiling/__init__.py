"""Compilation of kernels: cached on disk, and free of Python's lock."""

from importlib import import_module
from typing import Any

import numba

SUPPORTED_NUMBA = "0.68."
"""Prefix of the numba versions whose internals kernels may use. Other versions are used by their public interface."""
USES_NUMBA_INTERNALS = numba.__version__.startswith(SUPPORTED_NUMBA)
if USES_NUMBA_INTERNALS:
    import_module("studio.core.kernels.compiling.no_blas")
    import_module("studio.core.kernels.compiling.uncached_kernels")
compiled: Any = import_module(
    f"studio.core.kernels.compiling.{'linked_kernels' if USES_NUMBA_INTERNALS else 'plain_numba'}"
).compiled
pack: Any = import_module(
    f"studio.core.kernels.compiling.{'packed_tuples' if USES_NUMBA_INTERNALS else 'plain_numba'}"
).pack
"""``pack(values)``: a tuple of arrays passed to other kernels as one address."""

_COUNTED: dict[str, Any] = {"nogil": True, "_nrt": True}
_UNCOUNTED: dict[str, Any] = {**_COUNTED, "_nrt": False}

kernel = compiled(**_UNCOUNTED, fastmath={"contract"})
"""Decorator of a kernel over arrays that its caller owns.

It counts no references, which makes nested kernels three times as fast; therefore it can neither allocate arrays nor
assign slices.
"""
allocating_kernel = compiled(**_COUNTED, fastmath={"contract"})
"""Decorator of a kernel that allocates arrays."""
summing_kernel = compiled(**_UNCOUNTED, fastmath={"reassoc", "contract"})
"""Decorator of a kernel whose sums may be taken in any order, several terms at once; NaN stays NaN."""
small_kernel = compiled(**_UNCOUNTED, fastmath={"contract"}, forceinline=True)
"""Decorator of a small kernel that is inlined: arrays and tuples among its arguments cost nothing."""
