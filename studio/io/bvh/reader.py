"""Reader of BVH files in their own units and axes: any channel order, any joint with positions."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.kernels.body import file_channels as kernel
from studio.io.bvh.hierarchy import Hierarchy, read_hierarchy
from studio.io.bvh.spelling import plain_bvh
from studio.io.bvh.writer import write_bvh
from studio.io.numbers import (
    count_per_line,
    filled_in_time,
    glued_words,
    lines_of,
    separated_decimals,
    separated_numbers,
    table,
)
from studio.io.referenced_files import read_bytes

__all__ = ["BvhFile", "read_bvh", "write_bvh"]

FloatArray = NDArray[np.float64]
Progress = Callable[[float, str], None]

_LARGEST_FILE = 1 << 30
_LONGEST_HIERARCHY = 1 << 24
_MOST_NUMBERS = 1 << 28
_WITHOUT_COLON = re.compile(rb"^\s*(frames|frame[ \t_]*time)\s*(?:=\s*|\s)(?=[\d.])", re.IGNORECASE)
_FRAME_TIME = re.compile(
    r"(?P<over>\+?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?:\s*/\s*(?P<under>\d+\.?\d*))?"
    r"(?:\s*(?P<unit>ms|millisec\w*|hz|fps))?(?=\s|;|s|$)",
    re.ASCII | re.IGNORECASE,
)
"""Seconds, or what a unit behind says, as a number or as a fraction."""
_WIDE, _BEGINNING = ("utf-32-le", "utf-32-be", "utf-16-le", "utf-16-be"), 256
"""Encodings of several bytes a letter, with or without a mark, and the bytes in which the first word tells them."""
_SCALE_NOISE = 1e-3
_BENT_RADIANS, _WHOLE_TURN = 1.0, 2.001 * np.pi
"""Greatest angle of a joint, in radians, of one who moves, and most that a file writes."""
_TRAVELS = 2.0
"""Lengths of the longest bone from which a body has gone somewhere."""
_DEEDS = {
    "scale": kernel.IGNORED_CHANNEL,
    "position": kernel.POSITION_CHANNEL,
    "rotation": kernel.ROTATION_CHANNEL,
}  # scales are told as repairs
_MOTION = re.compile(rb"(?:\A|[\r\n}])[ \t]*(MOTION)[ \t]*:?[ \t]*(?=[\r\n]|\Z)", re.IGNORECASE)


@dataclass(frozen=True)
class BvhFile:
    """Content of a BVH file, in its own units and axes, with the repairs made while reading."""

    name: str
    skeleton: Skeleton
    channels: tuple[tuple[str, ...], ...]
    """Channels of each joint in the order of the file (``Zrotation``); empty for end sites."""
    moved_from_offsets: bool
    """True if positions, except those of the first joint, are relative to the offsets instead of replacing them."""
    frames: FloatArray
    """Numbers (F, C) as written: file units and degrees."""
    frame_time: float | None
    """Seconds per frame that the file states; None if it states nothing usable."""
    frame_time_digit: float
    """Value in seconds of the last written digit, to which the frame time may be rounded."""
    repairs: tuple[str, ...]

    @property
    def stated_unit(self) -> None:
        """None: the format has no field for the unit."""

    @property
    def stated_up_axis(self) -> None:
        """None: the format has no field for the up axis."""

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.frames)

    def poses(self) -> PoseSequence:
        """Rotations and translations of every joint in file axes and units."""
        return PoseSequence(*self.transforms(slice(None)))

    def transforms(self, frames: NDArray[np.int64] | slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (N, J, 4) and translations (N, J, 3) of ``frames`` (N,), in file axes and units."""
        offsets = self.skeleton.offsets
        starts = np.array(offsets) if self.moved_from_offsets else np.zeros_like(offsets)
        starts[_first_with_positions(self.channels)] = 0.0
        channels = [(joint, channel) for joint, each in enumerate(self.channels) for channel in each]
        joints = np.array([joint for joint, _ in channels])
        deeds = np.array([_DEEDS[channel[1:]] for _, channel in channels])
        axes = np.array(["XYZ".index(channel[0]) for _, channel in channels])
        numbers = self.frames[frames]
        rotations = np.empty((len(numbers), len(offsets), 4))
        translations = np.empty((len(numbers), len(offsets), 3))
        kernel.pose_joints(numbers, joints, deeds, axes, starts, offsets, rotations, translations)
        return rotations, translations


