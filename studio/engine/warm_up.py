"""Kernels are compiled or fetched from their cache in the background while the window opens."""

import threading
from importlib import import_module


def start_warm_up() -> threading.Thread:
    """Begin; whoever needs a kernel sooner waits for that one only. Join it before the process ends."""
    # Imported on the thread: numba alone takes a third of a second, which the window need not wait for.
    thread = threading.Thread(
        target=lambda: import_module("studio.engine.first_run").run(), name="warm-up", daemon=True
    )
    thread.start()
    return thread


def _run() -> None:
    import_module("studio.engine.first_run").run()
