"""Kernels are compiled or fetched from their cache in the background while the window opens."""

import threading

from studio.core import kernels


def start_warm_up() -> threading.Thread:
    """Begin; whoever needs a kernel sooner waits for that one only. Join it before the process ends."""
    thread = threading.Thread(target=getattr(kernels, "warm_up", lambda: None), name="warm-up", daemon=True)
    thread.start()
    return thread