def read_bvh(path: Path | str, progress: Progress | None = None) -> BvhFile:
    """Content of the BVH file at ``path``. Raises StudioError with file, line and what to do if it is damaged."""
    path = Path(path)
    report = progress or (lambda share, text: None)
    report(0.0, f"Reading {path.name}")
    spelling: list[str] = []
    content = plain_bvh(path.name, _content(path), spelling)
    head, motion_line, body = _split(path.name, content)
    hierarchy = read_hierarchy(path.name, head)
    report(0.2, f"Reading the motion of {path.name}")
    header, first_row = _motion_header(path.name, body, motion_line)
    repairs = [*spelling, *hierarchy.repairs]
    first_line = motion_line + min(first_row, len(body) - 1)
    frames = _frames(path.name, body[first_row:], first_line, hierarchy, header, repairs, report)
    frame_time, digit = _frame_time(path.name, header, repairs)
    offsets = np.array(hierarchy.offsets)
    moved = _moved_from_offsets(path.name, hierarchy.channels, offsets, frames, repairs)
    repairs += _scaled_joints(path.name, hierarchy, frames)
    _radians_to_degrees(path.name, hierarchy, frames, repairs)
    report(1.0, f"Read {path.name}")
    skeleton = Skeleton(
        tuple(hierarchy.names),
        np.array(hierarchy.parents),
        offsets,
        np.array(hierarchy.end_sites),
    )
    channels = tuple(hierarchy.channels)
    return BvhFile(path.name, skeleton, channels, moved, frames, frame_time, digit, tuple(repairs))


def _first_with_positions(channels: Sequence[tuple[str, ...]]) -> int:
    return next((joint for joint, each in enumerate(channels) if any("position" in channel for channel in each)), 0)


def _moved_from_offsets(
    name: str, channels: list[tuple[str, ...]], offsets: FloatArray, frames: FloatArray, repairs: list[str]
) -> bool:
    """True if most joints with positions, except the first, stay near zero although their bones are long.

    Usually a position replaces the offset; read that way, these files would have no bones.
    """
    travelling = _first_with_positions(channels)
    ends = np.cumsum([len(each) for each in channels])
    near = []
    for joint, (each, end) in enumerate(zip(channels, ends.tolist(), strict=True)):
        columns = [end - len(each) + index for index, channel in enumerate(each) if channel.endswith("position")]
        length = float(np.linalg.norm(offsets[joint]))
        if columns and joint != travelling and length > 0.0:
            near.append(float(np.abs(frames[:, columns]).max()) < 0.1 * length)
    if sum(near) <= len(near) / 2:
        return False
    repairs.append(f"{name}: the positions of its joints count from their offsets; they were added to them.")
    return True


def _scaled_joints(name: str, hierarchy: Hierarchy, frames: FloatArray) -> list[str]:
    """Warning about scale channels with values other than 1, which bones of a body do not have."""
    channels = [(joint, each) for joint, all_ in enumerate(hierarchy.channels) for each in all_]
    columns = [column for column, (_, each) in enumerate(channels) if each.endswith("scale")]
    grows = [column for column in columns if np.abs(frames[:, column] - 1.0).max() > _SCALE_NOISE]
    if not grows:
        return []
    joint = hierarchy.names[channels[grows[0]][0]]
    return [f"{name}: joints are scaled ('{joint}' the first of them); their scales were not applied."]


