"""What a performer plays live: its row as the timeline has it, or a clip that took over at any frame, without warning.

Whatever plays is one motion that stands on the ground whole, of which single frames are solved. A clip takes over from
the last poses of what played before, so the new motion begins where the body is: its feet stand where they stood.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.activation import ActivationCurve, ease
from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import COMING
from studio.core.normalized.compose import Composite
from studio.core.project import Project
from studio.core.solver.asking.tracks import Tracks, fixed_at
from studio.core.solver.performers.performing import Prepare, motion_of, unasked_request
from studio.core.solver.performers.rows import composite_of, constraints_in, pieces_of
from studio.core.solver.performers.stage import asked_of
from studio.core.solver.solved_window import targets_of
from studio.core.solver.standing.stand import Standing, standing_of
from studio.live.takeover import LAST_POSE_SECONDS, SPEED_FRAMES, take_over

FloatArray = NDArray[np.float64]

SOLVE_MARGIN = 0.5
"""Seconds around what is asked in which it has to do with how a body is solved."""


@dataclass(frozen=True, eq=False)
class Playing:
    """A motion on the ground, all that is asked in it by the constraints' ids, and what was asked before and goes."""

    composite: Composite
    standing: Standing
    asked: tuple[tuple[str, Constraint], ...]
    going: tuple[Constraint, ...] = ()
    kept: frozenset[str] = frozenset()
    """What was asked before it began and still is: it does not have to come."""

    def frame_at(self, seconds: float) -> int:
        """The frame that plays at ``seconds`` of the stage; before and after it, its first and its last one."""
        return round(self.composite.timing.frame_at(seconds))

    def time_of(self, frame: int) -> float:
        """Seconds of its motion at which a frame plays."""
        return frame / self.composite.timing.frame_rate

    def active(self, frame: int) -> tuple[Constraint, ...]:
        """What is asked in a frame and around it, in the order in which it is asked, what goes last.

        Limbs that are about to be asked something are no more free to keep the balance.
        """
        time = self.time_of(frame)
        every = (*(each for _, each in self.asked), *self.going)
        return tuple(
            each for each in every if each.activation.start - SOLVE_MARGIN <= time <= each.activation.end + SOLVE_MARGIN
        )

    @cached_property
    def solvable(self) -> Standing:
        """As it stands, where constraints may bring arms into the own body: to keep them clear takes many frames.

        Hands that touch each other, or the body, go on touching.
        """
        contact = self.standing.self_contact
        return replace(self.standing, self_contact=contact and replace(contact, rooms=None))


def own_row(project: Project, key: str, prepare: Prepare) -> Playing:
    """A performer's row as the timeline has it. Raises StudioError where it cannot be played."""
    composite = composite_of(project, key, lambda motion_id: motion_of(project, motion_id, prepare))
    return _playing(project, key, composite, prepare)


def restood(project: Project, key: str, playing: Playing, prepare: Prepare) -> Playing:
    """The same motion on the performer's body and ground as they are in another ``project``."""
    changed = _playing(project, key, playing.composite, prepare, playing.kept)
    return replace(changed, going=playing.going)


def asked_anew(project: Project, key: str, playing: Playing) -> Playing:
    """The same motion with what another ``project`` asks in it."""
    return replace(playing, asked=_asked(project, key, playing.composite, playing.standing, playing.kept))


def taken_over(project: Project, key: str, before: Playing, frame: int, tracks: Tracks, prepare: Prepare) -> Playing:
    """The only clip of a performer's row, which takes over as the clip starts from ``frame`` of what played ``before``.

    What acted in that frame goes in ``COMING`` seconds, where it was (``tracks`` have where it followed), unless it is
    asked in the clip as well.
    """
    clip = project.performers[key].clips[0]
    pieces = pieces_of(project, key, clip, lambda motion_id: motion_of(project, motion_id, prepare))
    seen = _last_seen(before, frame, pieces[0].start)
    made = take_over(
        before.standing, seen, pieces, lambda stands: standing_of(unasked_request(project, key, stands, prepare))
    )
    standing, first = made.led(before.standing, seen), made.first
    composite = replace(made.composite, contacts=standing.contacts)
    playing = Playing(composite, standing, _asked(project, key, composite, standing, frozenset()))
    begins = playing.time_of(first)
    kept = _kept(before, frame, project, key, playing, begins)
    going = _going(before, frame, kept, tracks, begins)
    return replace(asked_anew(project, key, replace(playing, kept=kept)), going=going)


def _playing(
    project: Project, key: str, composite: Composite, prepare: Prepare, kept: frozenset[str] = frozenset()
) -> Playing:
    standing = standing_of(unasked_request(project, key, composite, prepare))
    return Playing(composite, standing, _asked(project, key, composite, standing, kept), kept=kept)


def _asked(
    project: Project, key: str, composite: Composite, standing: Standing, kept: frozenset[str]
) -> tuple[tuple[str, Constraint], ...]:
    there = {each.piece.origin for each in composite.played}
    asked = tuple(each for each in asked_of(project, key) if (each.clip, each.repeat) in there)
    leg = standing.morphology.leg_length
    at_once = replace(composite, played=tuple(replace(each, first=0) for each in composite.played))
    carried = constraints_in(asked, composite, leg)
    lasting = constraints_in(asked, at_once, leg) if kept else carried
    return tuple(
        (each.constraint_id, whole if each.constraint_id in kept else came)
        for each, came, whole in zip(asked, carried, lasting, strict=True)
    )


def _last_seen(before: Playing, frame: int, start: float) -> NDArray[np.int64]:
    """(SEEN,) the frames that were seen last before ``start``: the last one again and again where it was held."""
    timing = before.composite.timing
    held = round((start - timing.end) * timing.frame_rate) - 1 if frame == timing.last else 0
    rows = np.arange(frame - SPEED_FRAMES + 1, frame + 1) + max(held, 0)
    return np.asarray(rows.clip(0, frame))


def _kept(before: Playing, frame: int, project: Project, key: str, playing: Playing, begins: float) -> frozenset[str]:
    """What acts in the last frame of what played and is asked as much in the first one of what plays."""
    time = before.time_of(frame)
    acted = {name: float(each.activation.at(time)) for name, each in before.asked}
    every = frozenset(name for name, share in acted.items() if share > 0.0)
    lasting = dict(_asked(project, key, playing.composite, playing.standing, every))
    return frozenset(
        name for name in every & lasting.keys() if float(lasting[name].activation.at(begins)) >= acted[name]
    )


def _going(before: Playing, frame: int, kept: frozenset[str], tracks: Tracks, begins: float) -> tuple[Constraint, ...]:
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
    """From ``share`` at ``begins`` down to nothing within ``COMING`` seconds."""
    progress = np.linspace(0.0, 1.0, 257)
    passed = float(np.interp(1.0 - share, ease(progress, curve.shape), progress)) * COMING
    end = begins - passed + COMING
    return curve.with_times(begins - LAST_POSE_SECONDS, begins - LAST_POSE_SECONDS, begins - passed, end)
