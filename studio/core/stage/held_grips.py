"""Grip constraints in a row of clips: each acts while its prop is held, in stage seconds."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from studio.core.changed_records import with_fields
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.target import follows_of
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, Prop

STAGE_TIME_TOLERANCE_SECONDS = 1e-6
"""Difference in seconds below which two moments count as the same."""


def gripped_prop(constraint: Constraint) -> str | None:
    """Id of the prop on which a grip constraint keeps a hand (see ``grip_constraints``); None for any other
    constraint.
    """
    follows = (each for each in follows_of(constraint) if isinstance(each, FollowProp) and each.along_arms)
    return next((each.prop_id for each in follows), None)


def repeats_as_held(
    project: Project, performer_id: str, clip: Clip, constraint: Constraint
) -> tuple[Constraint | None, ...]:
    """Constraint for each repeat of a performer's clip; None for a repeat after a gripped prop has been let go.

    A motion that plays again would repeat its grip constraints. The constraint's own times apply in the piece in which
    the hold begins; in the following pieces it lasts as long as the hold.
    """
    holds = [each for each in _holds(project.props, gripped_prop(constraint)) if each.performer_id == performer_id]
    if not holds:
        return (constraint,) * clip.repeats
    pieces, full = tuple(_pieces(project, performer_id, constraint)), constraint.activation.full
    row = min(each.begin for each in pieces), max(each.end for each in pieces)

    def distance(pair: tuple[_Piece, Carried]) -> tuple[float, float]:
        time = max(pair[0].stage_time(full), pair[0].begin)
        return pair[1].seconds_from(time), abs(time - (row[0] if pair[1].begin is None else pair[1].begin))

    origin, hold = min(itertools.product(pieces, holds), key=distance)
    own = [each for each in pieces if each.clip == clip]
    curves = [_curve_in(each, origin, hold, constraint.activation, row[1]) for each in own]
    return tuple(None if curve is None else with_fields(constraint, activation=curve) for curve in curves)


def _curve_in(
    piece: "_Piece", origin: "_Piece", hold: Carried, curve: ActivationCurve, row_end: float
) -> ActivationCurve | None:
    """Activation in ``piece`` of a grip whose hold begins in the piece ``origin``; None if the grip never
    acts there.
    """
    first, last = piece.stage_time(curve.full), piece.stage_time(curve.full_end)
    if piece.begin > origin.begin and origin.plays_no_longer_than(curve.full_end):
        first = origin.stage_time(curve.full)
    if piece.plays_no_longer_than(curve.full_end):
        last = max(origin.stage_time(curve.full_end), row_end)
    first = max(first, -math.inf if hold.begin is None else hold.begin)
    last = min(last, math.inf if hold.end is None else hold.end)
    if first > last + STAGE_TIME_TOLERANCE_SECONDS:
        return None
    full, full_end = piece.motion_time(first), piece.motion_time(max(last, first))
    times = full - (curve.full - curve.start), full, full_end, full_end + curve.end - curve.full_end
    if piece.stage_time(times[3]) <= piece.begin or piece.stage_time(times[0]) >= piece.end:
        return None
    return (
        curve
        if np.allclose(times, curve.times, rtol=0.0, atol=STAGE_TIME_TOLERANCE_SECONDS)
        else curve.with_times(*times)
    )


def _holds(props: Mapping[str, Prop], prop_id: str | None) -> list[Carried]:
    prop = props.get(prop_id or "")
    return [each for each in prop.holds if isinstance(each, Carried)] if prop else []


@dataclass(frozen=True)
class _Piece:
    """One repeat of a clip in a performer's row; ``frame_rate`` is that of its motion."""

    clip: Clip
    repeat: int
    frame_rate: float

    @property
    def delay(self) -> float:
        """Seconds from the clip's first repeat to this one."""
        return self.repeat * self.clip.length(self.frame_rate) / self.clip.repeats

    @property
    def begin(self) -> float:
        """Stage second at which the repeat begins."""
        return self.clip.start + self.delay

    @property
    def end(self) -> float:
        """Stage second at which the repeat ends."""
        return self.begin + self.clip.length(self.frame_rate) / self.clip.repeats

    def stage_time(self, seconds: float) -> float:
        """Seconds on the stage for seconds of the motion."""
        return float(self.clip.stage_seconds(seconds, self.frame_rate)) + self.delay

    def motion_time(self, seconds: float) -> float:
        """Seconds of the motion for seconds on the stage."""
        return float(self.clip.motion_seconds(seconds - self.delay, self.frame_rate))

    def plays_no_longer_than(self, seconds: float) -> bool:
        """True if the repeat ends at or before ``seconds`` of the motion."""
        return seconds >= self.clip.last / self.frame_rate - STAGE_TIME_TOLERANCE_SECONDS


def _pieces(project: Project, performer_id: str, constraint: Constraint) -> Iterator[_Piece]:
    """Repeats of all clips of a performer that play the motion of ``constraint`` within its scope."""
    for clip in project.performers[performer_id].clips:
        if clip.motion_id == constraint.motion_id and constraint.scope.includes(performer_id, clip.id):
            rate = project.frame_rate_of(clip)
            yield from (_Piece(clip, repeat, rate) for repeat in range(clip.repeats))
