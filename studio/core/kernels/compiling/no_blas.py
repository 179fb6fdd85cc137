"""Disables numba's search for a BLAS before any kernel runs: loading SciPy's linear algebra takes a fifth of a second.

No kernel multiplies matrices by a BLAS.
"""

from importlib import import_module

from numba.np import linalg


def _none() -> None:
    raise ImportError


_asked = linalg.ensure_blas
linalg.ensure_blas = _none
try:
    import_module("numba.np.arraymath")  # asks while it is loaded
finally:
    linalg.ensure_blas = _asked
