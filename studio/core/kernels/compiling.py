"""How kernels are compiled: once a machine, without Python's lock."""

from typing import Any

from studio.core.kernels.linked import compiled

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
