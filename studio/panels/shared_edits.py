"""Transfer of an edit of one selected entity to the other selected ones."""

from collections.abc import Iterable
from dataclasses import fields, is_dataclass

from studio.core.changed_records import RecordT, with_fields
from studio.core.stage.project import Entity
from studio.document.commands.replace import same_value

INDIVIDUAL_FIELDS = frozenset(
    {"name", "motion_id", "priority", "character_id", "clips", "layers", "position", "heading", "holds"}
)
"""Fields that are not transferred to the other entities."""
_WORDS = {
    "enabled": "on or off",
    "scope": "applies to",
    "end_segment": "end",
    "turn": "rotation",
    "ease": "blend",
    "grip": "hands",
    "repeats": "loop count",
    "clears": "arm self-collision",
    "limited": "joint limits",
    "eased": "smoothing",
}


def with_edit(other: RecordT, before: object, after: object) -> RecordT:
    """``other`` with the values in which ``after`` differs from ``before``."""
    names = [each.name for each in fields(other) if each.name not in INDIVIDUAL_FIELDS]
    edits = {
        name: _edited(getattr(other, name), getattr(before, name), getattr(after, name))
        for name in names
        if hasattr(before, name)
        and hasattr(after, name)
        and not same_value(getattr(before, name), getattr(after, name))
    }
    return with_fields(other, **edits)


def _edited(other: object, before: object, after: object) -> object:
    """``other`` with the edited parts of ``after``; all of ``after`` if the types differ."""
    if type(other) is type(before) is type(after):
        if isinstance(other, tuple) and isinstance(before, tuple) and isinstance(after, tuple):
            if len(other) == len(before) == len(after):
                parts = zip(other, before, after, strict=True)
                return tuple(one if same_value(old, new) else _edited(one, old, new) for one, old, new in parts)
        elif is_dataclass(other) and not isinstance(other, type):
            try:
                return with_edit(other, before, after)
            except ValueError:
                return after
    return after


def different_fields(entities: Iterable[Entity]) -> list[str]:
    """Labels of the fields in which ``entities`` differ."""
    first, *others = entities
    return [
        _WORDS.get(each.name, each.name.replace("_", " "))
        for each in fields(first)
        if each.name not in INDIVIDUAL_FIELDS
        and any(
            not hasattr(other, each.name) or not same_value(getattr(first, each.name), getattr(other, each.name))
            for other in others
        )
    ]
