"""Drags on keys: move or scale the selected ones, or select keys in a box."""

from PySide6.QtCore import QPointF, QRectF

from studio.document.key_edits import KeyDrag
from studio.document.keyed_fields import KeyRef
from studio.timeline.gestures.gesture import DragHint, TimelineGesture
from studio.timeline.sheet import TimelineLayout
from studio.timeline.shown import RowContext
from studio.timeline.snapping import key_magnets, snapped_time
from studio.timeline.time_words import time_text
from studio.timeline.tracks.brush import KEY_REACH
from studio.timeline.tracks.keys import fields_in, key_height, keys_between, stage_times


class DragKeys(TimelineGesture):
    """Drag of the selected keys in time, as one undo step; with ``scaling`` they are scaled about the playhead."""

    def __init__(self, shown: RowContext, grabbed: KeyRef, press: QPointF, scaling: bool) -> None:
        self.shown, self.scaling = shown, scaling
        self._drag = KeyDrag(shown.document)
        self._grabbed = float(stage_times(shown, grabbed.field)[grabbed.place])
        self._press_time = shown.axis.time_at(press.x())
        self._magnets = key_magnets(shown, scaling)
        shown.live.interactive = True

    def update(self, position: QPointF, free: bool) -> None:
        """Move the grabbed key with the mouse; ``free`` turns off snapping."""
        axis, here = self.shown.axis, self.shown.document.playhead.time
        wanted = self._grabbed + axis.time_at(position.x()) - self._press_time
        caught = snapped_time(axis, wanted, self._magnets, free)
        words = time_text(caught.time * axis.frame_rate, caught.time)
        if not self.scaling:
            self._drag.move(caught.time - self._grabbed)
            frames = (caught.time - self._grabbed) * axis.frame_rate
            self.mark = DragHint(caught.time, f"{words}  {frames:+.4g} frames", caught.magnet)
        elif abs(self._grabbed - here) * axis.frame_rate > 1e-3:
            factor = (caught.time - here) / (self._grabbed - here)
            self._drag.scale(factor, here)
            self.mark = DragHint(caught.time, f"{words}  × {max(factor, 0.01):.3g}", caught.magnet)

    def finish(self) -> None:
        """Finish the drag; the whole clip is solved again."""
        self.shown.live.interactive = False

    def cancel(self) -> None:
        """Restore the keys and drop the undo step."""
        self._drag.cancel()
        self.finish()


class BoxSelect(TimelineGesture):
    """Drag of a box that selects keys; with ``add`` in addition to those selected before."""

    def __init__(self, sheet: TimelineLayout, press: QPointF, add: bool) -> None:
        self._sheet, self._press = sheet, press
        self._before = sheet.context.document.keys.items
        self._kept = self._before if add else frozenset()
        self._items = sheet.context.document.selection.items if add else ()
        self.box = QRectF(press, press)

    def update(self, position: QPointF, free: bool) -> None:
        """Select all keys in the tracks and the time range of the box."""
        sheet, shown = self._sheet, self._sheet.context
        self.box = QRectF(self._press, position).normalized()
        reach = self.box.adjusted(-KEY_REACH, -KEY_REACH, KEY_REACH, KEY_REACH)
        begin, end = shown.axis.time_at(self.box.left()), shown.axis.time_at(self.box.right())
        found: set[KeyRef] = set()
        for row in sheet.rows:
            if reach.top() <= key_height(row, sheet.rect(row)) <= reach.bottom():
                found.update(keys_between(shown, fields_in(shown, row), begin, end))
        if not shown.shows_dope_sheet:
            owners = dict.fromkeys(key.field.item for key in sorted(found) if key.field.collection != "characters")
            bodies = (
                row.id
                for row in sheet.rows
                if row.kind == "growth" and found.intersection(keys_between(shown, fields_in(shown, row), begin, end))
            )
            shown.document.selection.set(*self._items, *owners, *(("performers", key) for key in bodies))
        shown.document.keys.set(found | self._kept)

    def cancel(self) -> None:
        """Restore the selection from before the drag."""
        self._sheet.context.document.keys.set(self._before)
