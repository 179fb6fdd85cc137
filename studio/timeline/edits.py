"""Edits by keyboard and actions: add a contact or label, delete the selection, move a handle by whole frames."""

from dataclasses import replace
from typing import Any

from studio.core.captures.annotations import Label
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.base import Constraint
from studio.core.constraints.target import key_times
from studio.core.names import free_name
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from studio.document.clip_edits import name_of as clip_name
from studio.document.clip_edits import remove_clips
from studio.document.key_edits import delete_keys
from studio.document.keyed_fields import KeyRef, fields_of
from studio.timeline.clip_actions import nudged_clip
from studio.timeline.gestures.activation import time_of, with_time
from studio.timeline.gestures.begin import name_of
from studio.timeline.gestures.contact import gap_between_contacts, new_contact
from studio.timeline.shown import EDGE_PARTS, HANDLE_PARTS, ItemPart, RowContext
from studio.timeline.tracks.keys import growth_fields, keys_between, sheet_fields, stage_times

DELETABLE_COLLECTIONS = ("constraints", "contacts", "clips", "labels", "corrections", "sounds", "footage")


def add_contact(shown: RowContext, point: ContactPoint | Touch, frame: int) -> str | None:
    """Add and select a contact around a frame of the motion. Returns its id, or None if there is a contact at that
    frame.
    """
    contact = new_contact(shown, point, frame)
    if contact is None:
        return None
    entity_id = shown.document.add_shown("contacts", contact, f"Add {name_of(contact).lower()}")
    shown.document.selection.set(("contacts", entity_id))
    return entity_id


def add_label(shown: RowContext, frame: int) -> str:
    """Add and select a label at a frame of the motion, clamped to its range. Returns the id."""
    taken = {each.name for each in shown.project.labels_of(shown.subject.motion_id).values()}
    frame = min(max(frame, 0), shown.subject.last_frame)
    label = Label(free_name("Label", taken), frame, frame, shown.subject.motion_id)
    label_id = shown.document.add("labels", label, "Add label")
    shown.document.selection.set(("labels", label_id))
    return label_id


def go_to_label(shown: RowContext, direction: int) -> None:
    """Move the playhead to the next (1) or previous (-1) label, and select it."""
    playhead, subject = shown.document.playhead, shown.subject
    times = {key: subject.stage_time(each.first) for key, each in shown.project.labels_of(subject.motion_id).items()}
    ahead = {key: time for key, time in times.items() if (time - playhead.time) * direction > 1e-6}
    if ahead:
        nearest = min(ahead, key=lambda key: abs(ahead[key] - playhead.time))
        playhead.pause()
        playhead.set_time(ahead[nearest])
        shown.document.selection.set(("labels", nearest))


def delete_selected(shown: RowContext) -> bool:
    """Delete the selected keys, or if there are none the selected constraints, contacts, labels and clips, in one undo
    step. Returns True if anything was deleted.
    """
    document = shown.document
    if document.keys.items:
        return delete_keys(document)
    items = [item for item in document.selection.items if item[0] in DELETABLE_COLLECTIONS]
    if not items:
        return False
    text = f"Delete {_words(shown.project, *items[0])}" if len(items) == 1 else f"Delete {len(items)} items"
    with document.group(text):
        remove_clips(document, document.selection.of("clips"), text)
        for collection, entity_id in items:
            if collection != "clips" and document.project.get(collection, entity_id) is not None:
                document.remove(collection, entity_id, text)
    return True


def _words(project: Project, collection: str, entity_id: str) -> str:
    entity = project.get(collection, entity_id)
    match entity:
        case ContactInterval():
            return name_of(entity).lower()
        case Clip():
            return f"clip {clip_name(project, entity)}"
    return getattr(entity, "name", "")


def go_to_key(shown: RowContext, direction: int) -> None:
    """Move the playhead to the next (1) or previous (-1) end of a contact, time of an activation, or key."""
    playhead = shown.document.playhead
    times = [
        shown.subject.to_stage(time)
        for each in shown.project.constraints_of(shown.subject.motion_id).values()
        for time in (*(time_of(each.activation, part) for part in HANDLE_PARTS), *key_times(each))
    ] + [
        shown.subject.stage_time(frame)
        for each in shown.project.contacts_of(shown.subject.motion_id).values()
        for frame in (each.first, each.last)
    ]
    props = (field for key, each in shown.project.props.items() for field in fields_of("props", key, each))
    for field in (*growth_fields(shown, shown.subject.performer_id), *props):
        times += stage_times(shown, field).tolist()
    ahead = [time for time in times if (time - playhead.time) * direction > 1e-6]
    if ahead:
        playhead.pause()
        playhead.set_time(min(ahead, key=lambda time: abs(time - playhead.time)))


