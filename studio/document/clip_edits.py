"""Edits of clips, each one undo step: they affect all performers that play the clip, and its constraints and
contacts.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from studio.core.changed_records import with_fields
from studio.core.curves.retiming import Speed
from studio.core.errors import StudioError
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import (
    MOST_CLIP_PARTS,
    ClipEdit,
    clip_halves,
    players_of,
    scoped_copies,
    with_clip_edited,
    with_row,
)
from studio.core.stage.layer import Layer
from studio.core.stage.project import Entity, Project, new_id, new_ids
from studio.document.edited_project import EditedProject

DEFAULT_BLEND_SECONDS = 0.3
"""Seconds by which an added clip overlaps the clip before it."""


def edit_clip(document: EditedProject, clip_id: str, edit: ClipEdit, text: str, gesture: int | None = None) -> None:
    """Replace a clip by the result of ``edit`` on all its performers. Raises StudioError, and changes nothing, if
    ``edit`` raises ValueError.
    """
    with document.group(text, gesture):
        for key, performer in players_of(document.project, clip_id).items():
            try:
                document.replace("performers", key, with_clip_edited(performer, clip_id, edit), text)
            except ValueError as error:
                raise StudioError(str(error)) from error


def set_speed(document: EditedProject, clip_id: str, speed: Speed, text: str, gesture: int | None = None) -> None:
    """Set the speed of a clip; later clips of its tracks move with its end."""
    project = document.project
    clip, rows = project.clips[clip_id], (each.clips for each in players_of(project, clip_id).values())
    rate = project.frame_rate_of(clip)
    later = dict.fromkeys(each.id for row in rows for each in row if each.start > clip.start)
    with document.group(text, gesture):
        edit_clip(document, clip_id, lambda each: (replace(each, speed=speed),), text)
        shift = document.project.clips[clip_id].length(rate) - clip.length(rate)
        for key in later if layer_of(project, clip_id) is None else ():
            edit_clip(document, key, lambda each: (replace(each, start=each.start + shift),), text)


def remove_clips(document: EditedProject, clip_ids: Iterable[str], text: str) -> None:
    """Remove clips from all tracks, with the constraints and contacts whose scope is one of them."""
    with document.group(text):
        for clip_id in clip_ids:
            edit_clip(document, clip_id, lambda _: (), text)
            for collection in ("constraints", "contacts"):
                for key in _asked_of(document.project, collection, clip_id):
                    document.remove(collection, key, text)


def split_clip(document: EditedProject, clip_id: str, time: float) -> str:
    """Split a clip at a stage time in seconds, and return the id of the second part. Raises StudioError if the time is
    not within the clip.
    """
    clip = document.project.clips[clip_id]
    text, names = f"Split {name_of(document.project, clip)}", new_ids(MOST_CLIP_PARTS)
    rate = document.project.frame_rate_of(clip)
    with document.group(text):
        edit_clip(document, clip_id, lambda each: clip_halves(each, rate, time, iter(names)), text)
        made = [name for name in names if name in document.project.clips]
        for name in made:
            copy_scoped_entities(document, clip_id, name, text)
    return made[-1]


def mirror_clip(document: EditedProject, clip_id: str) -> None:
    """Toggle the mirroring of a clip."""
    set_mirrored(document, clip_id, not document.project.clips[clip_id].mirrored)


def set_mirrored(document: EditedProject, clip_id: str, mirrored: bool) -> None:
    """Mirror a clip or not, together with those holds of props and corrections of poses during which its performers
    play no other clip.
    """
    project = document.project
    clip = project.clips[clip_id]
    if clip.mirrored is mirrored:
        return
    text = f"Mirror {name_of(project, clip)}"
    with document.group(text):
        edit_clip(document, clip_id, lambda clip: (replace(clip, mirrored=mirrored),), text)
        if layer_of(project, clip_id) is not None:
            return
        for key, prop in project.props.items():
            held = [
                hold.mirrored() if _is_alone(project, clip_id, hold.performer_id, hold.begin, hold.end) else hold
                for hold in prop.holds
            ]
            document.replace("props", key, prop.with_holds(held), text)
        for key, each in project.corrections.items():
            if _is_alone(project, clip_id, each.performer_id, each.activation.start, each.activation.end):
                document.replace("corrections", key, each.mirrored(), text)


def _is_alone(project: Project, clip_id: str, performer_id: str, begin: float | None, end: float | None) -> bool:
    """True if a performer plays that clip and no other one from ``begin`` to ``end``, seconds of the stage."""
    return [clip_id] == [
        clip.id
        for clip in project.performers[performer_id].clips
        if (end is None or clip.start < end)
        and (begin is None or clip.start + clip.length(project.frame_rate_of(clip)) > begin)
    ]


def duplicate_clip(document: EditedProject, clip_id: str) -> str:
    """Add a copy after a clip, aligned to the clip's end, and return the id of the copy."""
    project = document.project
    text, name = f"Duplicate {name_of(project, project.clips[clip_id])}", new_id()
    rate = project.frame_rate_of(project.clips[clip_id])

    def twice(clip: Clip) -> Sequence[Clip]:
        return clip, replace(clip, id=name, start=clip.start + clip.length(rate), joined=True)

    with document.group(text):
        edit_clip(document, clip_id, twice, text)
        copy_scoped_entities(document, clip_id, name, text)
    return name


