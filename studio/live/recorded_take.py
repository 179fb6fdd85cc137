"""Recorded take of live play, turned into clips with constraints that stay editable."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.keyed import KeyedPlace
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.joining import PlanarTransform
from studio.core.normalized.mirror import mirrored_motion
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import PlayedPiece
from studio.core.stage.clip import Clip
from studio.core.stage.project import Entity, Project
from studio.core.stage.timing import Timing

STILL_SECONDS = 0.1
"""Seconds between two moves of a target from which it counts as having stood still until the second one."""
StoredEntity = tuple[str, str, Entity]
"""Collection, id, and entity to be stored there."""


@dataclass(frozen=True, eq=False)
class StartedClips:
    """Start of a performer's motion at ``since`` seconds: clips, their pieces in the motion, its timing, and added
    constraints.
    """

    since: float
    clips: tuple[Clip, ...]
    played: tuple[PlayedPiece, ...]
    timing: Timing
    asked: tuple[Constraint, ...] = ()
    own: bool = False
    """True if the clips are the performer's own track."""


@dataclass(frozen=True, eq=False)
class StageTake:
    """Recording from ``begin`` to ``end`` seconds of the stage: the motions that each performer began, and the projects
    in use from each time on.
    """

    begin: float
    end: float
    begun: tuple[tuple[str, StartedClips], ...]
    project_with: tuple[tuple[float, Project], ...]


@dataclass(frozen=True)
class RecordedClip:
    """Clip of a take, its source clip, and the constraints that a behaviour added to it."""

    performer_id: str
    clip: Clip
    source: Clip
    asked: tuple[Constraint, ...]


def edits_of(
    take: StageTake,
    project: Project,
    motion_of: Callable[[str], NormalizedMotion],
    names: Iterator[str],
    begin: float | None = None,
) -> list[StoredEntity]:
    """Edits that make ``project`` play the take: rows of clips and their constraints; ``names`` supplies new ids.

    It plays from ``begin`` seconds of the stage on, or at its recorded time. Raises StudioError if a motion cannot be
    loaded.
    """
    later = 0.0 if begin is None else begin - take.begin
    recorded = [each for key in project.performers for each in _row(take, key, project, motion_of, names, later != 0.0)]
    edits: list[StoredEntity] = []
    for key, performer in project.performers.items():
        row = tuple(replace(each.clip, start=each.clip.start + later) for each in recorded if each.performer_id == key)
        if row:
            begun = [each for whose, each in take.begun if whose == key]
            layers = performer.layers if all(each.own for each in begun) else ()
            edits.append(("performers", key, replace(performer, clips=row, layers=layers)))
    edits += _contacts(recorded, project, names)
    return edits + _constraints(take, recorded, project, names)


def _row(
    take: StageTake,
    key: str,
    project: Project,
    motion_of: Callable[[str], NormalizedMotion],
    names: Iterator[str],
    cut: bool,
) -> Iterator[RecordedClip]:
    """Clips of one performer, each at its recorded placement until the next one took over.

    The motion that played when the take began begins at its own start, unless it is ``cut`` there, and the last one
    plays to its end: grounding depends on the frames before and after.
    """
    begun = [each for whose, each in take.begun if whose == key]
    for index, each in enumerate(begun):
        begin = -math.inf if each.own else each.since
        begin = max(begin, take.begin) if cut else begin
        end = math.inf if each is begun[-1] else begun[index + 1].since - 1.0 / each.timing.frame_rate
        for played in each.played:
            source = each.clips[played.piece.origin[0]]
            if source.motion_id not in project.motions:
                continue
            clip = _trimmed(source, played, each.timing, begin, end, motion_of(source.motion_id))
            if clip is not None:
                yield RecordedClip(key, replace(clip, id=next(names)), source, each.asked)


def _trimmed(
    source: Clip, played: PlayedPiece, timing: Timing, begin: float, end: float, motion: NormalizedMotion
) -> Clip | None:
    """Clip of the part of a piece that plays from ``begin`` to ``end`` (s), at the placement of the piece; None if no
    part does.
    """
    piece = played.piece
    begun = timing.stage_time(max(played.first, timing.first))
    starts, ends = max(begun, begin), min(timing.stage_time(min(played.last, timing.last)), end)
    if ends < starts - 1e-9:
        return None
    frames = np.rint(piece.frames_after(np.array([starts, ends]) - piece.start)).clip(0, motion.frame_count - 1)
    first, last = frames.astype(int).tolist()
    place = _about(played.placement, motion, first, piece.mirrored)
    return replace(
        source, first=first, last=max(last, first), start=starts, repeats=1, joined=False, turn=place.turn,
        offset=place.offset, ease=piece.ease if starts - begun < 1e-9 else 0.0,
    )  # fmt: skip


