"""The clips of a performer, played one after the other, as one motion, and its constraints in that motion's space."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import NEVER_ACTIVE, ClipTransform, constraint_on_clip
from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import playing_seconds
from studio.core.normalized.compose import Composite
from studio.core.normalized.joining import PlanarTransform
from studio.core.normalized.layers import PlayedLayer, with_layers
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece, PlayedPiece
from studio.core.stage.clip import Clip
from studio.core.stage.correction import Correction
from studio.core.stage.held_grips import gripped_prop
from studio.core.stage.project import Performer, Project
from studio.core.stage.timing import Timing

MotionOf = Callable[[str], NormalizedMotion]
"""Function that returns the normalised motion with a motion's id."""


@dataclass(frozen=True)
class ClipConstraint:
    """A constraint of one performer in one repeat of one of its clips, in the space of the clip's motion."""

    constraint_id: str
    constraint: Constraint
    clip: int = 0
    """Index of the clip among the performer's clips."""
    repeat: int = 0
    """Index of the repeat of the clip."""


def is_plain(clip: Clip) -> bool:
    """True if a clip plays its motion at its own speed, once, without mirroring and in place."""
    return (clip.speed, clip.repeats, clip.mirrored, clip.turn, *clip.offset) == (1.0, 1, False, 0.0, 0.0, 0.0)


def timing_of(project: Project, performer: Performer) -> Timing:
    """Timing of a performer's clips on the stage, computed without loading their motions."""
    clips = performer.clips
    rates = [project.frame_rate_of(clip) for clip in clips]
    if len(clips) == 1 and is_plain(clips[0]):
        [clip], [rate] = clips, rates
        return Timing(clip.start - clip.first / rate, rate, clip.first, clip.last)
    begin = min(clip.start for clip in clips)
    end = max(clip.start + clip.length(rate) for clip, rate in zip(clips, rates, strict=True))
    return Timing(begin, max(rates), 0, round((end - begin) * max(rates)))


def frame_count_of(project: Project, performer: Performer) -> int:
    """Number of frames of a performer's motion; for one plain clip, those of the whole capture."""
    clips = performer.clips
    if len(clips) == 1 and is_plain(clips[0]):
        return project.captures[project.motions[clips[0].motion_id].capture_id].frame_count
    return timing_of(project, performer).last + 1


def stage_span(project: Project) -> Timing | None:
    """Timing of the whole stage: highest frame rate, from the start of the first clip to the end of the last one; None
    if empty.
    """
    playing = [each for each in project.performers.values() if each.clips and not project.missing_references(each)]
    timings = [timing_of(project, each) for each in playing]
    if not timings:
        return None
    rate = max(timing.frame_rate for timing in timings)
    first = round(min(timing.start for timing in timings) * rate)
    return Timing(0.0, rate, first, max(first, round(max(timing.end for timing in timings) * rate)))


def composite_of(project: Project, performer_id: str, motion_of: MotionOf) -> Composite:
    """Composite motion of a performer's clips and layers, with their contacts."""
    performer = project.performers[performer_id]
    row = [
        piece
        for index, clip in enumerate(performer.clips)
        for piece in pieces_of(project, performer_id, clip, motion_of, index)
    ]
    overlays = [
        PlayedLayer(
            pieces_of(project, performer_id, each.clip, motion_of), each.region, each.weight,
            (each.fade_in, each.fade_out), each.additive, each.reference,
        )
        for each in performer.layers
    ]  # fmt: skip
    return with_layers(tuple(row), tuple(overlays))


def corrections_in(project: Project, performer_id: str, timing: Timing) -> tuple[Correction, ...]:
    """Enabled manual corrections of a performer, with times in seconds of its composite motion."""
    own = project.corrections_of(performer_id).values()
    return tuple(each.moved(-timing.begin) for each in own if each.enabled and each.weight > 0.0)


