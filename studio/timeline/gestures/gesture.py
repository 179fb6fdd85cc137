"""Base classes of drags, from the press of a button to its release or to Esc."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar, cast

from PySide6.QtCore import QPointF, Qt

from studio.core.stage.clip import Clip
from studio.core.stage.project import Entity
from studio.timeline.shown import RowContext
from studio.timeline.snapping import Snapped, beat_times, magnets_of, snapped_time


@dataclass(frozen=True)
class DragHint:
    """Hint shown at the mouse during a drag: ``text`` for a stage time, and the ``magnet`` to which it snapped, if any.
    Times are in seconds.
    """

    time: float
    text: str
    magnet: float | None = None


class TimelineGesture:
    """Base of drags; this one edits nothing that can be undone."""

    mark: DragHint | None = None
    modifiers = Qt.KeyboardModifier.NoModifier
    """Modifier keys that are held during the drag."""

    def update(self, position: QPointF, free: bool) -> None:
        """Handle a mouse move to ``position``; ``free`` turns snapping off."""

    def finish(self) -> None:
        """Finish the drag after the button is released."""

    def cancel(self) -> None:
        """Restore the state before the drag, after Esc."""


EntityT = TypeVar("EntityT", bound=Entity | Clip)
"""Type of the dragged entity; clips are edited in the tracks of their performers."""


class EditGesture(TimelineGesture, Generic[EntityT]):
    """Base of drags that edit an entity and all selected ones of its collection, as one undo step.

    The edit is shown on every visible character during the drag.
    """

    collection = ""
    text = ""

    def __init__(self, shown: RowContext, entity_id: str, press: QPointF) -> None:
        self.shown, self.entity_id = shown, entity_id
        self.original: EntityT = shown.project.get(self.collection, entity_id)
        selected = shown.document.selection.of(self.collection)
        beside = [key for key in selected if shown.project.get(self.collection, key) is not None]
        ids = beside if entity_id in beside else [entity_id]
        self.originals: dict[str, EntityT] = {key: shown.project.get(self.collection, key) for key in ids}
        self.press_time = shown.axis.time_at(press.x())
        self._number = shown.document.new_gesture()
        self._magnets = self._find_magnets()
        shown.live.interactive = True

    @property
    def words(self) -> str:
        """Name of the dragged entities: ``Kick target``, or ``2 constraints``."""
        count = len(self.originals)
        return f"{count} {self.collection}" if count > 1 else str(getattr(self.original, "name", ""))

    def show_edited(self, entity: EntityT) -> None:
        """Show the grabbed entity as edited by the drag, and make the same edit on the others."""
        self.show_all_edited(lambda key, each: entity if key == self.entity_id else each)

    def show_all_edited(self, edit: Callable[[str, EntityT], EntityT]) -> None:
        """Apply ``edit`` (id, entity) to every dragged entity that still exists."""
        document = self.shown.document
        with document.group(self.text, self._number):
            for key, original in self.originals.items():
                if self.shown.project.get(self.collection, key) is not None:
                    document.replace_shown(self.collection, key, cast(Entity, edit(key, original)), self.text)

    def finish(self) -> None:
        """Finish the drag; the whole clip is solved again."""
        self.shown.live.interactive = False

    def cancel(self) -> None:
        """Restore all entities and drop the undo step."""
        self.show_all_edited(lambda _, original: original)
        self.finish()

    def moved(self, position: QPointF) -> float:
        """Displacement in seconds from the press to ``position``."""
        return self.shown.axis.time_at(position.x()) - self.press_time

    def snap(self, stage_time: float, free: bool) -> Snapped:
        """Stage time snapped to frames, the playhead and contacts, unless ``free``."""
        return snapped_time(self.shown.axis, stage_time, self._magnets, free)

    def _find_magnets(self) -> tuple[float, ...]:
        stage_time = self.shown.subject.stage_time
        contacts = self.shown.project.contacts_of(self.shown.subject.motion_id)
        edges = {key: (stage_time(each.first), stage_time(each.last)) for key, each in contacts.items()}
        beats = () if self.collection == "sounds" else beat_times(self.shown.project)
        return (*magnets_of(edges, self.shown.document.playhead.time, *self.originals), *beats)
