"""Trial: the recording of an optical capture system: points over time, analog signals, force plates, events."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.plausible import FRAME_RATE_RANGE

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_PLATE = 0.2, 4.0
"""Metres between which the sides of force plates are, from a step to a treadmill."""
METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "foot": 0.3048}
"""Metres a unit."""
MARKER_KIND, VIRTUAL_KIND = "marker", "virtual"
"""Kinds of points that are places: seen by cameras, or computed from such."""


def _freeze(value: object, name: str, shape: tuple[int | None, ...]) -> None:
    array = np.array(getattr(value, name), dtype=np.float64)
    fits = array.ndim == len(shape) and all(
        wanted in (None, found) for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise StudioError(f"{type(value).__name__} needs {name} of shape {shape}, not {array.shape}.")
    array.setflags(write=False)
    object.__setattr__(value, name, array)


@dataclass(frozen=True)
class TrialEvent:
    """Event in time, marked by an operator or a program: ``Foot Strike`` of the side ``Right``."""

    label: str
    context: str
    time: float
    """Seconds from frame 1 of the recording, which is no frame of this trial where it begins later."""


@dataclass(frozen=True, eq=False)
class AnalogSignals:
    """Analog signals sampled beside the points: forces, muscles, switches."""

    labels: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    """Samples a second; a whole multiple of the frame rate."""
    samples: FloatArray
    """(N, C) in ``units``."""

    def __post_init__(self) -> None:
        _freeze(self, "samples", (None, len(self.labels)))


@dataclass(frozen=True, eq=False)
class ForcePlate:
    """Force plate in the floor, and its analog channels."""

    kind: int
    """1 to 4 as C3D counts them: 1 force and centre of pressure, 2 force and moment, 3 eight sensors, 4 calibrated; 0
    for one whose force is not described."""
    corners: FloatArray
    """(4, 3) in file units and axes."""
    origin: FloatArray
    """(3,) from the middle of the surface to the sensors (or back: files disagree), file units."""
    channels: tuple[int, ...]
    """Columns of the analog samples; none for kind 0."""
    calibration: FloatArray | None = None
    """(6, 6) from channels to forces and moments, kind 4."""

    def __post_init__(self) -> None:
        _freeze(self, "corners", (4, 3))
        _freeze(self, "origin", (3,))
        if self.calibration is not None:
            _freeze(self, "calibration", (6, 6))


NO_SIGNALS = AnalogSignals((), (), 1.0, np.zeros((0, 0)))


@dataclass(frozen=True, eq=False)
class Trial:
    """P points over F frames in the file's own unit and axes; NaN where a point was not seen.

    Raises StudioError if the parts do not fit each other.
    """

    name: str
    source: str
    """File name without folder."""
    labels: tuple[str, ...]
    """(P,) all different, with the subject's prefix where the file has one: ``Anna:LASI``."""
    kinds: tuple[str, ...]
    """(P,) ``marker``, or what a model computed and stored as a point: ``virtual``, ``angle``, ``force`` ..."""
    points: FloatArray
    """(F, P, 3) in ``unit`` (angles, forces and their like in units of their own)."""
    residuals: FloatArray
    """(F, P) in ``unit``: how well the cameras agreed; 0 for what was computed, -1 for what was not seen."""
    frame_rate: float
    first_frame: int
    """The number that the recording gives to frame 0 of this trial."""
    unit: str
    """``m``, ``cm``, ``mm`` or ``inch``."""
    analog: AnalogSignals = NO_SIGNALS
    plates: tuple[ForcePlate, ...] = ()
    events: tuple[TrialEvent, ...] = ()
    measures: Mapping[str, float] = field(default_factory=dict)
    """Measures of the subject in the file's units: ``LKneeWidth``, ``MarkerDiameter`` ..."""

    def __post_init__(self) -> None:
        count = len(self.labels)
        _freeze(self, "points", (None, count, 3))
        _freeze(self, "residuals", (len(self.points), count))
        object.__setattr__(self, "measures", MappingProxyType(dict(self.measures)))
        if len(set(self.labels)) != count or len(self.kinds) != count:
            raise StudioError(f"The {count} points of '{self.name}' need a label each and a kind.")
        if len(self.points) == 0 or not (np.isfinite(self.frame_rate) and self.frame_rate > 0.0):
            raise StudioError(f"'{self.name}' needs a frame at least and a usable frame rate.")
        try:
            FRAME_RATE_RANGE.check(self.frame_rate)
        except ValueError as error:
            raise StudioError(f"'{self.name}': {error}") from error
        if self.unit not in METRES:
            raise StudioError(f"'{self.unit}' is not a unit of '{self.name}'. Choose {', '.join(METRES)}.")

    @property
    def frame_count(self) -> int:
        """Frames F."""
        return len(self.points)

    @cached_property
    def ever_seen(self) -> tuple[bool, ...]:
        """(P,) true if a point is seen in any frame."""
        return tuple(np.asarray(seen_mask(self.points).any(axis=0)).tolist())

    @property
    def metres(self) -> float:
        """Metres per unit."""
        return METRES[self.unit]

    @cached_property
    def metres_of_plates(self) -> float:
        """Metres per unit of the plates' corners: that of the points, unless the plates would have impossible sizes."""
        corners = np.array([plate.corners for plate in self.plates]).reshape(-1, 4, 3)
        sides = np.linalg.norm(corners[:, [1, 3]] - corners[:, :1], axis=2)
        side = float(np.median(sides[sides > 0.0])) if sides.any() else 0.0
        fitting = (METRES[unit] for unit in (self.unit, "m", "mm", "cm", "inch"))
        return next((each for each in fitting if _PLATE[0] < side * each < _PLATE[1]), self.metres)

    @property
    def markers(self) -> tuple[str, ...]:
        """Labels of the points seen by cameras."""
        return tuple(label for label, kind in zip(self.labels, self.kinds, strict=True) if kind == MARKER_KIND)

    def track(self, label: str) -> FloatArray:
        """(F, 3) of one point, in the file's unit."""
        return np.asarray(self.points[:, self.labels.index(label)])

    def event_frame(self, event: TrialEvent) -> float:
        """Frame of an event, with a fraction, from frame 0 of this trial."""
        return event.time * self.frame_rate - (self.first_frame - 1)

    def with_labels(self, labels: Iterable[str]) -> "Trial":
        """Copy with some of its points, in their order."""
        wanted = set(labels)
        kept = [place for place, label in enumerate(self.labels) if label in wanted]
        return replace(
            self,
            labels=tuple(self.labels[place] for place in kept),
            kinds=tuple(self.kinds[place] for place in kept),
            points=self.points[:, kept],
            residuals=self.residuals[:, kept],
        )

    def with_points(self, points: FloatArray) -> "Trial":
        """Copy with other coordinates (F, P, 3)."""
        return replace(self, points=points)


def seen_mask(points: FloatArray) -> BoolArray:
    """True (...) for each of points (..., 3) that was seen; one sum is several times faster than three tests."""
    return np.asarray(np.isfinite(points[..., 0] + points[..., 1] + points[..., 2]))


def label_without_subject(label: str) -> str:
    """Label without its subject: ``LASI`` of ``Anna:LASI``."""
    return label.rpartition(":")[2].strip()


def subject_of(label: str) -> str:
    """Subject of a label: ``Anna`` of ``Anna:LASI``; empty if there is none."""
    return label.rpartition(":")[0].strip()
