"""Residual of a constraint on a performer, by one rule for all views.

It is that of the worst frame in which the constraint is fully active or, if it never is, of the worst frame in which it
is active at all. A foot's constraint is fully active only while the foot has no contact.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval
from studio.core.curves.activation import LEAST_FULL_ACTIVATION
from studio.core.project_cache import project_cache
from studio.core.solver.performers.rows import stage_span, timing_of
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.core.stage.timing import Timing
from studio.document import colours
from studio.engine.live_interface import Live
from studio.engine.residual_measures import LENGTH_MEASURE, Measure, measure_of

FloatArray = NDArray[np.float64]


class Inactive(StrEnum):
    """Reason why a constraint is not active in any frame of a performer."""

    ELSEWHERE = "not active"
    OVERRIDDEN = "overridden by contacts"
    CUT = "fade cut by the clip"

    @property
    def short(self) -> str:
        """Short text for a narrow column."""
        return {Inactive.OVERRIDDEN: "overridden", Inactive.CUT: "fade cut"}.get(self, str(self))

    @property
    def colour(self) -> str:
        """Text colour; that of a warning if the clip cuts the constraint off."""
        return colours.PARTLY if self is Inactive.CUT else colours.TEXT_THIRD


@dataclass(frozen=True)
class Residual:
    """Worst residual of a constraint on a performer, with its frame."""

    amount: float
    """Metres or radians, by ``measure``."""
    frame: int
    """Frame of the constraint's motion."""
    stage_frame: int
    time: float
    """Stage time in seconds."""
    fully_active: bool
    measure: Measure = LENGTH_MEASURE

    @property
    def text(self) -> str:
        """Amount as text with unit."""
        return self.measure.text_of(self.amount)

    @property
    def weight(self) -> float:
        """Badness of the residual, comparable between measures."""
        return self.measure.weight(self.amount)

    @property
    def is_hardly_visible(self) -> bool:
        """True if the residual is hardly visible, so that the constraint is partly held."""
        return self.amount < self.measure.partly_below

    @property
    def is_invisible(self) -> bool:
        """True if the residual is invisible, so that the constraint is held."""
        return self.amount < self.measure.held_below

    @property
    def remark(self) -> str:
        """Remark to be shown after the amount; usually empty."""
        return "" if self.fully_active else "never fully active"


@dataclass(frozen=True, eq=False)
class ConstraintResiduals:
    """Residuals of a constraint in all frames of a performer's track."""

    timing: Timing
    """Stage times of the frames; index 0 is the first frame."""
    frames: NDArray[np.int64]
    """(F,) frames of the constraint's motion; -1 where another motion plays."""
    amounts: FloatArray
    """(F,) residuals in metres or radians; NaN where inactive."""
    activation: FloatArray
    """(F,) activation, regardless of contacts."""
    freedom: FloatArray
    """(F,) factor of the activation: 0 while a contact holds the limb, 1 without one."""
    played: NDArray[np.bool_]
    """(F,) True where a clip plays the constraint's motion."""

    @property
    def times(self) -> FloatArray:
        """(F,) stage times in seconds."""
        return self.timing.begin + np.arange(len(self.frames)) / self.timing.frame_rate


