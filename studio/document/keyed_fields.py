"""Keyed fields: all values of a project that have keys over time."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import Keys
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project

FloatArray = NDArray[np.float64]
Keyed = Keys | ActivationCurve
"""Value with keys; an activation counts as four keys."""

KEYED_COLLECTIONS = ("constraints", "props", "characters", "corrections", "clips")


class KeyedField(NamedTuple):
    """Reference to a field of an entity that has keys."""

    collection: str
    entity_id: str
    name: str

    @property
    def item(self) -> tuple[str, str]:
        """Collection and id of the entity."""
        return self.collection, self.entity_id


class KeyRef(NamedTuple):
    """Reference to one key of a field, by its index in order of time."""

    field: KeyedField
    place: int


def fields_of(collection: str, entity_id: str, entity: object) -> dict[KeyedField, Keyed]:
    """Keyed fields of one entity, with their values."""
    if entity is None or collection not in KEYED_COLLECTIONS:
        return {}
    values = vars(entity).items()
    return {KeyedField(collection, entity_id, name): value for name, value in values if isinstance(value, Keyed)}


def keyed_value(project: Project, field: KeyedField) -> Keyed | None:
    """Keyed value of a field; None if the field has no keys."""
    value = getattr(project.get(*field.item), field.name, None)
    return value if isinstance(value, Keyed) else None


def owners_of(project: Project, collection: str, entity_id: str) -> tuple[tuple[str, str], ...]:
    """Selectable items that own the keys of an entity; for a character these include the performers that use it."""
    bodies = (
        ("performers", key)
        for key, each in project.performers.items()
        if (collection, each.character_id) == ("characters", entity_id)
    )
    return ((collection, entity_id), *bodies)


def selected_fields(project: Project, items: Iterable[tuple[str, str]]) -> dict[KeyedField, Keyed]:
    """Keyed fields of the selected entities, with their values; for a performer those of its character."""
    entities = dict.fromkeys(
        ("characters", project.performers[key].character_id)
        if collection == "performers" and key in project.performers
        else (collection, key)
        for collection, key in items
    )
    return {
        field: value
        for collection, key in entities
        for field, value in fields_of(collection, key, project.get(collection, key)).items()
    }


def to_stage(project: Project, clip: Clip | None, field: KeyedField, seconds: float) -> float:
    """Stage time in seconds of a key at ``seconds`` of its field's own time."""
    return float(all_to_stage(project, clip, field, seconds))


def from_stage(project: Project, clip: Clip | None, field: KeyedField, seconds: float) -> float:
    """Time in seconds of the field's own time at the stage time ``seconds``."""
    return float(all_from_stage(project, clip, field, seconds))


def all_to_stage(project: Project, clip: Clip | None, field: KeyedField, seconds: ArrayLike) -> FloatArray:
    """Stage times in seconds of keys, of the same shape as their own times ``seconds``.

    Keys of constraints count in the time of the motion that ``clip`` plays, keys of a clip's speed in that of the
    clip's motion, all others in stage time.
    """
    counted = counted_in(project, clip, field)
    return np.asarray(seconds) if counted is None else counted.stage_seconds(seconds, project.frame_rate_of(counted))


def all_from_stage(project: Project, clip: Clip | None, field: KeyedField, seconds: ArrayLike) -> FloatArray:
    """Times in seconds of the field's own time at the stage times ``seconds``, of the same shape."""
    counted = counted_in(project, clip, field)
    return np.asarray(seconds) if counted is None else counted.motion_seconds(seconds, project.frame_rate_of(counted))


def counted_in(project: Project, clip: Clip | None, field: KeyedField) -> Clip | None:
    """Clip in whose motion's time the keys of a field count; None for stage time."""
    if field.collection == "clips" and (clip is None or clip.id != field.entity_id):
        return project.clips.get(field.entity_id)
    return clip if field.collection in ("constraints", "clips") else None


def with_times(keyed: Keyed, times: Mapping[int, float], speed: float = 1.0) -> Keyed:
    """Copy with other times for the keys at some indices; those of an activation push its other times along."""
    if isinstance(keyed, Keys):
        return keyed.with_times(times, speed)
    order = dict(zip(sorted(times), sorted(times.values()), strict=True))
    return keyed.with_times(
        *(
            order.get(
                index,
                max(
                    min(time, *(order[other] for other in order if other > index), 1e9),
                    *(order[other] for other in order if other < index),
                    -1e9,
                ),
            )
            for index, time in enumerate(keyed.times)
        )
    )


def places_at(keyed: Keyed, times: Iterable[float]) -> tuple[int, ...]:
    """Indices of the keys at these times."""
    if isinstance(keyed, Keys):
        found = (keyed.key_at(time) for time in times)
        return tuple(place for place in found if place is not None)
    return tuple(dict.fromkeys(keyed.times.index(time) for time in times if time in keyed.times))
