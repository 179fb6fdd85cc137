"""Gesture: one drag, from the button's press to its release or to Esc."""

from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QPointF

from studio.core.project import Entity
from studio.timeline.shown import Shown
from studio.timeline.snapping import Snapped, magnets_of, snapped


@dataclass(frozen=True)
class Mark:
    """What a drag says beside the mouse: a sentence at a stage time, and the moment it has caught on."""

    time: float
    text: str
    caught: float | None = None


class Gesture:
    """A drag that changes nothing that could be undone."""

    mark: Mark | None = None

    def update(self, position: QPointF, free: bool) -> None:
        """The mouse stands at ``position``; ``free`` asks for no snapping."""

    def finish(self) -> None:
        """The button was let go."""

    def cancel(self) -> None:
        """Esc: everything as before."""


class EditGesture(Gesture):
    """A drag that edits one entity: a single undo step, while every visible character follows."""

    collection = ""
    text = ""

    def __init__(self, shown: Shown, entity_id: str, press: QPointF) -> None:
        self.shown, self.entity_id = shown, entity_id
        self.original: Any = shown.project.get(self.collection, entity_id)
        self.press_time = shown.axis.time_at(press.x())
        self._number = shown.document.new_gesture()
        self._magnets = self._find_magnets()
        shown.live.interactive = True

    def put(self, entity: Entity) -> None:
        """Show the entity as the drag makes it; nothing when it has been removed meanwhile."""
        if self.shown.project.get(self.collection, self.entity_id) is not None:
            self.shown.document.replace(self.collection, self.entity_id, entity, self.text, self._number)

    def finish(self) -> None:
        """Let the whole clip be solved."""
        self.shown.live.interactive = False

    def cancel(self) -> None:
        """Put the entity back; the step vanishes."""
        self.put(self.original)
        self.finish()

    def moved(self, position: QPointF) -> float:
        """Seconds from the press to ``position``."""
        return self.shown.axis.time_at(position.x()) - self.press_time

    def snap(self, stage_time: float, free: bool) -> Snapped:
        """The stage time as it catches on frames, the playhead and contacts."""
        return snapped(self.shown.axis, stage_time, self._magnets, free)

    def _find_magnets(self) -> tuple[float, ...]:
        stage_time = self.shown.subject.stage_time
        contacts = self.shown.project.contacts_of(self.shown.subject.motion_id)
        edges = {key: (stage_time(each.first), stage_time(each.last)) for key, each in contacts.items()}
        return magnets_of(edges, self.shown.document.playhead.time, self.entity_id)
