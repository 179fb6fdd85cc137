"""Caches of results computed from the motions, meshes and bodies of a project, emptied when it is closed."""

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from functools import _lru_cache_wrapper

Result = TypeVar("Result")

_caches: "list[_lru_cache_wrapper[Any]]" = []


def project_cache(maxsize: int) -> "Callable[[Callable[..., Result]], _lru_cache_wrapper[Result]]":
    """Decorator that caches the last ``maxsize`` results of a function until ``forget_project`` is called."""

    def cached(function: Callable[..., Result]) -> "_lru_cache_wrapper[Result]":
        cache = lru_cache(maxsize=maxsize)(function)
        _caches.append(cache)
        return cache

    return cached


def forget_project() -> None:
    """Empty all caches made by ``project_cache``; results are recomputed when needed."""
    for cache in _caches:
        cache.cache_clear()
