"""Residual of a constraint on a body: one rule for every view.

The residual is that of the worst frame in which the constraint is fully active or, if there is none, of the worst in
which it is active at all. A foot's constraint is fully active only where the foot has no contact.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Constraint
from studio.core.curves.activation import FULLY_ACTIVE
from studio.core.project_cache import project_cache
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from studio.document import colours
from studio.engine.live_interface import Live
from studio.engine.residual_measures import LENGTH_MEASURE, Measure, measure_of

FloatArray = NDArray[np.float64]


class Inactive(StrEnum):
    """Reason why a constraint acts in no frame of a body."""

    ELSEWHERE = "not active"
    OVERRIDDEN = "overridden by contacts"
    CUT = "fade cut by the clip"

    @property
    def short(self) -> str:
        """Word for a narrow column."""
        return {Inactive.OVERRIDDEN: "overridden", Inactive.CUT: "fade cut"}.get(self, str(self))

    @property
    def colour(self) -> str:
        """Colour of a warning where the clip leaves the constraint out."""
        return colours.PARTLY if self is Inactive.CUT else colours.TEXT_THIRD


@dataclass(frozen=True)
class Residual:
    """Worst residual of a constraint on a body: its amount, the motion's frame, True if it is fully active there."""

    amount: float
    """Metres or radians, as ``measure`` says."""
    frame: int
    fully_active: bool
    measure: Measure = LENGTH_MEASURE

    @property
    def text(self) -> str:
        """Amount with its unit."""
        return self.measure.text_of(self.amount)

    @property
    def weight(self) -> float:
        """Badness of the residual, comparable between measures."""
        return self.measure.weight(self.amount)

    @property
    def is_hardly_visible(self) -> bool:
        """True if the residual is hardly visible."""
        return self.amount < self.measure.partly_below

    @property
    def is_invisible(self) -> bool:
        """True if the residual is invisible."""
        return self.amount < self.measure.held_below

    @property
    def remark(self) -> str:
        """Remark beside the number; usually empty."""
        return "" if self.fully_active else "never fully active"


@dataclass(frozen=True, eq=False)
class ConstraintResiduals:
    """Residuals of a constraint in frames of its own motion, from ``first_frame`` on, at ``frame_rate``. ``amounts``
    (F,) metres or radians, NaN where inactive.
    """

    first_frame: int
    frame_rate: float
    amounts: FloatArray

    @property
    def frames(self) -> NDArray[np.int64]:
        """(F,) frames of the motion."""
        return self.first_frame + np.arange(len(self.amounts))


def residuals_on(
    project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str
) -> ConstraintResiduals | None:
    """Residual of a constraint on a body; None without a result, or where it does not apply.

    Where a performer plays its motion more than once, the worse one counts.
    """
    constraint = project.constraints.get(constraint_id)
    performer = project.performers.get(performer_id)
    if constraint is None or motion is None or performer is None or not constraint.enabled:
        return None
    asked = constraints_of_performer(project, performer_id)
    rows = [row for row, each in enumerate(asked) if each.constraint_id == constraint_id]
    # With another count the result answers an older question.
    if not rows or len(motion.residuals) != len(asked):
        return None
    composite = motion.composite
    if composite is None or composite.is_plain:
        return ConstraintResiduals(
            motion.first_frame, motion.frame_rate, np.fmax.reduce(motion.residuals[rows], axis=0)
        )
    clip = performer.clips[asked[rows[0]].clip]
    capture = project.captures[project.motions[clip.motion_id].capture_id]
    amounts = np.full(capture.frame_count, np.nan)
    played = {each.piece.origin: each for each in reversed(composite.played)}
    if any((asked[row].clip, asked[row].repeat) not in played for row in rows):
        return None  # the result is of a row of other clips
    for row in rows:
        each = played[asked[row].clip, asked[row].repeat]
        frames = motion.first_frame + np.flatnonzero(
            np.isfinite(motion.residuals[row])
        )  # on into parts of a split clip
        own = np.rint(each.motion_frames(frames, composite.timing)).astype(np.int64).clip(0, capture.frame_count - 1)
        np.fmax.at(amounts, own, motion.residuals[row, frames - motion.first_frame])
    return ConstraintResiduals(0, capture.frame_rate, amounts)


