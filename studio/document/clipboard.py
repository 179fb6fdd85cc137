"""Copy and paste of constraints, contacts, corrections and keys as readable JSON, optionally mirrored."""

import json
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import NoReturn

from studio.core.body.growth import KeyedProportions
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import MIRROR_TRANSFORM, ClipTransform, constraint_on_clip
from studio.core.constraints.objections import objection
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.curves.keyed import Key, KeyedNumber, KeyedPlace, KeyedTurn, Keys
from studio.core.errors import StudioError
from studio.core.names import free_name
from studio.core.stage.correction import Correction, KeyedPoses
from studio.core.stage.project import Project
from studio.document.edited_project import EditedProject
from studio.document.key_edits import replace_fields
from studio.document.keyed_fields import (
    KEYED_COLLECTIONS,
    KeyedField,
    KeyRef,
    from_stage,
    keyed_value,
    places_at,
    selected_fields,
    to_stage,
)
from studio.document.mirrored import mirrored_entity
from studio.io.json_text import JsonObject, json_of
from studio.io.project.constraint_file import constraint_of, constraint_record, too_large
from studio.io.project.entity_json import entity_of, entity_record
from studio.io.project.value_json import MemberCodec, from_json, to_json

CLIPBOARD_FORMAT = "morpho-studio clipboard"
CLIPBOARD_VERSION = 1
CLIPBOARD_NAME = "Clipboard"
CLIPBOARD_KEY_KINDS: Mapping[str, type[Keys]] = {
    "places": KeyedPlace,
    "offsets": KeyedOwnPlace,
    "numbers": KeyedNumber,
    "rotations": KeyedTurn,
    "measures": KeyedProportions,
    "poses": KeyedPoses,
}
NOTHING_TO_PASTE = "There is nothing to paste. Copy constraints, contacts, corrections or keys first."
_NUMBERS = re.compile(r"\[\s+(-?[\d.e+-]+(?:,\s+-?[\d.e+-]+)*)\s+\]")


def selection_as_json(document: EditedProject) -> str:
    """Selected keys, or if there are none, selected constraints, contacts and corrections, as JSON; empty if nothing is
    selected.
    """
    keys = _key_records(document)
    record: JsonObject = {
        "format": CLIPBOARD_FORMAT,
        "version": CLIPBOARD_VERSION,
        "from": _origin(document),
    }
    if keys:
        record["keys"] = keys
    else:
        record |= _entity_records(document)
    if len(record) == 3:
        return ""
    text = json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False)
    return _NUMBERS.sub(lambda found: "[" + re.sub(r"\s+", " ", found[1]) + "]", text)


def paste_json(document: EditedProject, text: str, mirrored: bool = False) -> None:
    """Paste JSON made by ``selection_as_json`` as one undo step, and select the result.

    Keys are pasted into the same fields of the selected entities, from the playhead on. Constraints and contacts keep
    their times if they are pasted on another motion or performer, or mirrored; otherwise they begin at the playhead, or
    with the motion if that begins later. Raises StudioError if the text contains nothing that can be pasted.
    """
    record = _record_of(text)
    if "keys" in record:
        _paste_keys(document, record["keys"], mirrored)
    else:
        _paste_entities(document, record, mirrored)


def _origin(document: EditedProject) -> JsonObject:
    clip = document.active_clip
    if clip is None:
        return {}
    rate = document.project.frame_rate_of(clip)
    return {"motion_id": clip.motion_id, "performer_id": document.active_performer_id or "", "frame_rate": rate}


def _record_of(text: str) -> JsonObject:
    try:
        record = json_of(text.encode())
    except ValueError:
        record = None
    if not isinstance(record, dict) or record.get("format") != CLIPBOARD_FORMAT:
        raise StudioError(NOTHING_TO_PASTE)
    if record.get("version") != CLIPBOARD_VERSION:
        raise StudioError(
            "The content of the clipboard is from a newer version of Morpho Studio. Update this one to paste it."
        )
    if large := too_large({name: item for name, item in record.items() if name != "from"}):
        raise StudioError(f"{CLIPBOARD_NAME}, {large} is out of range. Lengths are metres, times seconds.")
    return record


def _entity_records(document: EditedProject) -> JsonObject:
    project, selection = document.shown_project, document.selection
    constraints = [constraint_record(project.constraints[key]) for key in selection.of("constraints")]
    contacts = [_contact_record(project.contacts[key]) for key in selection.of("contacts")]
    corrections = [_correction_record(project.corrections[key]) for key in selection.of("corrections")]
    found = {"constraints": constraints, "contacts": contacts, "corrections": corrections}
    return {name: records for name, records in found.items() if records}


