"""How kernels are compiled: once a machine, without Python's lock."""

from numba import njit

kernel = njit(cache=True, nogil=True, _nrt=False)
"""A kernel over arrays that its caller owns. It counts no references to them, which makes kernels that call each other
three times as fast; so it can neither make arrays nor assign slices.
"""
allocating_kernel = njit(cache=True, nogil=True, _nrt=True)
"""A kernel that makes arrays of its own."""
summing_kernel = njit(cache=True, nogil=True, _nrt=False, fastmath={"reassoc", "contract"})
"""A kernel whose sums may be taken in any order, several terms at once; NaN stays NaN."""
