"""TRC files: three lines of header, a line of marker names, and a row for each frame; empty cells were not seen."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.subjects import with_subjects
from studio.core.markers.trial import MARKER_KIND, Trial
from studio.core.names import counted_noun, readable_name
from studio.io.markers.unit import unit_by_spelling
from studio.io.numbers import count_per_line, lines_of, number, table
from studio.io.referenced_files import read_bytes

FloatArray = NDArray[np.float64]

_LARGEST = 1 << 30
_KEYS_LINE, _VALUES_LINE, _NAMES_LINE, _AXES_LINE = 1, 2, 3, 4
_BEFORE = 2
"""Columns before the first marker: the frame's number and its time."""
_RATES = ("datarate", "camerarate", "origdatarate")
_COUNTS = "nummarkers", "numframes"
_FARTHEST = 1e6
"""Units beyond which a place is a mark for a gap."""


@dataclass(frozen=True)
class TrcFile:
    """Content of a TRC file, in its own unit and axes, and the repairs made while reading."""

    trial: Trial
    repairs: tuple[str, ...]


def read_trc(path: Path, progress: Callable[[float], object] = lambda share: None) -> TrcFile:
    """Content of the TRC file at ``path``. Raises StudioError with file, line and what to do if it is damaged."""
    name, repairs = path.name, list[str]()
    lines = lines_of(read_bytes(path, _LARGEST))
    if len(lines) <= _NAMES_LINE:
        raise StudioError(f"{name}, line {len(lines)}: the file ends within its header. It is cut off; copy it again.")
    said = _header(lines[_KEYS_LINE], lines[_VALUES_LINE])
    labels = _labels(name, lines[_NAMES_LINE], repairs)
    start = _first_row(lines)
    markers, frames = (int(text[:12]) if (text := said.get(key, "")).isdecimal() else 0 for key in _COUNTS)
    cells = _cells(name, lines[start:], start + 1, len(labels), frames, repairs, progress)
    points = cells[:, _BEFORE:].reshape(len(cells), len(labels), 3).copy()
    unseen = ~(np.abs(points) < _FARTHEST).all(axis=-1) | ~points.any(axis=-1)
    points[unseen] = np.nan
    if markers not in (0, len(labels)):
        repairs.append(
            f"{name}, line 3: the file says {counted_noun(markers, 'marker')}; with a name, and read: {len(labels)}."
        )
    if frames not in (0, len(points)):
        repairs.append(f"{name}, line 3: the file says {counted_noun(frames, 'frame')}; found and read: {len(points)}.")
    first = cells[0, 0]
    trial = Trial(
        name=readable_name(path.stem),
        source=name,
        labels=labels,
        kinds=(MARKER_KIND,) * len(labels),
        points=points,
        residuals=np.where(unseen, -1.0, 0.0),
        frame_rate=_frame_rate(name, said, cells[:, 1], repairs),
        first_frame=int(first) if np.isfinite(first) and first >= 0.0 else 1,
        unit=_unit(name, said.get("units", ""), repairs),
    )
    return TrcFile(trial, tuple(repairs))


def _header(keys: bytes, values: bytes) -> dict[str, str]:
    """Values of the third line by the keys of the second, in lower case."""
    words = [line.decode("utf-8", "replace").lower().split() for line in (keys, values)]
    return dict(zip(*words, strict=False))


def _labels(name: str, line: bytes, repairs: list[str]) -> tuple[str, ...]:
    """Unique name of each marker, written above the first of its three columns."""
    text = line.decode("utf-8-sig", "replace")
    words = [word.strip() for word in (text.split("\t") if "\t" in text else text.split())]
    found = [word for word in words[_BEFORE:] if word]
    if not found:
        raise StudioError(f"{name}, line {_NAMES_LINE + 1}: no marker has a name there. Export the file again.")
    labels: dict[str, None] = {}
    for word in found:
        label, count = word, 2
        while label in labels:
            label, count = f"{word}_{count}", count + 1
        if label != word:
            repairs.append(f"{name}, line {_NAMES_LINE + 1}: a second marker is called {word}; it was named {label}.")
        labels[label] = None
    return with_subjects(tuple(labels))