def _contact_record(contact: ContactInterval) -> JsonObject:
    record = entity_record("contacts", "", contact, {})
    return {name: item for name, item in record.items() if name not in ("id", "schema", "motion_id")}


def _correction_record(correction: Correction) -> JsonObject:
    record = entity_record("corrections", "", correction, {})
    return {name: item for name, item in record.items() if name not in ("id", "schema", "performer_id")}


def _corrections_of(record: JsonObject, performer_id: str) -> list[Correction]:
    found: list[Correction] = []
    for index, item in enumerate(_list_of(record, "corrections")):
        try:
            each = entity_of("corrections", {**item, "performer_id": performer_id}, _no_member)
        except (ValueError, TypeError) as error:
            raise StudioError(f"{CLIPBOARD_NAME}, corrections[{index}], {error}") from error
        assert isinstance(each, Correction)
        found.append(each)
    return found


def _add_correction(document: EditedProject, correction: Correction, text: str) -> str:
    taken = {each.name for each in document.project.corrections_of(correction.performer_id).values()}
    return document.add("corrections", replace(correction, name=free_name(correction.name, taken)), text)


def _paste_entities(document: EditedProject, record: JsonObject, mirrored: bool) -> None:
    clip, origin = document.active_clip, record.get("from", {})
    if clip is None:
        raise StudioError("No character has a clip to paste constraints on. Add a clip first.")
    chosen = [key for key in document.selection.of("performers") if key in document.project.performers]
    body = chosen[-1] if chosen and chosen[-1] != origin.get("performer_id") else ""
    constraints = [
        constraint_of(item, clip.motion_id, f"{CLIPBOARD_NAME}, constraints[{index}]")
        for index, item in enumerate(_list_of(record, "constraints"))
    ]
    rate = document.project.frame_rate_of(clip)
    contacts = _contacts_of(document, record, clip.motion_id, rate / float(origin.get("frame_rate") or rate))
    performer_id = document.active_performer_id or ""
    corrections = _corrections_of(record, performer_id)
    if not constraints and not contacts and not corrections:
        raise StudioError(NOTHING_TO_PASTE)
    moves = not (mirrored or body or origin.get("motion_id") != clip.motion_id)
    if moves and corrections:
        first = min(each.keys.times[0] for each in corrections)
        corrections = [each.moved(document.playhead.time - first) for each in corrections]
    if moves and (constraints or contacts):
        begins = [each.activation.start for each in constraints] + [each.first / rate for each in contacts]
        here = max(float(clip.motion_seconds(document.playhead.time, rate)), 0.0)
        seconds = round((here - min(begins)) * rate) / rate
        constraints = [constraint_on_clip(each, _later(seconds)) for each in constraints]
        frames = round(seconds * rate)
        contacts = [replace(each, first=each.first + frames, last=each.last + frames) for each in contacts]
    if mirrored:
        mirror = partial(mirrored_entity, document.project, performer_id, replace(clip, mirrored=True))
        constraints = [mirror(each) for each in constraints]
        contacts = [mirror(each) for each in contacts]
        corrections = [mirror(each) for each in corrections]
    count = len(constraints) + len(contacts) + len(corrections)
    names = [each.name for each in constraints] + [each.name for each in corrections]
    name = names[0] if names else f"{contacts[0].point.words} contact"
    text = f"Paste {name if count == 1 else f'{count} items'}{' mirrored' if mirrored else ''}"
    with document.group(text):
        items = [("constraints", _add(document, each, body, text)) for each in constraints]
        items += [("contacts", _add_contact(document, each, body, text)) for each in contacts]
        items += [("corrections", _add_correction(document, each, text)) for each in corrections]
    document.selection.set(*(("performers", key) for key in chosen), *items)


def _list_of(record: JsonObject, name: str) -> list[JsonObject]:
    found = record.get(name, [])
    if not isinstance(found, list):
        raise StudioError(f"{CLIPBOARD_NAME}, {name}: expected a list.")
    return found


