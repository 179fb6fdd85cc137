"""Seconds that tests wait for work beside them: only a hang ends it, on however slow a machine."""

import time
from collections.abc import Callable

SECONDS = 300.0
PATIENCE = 300_000
"""The same in milliseconds, as Qt counts."""


def eventually(test: Callable[[], object]) -> bool:
    """True as soon as ``test`` holds, False after all patience."""
    until = time.monotonic() + SECONDS
    while not test():
        if time.monotonic() > until:
            return False
        time.sleep(0.005)
    return True
