"""Printed output of verbs: tables for people, one JSON document for machines."""

import json
from collections.abc import Sequence

INTERRUPTED_EXIT_CODE = 130
"""Exit code of a verb that Ctrl-C ends, as for any tool that a signal ends."""


def print_json(value: object) -> None:
    """Print one JSON document on standard output, in ASCII, so that any terminal or pipe accepts it."""
    print(json.dumps(value, indent=1, allow_nan=False))


QUALITY_TITLES = {
    "slide_mm": "contact slide mm",
    "skate_mm": "foot slide mm",
    "float_mm": "float mm",
    "penetration_mm": "penetration mm",
    "acceleration_ratio": "acceleration ratio",
    "speed_ratio": "speed ratio",
}
"""Titles of the quality measures in tables, by their names in reports."""


def print_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print columns as wide as they need; the first is aligned left, the others right."""
    widths = [max(len(row[column]) for row in (titles, *rows)) for column in range(len(titles))]
    for row in (titles, ["-" * width for width in widths], *rows):
        cells = [
            cell.rjust(width) if index else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        print("  ".join(cells).rstrip())