def residuals_on(
    project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str
) -> ConstraintResiduals | None:
    """Residuals of a constraint on a performer; None without a result, or if the constraint does not apply.

    If several parts of the constraint are active in a frame, the worst one counts.
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
    count, composite = motion.first_frame + motion.frame_count, motion.composite
    amounts = np.full(count, np.nan)
    amounts[motion.first_frame :] = np.fmax.reduce(motion.residuals[rows], axis=0)
    timing = timing_of(project, performer)
    own, clips = np.full(count, -1), np.full(count, -1)
    curves = {(asked[row].clip, asked[row].repeat): asked[row].constraint.activation for row in rows}
    activation, freedom = np.zeros(count), np.ones(count)
    if composite is None or composite.is_plain:
        pieces = [((0, 0), np.arange(count), np.arange(count))]
    else:
        timing, frames = composite.timing, np.arange(count)
        played = {each.piece.origin: each for each in composite.played if each.piece.origin[0] >= 0}
        if not curves.keys() <= played.keys() or any(place >= len(performer.clips) for place, _ in played):
            return None  # the result is of a row of other clips
        pieces = [
            (origin, there, np.rint(each.motion_frames(there, timing)).astype(np.int64))
            for origin, each in played.items()
            if len(there := frames[each.first : each.last + 1])
        ]
    for (place, repeat), there, of_motion in pieces:
        clip = performer.clips[place]
        if clip.motion_id != constraint.motion_id:
            continue
        rate = project.frame_rate_of(clip)
        own[there], clips[there] = of_motion, np.where((of_motion >= clip.first) & (of_motion <= clip.last), place, -1)
        curve = curves.get((place, repeat))
        if curve is None and np.isfinite(amounts[there]).any():
            curve = next(iter(curves.values()))  # on into a part of a split clip
        activation[there] = 0.0 if curve is None else curve.at(of_motion / rate)
        contacts = tuple(project.contacts_for(performer_id, clip).values())
        held = _freedom(contacts, constraint.point.part, int(of_motion.max()) + 1, rate)
        freedom[there] = held[np.maximum(of_motion, 0)]
    return ConstraintResiduals(timing, own, amounts, activation, freedom, clips >= 0)


def applies_to(project: Project, performer_id: str, constraint_id: str) -> bool:
    """True if a constraint applies to a performer: it is enabled, in scope, and on a motion that the performer
    plays.
    """
    constraint, performer = project.constraints[constraint_id], project.performers[performer_id]
    return constraint.enabled and any(
        clip.motion_id == constraint.motion_id and constraint.scope.includes(performer_id, clip.id)
        for clip in performer.clips
    )


def unsolved_words(live: Live) -> str:
    """Text for a residual that is not known yet."""
    return "not solved yet" if live.ready else "waits for the solver"


def worst_residual(
    project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str
) -> Residual | None:
    """Worst residual in the frames that the performer plays; None if the constraint is inactive or not yet solved."""
    missed = residuals_on(project, performer_id, motion, constraint_id)
    if missed is None:
        return None
    asked = np.where(missed.played, missed.amounts, np.nan)
    full = np.where(missed.activation * missed.freedom >= LEAST_FULL_ACTIVATION, asked, np.nan)
    fully_active = bool(np.isfinite(full).any())
    counted = full if fully_active else asked
    if not np.isfinite(counted).any():
        return None
    index = int(np.nanargmax(counted))
    time, measure = float(missed.times[index]), measure_of(project.constraints[constraint_id])
    stage = stage_span(project)
    return Residual(
        float(counted[index]), int(missed.frames[index]), round(time * stage.frame_rate) if stage else index, time,
        fully_active, measure,
    )  # fmt: skip


def inactivity(project: Project, performer_id: str, motion: AdaptedMotion | None, constraint_id: str) -> Inactive:
    """Reason why a constraint without a residual is inactive: a contact holds its limb, or the clip is too short for
    its fade.
    """
    missed = residuals_on(project, performer_id, motion, constraint_id)
    if missed is None:
        return Inactive.ELSEWHERE
    active = missed.played & (missed.activation > 0.0)
    if not active.any():
        return Inactive.ELSEWHERE
    return Inactive.CUT if (active & (missed.freedom >= 1.0)).any() else Inactive.OVERRIDDEN


@project_cache(maxsize=64)
def _freedom(contacts: tuple[ContactInterval, ...], part: BodyPart, frame_count: int, frame_rate: float) -> FloatArray:
    from studio.core.solver.grounding.body_support import limb_freedom  # not before a result is there: it loads kernels
    from studio.core.solver.task_assembly.points import limb_of

    return limb_freedom(contacts, limb_of(part), frame_count, frame_rate)