def _radians_to_degrees(name: str, hierarchy: Hierarchy, frames: FloatArray, repairs: list[str]) -> None:
    """Convert the angles of ``frames`` in place if they can only be radians.

    Read as degrees, a body that travels by its own size would hardly bend.
    """
    channels = [(joint, each) for joint, all_ in enumerate(hierarchy.channels) for each in all_]
    turning = [column for column, (_, each) in enumerate(channels) if each.endswith("rotation")]
    limbs = [column for column in turning if channels[column][0] != channels[turning[0]][0]]
    travelling = _first_with_positions(hierarchy.channels)
    moving = [at for at, (joint, each) in enumerate(channels) if joint == travelling and each.endswith("position")]
    most = float(np.abs(frames[:, limbs]).max(initial=0.0))
    bones = np.array(hierarchy.offsets)[np.array(hierarchy.parents) >= 0]
    size = float(np.linalg.norm(bones, axis=1).max(initial=0.0))
    if _BENT_RADIANS < most <= _WHOLE_TURN and np.ptp(frames[:, moving], axis=0).max(initial=0.0) > _TRAVELS * size:
        frames[:, turning] = np.degrees(frames[:, turning])
        words = f"as degrees, a body that travels would not bend by more than {most:.1f}"
        repairs.append(f"{name}: its angles were read as radians; {words}.")


def _content(path: Path) -> bytes:
    content = read_bytes(path, _LARGEST_FILE)
    if not content or content.isspace():
        raise StudioError(f"{path.name} is empty. Export it again.")
    for codec in _WIDE if b"\0" in content[:_BEGINNING] else ():
        if "HIERARCHY" in content[:_BEGINNING].decode(codec, "ignore").upper():
            return content.decode(codec, "replace").lstrip("\ufeff").encode()
    if b"\0" in content:
        raise StudioError(
            f"{path.name}, byte {content.index(0)}: this is binary data, not BVH text. Choose a BVH file."
        )
    return content


def _split(name: str, content: bytes) -> tuple[list[str], int, list[bytes]]:
    """Lines before MOTION, the line of MOTION (from 1), lines after it."""
    found = _MOTION.search(content)
    if not found:
        if not content.lstrip(b"\xef\xbb\xbf \t\r\n")[:9].upper() == b"HIERARCHY":
            raise StudioError(
                f"{name}, line 1: a BVH file begins with HIERARCHY, this one does not. Choose a BVH file."
            )
        raise StudioError(f"{name}, line {len(content.splitlines())}: the file ends before MOTION. It is cut off.")
    head = content[: found.start(1)]
    if len(head) > _LONGEST_HIERARCHY:
        raise StudioError(f"{name}: its hierarchy is {len(head) >> 20} MB long. That is not a body; check the file.")
    try:
        text = head.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = head.decode("latin-1")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines, len(lines), lines_of(content, found.end())


@dataclass
class _Header:
    """Header of the MOTION block, with the lines of its values."""

    line: int
    """Of MOTION."""
    frames: str | None = None
    frames_line: int = 0
    frame_time: str | None = None
    frame_time_line: int = 0


def _motion_header(name: str, body: list[bytes], motion_line: int) -> tuple[_Header, int]:
    """Values of ``Frames:`` and ``Frame Time:``, in any order, either may be missing; and the line of the first row."""
    header = _Header(line=motion_line)
    for at, line in enumerate(body):
        words = _WITHOUT_COLON.sub(rb"\1:", line).decode("utf-8", "replace").replace(":", " : ").split()
        key = " ".join(words[: words.index(":")]).lower().replace("_", " ") if ":" in words else ""
        if not words:
            continue
        if key == "frames":
            header.frames = " ".join(words[words.index(":") + 1 :])
            header.frames_line = motion_line + at
        elif key in ("frame time", "frametime", "frame rate", "framerate", "fps"):
            header.frame_time = " ".join(words[words.index(":") + 1 :])
            header.frame_time += " Hz" * (header.frame_time != "" and key not in ("frame time", "frametime"))
            header.frame_time_line = motion_line + at
        elif ":" in words:
            raise StudioError(f"{name}, line {motion_line + at}: '{key[:40]}' is not part of a BVH motion. Remove it.")
        else:
            return header, at
    return header, len(body)


