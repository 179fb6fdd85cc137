"""Progress of long work, printed on standard error."""

import sys
from collections.abc import Callable

Progress = Callable[[float, str], None]
"""Callback for the fraction that is done, 0 to 1, and a text."""


def progress_line() -> Progress:
    """Callback that prints a progress line on standard error: rewritten in place on a terminal, else a new line every
    quarter.
    """
    last_quarter = -1

    def show(fraction: float, text: str) -> None:
        nonlocal last_quarter
        if sys.stderr.isatty():
            print(f"\r{fraction:4.0%} {text}\033[K", end="\n" if fraction >= 1.0 else "", file=sys.stderr, flush=True)
        elif int(4 * fraction) > last_quarter:
            last_quarter = int(4 * fraction)
            print(f"{fraction:4.0%} {text}", file=sys.stderr)

    return show
