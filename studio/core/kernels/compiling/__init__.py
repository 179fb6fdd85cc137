"""How kernels are compiled: once a machine, without Python's lock."""

from importlib import import_module
from typing import Any

import numba

TRIED = "0.68."
"""How versions of numba begin whose inside is known: any other is used by its public ways."""
KNOWN = numba.__version__.startswith(TRIED)
if KNOWN:
    import_module("studio.core.kernels.compiling.no_blas")
compiled: Any = import_module(f"studio.core.kernels.compiling.{'linked' if KNOWN else 'plain'}").compiled
pack: Any = import_module(f"studio.core.kernels.compiling.{'packed' if KNOWN else 'plain'}").pack
"""``pack(values)``: a tuple of arrays, handed on to other kernels as one address."""

_COUNTED: dict[str, Any] = {"nogil": True, "_nrt": True}
_UNCOUNTED: dict[str, Any] = {**_COUNTED, "_nrt": False}

kernel = compiled(**_UNCOUNTED, fastmath={"contract"})
"""A kernel over arrays that its caller owns. It counts no references to them, which makes kernels that call each other
three times as fast; so it can neither make arrays nor assign slices.
"""
allocating_kernel = compiled(**_COUNTED, fastmath={"contract"})
"""A kernel that makes arrays of its own."""
summing_kernel = compiled(**_UNCOUNTED, fastmath={"reassoc", "contract"})
"""A kernel whose sums may be taken in any order, several terms at once; NaN stays NaN."""
small_kernel = compiled(**_UNCOUNTED, fastmath={"contract"}, forceinline=True)
"""A small kernel that is put in where it is called: arrays and tuples among its arguments cost nothing there."""
