"""AMC files: for each frame one line for each bone, with the numbers announced by the skeleton's ``dof``."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.acclaim.skeleton import ANGLE_UNIT_IS_DEGREES
from studio.io.numbers import count_per_line, filled_in_time, lines_of, table
from studio.io.referenced_files import read_bytes

FloatArray = NDArray[np.float64]

_LARGEST = 1 << 30
_FRAME = re.compile(rb"\s*\d+\s*")
_SHOWN = 3


@dataclass(frozen=True)
class AmcMotion:
    """Content of an AMC file, as written."""

    values: Mapping[str, FloatArray]
    """Numbers (F, C) of each moving bone, in the order of its channels."""
    frame_count: int
    degrees: bool
    repairs: tuple[str, ...]


def read_amc(
    path: Path, channels: Mapping[str, tuple[str, ...]], degrees: bool, progress: Callable[[float], object]
) -> AmcMotion:
    """Motion in the file at ``path`` of bones with ``channels``. Raises StudioError with file and line.

    ``degrees`` is used if the file itself does not state the unit of its angles.
    """
    lines = lines_of(read_bytes(path, _LARGEST))
    start, said = _header(lines)
    rows = lines[start:]
    is_frame = np.array([_FRAME.fullmatch(line) is not None for line in rows], dtype=bool)
    if not is_frame.any():
        raise StudioError(
            f"{path.name}, line {len(lines)}: there is no frame in this file. Choose a complete AMC file."
        )
    words = [[] if frame else line.split(maxsplit=1) for line, frame in zip(rows, is_frame.tolist(), strict=True)]
    names = [own[0].decode("utf-8", "replace") if own else "" for own in words]
    numbers = [own[1] if len(own) > 1 else b"" for own in words]
    counts = count_per_line(numbers)
    values = table(numbers, counts, path.name, start + 1, progress)
    repairs = _strangers(path.name, names, channels)

    moving = [name for name, own in channels.items() if own]
    places = {name: place for place, name in enumerate(moving)}
    bones = np.array([places.get(name, -1) for name in names])
    widths = np.array([len(channels[name]) for name in moving])
    frames = np.cumsum(is_frame) - 1
    told = (bones >= 0) & (frames >= 0)
    if _ends_within_a_frame(frames[told], counts[told] < widths[bones[told]]):
        told &= frames < frames[-1]
        repairs.append(f"{path.name}, line {len(lines)}: the last frame is cut off and was dropped.")
    wrong = np.flatnonzero(told & (counts != widths[bones]))
    if len(wrong):
        line = wrong[0]
        raise StudioError(
            f"{path.name}, line {start + 1 + line}: '{names[line]}' has {counts[line]} numbers where its skeleton has "
            f"{widths[bones[line]]}. Choose the ASF file that belongs to it, or correct that line."
        )
    if not told.any():
        raise StudioError(f"{path.name}: no bone of its skeleton moves in it. Choose the ASF file that belongs to it.")
    frame_count = int(frames[told][-1]) + 1
    starts = np.cumsum(counts) - counts
    degrees = degrees if said is None else said
    by_bone = {}
    for name, place in places.items():
        own = np.flatnonzero(told & (bones == place))
        course = np.full((frame_count, widths[place]), np.nan)
        course[frames[own]] = values[starts[own][:, None] + np.arange(widths[place])]
        by_bone[name] = _whole(path.name, name, channels[name], course, degrees, repairs)
    return AmcMotion(by_bone, frame_count, degrees, tuple(repairs))


def _header(lines: list[bytes]) -> tuple[int, bool | None]:
    """Number of lines before the frames (comments and keywords); and True for degrees, False for radians, None if
    unstated.
    """
    degrees: bool | None = None
    for index, line in enumerate(lines):
        text = line.decode("utf-8-sig", "replace").strip()
        if text.startswith(":"):
            degrees = ANGLE_UNIT_IS_DEGREES.get(text[1:].lower(), degrees)
        elif text and not text.startswith("#"):
            return index, degrees
    return len(lines), degrees


def _strangers(file: str, names: list[str], channels: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Error message about bones that move although the skeleton lacks them, or gives them no degrees of freedom."""
    unknown = [name for name in dict.fromkeys(names) if name and not channels.get(name)]
    if not unknown:
        return []
    shown = ", ".join(unknown[:_SHOWN]) + (f" and {len(unknown) - _SHOWN} more" if len(unknown) > _SHOWN else "")
    return [f"{file}: the skeleton has no moving bone called {shown}; what the file says of it was left out."]


def _ends_within_a_frame(frames: NDArray[np.int64], short: NDArray[np.bool_]) -> bool:
    """True if the last of several frames has fewer bones than the one before, or its last bone too few numbers.

    ``frames`` (L,) of each line of a bone, in order; ``short`` (L,) the lines that have too few numbers.
    """
    if len(frames) == 0 or frames[-1] == frames[0]:
        return False
    last, before = (int(np.count_nonzero(frames == frame)) for frame in (frames[-1], frames[-1] - 1))
    return bool(short[-1]) or last < before


def _whole(
    file: str, name: str, channels: tuple[str, ...], course: FloatArray, degrees: bool, repairs: list[str]
) -> FloatArray:
    """Numbers ``course`` (F, C) with missing ones interpolated from the frames around; a bone without numbers rests."""
    missing = ~np.isfinite(course)
    if not missing.any():
        return course
    if missing.all(axis=0).any():
        repairs.append(f"{file}: it does not say how '{name}' moves; it was left at rest.")
        return np.zeros_like(course)
    frame = int(np.argmax(missing.any(axis=1)))
    repairs.append(f"{file}, frame {frame}: '{name}' lacks numbers; what is missing was filled from the frames around.")
    turn = 360.0 if degrees else 2.0 * np.pi
    return np.stack(
        [
            filled_in_time(column, turn if channel.startswith("r") else None)
            for column, channel in zip(course.T, channels, strict=True)
        ],
        axis=1,
    )
