"""By how much a constraint is missed on a body: one rule for every view.

What counts is the worst frame in which the constraint is fully active; where it never is, the worst in which it is
active at all. A foot's constraint is fully active only where no contact holds that foot.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.canonical import BodyPart
from studio.core.constraints.base import Constraint
from studio.core.contacts import ContactInterval
from studio.core.project import Clip, Project
from studio.core.solver.request import AdaptedMotion
from studio.engine.measures import LENGTH, Measure, measure_of

FloatArray = NDArray[np.float64]

FULLY = 1.0 - 1e-9


@dataclass(frozen=True)
class Residual:
    """The worst miss of a constraint on a body: its amount, the motion's frame, whether it is fully active there."""

    amount: float
    """Metres or radians, as ``measure`` says."""
    frame: int
    fully_active: bool
    measure: Measure = LENGTH

    @property
    def words(self) -> str:
        """The amount with its unit."""
        return self.measure.words(self.amount)

    @property
    def weight(self) -> float:
        """How bad it is, among misses of any measure."""
        return self.measure.weight(self.amount)

    @property
    def partly(self) -> bool:
        """Whether the eye forgives it."""
        return self.amount < self.measure.partly_below

    @property
    def held(self) -> bool:
        """Whether nobody sees that it is missed."""
        return self.amount < self.measure.held_below

    @property
    def remark(self) -> str:
        """What has to be said beside the number; mostly nothing."""
        return "" if self.fully_active else "never fully active"


def residual_row(project: Project, motion: AdaptedMotion | None, constraint_id: str) -> FloatArray | None:
    """(F,) metres or radians, NaN where nothing is asked; None without an answer, or while it is off."""
    constraint = project.constraints.get(constraint_id)
    if constraint is None or motion is None or not constraint.enabled:
        return None
    asked = [key for key, each in project.constraints_of(constraint.motion_id).items() if each.enabled]
    # With another count the result answers an older question.
    return motion.residuals[asked.index(constraint_id)] if len(motion.residuals) == len(asked) else None


def worst_residual(
    project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str
) -> Residual | None:
    """The worst miss in the frames that the performer plays; None where nothing is asked or known."""
    row = residual_row(project, motion, constraint_id)
    if row is None or motion is None:
        return None
    constraint = project.constraints[constraint_id]
    clip = _clip(project, performer_id, constraint.motion_id)
    if clip is None:
        return None
    frames = motion.first_frame + np.arange(motion.frame_count)
    asked = np.where((frames >= clip.first) & (frames <= clip.last), row, np.nan)
    full = np.where(_activation(project, constraint, frames, motion.frame_rate) >= FULLY, asked, np.nan)
    fully_active = bool(np.isfinite(full).any())
    counted = full if fully_active else asked
    if not np.isfinite(counted).any():
        return None
    place = int(np.nanargmax(counted))
    return Residual(float(counted[place]), int(frames[place]), fully_active, measure_of(constraint))


def _clip(project: Project, performer_id: str, motion_id: str) -> Clip | None:
    clips = project.performers[performer_id].clips
    return next((clip for clip in clips if clip.motion_id == motion_id), None)


def _activation(project: Project, constraint: Constraint, frames: NDArray[np.int64], frame_rate: float) -> FloatArray:
    """(F,) what is asked of the constraint: less than its curve where a contact has its limb."""
    contacts = tuple(project.contacts_of(constraint.motion_id).values())
    free = _freedom(contacts, constraint.point.part, int(frames[-1]) + 1, frame_rate)
    return np.asarray(constraint.activation.at(frames / frame_rate) * free[frames])


@lru_cache(maxsize=64)
def _freedom(contacts: tuple[ContactInterval, ...], part: BodyPart, frame_count: int, frame_rate: float) -> FloatArray:
    from studio.core.solver.carrying import limb_freedom  # not before a result is there: it loads kernels
    from studio.core.solver.packing import limb_of

    return limb_freedom(contacts, limb_of(part), frame_count, frame_rate)
