"""Motion of a performer in live play: its clip track, or a clip that takes over at any frame.

It is always one grounded motion, of which single frames are solved. A clip takes over from the last poses of the
previous motion, so that it begins where the body is and standing feet stay in place.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import BOUNDARY_FADE_SECONDS
from studio.core.curves.activation import ActivationCurve, ease
from studio.core.normalized.compose import Composite
from studio.core.solver.adapt import grounded_motion
from studio.core.solver.grounding.grounded_motion import GroundedMotion, grounded_motion_of
from studio.core.solver.performers.rows import composite_of, constraints_in, pieces_of
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.solver.performers.staged_performances import PrepareCapture, motion_of, unconstrained_request
from studio.core.solver.solved_window import targets_of
from studio.core.solver.task_assembly.tracks import Tracks, fixed_at
from studio.core.stage.project import Project
from studio.live.takeover import LAST_POSE_SECONDS, SPEED_FRAMES, take_over

FloatArray = NDArray[np.float64]

SOLVE_MARGIN_SECONDS = 0.5
"""Seconds before and after the activation of a constraint in which it still affects how the body is solved."""


@dataclass(frozen=True, eq=False)
class PlayingMotion:
    """Grounded motion of a performer with its constraints (id, constraint) in ``asked``, and the constraints ``going``
    of the previous motion that fade out.
    """

    composite: Composite
    standing: GroundedMotion
    asked: tuple[tuple[str, Constraint], ...]
    going: tuple[Constraint, ...] = ()
    kept: frozenset[str] = frozenset()
    """Ids of constraints that were active before the motion began and still are: they do not fade in."""

    def frame_at(self, seconds: float) -> int:
        """Frame that plays at the stage time ``seconds``, clamped to the motion."""
        return round(self.composite.timing.frame_at(seconds))

    def time_of(self, frame: int) -> float:
        """Time of a frame in seconds of the motion."""
        return frame / self.composite.timing.frame_rate

    def active(self, frame: int) -> tuple[Constraint, ...]:
        """Constraints that are active in or near a frame, in the order of the solver's residuals; those that fade out
        are last.

        Limbs that are about to be constrained are no longer used to keep the balance.
        """
        time = self.time_of(frame)
        every = (*(each for _, each in self.asked), *self.going)
        return tuple(
            each
            for each in every
            if each.activation.start - SOLVE_MARGIN_SECONDS <= time <= each.activation.end + SOLVE_MARGIN_SECONDS
        )

    @cached_property
    def solvable(self) -> GroundedMotion:
        """Grounded motion without arm collision, which needs many frames: constraints may move arms into the body.

        Hand-hand and hand-body contacts are kept.
        """
        contact = self.standing.self_contact
        return replace(self.standing, self_contact=contact and replace(contact, clearances=None))


def row_motion(project: Project, key: str, prepare: PrepareCapture) -> PlayingMotion:
    """Motion of a performer's clip track, as on the timeline. Raises StudioError if it cannot be played."""
    composite = composite_of(project, key, lambda motion_id: motion_of(project, motion_id, prepare))
    return _playing(project, key, composite, prepare)


def with_grounding_of(project: Project, key: str, playing: PlayingMotion, prepare: PrepareCapture) -> PlayingMotion:
    """``playing`` grounded for the performer's body and ground in another ``project``."""
    changed = _playing(project, key, playing.composite, prepare, playing.kept)
    return replace(changed, going=playing.going)


def with_constraints_of(project: Project, key: str, playing: PlayingMotion) -> PlayingMotion:
    """``playing`` with the constraints of another ``project``."""
    return replace(playing, asked=_asked(project, key, playing.composite, playing.standing, playing.kept))


