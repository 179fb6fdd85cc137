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
from studio.core.solver.asking.tracks import Tracks
from studio.core.stage.correction import Correction

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AdaptRequest:
    """One motion to be adapted to one body, with all values on which the result depends.

    An animated morphology has a row of measures for every frame of the motion.
    """

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    ground: Ground = Ground()
    tracks: Tracks = field(default_factory=dict)
    """Tracks of all targets beyond the body itself, over all frames of the motion."""
    volume: BodyVolume | None = None
    """Volume of the body, from its skin; None for the usual volume with its measures."""
    actor: Morphology | None = None
    """Captured body of the motion: where it touches itself, others may."""
    limited: bool = True
    """True if constraints keep limb joints within human range, or within the range of the motion itself."""
    eased: bool = False
    """True if frames are smoothed in time at acceleration peaks; otherwise each is solved from its own pose alone."""
    clears: bool = False
    """True if arms stay out of their own body where the actor's do."""
    corrections: tuple[Correction, ...] = ()
    """Manual corrections, their times in seconds of the motion."""
    final_tracks: Tracks = field(default_factory=dict)
    """Tracks of the others of its dependency cycle as solved in the end: residuals are measured by them."""


@dataclass(frozen=True, eq=False)
class UnconstrainedPoses:
    """Poses of all frames of a grounded motion before any constraint, in the motion's space."""

    positions: PoseArray
    rotations: PoseArray


@dataclass(frozen=True, eq=False)
class AdaptedMotion:
    """Frames from ``first_frame`` on of a motion on one body, in the motion's space (metres, Z up).

    ``positions`` (F, K+23, 3) and ``rotations`` (F, K+18, 3, 3) follow ``canonical.BodyLayout``; ``residuals`` (C, F)
    has each constraint's residual in its ``unit`` (metres or radians), in the order of the request, NaN where inactive.
    ``morphology`` of an animated body is its first frame, ``animated`` the whole; ``volume`` is the body's volume, if
    requested; ``unconstrained`` are the poses before constraints, in results of the solver.
    """

    morphology: Morphology
    frame_rate: float
    first_frame: int
    positions: PoseArray
    rotations: PoseArray
    residuals: FloatArray
    animated: AnimatedMorphology | None = None
    volume: BodyVolume | None = None
    unconstrained: UnconstrainedPoses | None = None
    contacts: tuple[ContactInterval, ...] = ()
    """Contacts of the solver's result: also those of feet that step where clips take over."""
    composite: Composite | None = None
    """Composite of a stage's motion: the clips that play in its frames."""
    passed_constraints: Mapping[float, "AdaptedMotion"] = field(default_factory=dict)
    """Earlier results of a live stage, by the seconds at which it took or released a prop."""

    @property
    def body(self) -> AnyMorphology:
        """All measures of the body, constant or animated."""
        return self.animated or self.morphology

    def morphology_at(self, row: int) -> Morphology:
        """Measures of the body in one of these frames."""
        return self.morphology if self.animated is None else self.animated.at(self.first_frame + row)

    @property
    def frame_count(self) -> int:
        return len(self.positions)

    def frames(self, first: int, last: int) -> "AdaptedMotion":
        """Frames ``first`` to ``last`` of the whole motion, both included, as far as they exist."""
        rows = slice(max(first - self.first_frame, 0), last + 1 - self.first_frame)
        return replace(
            self,
            first_frame=self.first_frame + rows.start,
            positions=part_of(self.positions, rows),
            rotations=part_of(self.rotations, rows),
            residuals=self.residuals[:, rows],
        )

    def kept(self, store: Callable[[PoseArray], CompactArray] = compact_array) -> "AdaptedMotion":
        """Copy with poses in half the memory, see ``core.compact_array``; ``store`` chooses where."""
        return replace(self, positions=store(self.positions), rotations=store(self.rotations))