def _about(placement: PlanarTransform, motion: NormalizedMotion, first: int, is_mirrored: bool) -> PlanarTransform:
    """``placement`` as a rotation about the root in frame ``first`` and an offset, as a clip has it."""
    shown = mirrored_motion(motion) if is_mirrored else motion
    place = shown.channels[first, channel.HIPS : channel.HIPS + 2]
    c, s = np.cos(placement.turn), np.sin(placement.turn)
    turned = np.array([c * place[0] - s * place[1], s * place[0] + c * place[1]])
    x, y = (turned + placement.offset - place).tolist()
    return PlanarTransform(placement.turn, (x, y))


def _contacts(recorded: Sequence[RecordedClip], project: Project, names: Iterator[str]) -> list[StoredEntity]:
    """Edits that copy the contacts of each source clip to the clips recorded of it."""
    return [
        ("contacts", next(names), replace(contact, scope=Scope(clip_id=each.clip.id)))
        for each in recorded
        for contact in project.contacts.values()
        if contact.scope.clip_id and contact.scope.clip_id == each.source.id
    ]


def _constraints(
    take: StageTake, recorded: Sequence[RecordedClip], project: Project, names: Iterator[str]
) -> list[StoredEntity]:
    """Edits of the constraints: those scoped to source clips are copied, those of behaviours added, moved targets
    keyed.
    """
    edits: list[StoredEntity] = []
    moved = _moved(take, project)
    for key, constraint in project.constraints.items():
        concerned = [each for each in recorded if _concerns(constraint, each)]
        path = moved.get(key)
        if path is None and not constraint.scope.clip_id:
            continue
        if path is not None and len(concerned) == 1 and not constraint.scope.clip_id:
            edits.append(("constraints", key, _keyed(constraint, path, concerned[0].clip, project)))
            continue
        for each in concerned:
            own = _keyed(constraint, path, each.clip, project) if path is not None else constraint
            edits.append(("constraints", next(names), replace(own, scope=Scope(clip_id=each.clip.id))))
        if path is not None and not constraint.scope.clip_id:
            edits.append(("constraints", key, replace(constraint, enabled=False)))
    edits += [
        ("constraints", next(names), replace(asked, scope=Scope(clip_id=each.clip.id)))
        for each in recorded
        for asked in each.asked
    ]
    return edits


def _concerns(constraint: Constraint, each: RecordedClip) -> bool:
    return constraint.motion_id == each.clip.motion_id and constraint.scope.includes(each.performer_id, each.source.id)


TargetPath = list[tuple[float, Vector]]
"""Stage time in seconds, and position of a target from then on, of each move."""


def _moved(take: StageTake, project: Project) -> dict[str, TargetPath]:
    """Paths of the targets that were moved during the recording, by the ids of their constraints."""
    paths: dict[str, TargetPath] = {}
    for key in project.constraints:
        path: TargetPath = []
        for seconds, given in take.project_with:
            target = _place(given.constraints.get(key))
            if target is not None and (not path or path[-1][1] != target):
                if path and seconds - path[-1][0] > STILL_SECONDS:
                    path.append((seconds - STILL_SECONDS / 2, path[-1][1]))
                path.append((seconds, target))
        if len(path) > 1 and _place(project.constraints[key]) is not None:
            paths[key] = path
    return paths


def _place(constraint: Constraint | None) -> Vector | None:
    target: Any = constraint.target if isinstance(constraint, PositionConstraint) else None
    return target if isinstance(target, tuple) else None


def _keyed(constraint: Constraint, path: TargetPath, clip: Clip, project: Project) -> Constraint:
    """Constraint with its target keyed along ``path``, in seconds of the motion of ``clip``."""
    rate = project.frame_rate_of(clip)
    times: list[float] = []
    values: list[Vector] = []
    for seconds, place in path:
        time = float(clip.motion_seconds(seconds, rate))
        if not times or time > times[-1]:
            times.append(time)
            values.append(place)
    return replace(constraint, target=KeyedPlace(tuple(times), tuple(values)))  # type: ignore[call-arg]