def _contacts_of(document: EditedProject, record: JsonObject, motion_id: str, frames: float) -> list[ContactInterval]:
    """Contacts of the JSON ``record`` in frames of the motion; ``frames`` is the number of these frames per frame of
    the copied motion.
    """
    found: list[ContactInterval] = []
    for index, item in enumerate(_list_of(record, "contacts")):
        try:
            each = entity_of("contacts", {**item, "motion_id": motion_id}, _no_member)
        except (ValueError, TypeError) as error:
            raise StudioError(f"{CLIPBOARD_NAME}, contacts[{index}], {error}") from error
        assert isinstance(each, ContactInterval)
        found.append(replace(each, first=round(each.first * frames), last=round(each.last * frames)))
    return found


def _later(seconds: float) -> ClipTransform:
    return ClipTransform(seconds, 1.0, 0.0, (0.0, 0.0), False, -math.inf, math.inf)


def _scope(project: Project, scope: Scope, body: str) -> Scope:
    """Scope of a pasted entity: the performer ``body`` if given, else its former scope if that performer or clip still
    exists.
    """
    if body:
        return Scope(performer_id=body)
    there = scope.performer_id in ("", *project.performers) and scope.clip_id in ("", *project.clips)
    return scope if there else EVERYONE


def _add(document: EditedProject, constraint: Constraint, body: str, text: str) -> str:
    """Add a constraint under a free name, with the lowest priority if it would conflict with another one."""
    others = document.shown_project.constraints_of(constraint.motion_id).values()
    name = free_name(constraint.name, {each.name for each in others})
    new = replace(constraint, name=name, scope=_scope(document.project, constraint.scope, body))
    if objection(new, others):
        new = replace(new, priority=max((each.priority for each in others), default=-1) + 1)
    return document.add_shown("constraints", new, text)


def _add_contact(document: EditedProject, contact: ContactInterval, body: str, text: str) -> str:
    """Add a contact, and remove contacts of the same point that it covers."""
    new = replace(contact, scope=_scope(document.project, contact.scope, body))
    for key, each in document.shown_project.contacts_of(new.motion_id).items():
        same = (each.point, each.scope) == (new.point, new.scope)
        if same and each.first <= new.last and new.first <= each.last:
            document.remove("contacts", key, text)
    return document.add_shown("contacts", new, text)


@dataclass(frozen=True)
class _CopiedKeys:
    """Keys of one field of one entity, with times in seconds after the earliest copied key."""

    entity: str
    field: str
    keyed: Keys


def _key_records(document: EditedProject) -> list[JsonObject]:
    project, clip = document.shown_project, document.active_clip
    found: list[tuple[KeyedField, Keys]] = []
    for field, places in document.keys.by_field().items():
        value = keyed_value(project, field)
        if isinstance(value, Keys):
            others = set(range(len(value.times))) - set(places)
            kept = value.without_keys(others)
            times = {at: to_stage(project, clip, field, time) for at, time in enumerate(kept.times)}
            found.append((field, kept.with_times(times)))
    first = min((value.times[0] for _, value in found), default=0.0)
    return [
        {
            "of": getattr(project.get(*field.item), "name", ""),
            "entity": "/".join(field.item),
            "field": field.name,
            "kind": next(name for name, kind in CLIPBOARD_KEY_KINDS.items() if isinstance(value, kind)),
            "keys": _without_kind(to_json(value.moved(-first), _NO_ARRAYS)),
        }
        for field, value in found
    ]


def _without_kind(record: JsonObject) -> JsonObject:
    return {name: item for name, item in record.items() if name not in ("kind", "before", "after")}


def _paste_keys(document: EditedProject, records: object, mirrored: bool) -> None:
    copies = [_keys_of(item, place) for place, item in enumerate(records if isinstance(records, list) else ())]
    project, clip = document.shown_project, document.active_clip
    values: dict[KeyedField, Keys] = {}
    pasted: dict[KeyedField, list[float]] = {}
    for copy, field in _destinations(document, copies):
        old = values.get(field, keyed_value(project, field))
        keyed = _mirrored(project, field, copy.keyed) if mirrored else copy.keyed
        times = [from_stage(project, clip, field, time + document.playhead.time) for time in keyed.times]
        new = [Key(time, key.value, key.tangents) for time, key in zip(times, keyed.keys, strict=True)]
        values[field] = old.with_keys(new) if isinstance(old, Keys) else replace(keyed, times=tuple(times))
        pasted[field] = times
    if not values:
        raise StudioError("Nothing selected has keys of this kind. Select a constraint, prop or character to paste on.")
    count = sum(map(len, pasted.values()))
    words = "key" if count == 1 else f"{count} keys"
    replace_fields(document, values, f"Paste {words}{' mirrored' if mirrored else ''}")
    document.keys.set(
        KeyRef(field, place) for field, value in values.items() for place in places_at(value, pasted[field])
    )


