"""Cached results that several callers need of one object, kept as long as the object lives."""

import threading
import weakref
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Source = TypeVar("Source")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class _CachedResult(Generic[Result]):
    """Result of an owner, valid as long as the source has these ``terms``."""

    terms: object
    result: "Future[Result]"


class Shared(Generic[Source, Result]):
    """Callable that returns ``compute(source)``, computed once and kept while the owner of the source lives.

    Other threads that call it meanwhile wait for the result. Errors are not kept. The result must not refer to the
    owner, or neither is ever freed.
    """

    def __init__(
        self,
        compute: Callable[..., Result],
        owner: Callable[[Source], object] = lambda source: source,
        terms: Callable[[Source], object] = lambda source: None,
    ) -> None:
        """Set the function, and the functions that return the owner and the terms of a source.

        A result is kept for each owner as long as the terms are equal; a source with other terms replaces it.
        """
        self._compute, self._owner, self._terms = compute, owner, terms
        self._kept: dict[int, _CachedResult[Result]] = {}
        self._lock = threading.Lock()

    def __call__(self, source: Source, *known: Any) -> Result:
        """Result for ``source``, computed by ``compute(source, *known)`` if none is kept; an error of ``compute`` is
        raised.
        """
        owner, terms = self._owner(source), self._terms(source)
        key = id(owner)
        while True:
            with self._lock:
                kept = self._kept.get(key)
                own = kept is None or kept.terms != terms
                if kept is None:
                    weakref.finalize(owner, self._kept.pop, key, None).atexit = False
                if own:
                    kept = self._kept[key] = _CachedResult(terms, Future())
            assert kept is not None
            if own:
                return self._computed(source, key, kept, known)
            if kept.result.exception() is None:  # else who computed it gave up, or failed: try again
                return kept.result.result()

    def _computed(self, source: Source, key: int, kept: _CachedResult[Result], known: tuple[Any, ...]) -> Result:
        try:
            result = self._compute(source, *known)
        except BaseException as error:
            with self._lock:
                if self._kept.get(key) is kept:
                    del self._kept[key]
            kept.result.set_exception(error)
            raise
        kept.result.set_result(result)
        return result
