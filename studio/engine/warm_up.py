"""Kernels are compiled or fetched from their cache in the background while the window opens."""

import sys
import threading
import time
from collections.abc import Callable
from importlib import import_module

KERNELS = "studio.core.kernels."
LOOKED_AT_EVERY = 0.1
LONG = 3.0
"""Seconds after which it is plain that the kernels are compiled and not fetched."""


class WarmUp:
    """Begins at once; whoever needs a kernel sooner waits for that one only. Join it before the process ends."""

    def __init__(self) -> None:
        # Imported on the thread: numba alone takes a third of a second, which the window need not wait for.
        self._thread = threading.Thread(
            target=lambda: import_module("studio.engine.first_run").run(), name="warm-up", daemon=True
        )
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether there is something left to do."""
        return self._thread.is_alive()

    def join(self) -> None:
        """Wait until all kernels are there."""
        self._thread.join()

    def follow(self, report: Callable[[float, str], None]) -> None:
        """Tell how far it is until it is done: a job for the ``TaskRunner``."""
        begun = time.monotonic()
        while self.running:
            report(ready_share(), "once, about a minute" if time.monotonic() - begun > LONG else "")
            time.sleep(LOOKED_AT_EVERY)


def ready_share() -> float:
    """The part of all loaded kernels that has been compiled or fetched."""
    modules = [module for name, module in sys.modules.copy().items() if name.startswith(KERNELS)]
    found = {id(item): item for module in modules for item in vars(module).values() if hasattr(item, "signatures")}
    return sum(bool(item.signatures) for item in found.values()) / max(len(found), 1)
