"""Capture: a recorded motion in world axes and metres, with all assumptions that its reader made."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.markers.force_plates import PlateLoad
from studio.core.markers.take import MarkerTake
from studio.core.plausible import FRAME_RATE_RANGE, GROUND_RANGE

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Guess:
    """Assumption that a reader made about a file, and that the user may change."""

    subject: str
    """Subject of the assumption: one of ``unit, up axis, frame rate, floor, floor drift, steps, body map, feet, moving
    offsets, cleaning, reference pose, first frame``.
    """
    value: str
    reason: str
    confidence: Confidence | None = None
    """Confidence of the assumption; None if the reader of a plug-in does not state it."""

    @property
    def title(self) -> str:
        """Subject and value, with the confidence if it is known: ``unit: cm (sure)``."""
        return f"{self.subject}: {self.value}" + (f" ({self.confidence})" if self.confidence else "")


@dataclass(frozen=True)
class Capture:
    """Recorded motion of one body. Raises StudioError if its parts do not fit each other."""

    name: str
    source: str
    """Name of the source file, without folder."""
    skeleton: Skeleton
    poses: PoseSequence
    frame_rate: float
    body_map: BodyMap | None
    """Joints of the human body; None if the body is no humanoid."""
    reference_rotations: FloatArray
    """Local rotations (J, 4) of a pose upright along Z, as near to a T-, A- or N-pose as possible."""
    floor: float
    """Height of the ground in metres, world Z."""
    unit: str
    up_axis: str
    first_frame: int
    """First frame of the motion proper: later than 0 after a calibration pose."""
    guesses: tuple[Guess, ...]
    repairs: tuple[str, ...]
    markers: MarkerTake | None = None
    """Optical markers from which the body was solved, kept to solve it again; None for captures without markers."""
    plate_loads: tuple[PlateLoad, ...] = ()
    """Loads of steps on force plates that were recorded with the markers."""
    digest: str = ""
    """SHA-256 of the content of the source file in hexadecimal digits, by which the file is found again; empty if
    unknown.
    """

    def __post_init__(self) -> None:
        reference = np.array(self.reference_rotations, dtype=np.float64)
        reference.setflags(write=False)
        object.__setattr__(self, "reference_rotations", reference)
        for name in ("frame_rate", "floor"):
            object.__setattr__(self, name, float(getattr(self, name)))  # kernels are compiled once more for an int
        joints = self.skeleton.joint_count
        if self.poses.joint_count != joints or reference.shape != (joints, 4):
            raise StudioError(f"The poses or the reference pose of '{self.name}' do not fit its {joints} joints.")
        if not (np.isfinite(self.frame_rate) and self.frame_rate > 0.0 and np.isfinite(self.floor)):
            raise StudioError(f"The frame rate or the floor of '{self.name}' is not a usable number.")
        try:
            FRAME_RATE_RANGE.check(self.frame_rate)
            GROUND_RANGE.check(self.floor)
        except ValueError as error:
            raise StudioError(f"'{self.name}': {error}") from error
        mapped = (*self.body_map.parts.values(), *self.body_map.spine) if self.body_map else ()
        if any(not 0 <= joint < joints for joint in mapped):
            raise StudioError(f"The body map of '{self.name}' names a joint that its skeleton does not have.")
        if not 0 <= self.first_frame < self.frame_count:
            raise StudioError(f"'{self.name}' has no frame {self.first_frame}; it ends at {self.frame_count - 1}.")

    @property
    def frame_count(self) -> int:
        """Number of frames F, including those before ``first_frame``."""
        return self.poses.frame_count

    @property
    def duration(self) -> float:
        """Seconds from the first frame of the motion proper to the last frame."""
        return (self.frame_count - 1 - self.first_frame) / self.frame_rate

    def with_body_map(self, names: Mapping[str, str]) -> "Capture":
        """Copy with the body map ``names`` of the user, without the guess about it."""
        return self._overruled("body map", body_map=BodyMap.from_json(self.skeleton, names))

    def with_frame_rate(self, frame_rate: float) -> "Capture":
        """Copy with the same frames played at ``frame_rate`` Hz."""
        return self._overruled("frame rate", frame_rate=frame_rate)

    def with_floor(self, floor: float) -> "Capture":
        """Copy with the ground at the height ``floor`` in metres."""
        return self._overruled("floor", floor=floor)

    def with_first_frame(self, first_frame: int) -> "Capture":
        """Copy whose motion begins at ``first_frame``."""
        return self._overruled("first frame", first_frame=first_frame)

    def with_guess(self, guess: Guess) -> "Capture":
        """Copy with one more guess, listed before the others."""
        return replace(self, guesses=(guess, *self.guesses))

    def without_guess(self, subject: str) -> "Capture":
        """Copy without the guess about ``subject``, after the user has decided."""
        return self._overruled(subject)

    def _overruled(self, subject: str, **values: object) -> "Capture":
        guesses = tuple(guess for guess in self.guesses if guess.subject != subject)
        return replace(self, guesses=guesses, **values)  # type: ignore[arg-type]
