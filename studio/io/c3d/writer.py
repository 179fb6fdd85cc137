"""Writer of C3D files: a trial with its points, signals, plates and events, as Intel floats. Whole or not at all."""

import struct
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.trial import MARKER_KIND, Trial
from studio.io.atomic_write import write_pieces
from studio.io.c3d.parameters import BLOCK_BYTES
from studio.io.registry import Progress

FloatArray = NDArray[np.float64]

_LIST = 255
"""Items that one parameter can hold; lists go on in ``LABELS2``."""
_MOST_NUMBERS = 65535
_FRAMES = 4096
"""Frames that are written between two reports of progress."""
_HEADER = struct.Struct("<BBHHHHHfHHf")
_PLURALS = {"angle": "ANGLES", "force": "FORCES", "moment": "MOMENTS", "power": "POWERS", "scalar": "SCALARS"}
_PLURALS |= {"reaction": "REACTIONS", "virtual": "MODELED_MARKERS"}

Record = tuple[str, bytes]


def write_c3d(path: Path | str, trial: Trial, progress: Progress = lambda share, text: None) -> None:
    """Write ``trial`` as a C3D file; points are kept to single precision.

    Raises StudioError if it does not fit into C3D. ``progress`` is called with a fraction from 0 to 1 and may raise an
    exception to cancel; the file is then as before, or absent.
    """
    path = Path(path)
    write_pieces(path, _pieces(trial, lambda share: progress(share, f"Writing {path.name}")))


def c3d_bytes(trial: Trial) -> bytes:
    """Bytes of a C3D file with ``trial``."""
    return b"".join(_pieces(trial, lambda share: None))


def _pieces(trial: Trial, progress: Callable[[float], object]) -> Iterator[bytes]:
    """Header, parameters, then the frames in pieces; each part fills whole blocks."""
    samples = _samples_a_frame(trial)
    channels = len(trial.analog.labels)
    if len(trial.labels) > _MOST_NUMBERS or channels * samples > _MOST_NUMBERS:
        raise StudioError(f"'{trial.name}' has more points or signals than a C3D file can hold ({_MOST_NUMBERS}).")
    data_block = 2 + _blocks(_parameters(trial, samples, 0))
    last = trial.first_frame + trial.frame_count - 1
    yield _padded(
        _HEADER.pack(
            *(2, 0x50, len(trial.labels), channels * samples),
            *(_short(trial.first_frame), _short(last), 0, -1.0, data_block, samples, trial.frame_rate),
        )
    )
    yield _padded(_parameters(trial, samples, data_block))
    size = 0
    for first in range(0, trial.frame_count, _FRAMES):
        progress(first / trial.frame_count)
        frames = _frames(trial, samples, slice(first, first + _FRAMES))
        size += len(frames)
        yield frames
    yield bytes(-size % BLOCK_BYTES)


def _samples_a_frame(trial: Trial) -> int:
    if not trial.analog.labels:
        return 0
    samples, rest = divmod(len(trial.analog.samples), trial.frame_count)
    if rest or samples == 0:
        raise StudioError(f"The signals of '{trial.name}' are not a whole number of samples a frame.")
    return samples


def _frames(trial: Trial, samples: int, run: slice) -> bytes:
    """Bytes of the frames in ``run``."""
    points = trial.points[run]
    unseen = np.isnan(points).any(axis=-1)
    numbered = np.concatenate([np.nan_to_num(points), np.where(unseen, -1.0, 0.0)[..., None]], axis=-1)
    rows = [numbered.reshape(len(points), -1)]
    if samples:
        rows.append(trial.analog.samples.reshape(trial.frame_count, -1)[run])
    return np.concatenate(rows, axis=1).astype("<f4").tobytes()


def _parameters(trial: Trial, samples: int, data_block: int) -> bytes:
    last = trial.first_frame + trial.frame_count - 1
    groups: dict[str, list[Record]] = {
        "TRIAL": [
            ("ACTUAL_START_FIELD", _integers([trial.first_frame & 0xFFFF, trial.first_frame >> 16])),
            ("ACTUAL_END_FIELD", _integers([last & 0xFFFF, last >> 16])),
        ],
        "POINT": [
            ("USED", _integers([len(trial.labels)], ())),
            ("SCALE", _floats([-1.0], ())),
            ("RATE", _floats([trial.frame_rate], ())),
            ("DATA_START", _integers([data_block], ())),
            ("FRAMES", _integers([min(trial.frame_count, _MOST_NUMBERS)], ())),
            ("LONG_FRAMES", _floats([trial.frame_count], ())),
            ("UNITS", _word(trial.unit)),
            ("X_SCREEN", _word("+X")),
            ("Y_SCREEN", _word("+Z")),
            *_lists("LABELS", trial.labels),
            *_lists("DESCRIPTIONS", [""] * len(trial.labels)),
            *_outputs(trial),
        ],
        "ANALOG": _analog(trial, samples),
        "FORCE_PLATFORM": _plates(trial),
        "EVENT": _events(trial),
        "PROCESSING": [(key, _floats([value], ())) for key, value in trial.measures.items()],
        "MANUFACTURER": [("SOFTWARE", _word("Morpho Studio"))],
    }
    body = b"".join(_group(-number, name, records) for number, (name, records) in enumerate(groups.items(), 1))
    return struct.pack("<BBBB", 1, 0x50, min(_blocks(body + b"\0" * 6), 255), 84) + body + b"\0\0"


