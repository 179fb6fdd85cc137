"""Request to the solver and its result: immutable values that threads may share."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology, AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.compact_array import CompactArray, PoseArray, compact_array, part_of
from studio.core.constraints.base import Constraint
from studio.core.grounds.ground import Ground
from studio.core.mesh.volume import BodyVolume
from studio.core.normalized.compose import Composite
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.task_assembly.tracks import Tracks
from studio.core.stage.correction import Correction

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AdaptRequest:
    """One motion to be adapted to one body, with all values that determine the result.

    An animated morphology has a row of measures for every frame of the motion.
    """

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    ground: Ground = Ground()
    tracks: Tracks = field(default_factory=dict)
    """Tracks of all targets outside the body, over all frames of the motion."""
    volume: BodyVolume | None = None
    """Volume of the body, from its skin; None for the typical volume of a body with these measures."""
    actor: Morphology | None = None
    """Body of the captured actor: where it touches itself, the adapted body may."""
    limited: bool = True
    """True if limb joints stay within human range, or within the range of the motion itself, despite constraints."""
    eased: bool = False
    """True if solved frames are smoothed in time at acceleration peaks; otherwise each is solved from its own pose
    alone.
    """
    clears: bool = False
    """True if arms stay out of their own body where the actor's arms do."""
    corrections: tuple[Correction, ...] = ()
    """Manual corrections, with times in seconds of the motion."""
    final_tracks: Tracks = field(default_factory=dict)
    """Final tracks of the other performers of a dependency cycle; residuals are measured against them."""


@dataclass(frozen=True, eq=False)
class UnconstrainedPoses:
    """Poses of all frames of a grounded motion before any constraint, in the motion's space."""

    positions: PoseArray
    rotations: PoseArray


@dataclass(frozen=True, eq=False)
class AdaptedMotion:
    """Frames of an adapted motion on one body, in the motion's space (metres, Z up)."""

    morphology: Morphology
    """Measures of the body; of an animated body, those of its first frame."""
    frame_rate: float
    first_frame: int
    """Frame of the motion with which the arrays begin."""
    positions: PoseArray
    """(F, K + 23, 3) points, in the order of ``canonical.BodyLayout``."""
    rotations: PoseArray
    """(F, K + 18, 3, 3) world rotations of the segments."""
    residuals: FloatArray
    """(C, F) residual of each constraint of the request in its ``unit`` (metres or radians), NaN where inactive."""
    animated: AnimatedMorphology | None = None
    """All measures of an animated body, else None."""
    volume: BodyVolume | None = None
    """Volume of the body, if the request has one."""
    unconstrained: UnconstrainedPoses | None = None
    """Poses before any constraint, in results of the solver."""
    contacts: tuple[ContactInterval, ...] = ()
    """Contacts in the result, including those of feet that step at transitions between clips."""
    composite: Composite | None = None
    """The clips that play in these frames, for a motion of the stage."""
    passed_constraints: Mapping[float, "AdaptedMotion"] = field(default_factory=dict)
    """Earlier results of a live stage, by the seconds at which the performer took or released a prop."""

    @property
    def body(self) -> AnyMorphology:
        """Measures of the body, constant or animated."""
        return self.animated or self.morphology

    def morphology_at(self, row: int) -> Morphology:
        """Measures of the body in row ``row`` of these frames."""
        return self.morphology if self.animated is None else self.animated.at(self.first_frame + row)

    @property
    def frame_count(self) -> int:
        return len(self.positions)

    def frames(self, first: int, last: int) -> "AdaptedMotion":
        """Frames ``first`` to ``last`` of the whole motion, both included, as far as they are in this one."""
        rows = slice(max(first - self.first_frame, 0), last + 1 - self.first_frame)
        return replace(
            self,
            first_frame=self.first_frame + rows.start,
            positions=part_of(self.positions, rows),
            rotations=part_of(self.rotations, rows),
            residuals=self.residuals[:, rows],
        )

    def kept(self, store: Callable[[PoseArray], CompactArray] = compact_array) -> "AdaptedMotion":
        """Copy with poses in half the memory (``core.compact_array``); ``store`` compresses an array and chooses its
        place.
        """
        return replace(self, positions=store(self.positions), rotations=store(self.rotations))