def applies_to(project: Project, performer_id: str, constraint_id: str) -> bool:
    """True if a constraint applies to a performer: enabled, on a motion that it plays, and in scope."""
    constraint, performer = project.constraints[constraint_id], project.performers[performer_id]
    return constraint.enabled and any(
        clip.motion_id == constraint.motion_id and constraint.scope.includes(performer_id, clip.id)
        for clip in performer.clips
    )


def unsolved_words(live: Live) -> str:
    """Words for a residual that is not known."""
    return "not solved yet" if live.ready else "waits for the solver"


def worst_residual(
    project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str
) -> Residual | None:
    """Worst residual in the frames that the performer plays; None if the constraint is inactive or not yet solved."""
    missed = residuals_on(project, performer_id, motion, constraint_id)
    if missed is None:
        return None
    constraint = project.constraints[constraint_id]
    frames = missed.frames
    clips = _clips_with(project, performer_id, constraint)
    played = np.any([(frames >= clip.first) & (frames <= clip.last) for clip in clips], axis=0)
    asked = np.where(played, missed.amounts, np.nan)
    activation = constraint.activation.at(frames / missed.frame_rate) * freedom_from_contacts(
        project, performer_id, constraint, missed
    )
    full = np.where(activation >= FULLY_ACTIVE, asked, np.nan)
    fully_active = bool(np.isfinite(full).any())
    counted = full if fully_active else asked
    if not np.isfinite(counted).any():
        return None
    place = int(np.nanargmax(counted))
    return Residual(float(counted[place]), int(frames[place]), fully_active, measure_of(constraint))


def inactivity(project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str) -> Inactive:
    """Reason why a constraint without a residual is inactive: its limb stands, or a clip leaves no time to fade."""
    missed = residuals_on(project, performer_id, motion, constraint_id)
    if missed is None:
        return Inactive.ELSEWHERE
    constraint, frames = project.constraints[constraint_id], missed.frames
    clips = _clips_with(project, performer_id, constraint)
    played = np.any([(frames >= clip.first) & (frames <= clip.last) for clip in clips], axis=0)
    active = played & (constraint.activation.at(frames / missed.frame_rate) > 0.0)
    free = freedom_from_contacts(project, performer_id, constraint, missed) >= 1.0
    if not active.any():
        return Inactive.ELSEWHERE
    return Inactive.CUT if (active & free).any() else Inactive.OVERRIDDEN


def freedom_from_contacts(
    project: Project, performer_id: str, constraint: Constraint, missed: ConstraintResiduals
) -> FloatArray:
    """Factor (F,) of the constraint's activation: 0 in frames in which a contact holds its limb, 1 without one."""
    clip, frames = _clips_with(project, performer_id, constraint)[0], missed.frames
    contacts = tuple(project.contacts_for(performer_id, clip).values())
    return _freedom(contacts, constraint.point.part, int(frames[-1]) + 1, missed.frame_rate)[frames]


def _clips_with(project: Project, performer_id: str, constraint: Constraint) -> list[Clip]:
    return [each for each in project.performers[performer_id].clips if each.motion_id == constraint.motion_id]


@project_cache(maxsize=64)
def _freedom(contacts: tuple[ContactInterval, ...], part: BodyPart, frame_count: int, frame_rate: float) -> FloatArray:
    from studio.core.solver.asking.points import limb_of
    from studio.core.solver.standing.body_support import limb_freedom  # not before a result is there: it loads kernels

    return limb_freedom(contacts, limb_of(part), frame_count, frame_rate)
