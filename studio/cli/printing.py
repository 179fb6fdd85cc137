"""What verbs print: tables for people, one JSON document for machines, progress beside both."""

import json
import sys
from collections.abc import Callable, Sequence

Progress = Callable[[float, str], None]
STOPPED = 130
"""Exit code of a verb that Ctrl-C ends, as of any tool that a signal ends."""


def print_json(value: object) -> None:
    """The one document on standard output, in ASCII, so that no terminal or pipe can refuse a letter of it."""
    print(json.dumps(value, indent=1, allow_nan=False))


def print_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Columns as wide as they need; the first stands left, the others right."""
    widths = [max(len(row[column]) for row in (titles, *rows)) for column in range(len(titles))]
    for row in (titles, ["-" * width for width in widths], *rows):
        cells = [
            cell.rjust(width) if place else cell.ljust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        print("  ".join(cells).rstrip())


def counted(number: int, thing: str) -> str:
    """``1 character``, ``3 characters``."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def progress_line() -> Progress:
    """Shows a share and a text on standard error, in place on a terminal, else a line every quarter."""
    told = [-1]

    def report(share: float, text: str) -> None:
        if sys.stderr.isatty():
            print(f"\r{share:4.0%} {text}\033[K", end="\n" if share >= 1.0 else "", file=sys.stderr, flush=True)
        elif int(4 * share) > told[0]:
            told[0] = int(4 * share)
            print(f"{share:4.0%} {text}", file=sys.stderr)

    return report
