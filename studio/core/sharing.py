"""What is asked for twice at the same time is worked out once."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

Key = TypeVar("Key")
Result = TypeVar("Result")


class Shared(Generic[Key, Result]):
    """``compute(key)``; threads that ask for the same object while it is computed wait for that and share it.

    Nothing is kept afterwards.
    """

    def __init__(self, compute: Callable[[Key], Result]) -> None:
        self._compute = compute
        self._running: dict[int, Future[Result]] = {}
        self._lock = threading.Lock()

    def __call__(self, key: Key) -> Result:
        """The result for ``key``; raises what ``compute`` raises."""
        with self._lock:
            running = self._running.get(id(key))
            future = self._running.setdefault(id(key), Future())
        if running is None:
            try:
                future.set_result(self._compute(key))
            except BaseException as error:  # noqa: BLE001 - raised below, in every thread that asked
                future.set_exception(error)
            finally:
                with self._lock:
                    del self._running[id(key)]
        return future.result()
