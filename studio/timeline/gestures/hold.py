"""Drags on the hold of a prop by a performer."""

from collections.abc import Callable

from PySide6.QtCore import QPointF

from studio.core.stage.prop import Prop
from studio.document.grips import retimed_grips
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import ItemPart, RowContext
from studio.timeline.time_words import time_text
from studio.timeline.tracks.hold import hold_under


class DragHold(EditGesture[Prop]):
    """Drag of the bar to move a hold in time, of an end to change the pick-up or put-down.

    The hand constraints that grip the prop are retimed too.
    """

    collection = "props"

    def __init__(self, shown: RowContext, entity_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        self._before = shown.project
        self._hold = hold_under(shown, self.original, press.x()) or self.original.holds[0]
        verb = {ItemPart.FIRST: "Pick up", ItemPart.LAST: "Put down"}.get(part, "Carry")
        self.text = f"{verb} {self.original.name} at another time"

    def show_all_edited(self, edit: Callable[[str, Prop], Prop]) -> None:
        """Apply the edit to every dragged prop, and to the hands that hold it."""
        document = self.shown.document
        with document.group(self.text, self._number):
            super().show_all_edited(edit)
            for prop_id, original in self.originals.items():
                for key, grip in retimed_grips(self._before, prop_id, edit(prop_id, original)).items():
                    if self.shown.project.get("constraints", key) is not None:
                        document.replace_shown("constraints", key, grip, self.text)

    def update(self, position: QPointF, free: bool) -> None:
        """Move the dragged ends, which stay in order; a hand-over is moved for both performers."""
        hold = self._hold
        first, last = (-1e9 if hold.begin is None else hold.begin), (1e9 if hold.end is None else hold.end)
        grabbed = hold.end if self.part == ItemPart.LAST or hold.begin is None else hold.begin
        if grabbed is None:
            grabbed = self.press_time
        caught = self.snap(grabbed + self.moved(position), free)
        way = caught.time - grabbed
        begin, end = hold.begin, hold.end
        if self.part != ItemPart.LAST and begin is not None:
            begin = min(begin + way, last) if self.part == ItemPart.FIRST else begin + way
        if self.part != ItemPart.FIRST and end is not None:
            end = max(end + way, first) if self.part == ItemPart.LAST else end + way
        self.show_edited(self.original.with_span(hold, begin, end))
        self.mark = DragHint(
            caught.time, time_text(caught.time * self.shown.axis.frame_rate, caught.time), caught.magnet
        )
