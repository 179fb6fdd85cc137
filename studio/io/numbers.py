"""Strict parsing of numbers: words that are not plain decimal numbers are refused with their line.

Programs write a missing value as a word (``nan``, ``1.#IND``, ``null``); tables may contain it, as NaN.
"""

import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.threads import run_in_threads

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+", re.ASCII)
_MISSING = re.compile(
    r"[+-]?(nan(\(\w*\))?|inf(inity)?|(1[.,]?)?#[a-z]+\d*)|\(?null\)?|none|#?n/?a|undefined|missing|-{1,3}|\?|\*",
    re.ASCII | re.IGNORECASE,
)
"""Words for a value that a program did not have."""
_GLUED = re.compile(r"(?<=[\d.])(?=[-+][\d.])", re.ASCII)
"""Seam of a number and a signed one without a blank: ``0.0-7.5``, not ``1e-5``."""
_ALLOWED = b"0123456789+-.eE \t\r\n\f\v"
_ABSURD = 1e12
_PIECE = 1 << 18
"""Bytes parsed at a time: a few milliseconds."""


def number(text: str, where: str) -> float:
    """Number in ``text``; ``where`` (``walk.bvh, line 12``) begins the sentence of the error."""
    if not _NUMBER.fullmatch(text):
        raise not_a_number(text, where)
    value = float(text)
    if abs(value) > _ABSURD:
        raise StudioError(f"{where}: {_shown(text)} is out of range. Export the file again.")
    return value


def separated_numbers(line: str) -> str:
    """Line with a blank inserted before every signed number that directly follows another one."""
    return _GLUED.sub(" ", line)


def separated_decimals(line: str) -> str:
    """Line with a blank inserted after every number, if all have as many decimals as the last one; else unchanged."""
    words = re.findall(rf"[+-]?\d*\.\d{{{len(line.rstrip().rpartition('.')[2])}}}", line, re.ASCII)
    return " ".join(words) if "".join(words) == "".join(line.split()) else line


def glued_words(name: str, lines: list[int]) -> list[str]:
    """Sentence about the separation of glued numbers in ``lines``, in a list; empty if there were none."""
    if not lines:
        return []
    more = f", as on {len(lines) - 1} more lines" if len(lines) > 1 else ""
    return [f"{name}, line {lines[0]}: numbers stand there without a blank{more}; they were parted."]


def filled_in_time(course: NDArray[np.float64], period: float | None = None) -> NDArray[np.float64]:
    """``course`` (F,) with NaN interpolated in time, angles along the shorter arc.

    ``period`` is a whole turn in the unit of ``course`` if it is an angle. At least one value must be known.
    """
    known = np.isfinite(course)
    frames = np.arange(len(course))
    told = course[known] if period is None else np.unwrap(course[known], period=period)
    return np.where(known, course, np.interp(frames, frames[known], told))


def not_a_number(text: str, where: str) -> StudioError:
    """Error for a word that should have been a number."""
    if _DECIMAL_COMMA.fullmatch(text):
        hint = "Commas seem to be decimals: export the file again with decimal points."
    else:
        hint = "Correct that line or export the file again."
    return StudioError(f"{where}: {_shown(text)} is not a number. {hint}")


def lines_of(content: bytes, start: int = 0) -> list[bytes]:
    """Lines of ``content`` from byte ``start`` on, without their line ends; an empty one more if the last has a line
    end.

    The content is split in pieces, so that other threads are never blocked for long.
    """
    ended = content.endswith((b"\n", b"\r")) or start >= len(content)
    end = b"\n" if content.find(b"\n", start) >= 0 else b"\r"
    lines: list[bytes] = []
    while start < len(content):
        cut = content.find(end, start + _PIECE) + 1 or len(content)
        lines += content[start:cut].splitlines()
        start = cut
    return [*lines, b""] if ended else lines


def count_per_line(lines: list[bytes]) -> NDArray[np.int64]:
    """Number of words in each line."""
    from studio.core.kernels.decimals import count_words  # late: it loads numba

    counts = np.zeros(len(lines), dtype=np.int64)
    step = _lines_a_piece(lines)

    def count(start: int) -> None:
        count_words(_as_bytes(b"\n".join(lines[start : start + step])), counts[start : start + step])

    for _ in run_in_threads(count, range(0, len(lines), step)):
        pass
    return counts


def table(
    lines: list[bytes], counts: NDArray[np.int64], name: str, first_line: int, progress: Callable[[float], object]
) -> NDArray[np.float64]:
    """All numbers of ``lines``, flat, with ``counts`` in each line; ``first_line`` is the first line's number in file
    ``name``.

    A missing value is NaN. ``progress`` is called with the fraction that is read. Raises StudioError at the first other
    word that is not a plain, plausible number.
    """
    ends = np.concatenate([[0], np.cumsum(counts)])
    values = np.empty(int(ends[-1]))
    step = _lines_a_piece(lines)

    def read(start: int) -> None:
        end = min(start + step, len(lines))
        _read(lines[start:end], values[ends[start] : ends[end]], name, first_line + start)

    for done in run_in_threads(read, range(0, len(lines), step)):
        progress(done)
    return values


def _read(lines: list[bytes], out_values: NDArray[np.float64], name: str, first_line: int) -> None:
    from studio.core.kernels.decimals import read_decimals  # late: it loads numba

    block = b" ".join(lines)
    if read_decimals(_as_bytes(block), _ABSURD, out_values):
        return
    if not block.translate(None, _ALLOWED):
        values = _parse(block)
        if values is not None and len(values) == len(out_values) and (np.abs(values) <= _ABSURD).all():
            out_values[:] = values
            return
    at = 0
    for line_number, line in enumerate(lines, first_line):
        for word in line.split():
            text = word.decode("utf-8", "replace")
            out_values[at] = np.nan if _MISSING.fullmatch(text) else number(text, f"{name}, line {line_number}")
            at += 1


def _parse(block: bytes) -> NDArray[np.float64] | None:
    try:
        return np.array(np.fromstring(block, dtype=np.float64, sep=" "))
    except (ValueError, DeprecationWarning):  # numpy's two ways to say "a word is no number"
        return None


def _lines_a_piece(lines: list[bytes]) -> int:
    return max(1, _PIECE * len(lines) // (sum(map(len, lines)) + 1))


def _as_bytes(text: bytes) -> NDArray[np.uint8]:
    return np.frombuffer(text, dtype=np.uint8) if text else np.empty(0, dtype=np.uint8)


def _shown(text: str) -> str:
    return f"'{text[:40]}…'" if len(text) > 40 else f"'{text}'"
