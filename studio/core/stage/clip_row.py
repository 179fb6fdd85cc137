"""Edits of the rows of clips of performers, such as trimming and splitting a clip.

All performers that have a clip of one id share it: an edit applies to all of them.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from studio.core.constraints.scope import Scope
from studio.core.curves.keyed import KeyedNumber
from studio.core.stage.clip import Clip
from studio.core.stage.project import Entity, Performer, Project, new_ids

ClipEdit = Callable[[Clip], Sequence[Clip]]
"""Function that returns the clips that replace a clip: none, a changed one, or several."""
MOST_CLIP_PARTS = 4
"""Maximum number of clips into which one clip is split."""


def players_of(project: Project, clip_id: str) -> dict[str, Performer]:
    """Performers that have the clip ``clip_id`` in their row or layers, by performer id."""
    return {key: each for key, each in project.performers.items() if any(clip.id == clip_id for clip in each.all_clips)}


def with_clip_edited(performer: Performer, clip_id: str, edit: ClipEdit) -> Performer:
    """Performer with a clip of its row or layers edited, and the row sorted by the start of the clips."""
    row = [new for clip in performer.clips for new in (edit(clip) if clip.id == clip_id else (clip,))]
    layers = [
        replace(layer, clip=new)
        for layer in performer.layers
        for new in (edit(layer.clip) if layer.clip.id == clip_id else (layer.clip,))
    ]
    return with_row(replace(performer, layers=tuple(layers)), row)


def with_row(performer: Performer, row: Sequence[Clip]) -> Performer:
    """Copy of a performer with ``row`` as its row of clips."""
    return replace(performer, clips=tuple(sorted(row, key=lambda clip: clip.start)))


def frame_at(clip: Clip, frame_rate: float, time: float) -> float:
    """Frame of the motion, with a fraction, that plays at stage second ``time``, as if the clip had no ends."""
    if not isinstance(clip.speed, KeyedNumber):
        return clip.first + (time - clip.start) * clip.speed * frame_rate
    return float(clip.motion_seconds(time, frame_rate) * frame_rate)


def with_first_frame(clip: Clip, frame_rate: float, frame: int) -> Clip:
    """Copy of a clip that begins at ``frame`` of the motion, at most at its last frame, and keeps its time on the
    stage.
    """
    frame = min(max(frame, 0), clip.last)
    if not isinstance(clip.speed, KeyedNumber):
        return replace(clip, first=frame, start=clip.start + (frame - clip.first) / (frame_rate * clip.speed))
    return replace(clip, first=frame, start=float(clip.stage_seconds(frame / frame_rate, frame_rate)))


def with_last_frame(clip: Clip, frame: int, frame_count: int) -> Clip:
    """Copy of a clip that ends at ``frame`` of its motion, which has ``frame_count`` frames."""
    return replace(clip, last=max(min(frame, frame_count - 1), clip.first))


def clip_halves(clip: Clip, frame_rate: float, time: float, names: Iterator[str]) -> tuple[Clip, ...]:
    """Clips into which a clip is split at stage second ``time``; together they play as the clip did.

    A split inside a repeat makes the repeats before and after it clips of their own. The first part keeps the id;
    ``names`` gives the ids of the others. Raises ValueError if the clip does not play at ``time``, or ends then.
    """
    length, once = clip.last - clip.first, clip.length(frame_rate) / clip.repeats
    whole = min(max(math.floor((time - clip.start) / once), 0), clip.repeats - 1) if once > 0.0 else 0
    played = whole * length + round(frame_at(clip, frame_rate, time - whole * once)) - clip.first
    if not 0 < played < clip.repeats * length:
        raise ValueError("The playhead is outside the clip. Move it between the first and the last frame of the clip.")
    whole, cut = divmod(played, length)
    first, middle, last, rest = clip.first, clip.first + cut, clip.last, clip.repeats - whole
    stretches = [(first, last, whole), (first, last, rest)]
    if cut:
        stretches = [(first, last, whole), (first, middle, 1), (middle, last, 1), (first, last, rest - 1)]
    parts: list[Clip] = []
    start = clip.start
    for begin, end, repeats in stretches:
        if repeats:
            part = replace(clip, first=begin, last=end, repeats=repeats, start=start)
            parts.append(continuing_clip(part, next(names)) if parts else part)
            start += part.length(frame_rate)
    return tuple(parts)


def continuing_clip(clip: Clip, clip_id: str) -> Clip:
    """Copy of a clip with the id ``clip_id`` that continues where the previous clip of its row ends."""
    return replace(clip, id=clip_id, joined=True, turn=0.0, offset=(0.0, 0.0))


def clips_until(performer: Performer, time: float, frame_rates: Mapping[str, float]) -> tuple[Clip, ...]:
    """Clips of a performer before stage second ``time``; the rest is cut off. ``frame_rates`` are by motion id.

    A repeating clip that is cut inside a repeat is followed by a new clip for the part of that repeat.
    """
    kept: list[Clip] = []
    for clip in performer.clips:
        rate, names = frame_rates[clip.motion_id], new_ids(MOST_CLIP_PARTS)
        if clip.start >= time:
            continue
        length = clip.length(rate)
        frame = length / max(clip.repeats * (clip.last - clip.first), 1)
        if clip.start + length <= time + frame:
            kept.append(clip)
        elif clip.repeats > 1 and clip.start + frame <= time:
            kept += [each for each in clip_halves(clip, rate, time, iter(names)) if each.start < time - frame / 2]
        else:
            kept.append(replace(clip, repeats=1, last=int(frame_at(clip, rate, time))))
    return tuple(kept)


def scoped_copies(project: Project, clip_id: str, other: str) -> dict[str, dict[str, Entity]]:
    """Copies for the clip ``other`` of the constraints and contacts whose scope is the clip ``clip_id`` alone.

    The result has new entities by collection and id.
    """
    scoped = {
        collection: [
            replace(each, scope=Scope(clip_id=other))
            for each in getattr(project, collection).values()
            if each.scope.clip_id == clip_id
        ]
        for collection in ("constraints", "contacts")
    }
    return {name: dict(zip(new_ids(len(each)), each, strict=True)) for name, each in scoped.items()}


def copies_for_parts(project: Project, before: Performer, clips: Sequence[Clip]) -> dict[str, dict[str, Entity]]:
    """Copies of scoped constraints and contacts for those of ``clips`` that are new parts of clips of ``before``.

    The result has new entities by collection and id.
    """
    known, whole = {clip.id for clip in before.clips}, ""
    copies: dict[str, dict[str, Entity]] = {"constraints": {}, "contacts": {}}
    for clip in clips:
        if clip.id in known:
            whole = clip.id
        else:
            for collection, entities in scoped_copies(project, whole, clip.id).items():
                copies[collection] |= entities
    return copies