def _frame_time(name: str, header: _Header, repairs: list[str]) -> tuple[float | None, float]:
    """Seconds per frame, and the value in seconds of its last digit; 1e-9 for a fraction (``1/60``)."""
    text = header.frame_time
    if not text:
        repairs.append(f"{name}, line {header.frame_time_line or header.line}: the file has no Frame Time.")
        return None, 0.0
    where = f"{name}, line {header.frame_time_line}"
    plain = _FRAME_TIME.match(text.replace(",", "."))
    over, under = (float(plain[part] or 1.0) for part in ("over", "under")) if plain else (0.0, 1.0)
    unit = ((plain and plain["unit"]) or "").lower()
    over, under = (under, over) if unit in ("hz", "fps") else (over, under * (1000.0 if unit.startswith("m") else 1.0))
    seconds = over / under if under else 0.0
    if not plain or not 1e-4 <= seconds <= 1.0:
        repairs.append(f"{where}: Frame Time {text[:20]} is not valid and was not used.")
        return None, 0.0
    if plain[0] != text or plain["under"] or unit:
        repairs.append(f"{where}: Frame Time {text[:20]} was read as {seconds:.6g} s.")
    if plain["under"] or unit:
        return seconds, 1e-9
    mantissa, _, exponent = plain["over"].lower().partition("e")
    return seconds, float(10.0 ** (float(exponent or 0) - len(mantissa.partition(".")[2])))