def pieces_of(
    project: Project, performer_id: str, clip: Clip, motion_of: MotionOf, index: int = 0
) -> tuple[MotionPiece, ...]:
    """Pieces of the composite motion for a clip at ``index`` of a performer's clips, one for each repeat."""
    motion, contacts = motion_of(clip.motion_id), tuple(project.contacts_for(performer_id, clip).values())
    own, once = PlanarTransform(clip.turn, clip.offset), clip.length(motion.frame_rate) / clip.repeats
    return tuple(
        MotionPiece(
            motion, contacts, clip.first, clip.last, clip.start + repeat * once, clip.speed, clip.mirrored,
            own if repeat == 0 else PlanarTransform(), clip.joined or repeat > 0, clip.ease, (index, repeat),
        )
        for repeat in range(clip.repeats)
    )  # fmt: skip


def clip_transform(played: PlayedPiece, timing: Timing, leg_length: float) -> ClipTransform:
    """Mapping of constraints from the motion of a piece to the composite motion, on a body with that leg length."""
    piece, placement = played.piece, played.placement
    rate = piece.motion.frame_rate
    before = (
        float(playing_seconds(piece.speed, piece.first / rate))
        if isinstance(piece.speed, KeyedNumber)
        else piece.first / (rate * piece.speed)
    )
    begin = piece.start - timing.begin - before
    x, y = (leg_length * np.array(placement.offset)).tolist()
    ends = played.first / timing.frame_rate, played.last / timing.frame_rate
    return ClipTransform(begin, piece.speed, placement.turn, (x, y), piece.mirrored, *ends)


def constraints_in(
    asked: tuple[ClipConstraint, ...], composite: Composite, leg_length: float
) -> tuple[Constraint, ...]:
    """Constraints mapped to the composite motion, in the same order.

    Where a clip continues the one before it, as parts of a split clip do, a constraint of both is active throughout; a
    grip on a prop is, too, where the next clip or repeat plays another part of the motion.
    """
    if composite.is_plain:
        return tuple(each.constraint for each in asked)
    carries = [clip_transform(each, composite.timing, leg_length) for each in composite.played]
    places = {each.piece.origin: place for place, each in enumerate(composite.played)}
    by_place: dict[int, list[ClipConstraint]] = {place: [] for place in range(len(carries))}
    for each in asked:
        by_place[places[each.clip, each.repeat]].append(each)

    pause = 1.5 / composite.timing.frame_rate

    def goes_on(each: ClipConstraint, index: int) -> bool:
        """True if the clip at ``index`` has the same constraint, and continues the one before."""
        if not 0 < index < len(carries):
            return False
        before, after = carries[index - 1 : index + 1]
        ours, others = ([one for one in by_place[at] if _is_same(each, one)] for at in (index - 1, index))
        if not ours or not others:
            return False
        held = gripped_prop(each.constraint) is not None and before.adjoins(after, pause)
        return before.goes_on_in(after, pause) or (
            held
            and np.allclose(
                before.stage_times(ours[0].constraint.activation.times),
                after.stage_times(others[0].constraint.activation.times),
            )
        )

    def carried(each: ClipConstraint) -> Constraint:
        """Constraint mapped to its clip, and extended over the clips that continue it; never active if an earlier one
        covers it.
        """
        place = until = places[each.clip, each.repeat]
        while goes_on(each, until + 1):
            until += 1
        whole = constraint_on_clip(each.constraint, replace(carries[place], last=carries[until].last))
        return replace(whole, activation=NEVER_ACTIVE) if goes_on(each, place) else whole

    return tuple(carried(each) for each in asked)


def _is_same(one: ClipConstraint, other: ClipConstraint) -> bool:
    """True if two clips have the same constraint: one of the same id, or a copy in each part of a split clip."""
    if one.constraint_id == other.constraint_id:
        return True
    first, second = vars(one.constraint), vars(other.constraint)
    return type(one.constraint) is type(other.constraint) and all(
        name == "scope" or first[name] is second[name] or (name != "mesh" and first[name] == second[name])
        for name in first
    )