def select_all_keys(shown: RowContext) -> None:
    """Select all keys of the selected entities; without any, all keys in the dope sheet."""
    fields = sheet_fields(shown)
    shown.document.keys.set(
        KeyRef(field, index) for field, value in fields.items() for index in range(len(value.times))
    )


def select_keys_at_playhead(shown: RowContext) -> None:
    """Select the keys at the playhead: of the selected entities, or of all without any."""
    time, close = shown.document.playhead.time, 0.5 / shown.document.playhead.frame_rate
    shown.document.keys.set(keys_between(shown, sheet_fields(shown), time - close, time + close))


def handles_of(shown: RowContext) -> tuple[ItemPart, ...]:
    """Handles of the selected entity that can be moved by keyboard."""
    match shown.document.selection.current:
        case ("constraints", _):
            return HANDLE_PARTS
        case ("contacts" | "clips", _):
            return EDGE_PARTS
    return ()


def next_handle(shown: RowContext, forward: bool) -> ItemPart | None:
    """Handle after, or before, the focused one; None past the last one."""
    ring = handles_of(shown) if forward else handles_of(shown)[::-1]
    if not ring:
        return None
    if shown.handle not in ring:
        return ring[0]
    place = ring.index(shown.handle) + 1
    return ring[place] if place < len(ring) else None


def nudge_handle(shown: RowContext, frames: int) -> None:
    """Move the focused handle by whole frames on all selected entities of the kind, as one undo step."""
    current = shown.document.selection.current
    if current is None or shown.handle is None:
        return
    collection, _ = current
    ids = shown.document.selection.of(collection)
    verb = f"Move {shown.handle} of" if collection == "constraints" else "Trim"
    words = _words(shown.project, *current) if len(ids) == 1 else f"{len(ids)} {collection}"
    with shown.document.group(f"{verb} {words}"):
        for key in ids:
            entity: Any = shown.project.get(collection, key)
            if collection == "clips":
                nudged_clip(shown, key, shown.handle, frames)
                continue
            if collection == "contacts":
                new: Any = _trimmed(shown, key, entity, shown.handle, frames)
            else:
                new = _shifted(shown, entity, shown.handle, frames)
            shown.document.replace_shown(collection, key, new, verb)


def _shifted(shown: RowContext, constraint: Constraint, handle: ItemPart, frames: int) -> Constraint:
    rate = shown.subject.frame_rate
    frame = round(time_of(constraint.activation, handle) * rate) + frames
    frame = min(max(frame, 0), shown.subject.last_frame)
    return replace(constraint, activation=with_time(constraint.activation, handle, frame / rate))


def handle_words(shown: RowContext) -> str:
    """Description of the focused handle for screen readers: ``Kick target, fade-in end, 0.667 s · frame 20``."""
    current = shown.document.selection.current
    entity = shown.project.get(*current) if current else None
    if entity is None or shown.handle is None:
        return "Timeline"
    rate = shown.subject.frame_rate
    if isinstance(entity, Clip):
        frame = entity.first if shown.handle == ItemPart.FIRST else entity.last
        return f"Clip {clip_name(shown.project, entity)}, {shown.handle} {frame}"
    if isinstance(entity, ContactInterval):
        frame = entity.first if shown.handle == ItemPart.FIRST else entity.last
        return f"{name_of(entity)}, {shown.handle}, {shown.moment(frame)}"
    time = time_of(entity.activation, shown.handle)
    return f"{entity.name}, {shown.handle}, {shown.moment(time * rate)}"


def _trimmed(
    shown: RowContext, entity_id: str, contact: ContactInterval, edge: ItemPart, frames: int
) -> ContactInterval:
    room = gap_between_contacts(shown, contact.point, contact.first, (entity_id,))
    low, high = room or (contact.first, contact.last)
    if edge == ItemPart.FIRST:
        return replace(contact, first=min(max(contact.first + frames, low), contact.last))
    return replace(contact, last=max(min(contact.last + frames, high), contact.first))
