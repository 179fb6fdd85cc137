"""Reader of C3D files: points, analog signals, plates and events as recorded.

No header is trusted. Intel, DEC and MIPS, integers and floats. Every size is checked against the bytes of the file
before it is used, so that memory is proportional to the file's own size.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.trial import Trial
from studio.core.names import counted_noun, readable_name
from studio.io.c3d.contents import (
    analog_signals,
    force_plates,
    labels_and_kinds,
    marked_events,
    measures,
    unit_in_parameters,
)
from studio.io.c3d.parameters import BLOCK_BYTES, Numbers, Parameters, read_parameters
from studio.io.referenced_files import read_bytes

FloatArray = NDArray[np.float64]
Progress = Callable[[float, str], None]

_LARGEST_FILE = 1 << 30
_ABSURD = 1e7
"""Beyond so many units nothing was recorded by a camera."""


@dataclass(frozen=True)
class C3dFile:
    """Content of a C3D file: the trial, the parameters, and the repairs made while reading."""

    trial: Trial
    order: str
    """``Intel``, ``DEC`` or ``MIPS``."""
    integers: bool
    parameters: Parameters
    repairs: tuple[str, ...]


@dataclass(frozen=True)
class _Header:
    """First block of the file; the parameters take precedence over its values."""

    points: int
    channels: int
    samples: int
    """Analog samples a frame."""
    first_frame: int
    frames: int
    scale: float
    """Units a step of an integer; the coordinates are floats where it was written with a minus."""
    integers: bool
    data_start: int
    frame_rate: float

    @property
    def words_a_frame(self) -> int:
        """Numbers per frame."""
        return 4 * self.points + self.channels * self.samples

    @property
    def bytes_a_frame(self) -> int:
        """Bytes per frame."""
        return self.words_a_frame * (2 if self.integers else 4)


def read_c3d(path: Path | str, progress: Progress | None = None) -> C3dFile:
    """File at ``path``; raises StudioError with file, byte and what to do if it is damaged."""
    path = Path(path)
    report = progress or (lambda share, text: None)
    report(0.0, f"Reading {path.name}")
    content = _content(path)
    parameters = read_parameters(path.name, content)
    repairs = parameters.repairs
    header = _header(path.name, content, parameters, repairs)
    report(0.3, f"Reading the points of {path.name}")
    words = _words(content, header, parameters.numbers)
    points, residuals = _points(path.name, words[:, : 4 * header.points], header, repairs)
    report(0.7, f"Reading the signals of {path.name}")
    raw = words[:, 4 * header.points :].reshape(header.frames * header.samples, header.channels)
    labels, kinds = labels_and_kinds(path.name, parameters, header.points, repairs)
    trial = Trial(
        name=readable_name(path.stem),
        source=path.name,
        labels=labels,
        kinds=kinds,
        points=points,
        residuals=residuals,
        frame_rate=header.frame_rate,
        first_frame=header.first_frame,
        unit=unit_in_parameters(path.name, parameters, repairs),
        analog=analog_signals(path.name, parameters, raw, header.frame_rate * max(header.samples, 1), repairs),
        plates=force_plates(path.name, parameters, header.channels, repairs),
        events=marked_events(path.name, content, parameters, repairs),
        measures=measures(parameters),
    )
    report(1.0, f"Read {path.name}")
    return C3dFile(trial, parameters.numbers.order, header.integers, parameters, tuple(repairs))


def _content(path: Path) -> bytes:
    content = read_bytes(path, _LARGEST_FILE)
    if not content:
        raise StudioError(f"{path.name} is empty. Export it again.")
    if len(content) < BLOCK_BYTES:
        raise StudioError(
            f"{path.name}, byte {len(content)}: the file ends within its header. It is cut off; export it again."
        )
    if content[1] != 0x50:
        raise StudioError(f"{path.name}, byte 1: a C3D file has 80 here, this one has {content[1]}. Choose a C3D file.")
    return content


def _header(name: str, content: bytes, parameters: Parameters, repairs: list[str]) -> _Header:
    words = parameters.numbers.integers(content[:BLOCK_BYTES]).view()
    unsigned = [int(word) & 0xFFFF for word in words[:10]]
    rate = float(parameters.numbers.floats(content[20:24])[0])
    scale = float(parameters.numbers.floats(content[12:16])[0])
    points = _counted(name, "points", unsigned[1], parameters.number("POINT", "USED"), repairs)
    samples = unsigned[9]
    if unsigned[2] and not samples:
        samples = 1
        repairs.append(f"{name}, byte 18: the file says 0 analog samples a frame though it has some; taken as 1.")
    channels = unsigned[2] // samples if samples else 0
    if channels * samples != unsigned[2]:
        raise StudioError(
            f"{name}, byte 4: {unsigned[2]} analog numbers a frame are not a whole multiple of {samples} samples. "
            "Its header is damaged; export it again."
        )
    told = parameters.number("ANALOG", "USED")
    if told is not None and told != channels:
        repairs.append(f"{name}, byte 4: the header says {channels} analog channels, ANALOG:USED {told:g}; read so.")
    if points == 0:
        raise StudioError(f"{name}, byte 2: {_without_points(unsigned, channels, parameters)}")
    scale, integers = _scale(name, scale, parameters, repairs)
    header = _Header(
        points=points,
        channels=channels,
        samples=samples,
        first_frame=_first_frame(unsigned[3], parameters),
        frames=0,
        scale=scale,
        integers=integers,
        data_start=_data_start(name, content, unsigned[8], parameters, repairs),
        frame_rate=_frame_rate(name, rate, parameters, repairs),
    )
    frames = _frames(name, content, unsigned, header, parameters, repairs)
    return _Header(**{**vars(header), "frames": frames})


def _without_points(unsigned: list[int], channels: int, parameters: Parameters) -> str:
    """Error message for a file without points: its content by its parameters, and what to do."""
    samples = max(unsigned[4] - unsigned[3] + 1, 0) * unsigned[9]
    rotations = int(parameters.number("ROTATION", "USED") or 0)
    held = [f"{channels} signals of {samples} samples"] if channels else []
    held += [f"the rotations of {rotations} segments"] if rotations > 0 else []
    only = f"only {' and '.join(held)}" if held else "nor any signals"
    return f"the file holds no points, {only}. Export it with its markers."


def _counted(name: str, what: str, header: int, parameter: float | None, repairs: list[str]) -> int:
    if parameter is None or int(parameter) & 0xFFFF == header:
        return header
    repairs.append(
        f"{name}, byte 2: the header says {header} {what}, POINT:USED {parameter:g}; read as the header says."
    )
    return header


def _first_frame(header: int, parameters: Parameters) -> int:
    field = _long(parameters, "ACTUAL_START_FIELD")
    return header if field is None else field


def _long(parameters: Parameters, name: str) -> int | None:
    """Frame number of 31 bits that is stored as two numbers of 16 bits, the lower first; None for another value."""
    field = parameters.columns("TRIAL", name, 2)
    if not field.size or not np.isfinite(field).all():
        return None
    frame = (int(field[0, 0]) & 0xFFFF) + ((int(field[1, 0]) & 0xFFFF) << 16)
    return frame if frame < 1 << 31 else None


def _scale(name: str, header: float, parameters: Parameters, repairs: list[str]) -> tuple[float, bool]:
    """Units per step, and True for integer coordinates."""
    told = parameters.number("POINT", "SCALE")
    if np.isfinite(header) and 0.0 < abs(header) < _ABSURD:
        if told is not None and header > 0.0 and _differ(header, told):
            what = f"the header says a scale of {header:g}, POINT:SCALE {told:g}"
            repairs.append(f"{name}, byte 12: {what}; read as the header says.")
        return abs(header), header > 0.0
    if told is not None and 0.0 < abs(told) < _ABSURD:
        repairs.append(f"{name}, byte 12: the scale {header:g} is not valid; POINT:SCALE {told:g} was taken.")
        return abs(told), told > 0.0
    raise StudioError(f"{name}, byte 12: the scale of its points, {header:g}, is not valid. Export it again.")


def _differ(header: float, parameter: float) -> bool:
    """True unless both values are one number written in two ways, such as 60 Hz and 59.94."""
    return not math.isclose(header, parameter, rel_tol=2e-3)


def _data_start(name: str, content: bytes, header: int, parameters: Parameters, repairs: list[str]) -> int:
    """Byte at which the frames begin."""
    for block in (header, int(parameters.number("POINT", "DATA_START") or 0) & 0xFFFF):
        if block > 1 and (block - 1) * BLOCK_BYTES < len(content):
            if block != header:
                repairs.append(f"{name}, byte 16: block {header} cannot hold the frames; POINT:DATA_START was taken.")
            return (block - 1) * BLOCK_BYTES
    raise StudioError(
        f"{name}, byte 16: its frames should begin in block {header}, which is not in the file of {len(content)} "
        "bytes. It is cut off; export it again."
    )


def _frame_rate(name: str, header: float, parameters: Parameters, repairs: list[str]) -> float:
    told = parameters.number("POINT", "RATE")
    true = [rate for rate in (header, told) if rate is not None and np.isfinite(rate) and 0.01 <= rate <= 100000.0]
    if len(true) == 2 and _differ(*true):
        repairs.append(f"{name}, byte 20: the header says {header:g} Hz, POINT:RATE {told:g}; read as the header says.")
    elif header not in true:
        instead = "POINT:RATE" if true else "100 Hz"
        repairs.append(f"{name}, byte 20: the frame rate {header:g} is not valid; {instead} was taken.")
    return true[0] if true else 100.0


def _frames(
    name: str, content: bytes, unsigned: list[int], header: _Header, parameters: Parameters, repairs: list[str]
) -> int:
    """Number of frames: by ACTUAL_START_FIELD and ACTUAL_END_FIELD, else the header, else POINT:FRAMES.

    It is at most that in the file, and a count that fills the file is preferred to a smaller one. If 16 bits are full,
    LONG_FRAMES is preferred, else the largest of these counts.
    """
    there = (len(content) - header.data_start) // header.bytes_a_frame
    start, end = (_long(parameters, f"ACTUAL_{which}_FIELD") for which in ("START", "END"))
    told = unsigned[4] - unsigned[3] + 1 if unsigned[4] >= unsigned[3] else 0
    claims = [told, int(parameters.number("POINT", "FRAMES") or 0) & 0xFFFF]
    if start is not None and end is not None:
        claims.insert(0, end - start + 1)
    longest = int(np.clip(parameters.number("POINT", "LONG_FRAMES") or 0.0, 0.0, 2.0**31))
    if unsigned[4] == 0xFFFF or claims[-1] == 0xFFFF:
        claims.insert(0, longest or (there if max(claims) == 0xFFFF else max(claims)))
    filling = [claim for claim in claims if 0 <= (there - claim) * header.bytes_a_frame < BLOCK_BYTES]
    claimed = next((claim for claim in claims if claim > 0), 0)
    claimed = filling[0] if filling and 0 < claimed < filling[0] else claimed
    if there == 0 or claimed == 0:
        raise StudioError(
            f"{name}, byte {header.data_start}: there is no complete frame in this file, though it says {claimed}. "
            "Export it again."
        )
    if claimed > there:
        repairs.append(
            f"{name}: the file says {counted_noun(claimed, 'frame')}, but holds {there}; it is cut off."
            " Those were read."
        )
        return there
    others = sorted({claim for claim in claims if claim > 0} - {claimed})
    if others:
        repairs.append(
            f"{name}: the file says {counted_noun(claimed, 'frame')} and in another place {others[0]}; read: {claimed}."
        )
    return claimed


def _words(content: bytes, header: _Header, numbers: Numbers) -> NDArray[np.generic]:
    """Numbers as stored in the file, (frames, numbers per frame)."""
    data = memoryview(content)[header.data_start : header.data_start + header.frames * header.bytes_a_frame]
    flat: NDArray[np.generic] = numbers.integers(data) if header.integers else numbers.floats(data)
    return flat.reshape(header.frames, header.words_a_frame)


def _points(
    name: str, words: NDArray[np.generic], header: _Header, repairs: list[str]
) -> tuple[FloatArray, FloatArray]:
    """Points (F, P, 3) and residuals (F, P) in units; NaN and -1 for points that were not seen."""
    quads = words.reshape(header.frames, header.points, 4)
    with np.errstate(invalid="ignore", over="ignore"):
        points = quads[..., :3].astype(np.float64) * (header.scale if header.integers else 1.0)
        wild = ~(np.abs(points) < _ABSURD).all(axis=-1)
        last = np.nan_to_num(quads[..., 3].astype(np.float64), nan=-1.0, posinf=-1.0, neginf=-1.0)
    cameras = np.clip(np.trunc(last), -32768, 32767).astype(np.int16)
    unseen = (cameras < 0) | ~points.any(axis=-1)
    if (wild & ~unseen).any():
        frame, point = np.argwhere(wild & ~unseen)[0]
        places = counted_noun(int((wild & ~unseen).sum()), "unbelievable place")
        repairs.append(f"{name}: {places} made a gap, the first of point {point + 1} in frame {frame}.")
    unseen |= wild
    points[unseen] = np.nan
    residuals = np.where(unseen, -1.0, np.bitwise_and(cameras, 0xFF) * header.scale)
    return points, residuals
