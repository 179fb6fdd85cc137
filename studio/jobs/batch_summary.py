"""Summary of a batch: a table for other programs, and a page of plots for people."""

import csv
from collections.abc import Sequence
from html import escape
from io import StringIO
from pathlib import Path
from typing import Any

from studio.core.names import counted_noun
from studio.io.atomic_write import write_text
from studio.io.json_text import JsonObject

Row = JsonObject

SUMMARY_TABLE_FILE, SUMMARY_PAGE_FILE = "summary.csv", "summary.html"
"""Names of the files of the table and of the page."""
SUMMARY_COLUMNS = (
    *("capture", "character", "file", "frames", "frame_rate", "slide_mm", "skate_mm", "float_mm", "penetration_mm"),
    *("residual_mm", "residual_deg", "targets", "reached", "microseconds_per_frame", "seconds", "error"),
)
SUMMARY_PLOTS = (
    ("Contact sliding", "mm", "slide_mm"),
    ("Penetration of the ground", "mm", "penetration_mm"),
    ("Worst position error", "mm", "residual_mm"),
    ("Worst angle error", "°", "residual_deg"),
    ("Solver time per frame", "µs", "microseconds_per_frame"),
)
"""Plots of the page: title, unit, and column of the table."""
CHART_COLOURS = ("#4f8fba", "#d98e3f", "#6a9f58", "#b65c7a", "#8a77b5", "#55a9a4", "#a68a5b", "#888888")
CHART_WIDTH, CHART_HEIGHT, CHART_LEFT, CHART_BOTTOM = 900, 220, 60, 30
LEAST_AXIS_TOP = 0.1
"""Least top value of an axis, in the unit of the plot; smaller differences do not matter."""
SUMMARY_STYLE = (
    "body{font:14px sans-serif;margin:2em;color:#222}table{border-collapse:collapse}td{padding:2px 12px 2px 0}"
)


def summary_rows(records: Sequence[JsonObject]) -> list[Row]:
    """Row for each capture and character; a capture that failed has one row with the error."""
    return [row for record in records for row in _rows(record)]


def write_summary(folder: Path, records: Sequence[JsonObject]) -> None:
    """Write ``summary.csv`` and ``summary.html`` into ``folder``. Raises StudioError if they cannot be written."""
    rows = summary_rows(records)
    write_rows(folder / SUMMARY_TABLE_FILE, rows)
    write_text(folder / SUMMARY_PAGE_FILE, _page(records, rows))


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as CSV with a line of titles. Raises StudioError if they cannot be written."""
    table = StringIO()
    writer = csv.DictWriter(table, SUMMARY_COLUMNS)
    writer.writeheader()
    writer.writerows(rows)
    write_text(path, table.getvalue())


def _rows(record: JsonObject) -> list[Row]:
    shared = {"capture": record["name"], "error": record.get("error"), "seconds": record.get("seconds")}
    shared |= {key: record.get(key) for key in ("frames", "frame_rate")}
    rows = []
    for each in record["characters"] or [{}]:
        targets = [target for target in each.get("constraints", ()) if target["reached"] is not None]
        row = shared | {"character": each.get("name"), "targets": len(targets)}
        row["reached"] = sum(target["reached"] for target in targets)
        for unit in ("residual_mm", "residual_deg"):
            row[unit] = max((target[unit] for target in targets if target[unit] is not None), default=None)
        rows.append({column: _short(row.get(column, each.get(column))) for column in SUMMARY_COLUMNS})
    return rows


def _short(value: Any) -> Any:
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _page(records: Sequence[JsonObject], rows: Sequence[Row]) -> str:
    failed = [record for record in records if "error" in record]
    names = list(dict.fromkeys(row["character"] for row in rows if row["character"]))
    colours = {name: CHART_COLOURS[index % len(CHART_COLOURS)] for index, name in enumerate(names)}
    legend = " ".join(f'<b style="color:{colour}">● {escape(name)}</b>' for name, colour in colours.items())
    plots = "".join(_plot(title, unit, column, rows, colours) for title, unit, column in SUMMARY_PLOTS)
    errors = "".join(f"<tr><td>{escape(each['name'])}<td>{escape(each['error'])}" for each in failed)
    return (
        f'<!doctype html><meta charset="utf-8"><title>Batch</title><style>{SUMMARY_STYLE}</style>'
        f"<h1>{counted_noun(len(records), 'capture')}, {len(failed)} failed</h1><p>Captures from left to right, a dot"
        f" for each character; point at one for its name. {legend}{plots}"
        + (f"<h2>Failed</h2><table>{errors}</table>" if failed else "")
    )


def _plot(title: str, unit: str, column: str, rows: Sequence[Row], colours: dict[str, str]) -> str:
    """HTML of a plot with one dot for each row, the captures side by side; empty if no row has a value."""
    captures = {name: index for index, name in enumerate(dict.fromkeys(row["capture"] for row in rows))}
    values = [(row, float(row[column])) for row in rows if row[column] is not None]
    if not values:
        return ""
    most = max(LEAST_AXIS_TOP, *(value for _, value in values))
    wide, high = CHART_WIDTH - CHART_LEFT - 10, CHART_HEIGHT - CHART_BOTTOM - 10
    dots = "".join(
        f'<circle cx="{CHART_LEFT + wide * (captures[row["capture"]] + 0.5) / len(captures):.1f}"'
        f' cy="{10 + high * (1.0 - value / most):.1f}" r="3.5" fill="{colours[row["character"]]}" fill-opacity="0.8">'
        f"<title>{escape(row['capture'])}, {escape(row['character'])}: {value:.3g} {unit}</title></circle>"
        for row, value in values
    )
    lines = "".join(
        f'<path d="M{CHART_LEFT} {10 + high * (1 - share):.0f}H{CHART_WIDTH - 10}" stroke="#ddd"/>'
        f'<text x="{CHART_LEFT - 6}" y="{14 + high * (1 - share):.0f}" text-anchor="end" font-size="11">'
        f"{most * share:.3g}</text>"
        for share in (0.0, 0.5, 1.0)
    )
    return f'<h2>{title}, {unit}</h2><svg width="{CHART_WIDTH}" height="{CHART_HEIGHT}" role="img">{lines}{dots}</svg>'
