"""Selection of keys. It is not undoable, and never contains a missing key."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from studio.core.stage.project import Project
from studio.document.keyed_fields import KeyedField, KeyRef, keyed_value, owners_of, places_at

if TYPE_CHECKING:
    from studio.document.edited_project import EditedProject


class KeySelection(QObject):
    """Set of selected keys, all of selected entities.

    Keys that are moved stay selected by their index; if keys are added or deleted, the others stay selected by their
    time. Undo and redo select those keys of changed fields that were selected in the restored state.
    """

    changed = Signal()

    def __init__(self, document: "EditedProject") -> None:
        super().__init__(document)
        self._document = document
        self._items: frozenset[KeyRef] = frozenset()
        self._by_field: dict[KeyedField, tuple[int, ...]] = {}
        self._times: dict[KeyedField, tuple[float, ...]] = {}
        document.entity_changed.connect(self._follow)
        document.project_opened.connect(self.clear)
        document.selection.changed.connect(self._drop_unselected)

    @property
    def items(self) -> frozenset[KeyRef]:
        """All selected keys."""
        return self._items

    def __contains__(self, key: object) -> bool:
        return key in self._items

    def by_field(self) -> Mapping[KeyedField, tuple[int, ...]]:
        """Indices of the selected keys of each field, in order."""
        return self._by_field

    def set(self, keys: Iterable[KeyRef]) -> None:
        """Select exactly these keys."""
        items = frozenset(keys)
        if items == self._items:
            return
        project = self._document.project
        self._times = {
            field: value.times
            for field in {key.field for key in items}
            if (value := keyed_value(project, field)) is not None
        }
        items = frozenset(key for key in items if key.place < len(self._times.get(key.field, ())))
        if items != self._items:
            found: dict[KeyedField, list[int]] = {}
            for field, place in sorted(items):
                found.setdefault(field, []).append(place)
            self._by_field = {field: tuple(places) for field, places in found.items()}
            self._items = items
            self.changed.emit()

    def clear(self) -> None:
        """Select no key."""
        self.set(())

    def toggle(self, keys: Iterable[KeyRef]) -> None:
        """Add the keys, or remove them if all of them are selected: Ctrl+click."""
        keys = frozenset(keys)
        self.set(self._items - keys if keys <= self._items else self._items | keys)

    def restore(self, keys: Iterable[KeyRef], before: Project) -> None:
        """Select ``keys`` again in those of their fields whose key times differ from the project ``before``."""
        selected, project = {*self._document.selection.items}, self._document.project
        fields = {
            field
            for field in {key.field for key in keys}
            if _times(before, field) != _times(project, field)
            and (not selected or not selected.isdisjoint(owners_of(project, *field.item)))
        }
        if fields:
            others = (key for key in self._items if key.field not in fields)
            self.set((*others, *(key for key in keys if key.field in fields)))

    def _follow(self, collection: str, entity_id: str) -> None:
        """Update the selected keys of a changed entity; an empty id stands for many. Clips also change with their
        performers.
        """
        changed = {
            field: keyed_value(self._document.project, field)
            for field in self._times
            if (field.collection, collection) == ("clips", "performers")
            or (field.collection == collection and entity_id in ("", field.entity_id))
        }
        moved = {
            field: value.times
            for field, value in changed.items()
            if value is not None and len(value.times) == len(self._times[field])
        }
        if len(moved) == len(changed):
            self._times |= moved
            return
        kept: list[KeyRef] = []
        for field, places in self.by_field().items():
            value, before = keyed_value(self._document.project, field), self._times[field]
            if value is None:
                continue
            if len(value.times) != len(before):
                places = places_at(value, (before[place] for place in places))
            kept += [KeyRef(field, place) for place in places]
        self.set(kept)

    def _drop_unselected(self) -> None:
        selected = set(self._document.selection.items)
        project = self._document.project
        kept = {field for field in self._times if selected.intersection(owners_of(project, *field.item))}
        self.set(key for key in self._items if key.field in kept)


def _times(project: Project, field: KeyedField) -> tuple[float, ...]:
    value = keyed_value(project, field)
    return () if value is None else value.times