def _keys_of(record: JsonObject, index: int) -> _CopiedKeys:
    try:
        kind = CLIPBOARD_KEY_KINDS[record["kind"]]
        keyed: Keys = from_json(record["keys"], kind, _NO_ARRAYS)
        return _CopiedKeys(str(record["entity"]), str(record["field"]), keyed)
    except (KeyError, TypeError, ValueError) as error:
        raise StudioError(f"{CLIPBOARD_NAME}, keys[{index}]: {error}") from error


def _destinations(document: EditedProject, copies: Iterable[_CopiedKeys]) -> Iterable[tuple[_CopiedKeys, KeyedField]]:
    """Pairs of copied keys and a field to paste them into: keys of one entity go to all selected entities, keys of
    several entities to one each.
    """
    groups: dict[str, list[_CopiedKeys]] = {}
    for copy in copies:
        groups.setdefault(copy.entity, []).append(copy)
    items = dict.fromkeys(
        ("characters", document.project.performers[key].character_id) if name == "performers" else (name, key)
        for name, key in document.selection.items
        if name != "performers" or key in document.project.performers
    )
    if not items:
        items = dict.fromkeys(_item(entity) for entity in groups)
    fitting = [item for item in items if item[0] in KEYED_COLLECTIONS]
    pairs = (
        [(group, item) for group in groups.values() for item in fitting]
        if len(groups) == 1
        else list(zip(groups.values(), fitting, strict=False))
    )
    for group, item in pairs:
        for copy in group:
            field = _field_for(document, copy, item)
            if field is not None:
                yield copy, field


def _item(entity: str) -> tuple[str, str]:
    collection, _, entity_id = entity.partition("/")
    return collection, entity_id


def _field_for(document: EditedProject, copy: _CopiedKeys, item: tuple[str, str]) -> KeyedField | None:
    """Field of an entity into which copied keys are pasted; None if there is none.

    The field of the same name is preferred, then one with keys of the same type, then an unkeyed value of that type.
    Numbers of another name are never used, since their unit differs.
    """
    project = document.shown_project
    entity = project.get(*item)
    if entity is None:
        return None
    alike = [field for field, value in selected_fields(project, [item]).items() if isinstance(value, type(copy.keyed))]
    same = [field for field in alike if field.name == copy.field]
    alike = [] if isinstance(copy.keyed, KeyedNumber) else alike
    fixed = [
        KeyedField(*item, name)
        for name in dict.fromkeys((copy.field, "target", "centre", "position", "proportions"))
        if _is_plain(getattr(entity, name, None), copy.keyed)
    ]
    return next(iter((*same, *(field for field in fixed if field.name == copy.field), *alike, *fixed)), None)


def _is_plain(value: object, keyed: Keys) -> bool:
    """True if the unkeyed ``value`` has the type of the values of ``keyed``."""
    return type(value) is type(keyed.values[0]) and (not isinstance(value, tuple) or len(value) == keyed.size)


def _mirrored(project: Project, field: KeyedField, keyed: Keys) -> Keys:
    """Keys of a field mirrored to the other side of the body."""
    match keyed:
        case KeyedPoses():
            return keyed.mirrored()
        case KeyedOwnPlace():
            values = tuple(map(tuple, MIRROR_TRANSFORM.directions(keyed.values).tolist()))
            return replace(keyed.with_rates(MIRROR_TRANSFORM.directions), values=values)
        case KeyedPlace():
            values = tuple(map(tuple, MIRROR_TRANSFORM.positions(keyed.values).tolist()))
            return replace(keyed.with_rates(MIRROR_TRANSFORM.directions), values=values)
        case KeyedTurn():
            entity = project.get(*field.item)
            assert isinstance(entity, Constraint)
            part = entity.point.part
            values = tuple(map(tuple, MIRROR_TRANSFORM.rotations(keyed.values, part).tolist()))
            return replace(keyed.with_rates(lambda rate: MIRROR_TRANSFORM.own_rates(rate, part)), values=values)
        case KeyedNumber() if field.name == "heading":
            return replace(keyed.with_rates(lambda rate: -rate), values=tuple(-value for value in keyed.values))
    return keyed


def _no_member(_name: object) -> NoReturn:
    raise ValueError("an array is not expected here.")


_NO_ARRAYS = MemberCodec(_no_member, _no_member)
