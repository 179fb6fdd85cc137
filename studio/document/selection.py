"""Selection of entities. It is not undoable, and never contains a missing entity."""

from PySide6.QtCore import QObject, Signal

Item = tuple[str, str]


class Selection(QObject):
    """Ordered set of selected (collection, id) pairs; the last one is the current one."""

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._items: tuple[Item, ...] = ()

    @property
    def items(self) -> tuple[Item, ...]:
        """All selected entities, in the order in which they were selected."""
        return self._items

    @property
    def current(self) -> Item | None:
        """The entity selected last, or None."""
        return self._items[-1] if self._items else None

    def set(self, *items: Item) -> None:
        """Replace the selection; emits ``changed`` only if it differs."""
        unique = tuple(dict.fromkeys((str(collection), str(entity_id)) for collection, entity_id in items))
        if unique != self._items:
            self._items = unique
            self.changed.emit()

    def clear(self) -> None:
        """Deselect everything."""
        self.set()

    def toggle(self, item: Item) -> None:
        """Add the item, or remove it if it is selected: Ctrl+click."""
        rest = tuple(other for other in self._items if other != item)
        self.set(*(rest if item in self._items else (*rest, item)))

    def of(self, collection: str) -> tuple[str, ...]:
        """Selected ids of one collection, in the order of selection."""
        return tuple(entity_id for name, entity_id in self._items if name == collection)

    def __contains__(self, item: object) -> bool:
        return item in self._items
