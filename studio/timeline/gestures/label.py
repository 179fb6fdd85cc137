"""Drags on labels."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.captures.annotations import Label
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import ItemPart, RowContext
from studio.timeline.time_words import time_text


class DragLabel(EditGesture[Label]):
    """Drag of a label to another frame of the motion, or of its first or last frame."""

    collection = "labels"

    def __init__(self, shown: RowContext, entity_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        self.text = f"{'Move' if part == ItemPart.BODY else 'Trim'} label {self.original.name}"

    def update(self, position: QPointF, free: bool) -> None:
        """Move by whole frames; ``free`` turns snapping to magnets off."""
        subject, old = self.shown.subject, self.original
        grabbed = old.last if self.part == ItemPart.LAST else old.first
        caught = self.snap(subject.stage_time(grabbed) + self.moved(position), free)
        label = self._dragged(round(subject.motion_frame(caught.time)))
        self.show_edited(label)
        frame = label.last if self.part == ItemPart.LAST else label.first
        self.mark = DragHint(subject.stage_time(frame), time_text(frame, frame / subject.frame_rate), caught.magnet)

    def _dragged(self, frame: int) -> Label:
        old: Label = self.original
        last_frame = max(self.shown.subject.last_frame, old.last)
        if self.part == ItemPart.FIRST:
            return replace(old, first=min(max(frame, 0), old.last))
        if self.part == ItemPart.LAST:
            return replace(old, last=max(min(frame, last_frame), old.first))
        first = max(min(frame, last_frame - (old.last - old.first)), 0)
        return replace(old, first=first, last=first + old.last - old.first)
