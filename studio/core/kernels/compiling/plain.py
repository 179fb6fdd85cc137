"""Kernels by numba's public ways alone: for a numba whose inside nobody has tried ``linked`` and ``packed`` with.

The same poses, compiled in several times the work and solved at a half to a third of the speed.
"""

# mypy: allow-untyped-calls
# Numba says no types of its own.

from collections.abc import Callable
from typing import Any

from numba import njit

_OURS = "nopython", "_nrt"
"""Options that only ``linked`` takes, or that are as a matter of course."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """As ``linked.compiled``."""
    public = {name: value for name, value in options.items() if name not in _OURS}
    return lambda function: njit(cache=True, **public)(function)


@njit
def pack(values: Any) -> Any:
    """As ``packed.pack``: a tuple is handed on as numba does."""
    return values
