"""Kernels compiled by numba's public interface, for numba versions with unknown internals."""

# mypy: allow-untyped-calls
# Numba says no types of its own.

from collections.abc import Callable
from typing import Any

from numba import njit

_OURS = "nopython", "_nrt"
"""Options that only kernels linked by ``KernelPart`` have, or that ``njit`` implies."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Decorator that compiles a function with ``numba.njit`` and caches it on disk; options of linked kernels are
    dropped.
    """
    public = {name: value for name, value in options.items() if name not in _OURS}
    return lambda function: njit(cache=True, **public)(function)


@njit
def pack(values: Any) -> Any:
    """``values`` unchanged: the counterpart of ``packed.pack`` for numba versions whose tuples cannot be packed."""
    return values
