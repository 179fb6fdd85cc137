"""Trial: a recording of an optical capture system, with points over time, analog signals, force plates and events."""

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
TRIAL_UNIT_METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "foot": 0.3048}
"""Length in metres of each unit of a trial."""
MARKER_KIND, VIRTUAL_KIND = "marker", "virtual"
"""Kinds of points that are positions: seen by cameras, or computed from such."""


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
    """Event marked by an operator or a program, such as ``Foot Strike`` of the side ``Right``."""

    label: str
    context: str
    time: float
    """Seconds from frame 1 of the recording, which is before this trial if it begins later."""


@dataclass(frozen=True, eq=False)
class AnalogSignals:
    """Analog signals sampled together with the points: forces, muscles, switches."""

    labels: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    """Samples per second; a whole multiple of the frame rate."""
    samples: FloatArray
    """Samples (N, C) in ``units``."""

    def __post_init__(self) -> None:
        _freeze(self, "samples", (None, len(self.labels)))


@dataclass(frozen=True, eq=False)
class ForcePlate:
    """Force plate in the floor, and its analog channels."""

    kind: int
    """Type 1 to 4 of C3D: 1 force and centre of pressure, 2 force and moment, 3 eight sensors, 4 calibrated; 0 for a
    plate whose force is not described.
    """
    corners: FloatArray
    """Corners (4, 3) in file units and axes."""
    origin: FloatArray
    """Vector (3,) in file units from the middle of the surface to the sensors, or back: files disagree."""
    channels: tuple[int, ...]
    """Columns of the analog samples; empty for kind 0."""
    calibration: FloatArray | None = None
    """Matrix (6, 6) from channels to forces and moments, for kind 4."""

    def __post_init__(self) -> None:
        _freeze(self, "corners", (4, 3))
        _freeze(self, "origin", (3,))
        if self.calibration is not None:
            _freeze(self, "calibration", (6, 6))


NO_SIGNALS = AnalogSignals((), (), 1.0, np.zeros((0, 0)))


@dataclass(frozen=True, eq=False)
class Trial:
    """Positions of P points over F frames in the file's own unit and axes; NaN where a point was not seen.

    Raises StudioError if the parts do not fit each other.
    """

    name: str
    source: str
    """Name of the file without folder."""
    labels: tuple[str, ...]
    """Unique labels (P,), with the subject's prefix if the file has one: ``Anna:LASI``."""
    kinds: tuple[str, ...]
    """Kinds (P,): ``marker``, or that of a quantity that a model computed and stored as a point: ``virtual``,
    ``angle``, ``force`` ...
    """
    points: FloatArray
    """Coordinates (F, P, 3) in ``unit``; angles, forces and other quantities are in units of their own."""
    residuals: FloatArray
    """Residuals (F, P) in ``unit`` of the cameras' rays; 0 for computed points, -1 for points not seen."""
    frame_rate: float
    first_frame: int
    """Number in the recording of frame 0 of this trial."""
    unit: str
    """Unit of length: ``m``, ``cm``, ``mm`` or ``inch``."""
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
        if self.unit not in TRIAL_UNIT_METRES:
            raise StudioError(f"'{self.unit}' is not a unit of '{self.name}'. Choose {', '.join(TRIAL_UNIT_METRES)}.")

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.points)

    @cached_property
    def ever_seen(self) -> tuple[bool, ...]:
        """Flags (P,) of the points that are seen in some frame."""
        return tuple(np.asarray(seen_mask(self.points).any(axis=0)).tolist())

    @property
    def metres(self) -> float:
        """Length in metres of the trial's unit."""
        return TRIAL_UNIT_METRES[self.unit]

    @cached_property
    def metres_of_plates(self) -> float:
        """Length in metres of the unit of the plates' corners: that of the points, unless the plates would have
        impossible sizes.
        """
        corners = np.array([plate.corners for plate in self.plates]).reshape(-1, 4, 3)
        sides = np.linalg.norm(corners[:, [1, 3]] - corners[:, :1], axis=2)
        side = float(np.median(sides[sides > 0.0])) if sides.any() else 0.0
        fitting = (TRIAL_UNIT_METRES[unit] for unit in (self.unit, "m", "mm", "cm", "inch"))
        return next((each for each in fitting if _PLATE[0] < side * each < _PLATE[1]), self.metres)

    @property
    def markers(self) -> tuple[str, ...]:
        """Labels of the points seen by cameras."""
        return tuple(label for label, kind in zip(self.labels, self.kinds, strict=True) if kind == MARKER_KIND)

    def track(self, label: str) -> FloatArray:
        """Coordinates (F, 3) of the point ``label``, in the file's unit."""
        return np.asarray(self.points[:, self.labels.index(label)])

    def event_frame(self, event: TrialEvent) -> float:
        """Frame of an event, with a fraction, counted from frame 0 of this trial."""
        return event.time * self.frame_rate - (self.first_frame - 1)

    def with_labels(self, labels: Iterable[str]) -> "Trial":
        """Copy with only the points ``labels``, in their order."""
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
    """Mask (...) of the ``points`` (..., 3) that were seen; one sum is several times faster than three tests."""
    return np.asarray(np.isfinite(points[..., 0] + points[..., 1] + points[..., 2]))


def label_without_subject(label: str) -> str:
    """Label without its subject: ``LASI`` for ``Anna:LASI``."""
    return label.rpartition(":")[2].strip()


def subject_of(label: str) -> str:
    """Subject of a label: ``Anna`` for ``Anna:LASI``; empty if there is none."""
    return label.rpartition(":")[0].strip()
