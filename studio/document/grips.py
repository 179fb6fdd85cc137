"""Hand constraints of performers that carry props: made with a hold, and removed with it."""

import math
from dataclasses import replace

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.stage.clip import Clip
from studio.core.stage.held_grips import STAGE_TIME_TOLERANCE_SECONDS, gripped_prop
from studio.core.stage.holding import HAND_REACH_SECONDS, grip_constraints
from studio.core.stage.mirrored_props import constraint_as_played
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import Carried, InHand, Prop, quarter_turns
from studio.document.edited_project import EditedProject


def is_grip(constraint: Constraint, prop_id: str, performer_id: str) -> bool:
    """True if a constraint holds a hand of the performer on a prop."""
    return gripped_prop(constraint) == prop_id and constraint.scope.performer_id == performer_id


def update_grips(
    document: EditedProject, prop_id: str, before: Prop, text: str, *, reaching: float = HAND_REACH_SECONDS
) -> None:
    """Remove the hand constraints of the holds that a prop has no longer, and add those of its new ones, with undo
    ``text``. Hands come to the prop in ``reaching`` seconds. A hold by the same performer from the same time on is not
    a new one.
    """
    old, new = _holds_by_begin(before), _holds_by_begin(document.project.props[prop_id])
    for key, hold in old.items():
        if key not in new:
            remove_grips(document, prop_id, hold, text)
    for key, hold in new.items():
        if key not in old:
            add_grips(document, prop_id, hold, text, reaching=reaching)


def add_grips(
    document: EditedProject,
    prop_id: str,
    hold: Carried,
    text: str,
    *,
    lower: bool = False,
    reaching: float = HAND_REACH_SECONDS,
) -> None:
    """Let both hands of its performer grip a prop for ``hold``, in all motions that the performer plays then, with undo
    ``text``. ``lower`` and ``reaching`` are as in ``grip_constraints``.
    """
    project, performer_id = document.project, hold.performer_id
    performer, prop = project.performers[performer_id], project.props[prop_id]
    for motion_id, (clip, seconds) in _gripped_ranges(project, performer, hold.begin).items():
        last = max((each.priority for each in document.project.constraints_of(motion_id).values()), default=-1) + 1
        made = grip_constraints(
            motion_id, performer_id, prop_id, prop, seconds, last,
            turned=quarter_turns(hold.heading), lower=lower, reaching=reaching,
        )  # fmt: skip
        seen = [constraint_as_played(project, performer_id, clip, each) for each in made]
        document.add_all("constraints", seen, text)
    if hold.end is not None:
        fade_grips(document, prop_id, performer_id, hold.end, text)


def fade_grips(document: EditedProject, prop_id: str, performer_id: str, time: float, text: str) -> None:
    """Fade out the hand constraints of a performer that releases a prop at second ``time`` of the stage."""
    for clip in document.project.performers[performer_id].clips:
        rate = document.project.frame_rate_of(clip)
        left = float(np.clip(clip.motion_seconds(time, rate), clip.first / rate, clip.last / rate))
        for key, each in document.project.constraints_of(clip.motion_id).items():
            if is_grip(each, prop_id, performer_id) and each.activation.at(left) > 0.0:
                curve = each.activation
                full = min(curve.full, left)
                faded = curve.with_times(min(curve.start, full), full, left, left + HAND_REACH_SECONDS)
                document.replace("constraints", key, replace(each, activation=faded), text)


def remove_grips(document: EditedProject, prop_id: str, hold: Carried, text: str) -> None:
    """Remove the constraints that keep the hands of its performer on a prop during ``hold``, with undo ``text``."""
    for key in _grips_of(document.project, prop_id, hold):
        document.remove("constraints", key, text)


def retimed_grips(project: Project, prop_id: str, after: Prop) -> dict[str, Constraint]:
    """Hand constraints of a prop, by id, at the times of the holds that it has in ``after``, which has as many."""
    found: dict[str, Constraint] = {}
    for hold, new in zip(project.props[prop_id].holds, after.holds, strict=True):
        for key, clip in _grips_of(project, prop_id, hold).items():
            rate, each = project.frame_rate_of(clip), project.constraints[key]
            delays = [
                0.0 if old is None or time is None else float(np.subtract(*clip.motion_seconds((time, old), rate)))
                for old, time in ((hold.begin, new.begin), (hold.end, new.end))
            ]
            times = np.maximum.accumulate(np.array(each.activation.times) + np.repeat(delays, 2))
            found[key] = replace(each, activation=each.activation.with_times(*times.tolist()))
    return found


def _grips_of(project: Project, prop_id: str, hold: InHand | Carried) -> dict[str, Clip]:
    """Clips of the hand constraints of a hold, by their ids."""
    found = {}
    for clip in project.performers[hold.performer_id].clips:
        rate = project.frame_rate_of(clip)
        first, last = (
            open_end
            if time is None
            else float(np.clip(clip.motion_seconds(time, rate), clip.first / rate, clip.last / rate))
            for time, open_end in ((hold.begin, -math.inf), (hold.end, math.inf))
        )
        for key, each in project.constraints_of(clip.motion_id).items():
            begin, end = first - STAGE_TIME_TOLERANCE_SECONDS, last + STAGE_TIME_TOLERANCE_SECONDS
            during = begin <= each.activation.full <= end
            if during and is_grip(each, prop_id, hold.performer_id):
                found[key] = clip
    return found


def _holds_by_begin(prop: Prop) -> dict[tuple[str, float | None], Carried]:
    return {(each.performer_id, each.begin): each for each in prop.holds if isinstance(each, Carried)}


def _gripped_ranges(
    project: Project, performer: Performer, begin: float | None
) -> dict[str, tuple[Clip, tuple[float, float]]]:
    """Each motion that a performer plays after ``begin``, with its first clip then and the range of its seconds,
    without motions of which it has played the same range before, where the constraints would apply too.
    """
    ranges: dict[str, tuple[Clip, tuple[float, float]]] = {}
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        if begin is not None and clip.start + clip.length(rate) <= begin:
            continue
        first = clip.first / rate if begin is None else _looped_motion_time(clip, rate, begin)
        known, (start, end) = ranges.get(clip.motion_id, (clip, (first, first)))
        ranges[clip.motion_id] = known, (min(first, start), max(clip.last / rate, end))
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        over = begin is not None and clip.start + clip.length(rate) <= begin
        if over and clip.motion_id in ranges and clip.last / rate > ranges[clip.motion_id][1][0]:
            del ranges[clip.motion_id]
    return ranges


def _looped_motion_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Seconds of the clip's motion that its repeats play at a time of the stage, clamped to the clip."""
    once = clip.length(frame_rate) / clip.repeats
    seconds = float(clip.motion_seconds(time - clip.repeat_at(time, frame_rate) * once, frame_rate))
    return min(max(seconds, clip.first / frame_rate), clip.last / frame_rate)