def motion_after_takeover(
    project: Project, key: str, before: PlayingMotion, frame: int, tracks: Tracks, prepare: PrepareCapture
) -> PlayingMotion:
    """Motion in which the only clip of a performer's row takes over, at its start, from ``frame`` of ``before``.

    Constraints that acted in that frame fade out in ``BOUNDARY_FADE_SECONDS`` seconds at their last targets (``tracks``
    has those that were followed), unless they act on the clip as well.
    """
    clip = project.performers[key].clips[0]
    pieces = pieces_of(project, key, clip, lambda motion_id: motion_of(project, motion_id, prepare))
    seen = _last_seen(before, frame, pieces[0].start)
    made = take_over(
        before.standing,
        seen,
        pieces,
        lambda stands: grounded_motion_of(unconstrained_request(project, key, stands, prepare)),
    )
    standing, first = made.inertialised(before.standing, seen), made.first
    composite = replace(made.composite, contacts=standing.contacts)
    playing = PlayingMotion(composite, standing, _asked(project, key, composite, standing, frozenset()))
    begins = playing.time_of(first)
    kept = _kept(before, frame, project, key, playing, begins)
    going = _going(before, frame, kept, tracks, begins)
    return replace(with_constraints_of(project, key, replace(playing, kept=kept)), going=going)


def _playing(
    project: Project, key: str, composite: Composite, prepare: PrepareCapture, kept: frozenset[str] = frozenset()
) -> PlayingMotion:
    standing = grounded_motion(unconstrained_request(project, key, composite, prepare))
    return PlayingMotion(composite, standing, _asked(project, key, composite, standing, kept), kept=kept)


def _asked(
    project: Project, key: str, composite: Composite, standing: GroundedMotion, kept: frozenset[str]
) -> tuple[tuple[str, Constraint], ...]:
    there = {each.piece.origin for each in composite.played}
    asked = tuple(each for each in constraints_of_performer(project, key) if (each.clip, each.repeat) in there)
    leg = standing.morphology.leg_length
    at_once = replace(composite, played=tuple(replace(each, first=0) for each in composite.played))
    carried = constraints_in(asked, composite, leg)
    lasting = constraints_in(asked, at_once, leg) if kept else carried
    return tuple(
        (each.constraint_id, whole if each.constraint_id in kept else came)
        for each, came, whole in zip(asked, carried, lasting, strict=True)
    )


def _last_seen(before: PlayingMotion, frame: int, start: float) -> NDArray[np.int64]:
    """(SPEED_FRAMES,) frames displayed last before ``start``; the last one is repeated if it was held."""
    timing = before.composite.timing
    held = round((start - timing.end) * timing.frame_rate) - 1 if frame == timing.last else 0
    rows = np.arange(frame - SPEED_FRAMES + 1, frame + 1) + max(held, 0)
    return np.asarray(rows.clip(0, frame))


def _kept(
    before: PlayingMotion, frame: int, project: Project, key: str, playing: PlayingMotion, begins: float
) -> frozenset[str]:
    """Ids of constraints that are active in ``frame`` of ``before``, and at least as strongly in the first frame of
    ``playing``.
    """
    time = before.time_of(frame)
    acted = {name: float(each.activation.at(time)) for name, each in before.asked}
    every = frozenset(name for name, share in acted.items() if share > 0.0)
    lasting = dict(_asked(project, key, playing.composite, playing.standing, every))
    return frozenset(
        name for name in every & lasting.keys() if float(lasting[name].activation.at(begins)) >= acted[name]
    )


def _going(
    before: PlayingMotion, frame: int, kept: frozenset[str], tracks: Tracks, begins: float
) -> tuple[Constraint, ...]:
    time, window = before.time_of(frame), slice(frame, frame + 1)
    gone = [each for name, each in before.asked if name not in kept] + list(before.going)
    going = []
    for each in gone:
        share = float(each.activation.at(time))
        if share > 0.0:
            there = fixed_at(each, targets_of(before.standing, [each], window, tracks))
            going.append(replace(there, activation=_falling(each.activation, share, begins)))
    return tuple(going)


def _falling(curve: ActivationCurve, share: float, begins: float) -> ActivationCurve:
    """Activation that falls from ``share`` at ``begins`` seconds to zero within ``BOUNDARY_FADE_SECONDS`` seconds."""
    progress = np.linspace(0.0, 1.0, 257)
    passed = float(np.interp(1.0 - share, ease(progress, curve.shape), progress)) * BOUNDARY_FADE_SECONDS
    end = begins - passed + BOUNDARY_FADE_SECONDS
    return curve.with_times(begins - LAST_POSE_SECONDS, begins - LAST_POSE_SECONDS, begins - passed, end)
