"""Kernels that cannot be cached on disk, for example because it is full, are compiled at each start, with a warning.

By itself numba would let an error of its cache end the call of the kernel, except for one error on Windows.
"""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import caching

_said: set[str] = set()


@contextmanager
def _report_errors(cache: caching.Cache) -> Iterator[None]:
    """Log the first error of each cache folder instead of raising it."""
    try:
        yield
    except OSError as error:
        if cache.cache_path not in _said:
            _said.add(cache.cache_path)
            logging.getLogger(__name__).warning(
                "Compiled kernels cannot be stored in %s: %s. They are compiled at each start.",
                cache.cache_path,
                error.strerror,
            )


caching.Cache._guard_against_spurious_io_errors = _report_errors  # type: ignore[method-assign, assignment]