def _first_row(lines: list[bytes]) -> int:
    """First line of the rows, after that of the axes (X1 Y1 Z1) and blank ones."""
    start = _NAMES_LINE + 1
    while start < len(lines) and (not lines[start].strip() or lines[start].lstrip()[:1].isalpha()):
        start += 1
    return start


def _cells(
    name: str,
    rows: list[bytes],
    first_line: int,
    markers: int,
    promised: int,
    repairs: list[str],
    progress: Callable[[float], object],
) -> FloatArray:
    """Numbers (F, 2 + 3 P) of all rows, NaN in empty cells; a last row that is cut off is dropped and listed in
    ``repairs``.
    """
    width = _BEFORE + 3 * markers
    if any(b"," in row for row in rows):
        if any(b"." in row for row in rows):
            raise StudioError(f"{name}: its numbers have both points and commas. Export it with decimal points.")
        rows = [row.replace(b",", b".") for row in rows]
        repairs.append(f"{name}: its numbers have decimal commas; they were read as points.")
    tabbed = any(b"\t" in row for row in rows)
    plain, places = [], []
    for place, row in enumerate(rows):
        if not row.strip():
            continue
        plain.append(_filled(row, width) if tabbed else row)
        places.append(place)
    counts = count_per_line(plain)
    last = rows[-1].split(b"\t" if tabbed else None) if rows else []
    if b"".join(last).strip() and (len(plain) < promised or len(last) < width):  # no end of line, and too little
        repairs.append(f"{name}, line {first_line + places[-1]}: the last row is cut off and was dropped.")
        del plain[-1], places[-1]
        counts = counts[:-1]
    wrong = np.flatnonzero(counts != width)
    if len(wrong):
        line = first_line + places[wrong[0]]
        raise StudioError(
            f"{name}, line {line}: {counts[wrong[0]]} numbers stand here where {markers} markers need {width}. "
            "Correct that line or export the file again."
        )
    if not plain:
        raise StudioError(f"{name}, line {first_line}: there is no row with a frame. Export the file again.")
    whole = [b""] * len(rows)
    for place, row in zip(places, plain, strict=True):
        whole[place] = row
    return table(whole, count_per_line(whole), name, first_line, progress).reshape(-1, width)


def _filled(row: bytes, width: int) -> bytes:
    """Row of tab-separated cells in which empty and missing cells are filled with the word for NaN."""
    cells = [cell.strip() or b"nan" for cell in row.rstrip(b"\r\n").split(b"\t")]
    extra = cells[width:]
    cells = cells[:width] if all(cell == b"nan" for cell in extra) else cells
    return b" ".join([*cells, *([b"nan"] * (width - len(cells)) if len(cells) > _BEFORE else [])])


def _frame_rate(name: str, said: dict[str, str], times: FloatArray, repairs: list[str]) -> float:
    """Frame rate in Hz from the header, else from the column of times; raises StudioError."""
    for key in _RATES:
        word = said.get(key, "").replace(",", ".")
        try:
            rate = number(word, name)
        except StudioError:
            continue
        if 0.0 < rate < 1e5:
            return rate
    steps = np.diff(times[np.isfinite(times)])
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0.0:
        raise StudioError(
            f"{name}, line 3: neither DataRate nor the times of its rows say how fast it is. Add DataRate."
        )
    rate = round(1.0 / step, 3)
    repairs.append(f"{name}, line 3: it says no usable DataRate; by the times of its rows it is {rate:g} Hz.")
    return rate


def _unit(name: str, said: str, repairs: list[str]) -> str:
    unit = unit_by_spelling(said)
    if unit is None:
        repairs.append(f"{name}, line 3: Units is '{said[:20]}', which is not a known unit; taken as mm.")
    return unit or "mm"
