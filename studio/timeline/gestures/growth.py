"""Drags on the keys of a body that grows."""

from dataclasses import replace

from PySide6.QtCore import QPointF

from studio.timeline.figures import moment
from studio.timeline.gestures.gesture import EditGesture, Mark
from studio.timeline.shown import Shown
from studio.timeline.tracks.growth import nearest_key


class DragGrowthKey(EditGesture):
    """Drag a key to another time, between those beside it."""

    collection = "characters"

    def __init__(self, shown: Shown, performer_id: str, press: QPointF) -> None:
        super().__init__(shown, shown.project.performers[performer_id].character_id, press)
        self._place = nearest_key(shown, self.original.proportions, press.x())
        self.text = f"Move key of {self.original.name}"

    def update(self, position: QPointF, free: bool) -> None:
        """The time under the mouse, snapped."""
        keyed, rate = self.original.proportions, self.shown.axis.frame_rate
        caught = self.snap(keyed.times[self._place] + self.moved(position), free)
        moved = keyed.with_time(self._place, max(caught.time, 0.0))
        self.put(replace(self.original, proportions=moved))
        time = moved.times[self._place]
        self.mark = Mark(time, moment(time * rate, time), caught.caught)
