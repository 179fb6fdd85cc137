"""Handling of Ctrl-C while a library is loaded that would swallow it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def deferred_interrupt() -> Iterator[None]:
    """Context at whose end the KeyboardInterrupt of a Ctrl-C within its block is raised.

    Modules that load each other in C++ print such an exception, continue half loaded, and lose it.
    """
    if threading.current_thread() is not threading.main_thread():  # no other is interrupted
        yield
        return
    pressed = threading.Event()
    before = signal.signal(signal.SIGINT, lambda _signal, _frame: pressed.set())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed.is_set():
        raise KeyboardInterrupt