def _group(number: int, name: str, records: Iterable[Record]) -> bytes:
    parts = [struct.pack("<bb", len(name), number) + name.encode() + struct.pack("<HB", 3, 0)]
    for label, value in records:
        title = label.encode()[:127]
        parts.append(
            struct.pack("<bb", len(title), -number) + title + struct.pack("<H", len(value) + 3) + value + b"\0"
        )
    return b"".join(parts)


def _outputs(trial: Trial) -> list[Record]:
    records: list[Record] = []
    for kind in dict.fromkeys(kind for kind in trial.kinds if kind != MARKER_KIND):
        labels = [label for label, own in zip(trial.labels, trial.kinds, strict=True) if own == kind]
        records += _lists(_PLURALS.get(kind, "SCALARS"), labels)
    return records


def _analog(trial: Trial, samples: int) -> list[Record]:
    count = len(trial.analog.labels)
    records: list[Record] = [
        ("USED", _integers([count], ())),
        ("RATE", _floats([trial.frame_rate * max(samples, 1)], ())),
        ("GEN_SCALE", _floats([1.0], ())),
        ("FORMAT", _word("SIGNED")),
        ("BITS", _integers([16], ())),
    ]
    if count:
        records += _lists("LABELS", trial.analog.labels) + _lists("UNITS", trial.analog.units)
        for name, part in (("SCALE", 1.0), ("OFFSET", 0.0)):
            for index, first in enumerate(range(0, count, _LIST), 1):
                values = [part] * min(_LIST, count - first)
                numbers = _floats(values) if name == "SCALE" else _integers([int(value) for value in values])
                records.append((name if index == 1 else f"{name}{index}", numbers))
    return records


def _plates(trial: Trial) -> list[Record]:
    plates = trial.plates
    records: list[Record] = [("USED", _integers([len(plates)], ())), ("ZERO", _integers([1, 0]))]
    if plates:
        width = max(1, *(len(plate.channels) for plate in plates))
        feeds = [[channel + 1 for channel in plate.channels] + [0] * (width - len(plate.channels)) for plate in plates]
        count = len(plates)
        records += [
            ("TYPE", _integers([plate.kind for plate in plates])),
            ("CORNERS", _floats(np.array([plate.corners for plate in plates]).ravel(), (3, 4, count))),
            ("ORIGIN", _floats(np.array([plate.origin for plate in plates]).ravel(), (3, count))),
            ("CHANNEL", _integers(np.array(feeds).ravel().tolist(), (width, count))),
        ]
        if any(plate.calibration is not None for plate in plates):
            eye = np.eye(6)
            matrices = [eye if plate.calibration is None else plate.calibration.T for plate in plates]
            records.append(("CAL_MATRIX", _floats(np.array(matrices).ravel(), (6, 6, count))))
    return records


def _events(trial: Trial) -> list[Record]:
    events = trial.events[:_LIST]
    records: list[Record] = [("USED", _integers([len(events)], ()))]
    if events:
        times = [part for event in events for part in divmod(event.time, 60.0)]
        records += _lists("LABELS", [event.label for event in events])
        records += _lists("CONTEXTS", [event.context for event in events])
        records.append(("TIMES", _floats(times, (2, len(events)))))
    return records


def _lists(name: str, words: Sequence[str]) -> list[Record]:
    """Lists ``LABELS``, ``LABELS2`` ...; names of one list are padded to the longest."""
    records = []
    for index, first in enumerate(range(0, len(words), _LIST), 1):
        part = [word.encode()[:_LIST] for word in words[first : first + _LIST]]
        length = max(1, *map(len, part))
        value = struct.pack("<bBBB", -1, 2, length, len(part)) + b"".join(word.ljust(length) for word in part)
        records.append((name if index == 1 else f"{name}{index}", value))
    return records


def _word(text: str) -> bytes:
    return struct.pack("<bBB", -1, 1, len(text)) + text.encode()


def _integers(values: Sequence[int], shape: tuple[int, ...] | None = None) -> bytes:
    """16-bit integers, negative ones signed, large ones unsigned."""
    data = b"".join(struct.pack("<H", value & 0xFFFF) for value in values)
    return _dimensions(2, len(values), shape) + data


def _floats(values: Sequence[float] | FloatArray, shape: tuple[int, ...] | None = None) -> bytes:
    return _dimensions(4, len(values), shape) + np.asarray(values, dtype="<f4").tobytes()


def _dimensions(kind: int, count: int, shape: tuple[int, ...] | None) -> bytes:
    sizes = (count,) if shape is None else shape
    return struct.pack("<bB", kind, len(sizes)) + bytes(sizes)


def _short(number: int) -> int:
    return int(min(max(number, 0), _MOST_NUMBERS))


def _blocks(content: bytes) -> int:
    return -(-len(content) // BLOCK_BYTES)


def _padded(content: bytes) -> bytes:
    return content.ljust(_blocks(content) * BLOCK_BYTES, b"\0")
