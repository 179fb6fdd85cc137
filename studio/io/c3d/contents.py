"""Contents of the parameters of a C3D file: labels, kinds, unit, signals, plates, events and measures."""

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.subjects import with_subjects
from studio.core.markers.trial import (
    MARKER_KIND,
    NO_SIGNALS,
    VIRTUAL_KIND,
    AnalogSignals,
    ForcePlate,
    TrialEvent,
    label_without_subject,
)
from studio.core.names import counted_noun
from studio.io.c3d.parameters import BLOCK_BYTES, Parameters
from studio.io.markers.unit import unit_by_spelling

FloatArray = NDArray[np.float64]

_MODEL_OUTPUTS = {
    "ANGLES": "angle", "FORCES": "force", "MOMENTS": "moment", "POWERS": "power", "SCALARS": "scalar",
    "MODELED_MARKERS": VIRTUAL_KIND, "REACTIONS": "reaction",
}  # fmt: skip
_ENDINGS = ("angles", "angle", "force", "moment", "power", "grf", "forces", "moments", "powers")
_EVENT_KEY = 12345
_MEASURE_GROUPS = ("PROCESSING", "SUBJECTS", "SUBJECT", "SEG")


def labels_and_kinds(
    name: str, parameters: Parameters, count: int, repairs: list[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Unique labels of ``count`` points, subjects before a colon, and the kind of each point."""
    written = parameters.continued_words("POINT", "LABELS")[:count]
    labels: dict[str, None] = {}
    twice: list[str] = []
    for index in range(count):
        label = written[index] if index < len(written) else ""
        label = label or f"Point {index + 1}"
        if label in labels:
            twice.append(label)
            number = 2
            while f"{label}_{number}" in labels:
                number += 1
            label = f"{label}_{number}"
        labels[label] = None
    if twice:
        shown = ", ".join(dict.fromkeys(twice[:4]))
        repairs.append(f"{name}: {counted_noun(len(twice), 'label')} repeated ({shown}); numbers were added.")
    if len(written) < count:
        repairs.append(
            f"{name}: {counted_noun(count, 'point')} and {counted_noun(len(written), 'label')};"
            " the others were numbered."
        )
    outputs = {
        label: kind
        for group, kind in _MODEL_OUTPUTS.items()
        for label in parameters.continued_words("POINT", group)
        if label
    }
    told = with_subjects(tuple(labels))
    outputs |= dict.fromkeys(_segment_axes(told), VIRTUAL_KIND)
    return told, tuple(
        outputs.get(label, outputs.get(own, _kind_by_name(own))) for label, own in zip(labels, told, strict=True)
    )


def _segment_axes(labels: tuple[str, ...]) -> set[str]:
    """Labels such as ``LFEO, LFEA, LFEL, LFEP``: origin and axes of a segment, as written by Plug-in-Gait."""
    there = set(labels)
    stems = {label[:-1] for label in labels if len(label_without_subject(label)) == 4 and label.endswith("O")}
    quads = ([stem + end for end in "OALP"] for stem in stems)
    return {label for quad in quads if there.issuperset(quad) for label in quad}


def _kind_by_name(label: str) -> str:
    """Kind of a point by a name that models give only to their outputs, such as ``LKneeAngles`` or ``RHipMoment``."""
    if label.lower().startswith("centreofmass"):
        return VIRTUAL_KIND
    ending = next((ending for ending in _ENDINGS if label.lower().endswith(ending)), "")
    if not ending or len(label) <= len(ending):
        return MARKER_KIND
    return {"grf": "force"}.get(ending, ending.removesuffix("s"))


def unit_in_parameters(name: str, parameters: Parameters, repairs: list[str]) -> str:
    """Unit of length that the file states; millimetres if it states no known one."""
    said = (*parameters.words("POINT", "UNITS"), "")[0]
    unit = unit_by_spelling(said)
    if unit is None:
        repairs.append(f"{name}: POINT:UNITS is '{said[:20]}', which is not a known unit; taken as mm.")
    elif unit != said.lower():
        repairs.append(f"{name}: POINT:UNITS is '{said[:20]}', taken as {unit}.")
    return unit or "mm"


def analog_signals(
    name: str, parameters: Parameters, raw: NDArray[np.generic], rate: float, repairs: list[str]
) -> AnalogSignals:
    """Signals (N, C) in their units: (raw - offset) x scale x general scale, as defined by C3D."""
    count = raw.shape[1]
    if count == 0:
        return NO_SIGNALS
    general = parameters.number("ANALOG", "GEN_SCALE")
    scales, offsets = (
        _filled(parameters.continued_array("ANALOG", which), count, usual)
        for which, usual in (("SCALE", 1.0), ("OFFSET", 0.0))
    )
    if "UNSIGNED" in (word.upper() for word in parameters.words("ANALOG", "FORMAT")):
        raw = raw.view(raw.dtype.str.replace("i", "u"))
        offsets = offsets % 65536  # stored in 16 bits, too
    with np.errstate(all="ignore"):
        samples = (raw.astype(np.float64) - offsets) * scales * (1.0 if general is None else general)
    wild = ~(np.abs(samples) < 1e30)
    if wild.any():
        samples[wild] = 0.0
        repairs.append(f"{name}: made 0, as not finite: {counted_noun(int(wild.sum()), 'analog number')}.")
    labels, units = parameters.continued_words("ANALOG", "LABELS"), parameters.continued_words("ANALOG", "UNITS")
    return AnalogSignals(
        tuple(_at(labels, index) or f"Channel {index + 1}" for index in range(count)),
        tuple(_at(units, index) for index in range(count)),
        rate,
        samples,
    )


def force_plates(name: str, parameters: Parameters, channels: int, repairs: list[str]) -> tuple[ForcePlate, ...]:
    """Force plates whose corners the file states; those without a complete description have no channels, and are
    reported.
    """
    count = int(np.clip(parameters.number("FORCE_PLATFORM", "USED") or 0, 0, 32))
    kinds, feeds = (parameters.array("FORCE_PLATFORM", which).squeeze() for which in ("TYPE", "CHANNEL"))
    each = feeds.shape[0] if feeds.ndim > 1 else feeds.size // max(count, 1)
    feeds = parameters.columns("FORCE_PLATFORM", "CHANNEL", max(each, 1))
    corners, origins, matrices = (
        parameters.columns("FORCE_PLATFORM", which, *shape)
        for which, shape in (("CORNERS", (3, 4)), ("ORIGIN", (3,)), ("CAL_MATRIX", (6, 6)))
    )

    def measuring(index: int) -> ForcePlate:
        columns = tuple(int(channel) - 1 for channel in feeds[:, index] if 0 < channel <= channels)
        kind = int(kinds.flat[index])
        size = {1: 6, 2: 6, 3: 8, 4: 6}.get(kind, 0)
        calibration = matrices[:, :, index] if kind == 4 and matrices.size else None
        origin, shape = origins[:, index], corners[:, :, index]
        numbers = (shape, origin, *(() if calibration is None else (calibration,)))
        if len(columns) < size or not size or not all(np.isfinite(array).all() for array in numbers):
            raise ValueError
        return ForcePlate(kind, shape.T, origin, columns[:size], calibration)

    plates: list[ForcePlate] = []
    for place in range(count):
        try:
            plates.append(measuring(place))
        except (IndexError, ValueError, StudioError):
            repairs.append(
                f"{name}: force plate {place + 1} is not described completely; its signals are kept as such."
            )
            if place < corners.shape[2] and np.isfinite(corners[:, :, place]).all() and corners[:, :, place].any():
                plates.append(ForcePlate(0, corners[:, :, place].T, np.zeros(3), ()))
    return tuple(plates)


def marked_events(name: str, content: bytes, parameters: Parameters, repairs: list[str]) -> tuple[TrialEvent, ...]:
    """Events of the parameters, else those of the header, in order of time."""
    labels = parameters.continued_words("EVENT", "LABELS")
    contexts = parameters.continued_words("EVENT", "CONTEXTS")
    times = parameters.columns("EVENT", "TIMES", 2)
    count = int(np.clip(parameters.number("EVENT", "USED") or 0, 0, 65535))
    if not count:
        return _header_events(content, parameters)
    usable = min(count, len(labels), times.shape[1])
    if usable < count:
        repairs.append(f"{name}: EVENT:USED is {count}, but only {usable} events have a label and a time.")
    events = [
        TrialEvent(labels[index], _at(contexts, index), float(60.0 * times[0, index] + times[1, index]))
        for index in range(usable)
        if np.isfinite(times[:, index]).all()
    ]
    return tuple(sorted(events, key=lambda event: event.time))


def _header_events(content: bytes, parameters: Parameters) -> tuple[TrialEvent, ...]:
    """Up to 18 events with labels of four letters, in the second half of the header."""
    words = parameters.numbers.integers(content[:BLOCK_BYTES])
    count = int(words[150])
    if int(words[149]) != _EVENT_KEY or not 0 < count <= 18:
        return ()
    times = parameters.numbers.floats(content[304 : 304 + 72]).astype(np.float64)
    labels = [content[396 + 4 * index : 400 + 4 * index].decode("latin-1").strip() for index in range(count)]
    pairs = zip(labels, times, strict=False)
    found = [TrialEvent(label, "", float(time)) for label, time in pairs if label.isprintable() and np.isfinite(time)]
    return tuple(sorted(found, key=lambda event: event.time))


def measures(parameters: Parameters) -> dict[str, float]:
    """Measures of the subject by name: bone widths, leg lengths, the size of the markers."""
    found: dict[str, float] = {}
    for group in _MEASURE_GROUPS:
        for key, value in parameters.groups.get(group, {}).items():
            if not isinstance(value, tuple) and value.size == 1 and np.isfinite(value.flat[0]):
                found.setdefault(key, float(value.flat[0]))
    return found


def _filled(values: FloatArray, count: int, usual: float) -> FloatArray:
    full = np.full(count, usual)
    known = values[:count]
    full[: len(known)] = np.where(np.isfinite(known), known, usual)
    return full


def _at(words: tuple[str, ...], index: int) -> str:
    return words[index] if index < len(words) else ""