def add_clip(document: EditedProject, performer_ids: Iterable[str], motion_id: str, start: float | None = None) -> str:
    """Add a whole motion as a clip to the tracks of performers, at the stage time ``start`` or at the end of each, and
    return its id.
    """
    project = document.project
    clip = _whole(project, motion_id, 0.0)
    text = f"Add clip {project.motions[motion_id].name}"
    with document.group(text):
        for key in performer_ids:
            performer = project.performers[key]
            end = timing_of(project, performer).end - DEFAULT_BLEND_SECONDS if performer.clips else 0.0
            placed = replace(clip, start=max(end, 0.0) if start is None else start)
            document.replace("performers", key, with_row(performer, (*performer.clips, placed)), text)
    return clip.id


def _whole(project: Project, motion_id: str, start: float) -> Clip:
    """Clip of a whole motion with a new id."""
    if motion_id not in project.motions:
        raise StudioError("The capture has been removed from the project. Choose another one.")
    capture = project.captures[project.motions[motion_id].capture_id]
    if capture.body_map is None:
        raise StudioError(
            f"No skeleton was found in '{capture.name}', so no character can play it. Its import report lists"
            " what is missing."
        )
    return Clip(motion_id, capture.first_frame, capture.frame_count - 1, start, new_id())


def add_layer(document: EditedProject, performer_ids: Iterable[str], motion_id: str, start: float) -> str:
    """Add a whole motion as a layer over the upper body of performers, from the stage time ``start`` on; return its
    clip's id.
    """
    project = document.project
    clip = _whole(project, motion_id, start)
    text = f"Add layer {project.motions[motion_id].name}"
    with document.group(text):
        for key in performer_ids:
            performer = project.performers[key]
            document.replace("performers", key, replace(performer, layers=(*performer.layers, Layer(clip))), text)
    return clip.id


def edit_layer(document: EditedProject, clip_id: str, text: str, gesture: int | None = None, **values: object) -> None:
    """Set ``values`` of the layer of a clip on all its performers. Raises StudioError for invalid values."""
    with document.group(text, gesture):
        for key, performer in players_of(document.project, clip_id).items():
            try:
                layers = [with_fields(each, **values) if each.clip.id == clip_id else each for each in performer.layers]
            except ValueError as error:
                raise StudioError(str(error)) from error
            document.replace("performers", key, replace(performer, layers=tuple(layers)), text)


def layer_of(project: Project, clip_id: str) -> Layer | None:
    """Layer that plays a clip; None for a clip of the track."""
    layers = (layer for performer in project.performers.values() for layer in performer.layers)
    return next((layer for layer in layers if layer.clip.id == clip_id), None)


def detach_clip(document: EditedProject, performer_id: str, clip_id: str) -> str:
    """Give a performer its own copy of a shared clip, with the clip's constraints; return the copy's id."""
    performer, name = document.project.performers[performer_id], new_id()
    text = f"Make {name_of(document.project, document.project.clips[clip_id])} unique for {performer.name}"
    with document.group(text):
        own = with_clip_edited(performer, clip_id, lambda clip: (replace(clip, id=name),))
        document.replace("performers", performer_id, own, text)
        copy_scoped_entities(document, clip_id, name, text)
    return name


def name_of(project: Project, clip: Clip) -> str:
    """Name of a clip: that of its motion."""
    return project.motions[clip.motion_id].name


def copy_scoped_entities(document: EditedProject, clip_id: str, other: str, text: str) -> None:
    """Copy the constraints and contacts whose scope is ``clip_id`` to the clip ``other``."""
    add_copies(document, scoped_copies(document.project, clip_id, other), text)


def add_copies(document: EditedProject, copies: Mapping[str, Mapping[str, Entity]], text: str) -> None:
    """Add entities to the project, given by collection and id."""
    for collection, entities in copies.items():
        document.put_all(collection, entities, text)


def _asked_of(project: Project, collection: str, clip_id: str) -> list[str]:
    return [key for key, each in getattr(project, collection).items() if each.scope.clip_id == clip_id]