def _frames(
    name: str,
    lines: list[bytes],
    first_line: int,
    hierarchy: Hierarchy,
    header: _Header,
    repairs: list[str],
    progress: Progress,
) -> FloatArray:
    """Numbers (F, C) of all rows; a last row that is cut off is dropped and listed in ``repairs``."""
    width = sum(map(len, hierarchy.channels))
    if width == 0:
        raise StudioError(f"{name}: no joint declares channels, so there is no motion to read. Export it with motion.")
    counts = count_per_line(lines)
    _part_glued(name, lines, counts, width, first_line, repairs)
    total = int(counts.sum())
    if total > _MOST_NUMBERS:
        raise StudioError(f"{name} holds {total} numbers; at most {_MOST_NUMBERS} are read. Cut the take into parts.")
    if total == 0:
        raise _no_frame(name, first_line, header)
    last = int(np.flatnonzero(counts)[-1])
    ends = np.cumsum(counts)
    incomplete = total % width
    if incomplete or _is_cut(lines, last, header, total // width):
        dropped = incomplete or width
        row_start = total - dropped
        if row_start and row_start not in ends[:last]:
            raise _wrong_row(name, counts, width, first_line)
        if row_start == 0:
            raise _no_frame(name, first_line, header)
        last = int(np.searchsorted(ends, row_start, side="left"))
        repairs.append(f"{name}, line {first_line + last + 1}: the last row is cut off and was dropped.")
        total = row_start
    rows = np.arange(width, total + 1, width)
    if (ends[np.searchsorted(ends, rows)] != rows).any():
        if not _is_wrapped(counts) or total != width * _promised(header):
            raise _wrong_row(name, counts, width, first_line)
        repairs.append(f"{name}, line {first_line}: lines do not end where frames do; {width} numbers are a frame.")
    lines, counts = lines[: last + 1], counts[: last + 1]
    told = lambda share: progress(0.3 + 0.7 * share, f"Reading the motion of {name}")  # noqa: E731
    values = table(lines, counts, name, first_line, told).reshape(-1, width)
    row_lines = first_line + np.searchsorted(np.cumsum(counts), rows[: len(values)])
    _fill(name, values, row_lines, hierarchy, repairs)
    _compare_count(name, header, len(values), first_line + last, repairs)
    return values


def _part_glued(
    name: str, lines: list[bytes], counts: NDArray[np.int64], width: int, first_line: int, repairs: list[str]
) -> None:
    """Separate glued numbers in rows with too few words that are complete then; report the first of them."""
    glued = []
    for row in np.flatnonzero((counts > 0) & (counts < width)).tolist():
        line = lines[row].decode("utf-8", "replace")
        apart = next(
            (each for each in (separated_numbers(line), separated_decimals(line)) if len(each.split()) == width), None
        )
        if apart is not None:
            lines[row], counts[row] = apart.encode(), width
            glued.append(first_line + row)
    repairs += glued_words(name, glued)


def _fill(name: str, values: FloatArray, lines: NDArray[np.int64], hierarchy: Hierarchy, repairs: list[str]) -> None:
    """Interpolate missing values in time, angles along the shorter arc; report the number of rows and the first line.

    ``values`` (F, C) have NaN for a missing value, and rows of zeros are missing too; ``lines`` (F,) are line numbers.
    Raises StudioError if a channel has no number at all.
    """
    channels = [(joint, each) for joint, all_ in enumerate(hierarchy.channels) for each in all_]
    zeros = _rows_of_zeros(values, [column for column, (_, each) in enumerate(channels) if each.endswith("position")])
    values[zeros] = np.nan
    missing = ~np.isfinite(values)
    rows = np.flatnonzero(missing.any(axis=1))
    if not len(rows):
        return
    for column in np.flatnonzero(missing.any(axis=0)).tolist():
        joint, channel = channels[column]
        if missing[:, column].all():
            raise StudioError(
                f"{name}: {channel} of '{hierarchy.names[joint]}' has no number in any row. Export the file again."
            )
        values[:, column] = filled_in_time(values[:, column], 360.0 if channel.endswith("rotation") else None)
    count = "1 row lacks" if len(rows) == 1 else f"{len(rows)} rows lack"
    or_zeros = " or holds" if len(rows) == 1 else " or hold"
    repairs.append(
        f"{name}, line {lines[rows[0]]}: {count} numbers{f'{or_zeros} zeros alone' if zeros.any() else ''}; "
        "what is missing was filled from the rows before and after."
    )


def _rows_of_zeros(values: FloatArray, positions: list[int]) -> NDArray[np.bool_]:
    """Mask (F,) of rows of zeros that a recorder wrote when it had lost the body.

    The first rows may be a calibration pose, and so may all if the body is nowhere else than at zero.
    """
    zeros = ~values.any(axis=1)
    away = values[:, positions].any(axis=1)
    lost = zeros & np.maximum.accumulate(~zeros)
    return lost if (zeros | away).all() else np.zeros_like(lost)


def _is_cut(lines: list[bytes], last: int, header: _Header, rows: int) -> bool:
    """True if the file ends within a line before its last promised frame, so that its last number may lack digits."""
    return last == len(lines) - 1 and rows < _promised(header)


def _is_wrapped(counts: NDArray[np.int64]) -> bool:
    """True if the numbers run through lines of equal length, the last one shorter, as a table of fixed width does."""
    full = counts[counts > 0]
    return bool((full[:-1] == full[0]).all() and full[-1] <= full[0])


def _no_frame(name: str, line: int, header: _Header) -> StudioError:
    promised = f", though it says Frames: {header.frames[:20]}" if header.frames else ""
    return StudioError(f"{name}, line {line}: there is no complete frame in this file{promised}. Export it again.")


def _wrong_row(name: str, counts: NDArray[np.int64], width: int, first_line: int) -> StudioError:
    row = int(np.flatnonzero((counts != width) & (counts > 0))[0])
    return StudioError(
        f"{name}, line {first_line + row}: {counts[row]} numbers stand here where {width} should stand. "
        "Correct that line or export the file again."
    )


def _compare_count(name: str, header: _Header, rows: int, last_line: int, repairs: list[str]) -> None:
    where = f"{name}, line {header.frames_line or header.line}"
    if not header.frames:
        repairs.append(f"{where}: the file does not say how many frames it has; found and read: {rows}.")
    elif header.frames != str(rows):
        cut = f" The last is on line {last_line}: the file may be cut off." if rows < _promised(header) else ""
        repairs.append(f"{where}: the file says Frames: {header.frames[:20]}; found and read: {rows}.{cut}")


def _promised(header: _Header) -> int:
    return int(header.frames[:12]) if header.frames and header.frames.isdecimal() else 0
