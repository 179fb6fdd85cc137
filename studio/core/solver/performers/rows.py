"""What a performer plays and what is asked of it: its row as one motion, constraints in that motion's space."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import Carry, carried_over
from studio.core.normalized.compose import Composite, compose
from studio.core.normalized.joining import Planar
from studio.core.normalized.layers import Overlay, layered
from studio.core.normalized.mirror import mirrored
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import Piece, Played
from studio.core.project import Performer, Project
from studio.core.stage.clip import Clip
from studio.core.stage.timing import Timing

MotionOf = Callable[[str], NormalizedMotion]
"""The normalised motion of a motion's id."""


@dataclass(frozen=True)
class Asked:
    """A constraint as it is asked of one performer in one repeat of one of its clips, in the space of its motion."""

    constraint_id: str
    constraint: Constraint
    clip: int = 0
    repeat: int = 0


def is_plain(clip: Clip) -> bool:
    """Whether a clip plays its motion as it is."""
    return (clip.speed, clip.repeats, clip.mirrored, clip.turn, *clip.offset) == (1.0, 1, False, 0.0, 0.0, 0.0)


def timing_of(project: Project, performer: Performer) -> Timing:
    """When a performer's row plays, known before any motion is: as ``compose`` has it."""
    clips = performer.clips
    rates = [project.frame_rate_of(clip) for clip in clips]
    if len(clips) == 1 and is_plain(clips[0]):
        [clip], [rate] = clips, rates
        return Timing(clip.start - clip.first / rate, rate, clip.first, clip.last)
    begin = min(clip.start for clip in clips)
    end = max(clip.start + clip.length(rate) for clip, rate in zip(clips, rates, strict=True))
    return Timing(begin, max(rates), 0, round((end - begin) * max(rates)))


def frame_count_of(project: Project, performer: Performer) -> int:
    """Frames of what a performer's row comes to: all of the capture where it is one clip as it is."""
    clips = performer.clips
    if len(clips) == 1 and is_plain(clips[0]):
        return project.captures[project.motions[clips[0].motion_id].capture_id].frame_count
    return timing_of(project, performer).last + 1


def stage_span(project: Project) -> Timing | None:
    """The stage's own frames: at the highest rate that plays, from the first clip's start to the last one's end.

    None while nobody plays anything.
    """
    playing = [each for each in project.performers.values() if each.clips and not project.missing_references(each)]
    timings = [timing_of(project, each) for each in playing]
    if not timings:
        return None
    rate = max(timing.frame_rate for timing in timings)
    first = round(min(timing.start for timing in timings) * rate)
    return Timing(0.0, rate, first, max(first, round(max(timing.end for timing in timings) * rate)))


def composite_of(project: Project, performer_id: str, motion_of: MotionOf) -> Composite:
    """What a performer's clips and layers come to, with their contacts."""
    performer = project.performers[performer_id]
    row = [
        piece
        for place, clip in enumerate(performer.clips)
        for piece in pieces_of(project, performer_id, clip, motion_of, place)
    ]
    overlays = [
        Overlay(
            pieces_of(project, performer_id, each.clip, motion_of), each.region, each.weight,
            (each.fade_in, each.fade_out), each.additive, each.reference,
        )
        for each in performer.layers
    ]  # fmt: skip
    return layered(tuple(row), tuple(overlays))


def pieces_of(
    project: Project, performer_id: str, clip: Clip, motion_of: MotionOf, place: int = 0
) -> tuple[Piece, ...]:
    """A clip as a performer plays it at a ``place`` of its row, each time that it plays."""
    motion, contacts = motion_of(clip.motion_id), tuple(project.contacts_for(performer_id, clip).values())
    own, once = Planar(clip.turn, clip.offset), clip.length(motion.frame_rate) / clip.repeats
    return tuple(
        Piece(
            motion, contacts, clip.first, clip.last, clip.start + repeat * once, clip.speed, clip.mirrored,
            own if repeat == 0 else Planar(), clip.joined or repeat > 0, clip.ease, (place, repeat),
        )
        for repeat in range(clip.repeats)
    )  # fmt: skip


def carry_of(played: Played, timing: Timing, leg_length: float) -> Carry:
    """How what is asked of a piece's motion is asked where the piece plays, on a body of that leg length."""
    piece, placement = played.piece, played.placement
    begin = piece.start - timing.begin - piece.first / (piece.motion.frame_rate * piece.speed)
    x, y = (leg_length * np.array(placement.offset)).tolist()
    ends = played.first / timing.frame_rate, played.last / timing.frame_rate
    return Carry(begin, piece.speed, placement.turn, (x, y), piece.mirrored, *ends)


def constraints_in(asked: tuple[Asked, ...], composite: Composite, leg_length: float) -> tuple[Constraint, ...]:
    """What is asked, each where its clip plays, in the same order."""
    if composite.is_plain:
        return tuple(each.constraint for each in asked)
    played = {each.piece.origin: each for each in composite.played}
    return tuple(
        carried_over(each.constraint, carry_of(played[each.clip, each.repeat], composite.timing, leg_length))
        for each in asked
    )


def forget_rows() -> None:
    """Let go of the rows, layers and mirrored motions that are kept; they are made again where they are asked for."""
    for kept in (compose, layered, mirrored):
        kept.cache_clear()
