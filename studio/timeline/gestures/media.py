"""Drags of sound tracks and footage in time."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.core.stage.footage import Footage
from studio.core.stage.sound_track import SoundTrack
from studio.timeline.gestures.gesture import DragHint, EditGesture
from studio.timeline.shown import RowContext
from studio.timeline.time_words import time_text


class MoveMedia(EditGesture[SoundTrack | Footage]):
    """Drag of a sound track or footage to another start time."""

    def __init__(self, shown: RowContext, collection: str, entity_id: str, press: QPointF) -> None:
        self.collection = collection
        super().__init__(shown, entity_id, press)
        self.text = f"Move {self.original.name}"

    def update(self, position: QPointF, free: bool) -> None:
        """Set the start time, snapped to frames, contacts and the playhead."""
        caught = self.snap(self.original.start + self.moved(position), free)
        self.show_edited(replace(self.original, start=caught.time))
        self.mark = DragHint(
            caught.time, time_text(caught.time * self.shown.axis.frame_rate, caught.time), caught.magnet
        )
