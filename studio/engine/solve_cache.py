"""Cache of costly results, each computed from one immutable value and kept while that value is in use."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

Key = TypeVar("Key")
Result = TypeVar("Result")


class _Slot(Generic[Key, Result]):
    def __init__(self, key: Key) -> None:
        self.key = key
        self.lock = threading.Lock()
        self.results: list[Result] = []


class SolveCache(Generic[Key, Result]):
    """Cache of ``compute(key)`` by the identity of ``key``; threads that ask for the same key share one
    computation.

    The ``size`` most recently used keys are kept. Exceptions are not cached.
    """

    def __init__(self, compute: Callable[[Key], Result], size: int = 32) -> None:
        self._compute, self._size = compute, size
        self._slots: OrderedDict[int, _Slot[Key, Result]] = OrderedDict()
        self._lock = threading.Lock()

    def is_cached(self, key: Key) -> bool:
        """True if the result for ``key`` is cached."""
        slot = self._slots.get(id(key))
        return slot is not None and bool(slot.results)

    def __call__(self, key: Key) -> Result:
        """Result for ``key``. Raises the exceptions of ``compute``."""
        with self._lock:
            slot = self._slots.setdefault(id(key), _Slot(key))
            self._slots.move_to_end(id(key))
            while len(self._slots) > self._size:
                self._slots.popitem(last=False)
        with slot.lock:
            if not slot.results:
                slot.results.append(self._compute(key))
            return slot.results[0]

    def retain_only(self, keys: Iterable[Key]) -> None:
        """Drop the results of all other keys."""
        kept = {id(each) for each in keys}
        with self._lock:
            for other in self._slots.keys() - kept:
                del self._slots[other]
