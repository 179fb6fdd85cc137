"""Drags on the bar of a correction layer: one of the four times of its range, or all of it."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.stage.correction import Correction
from studio.timeline.gestures.activation import time_of, with_time
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import ItemPart, RowContext
from studio.timeline.time_words import time_text


class DragCorrectionRange(EditGesture[Correction]):
    """Drag of one of the four times of a correction's range."""

    collection = "corrections"

    def __init__(self, shown: RowContext, entity_id: str, part: ItemPart, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.part = part
        self.text = f"Move {part} of {self.words}"

    def update(self, position: QPointF, free: bool) -> None:
        """Set the time to the one under the mouse, snapped."""
        old = time_of(self.original.activation, self.part)
        caught = self.snap(old + self.moved(position), free)
        seconds = caught.time - old

        def moved(correction: Correction) -> Correction:
            curve = correction.activation
            return replace(correction, activation=with_time(curve, self.part, time_of(curve, self.part) + seconds))

        self.show_all_edited(lambda _, each: moved(each))
        words = time_text(caught.time * self.shown.axis.frame_rate, caught.time)
        self.mark = DragHint(caught.time, f"{self.part}  {words}", caught.magnet)


class MoveCorrection(EditGesture[Correction]):
    """Drag of a correction's bar: its range and keys move together; ``free`` leaves the keys in place."""

    collection = "corrections"

    def __init__(self, shown: RowContext, entity_id: str, press: QPointF) -> None:
        super().__init__(shown, entity_id, press)
        self.text = f"Move {self.words}"

    def update(self, position: QPointF, free: bool) -> None:
        """Move all times by the displacement of the mouse."""
        start = self.original.activation.start
        caught = self.snap(start + self.moved(position), free)
        seconds = caught.time - start

        def moved(correction: Correction) -> Correction:
            later = correction.moved(seconds)
            return replace(later, keys=correction.keys) if free else later

        self.show_all_edited(lambda _, each: moved(each))
        words = time_text(caught.time * self.shown.axis.frame_rate, caught.time)
        self.mark = DragHint(caught.time, f"{seconds:+.3f} s  starts {words}", caught.magnet)
