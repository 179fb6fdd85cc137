"""Kernels by numba's public interface: for a numba version with unknown internals."""

# mypy: allow-untyped-calls
# Numba says no types of its own.

from collections.abc import Callable
from typing import Any

from numba import njit

_OURS = "nopython", "_nrt"
"""Options that only ``linked`` takes, or that are as a matter of course."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Decorator like ``linked.compiled``."""
    public = {name: value for name, value in options.items() if name not in _OURS}
    return lambda function: njit(cache=True, **public)(function)


@njit
def pack(values: Any) -> Any:
    """``values`` unchanged: the counterpart of ``packed.pack`` for numba versions whose tuples cannot be packed."""
    return values
