"""Edits of keys: set, delete, move and scale them."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.changed_records import with_fields
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.target import Place, Turn
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Keys
from studio.core.curves.tangents import Beyond
from studio.core.stage.correction import KeyedPoses
from studio.core.stage.prop import Prop
from studio.document.channels import allowed_value_at
from studio.document.clip_edits import set_speed
from studio.document.edited_project import EditedProject
from studio.document.keyed_fields import (
    FloatArray,
    Keyed,
    KeyedField,
    KeyRef,
    all_from_stage,
    all_to_stage,
    counted_in,
    from_stage,
    keyed_value,
    places_at,
    selected_fields,
    to_stage,
    with_times,
)

LEAST_TIME_SCALE, MOST_TIME_SCALE = 0.01, 100.0
"""Minimum and maximum factor by which key times can be scaled at once."""
ROTATION_FIELDS = ("heading", "tilt")
"""Fields with the rotation of a volume constraint or a prop."""


def replace_fields(
    document: EditedProject, values: Mapping[KeyedField, object], text: str, gesture: int | None = None
) -> None:
    """Replace the values of keyed fields in one undo step. Values are given as shown, so those of a mirrored clip are
    mirrored back.
    """
    changes: dict[tuple[str, str], dict[str, object]] = {}
    for field, value in values.items():
        changes.setdefault(field.item, {})[field.name] = value
    with document.group(text, gesture):
        for (collection, entity_id), named in changes.items():
            entity: Any = document.shown_project.get(collection, entity_id)
            if entity is not None and collection == "clips":
                set_speed(document, entity_id, with_fields(entity, **named).speed, text)
            elif entity is not None:
                document.replace_shown(collection, entity_id, with_fields(entity, **named), text)


class KeyDrag:
    """Drag of the selected keys; every state is computed from the keys at its start."""

    def __init__(self, document: EditedProject) -> None:
        self._document, self._clip = document, document.active_clip
        self._gesture = document.new_gesture()
        self.before: dict[KeyedField, Keyed] = {}
        self._keys, self._places = document.keys.items, document.keys.by_field()
        for field in self._places:
            value = keyed_value(document.shown_project, field)
            if value is not None:
                self.before[field] = value

    @property
    def count(self) -> int:
        """Number of dragged keys."""
        return sum(map(len, self._places.values()))

    def stage_times(self) -> list[float]:
        """Stage times in seconds of the dragged keys at the start of the drag."""
        return [
            to_stage(self._document.project, self._clip, field, value.times[place])
            for field, value in self.before.items()
            for place in self._places[field]
        ]

    def move(self, seconds: float, changed: Mapping[KeyedField, Keyed] | None = None) -> None:
        """Move the keys by ``seconds`` on the stage; ``changed`` holds values that the drag has changed otherwise, by
        field.
        """
        self._show(lambda time: time + seconds, 1.0, "Move", changed or {})

    def scale(self, factor: float, about: float) -> None:
        """Scale the keys by ``factor`` about the stage time ``about``, in seconds."""
        factor = min(max(factor, LEAST_TIME_SCALE), MOST_TIME_SCALE)
        self._show(lambda time: about + (time - about) * factor, 1.0 / factor, "Scale", {})

    def cancel(self) -> None:
        """Restore the keys from before the drag and drop the undo step."""
        self._put(self.before, "Move keys")
        self._document.keys.set(self._keys)

    def _show(
        self, change: Callable[[FloatArray], FloatArray], speed: float, verb: str, changed: Mapping[KeyedField, Keyed]
    ) -> None:
        project, clip = self._document.project, self._clip
        values, moved = {}, {}
        for field, value in self.before.items():
            places = self._places[field]
            stage = all_to_stage(project, clip, field, np.array(value.times)[[*places]])
            moved[field] = dict(zip(places, all_from_stage(project, clip, field, change(stage)).tolist(), strict=True))
            values[field] = with_times(changed.get(field, value), moved[field], speed)
        self._put(values, f"{verb} {keys_undo_text(self.count)}")
        in_order = all(
            len(value.times) == len(self.before[field].times)
            and all(value.times[place] == time for place, time in moved[field].items())
            for field, value in values.items()
        )
        self._document.keys.set(
            self._keys
            if in_order
            else (
                KeyRef(field, place)
                for field, value in values.items()
                for place in places_at(value, moved[field].values())
            )
        )

    def _put(self, values: Mapping[KeyedField, Keyed], text: str) -> None:
        there = {field: value for field, value in values.items() if keyed_value(self._document.project, field)}
        replace_fields(self._document, there, text, self._gesture)


def keys_undo_text(count: int) -> str:
    """Number of keys as text, ``key`` or ``3 keys``."""
    return "key" if count == 1 else f"{count} keys"


def nudge_keys(document: EditedProject, frames: int) -> None:
    """Move the selected keys by whole frames, as one undo step."""
    KeyDrag(document).move(frames / document.playhead.frame_rate)


def stretch_keys(document: EditedProject, frames: int) -> None:
    """Scale the selected keys about the playhead so that the farthest one moves ``frames`` away from the playhead."""
    drag, here = KeyDrag(document), document.playhead.time
    farthest = max((abs(time - here) for time in drag.stage_times()), default=0.0)
    if farthest > 0.0:
        drag.scale(1.0 + frames / document.playhead.frame_rate / farthest, here)


def delete_keys(document: EditedProject) -> bool:
    """Delete the selected keys as one undo step; True if there was anything to delete.

    A field that loses all keys keeps its value at the playhead. The four times of an activation cannot be deleted. A
    correction is deleted with its last key.
    """
    values: dict[KeyedField, object] = {}
    gone: list[tuple[str, str]] = []
    count = 0
    for field, places in document.keys.by_field().items():
        value = keyed_value(document.shown_project, field)
        if not isinstance(value, Keys):
            continue
        count += len(places)
        if isinstance(value, KeyedPoses) and len(places) == len(value.times):
            gone.append(field.item)
            continue
        values[field] = (
            value.without_keys(set(places)) if len(places) < len(value.times) else _fixed(document, field, value)
        )
    text = f"Delete {keys_undo_text(count)}"
    with document.group(text):
        replace_fields(document, values, text)
        for item in gone:
            document.remove(*item, text)
    return bool(values or gone)


def set_keys(document: EditedProject, turning: bool = False) -> int:
    """Set a key at the playhead in all keyed fields of the selection, with the current value; return the number of
    keys.

    The unkeyed target, position, proportions or speed of a selected constraint, prop, character or clip becomes keyed;
    that of a character only if nothing else is selected, since characters are selected along with their constraints and
    clips. With ``turning``, heading and tilt of a selected volume or prop become keyed instead of its position.
    """
    selected = document.selection.items
    items = [item for item in selected if item[0] != "performers"] or [*selected]
    fields = selected_fields(document.shown_project, items)
    values: dict[KeyedField, Keys] = {
        field: value.with_key(time, allowed_value_at(field, value, time))
        for field, value in fields.items()
        if isinstance(value, Keys)
        for time in (time_at_playhead(document, field),)
    }
    keyed = {field.item for field in values}
    for field, value in _fixed_fields(document, items, turning).items():
        if field.item not in keyed or field.name in ROTATION_FIELDS:
            values[field] = value
    if values:
        replace_fields(document, values, "Set key" if len(values) == 1 else f"Set {len(values)} keys")
        document.keys.set(
            KeyRef(field, place)
            for field, value in values.items()
            for place in places_at(value, (time_at_playhead(document, field),))
        )
    return len(values)


def time_at_playhead(document: EditedProject, field: KeyedField) -> float:
    """Time of the playhead in seconds of the field's own time, rounded to a whole frame if that is the time of a
    motion.
    """
    seconds = from_stage(document.project, document.active_clip, field, document.playhead.time)
    clip = counted_in(document.project, document.active_clip, field)
    if clip is None:
        return seconds
    rate = document.project.frame_rate_of(clip)
    return round(seconds * rate) / rate


def _fixed(document: EditedProject, field: KeyedField, value: Keys) -> object:
    """Unkeyed value of a field, equal to its current value."""
    if isinstance(value, KeyedOwnPlace):
        return value.own_at(time_at_playhead(document, field))
    found = allowed_value_at(field, value, time_at_playhead(document, field))
    return Proportions(*found) if isinstance(found, tuple) and isinstance(value, KeyedProportions) else found


def _fixed_fields(document: EditedProject, items: Iterable[tuple[str, str]], turning: bool) -> dict[KeyedField, Keys]:
    """Unkeyed fields of selected items, with one key at the playhead: targets, centres, props, proportions; with
    ``turning``, rotations of volumes and props.
    """
    found: dict[KeyedField, Keys] = {}
    for collection, entity_id in items:
        if collection == "performers" and entity_id in document.project.performers:
            collection, entity_id = "characters", document.project.performers[entity_id].character_id
        entity: Any = document.shown_project.get(collection, entity_id)
        names = {
            "constraints": ("target", "centre", "place"), "props": ("position",), "characters": ("proportions",),
            "clips": ("speed",),
        }  # fmt: skip
        turned = turning and isinstance(entity, Prop | AreaConstraint) and not _is_half_space(entity)
        for name in ROTATION_FIELDS if turned else names.get(collection, ()):
            field = KeyedField(collection, entity_id, name)
            keys = _first_key(time_at_playhead(document, field), getattr(entity, name, None))
            if keys is not None:
                found[field] = keys
    return found


def _is_half_space(entity: Prop | AreaConstraint) -> bool:
    return isinstance(entity, AreaConstraint) and entity.shape is AreaShape.HALF_SPACE


def _first_key(time: float, value: Proportions | Place | Turn | float | None) -> Keys | None:
    """Keyed value with one key at ``time``; None if ``value`` follows an object or is missing."""
    match value:
        case Proportions():
            return KeyedProportions((time,), (value,))
        case OwnPlace():
            return value.keyed(time)
        case (_, _, _):
            return KeyedPlace((time,), (value,))
        case (_, _, _, _):
            return KeyedTurn((time,), (value,))
        case float():
            return KeyedNumber((time,), (value,))
    return None


def edit_selected(document: EditedProject, edit: Callable[[Keyed, int], Keyed], text: str) -> None:
    """Change every selected key by ``edit``, as one undo step."""
    values: dict[KeyedField, object] = {}
    for field, places in document.keys.by_field().items():
        value = keyed_value(document.shown_project, field)
        if value is not None:
            for place in places:
                value = edit(value, place)
            values[field] = value
    replace_fields(document, values, text)


def set_beyond(document: EditedProject, fields: Iterable[KeyedField], side: str, beyond: Beyond) -> None:
    """Set the extrapolation of curves before their first key or after their last one, as one undo step; ``side`` is
    ``before`` or ``after``.
    """
    values = {field: keyed_value(document.shown_project, field) for field in fields}
    changes: dict[str, object] = {side: beyond}
    keyed = {field: with_fields(value, **changes) for field, value in values.items() if isinstance(value, Keys)}
    replace_fields(document, keyed, f"Set {'pre' if side == 'before' else 'post'}-infinity to {beyond.value}")
