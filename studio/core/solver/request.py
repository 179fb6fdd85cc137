"""What is asked of the solver and what it answers: values that any thread may hold."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology, AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Constraint
from studio.core.grounds.ground import Ground
from studio.core.mesh.volume import BodyVolume
from studio.core.normalized.compose import Composite
from studio.core.normalized.motion import NormalizedMotion
from studio.core.single import PoseArray, part_of, single
from studio.core.solver.asking.tracks import Tracks

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AdaptRequest:
    """One motion to be adapted to one body: all the values the answer depends on.

    An animated morphology has a row of measures for every frame of the motion.
    """

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    ground: Ground = Ground()
    tracks: Tracks = field(default_factory=dict)
    """What constraints follow beyond the body itself, over all frames of the motion."""
    volume: BodyVolume | None = None
    """The room that the body takes up, as its skin has it; None for what is usual with its measures."""
    actor: Morphology | None = None
    """The body that the motion was captured from: where it touches itself, others may."""
    limited: bool = True
    """Whether constraints bring the joints of limbs no further than a person's go, or than the motion itself does."""
    eased: bool = False
    """Whether frames are eased in time where joints jolt; without, each is solved from its own pose alone."""
    clears: bool = False
    """Whether arms stay out of their own body where the actor's do."""


@dataclass(frozen=True, eq=False)
class Unasked:
    """All frames of a motion on a body as it stands before anything is asked of it, in the motion's space."""

    positions: PoseArray
    rotations: PoseArray


@dataclass(frozen=True, eq=False)
class AdaptedMotion:
    """Frames ``first_frame`` and on of a motion on one body, in the motion's space (metres, Z up).

    ``positions`` (F, K+23, 3) and ``rotations`` (F, K+18, 3, 3) follow ``canonical.BodyLayout``; ``residuals``
    (C, F) is by how much each constraint is missed, in its ``unit`` (metres or radians), in the order of the request,
    NaN where the constraint is not active. ``morphology`` of a body that changes is its beginning, ``animated`` is all;
    ``volume`` is the room that the body takes up, where it was asked for; ``unasked`` is known of what the solver made.
    """

    morphology: Morphology
    frame_rate: float
    first_frame: int
    positions: PoseArray
    rotations: PoseArray
    residuals: FloatArray
    animated: AnimatedMorphology | None = None
    volume: BodyVolume | None = None
    unasked: Unasked | None = None
    contacts: tuple[ContactInterval, ...] = ()
    """What stands on the ground, of what the solver made: where clips take over, when feet are lifted and land."""
    composite: Composite | None = None
    """What of a stage it is, where it is of one: which clips play in which of its frames."""
    passed: Mapping[float, "AdaptedMotion"] = field(default_factory=dict)
    """What it was, of a stage that plays live, at the seconds at which it took or let go of something."""

    @property
    def body(self) -> AnyMorphology:
        """All measures of the body, whether they change or not."""
        return self.animated or self.morphology

    def morphology_at(self, row: int) -> Morphology:
        """The measures of the body in one of these frames."""
        return self.morphology if self.animated is None else self.animated.at(self.first_frame + row)

    @property
    def frame_count(self) -> int:
        return len(self.positions)

    def frames(self, first: int, last: int) -> "AdaptedMotion":
        """Frames ``first`` to ``last`` of the whole motion, both included, as far as they are there."""
        rows = slice(max(first - self.first_frame, 0), last + 1 - self.first_frame)
        return replace(
            self,
            first_frame=self.first_frame + rows.start,
            positions=part_of(self.positions, rows),
            rotations=part_of(self.rotations, rows),
            residuals=self.residuals[:, rows],
        )

    def kept(self) -> "AdaptedMotion":
        """The same with its poses in half the memory, see ``core.single``."""
        return replace(self, positions=single(self.positions), rotations=single(self.rotations))
