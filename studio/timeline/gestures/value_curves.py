"""Drags in the curve editor: of keys in time and value, of tangent handles, and of a selection box."""

from PySide6.QtCore import QPointF, QRect, QRectF, Qt

from studio.document.channels import key_values, with_handle, with_values
from studio.document.key_edits import KeyDrag, replace_fields
from studio.timeline.gestures.gesture import DragHint, TimelineGesture
from studio.timeline.shown import RowContext
from studio.timeline.snapping import key_magnets, snapped_time
from studio.timeline.time_words import time_text
from studio.timeline.tracks.value_curves import (
    HandleRef,
    ValueCurves,
    own_times,
    plot_area,
    stage_time,
    value_in,
)

DRAG_LOCK_PIXELS = 5.0
"""Pixels up to which a drag along one axis does not change the other axis' quantity, time or value."""
VALUE_SNAP_STEPS = {"m": 0.01, "cm": 1.0, "in": 0.5, "°": 5.0, "×": 0.01}
"""Steps to which values snap while Ctrl is held, by unit."""
FINE_KEY_DRAG = 0.1
Modifier = Qt.KeyboardModifier


class DragCurveKeys(TimelineGesture):
    """Drag of the selected keys in time, and of those in the grabbed channel also in value, as one undo step.

    Shift drags more finely, Ctrl snaps to round values.
    """

    def __init__(self, shown: RowContext, curves: ValueCurves, row: QRect, grabbed: HandleRef, press: QPointF) -> None:
        self.shown, self._curves, self._area = shown, curves, plot_area(row)
        self._grabbed, self._press = grabbed, press
        self._drag = KeyDrag(shown.document)
        channel = grabbed.channel
        keyed = self._drag.before[channel.field]
        self._time = stage_time(shown, channel.field, keyed.times[grabbed.place])
        self._values = key_values(channel, keyed)
        self._places = shown.document.keys.by_field()[channel.field]
        self._magnets = key_magnets(shown, False)
        self._is_moved = self._is_raised = False
        shown.live.interactive = True

    def update(self, position: QPointF, free: bool) -> None:
        """Move the grabbed key with the mouse."""
        way, channel = position - self._press, self._grabbed.channel
        self._is_moved |= abs(way.x()) >= DRAG_LOCK_PIXELS
        self._is_raised |= abs(way.y()) >= DRAG_LOCK_PIXELS
        caught = snapped_time(self.shown.axis, self._time + way.x() / self.shown.axis.scale, self._magnets, free)
        seconds = caught.time - self._time if self._is_moved else 0.0
        rise = self._curves.value_of(self.shown, self._area, channel, -way.y()) if self._is_raised else 0.0
        rise *= FINE_KEY_DRAG if self.modifiers & Modifier.ShiftModifier else 1.0
        old = float(self._values[self._grabbed.place])
        step = VALUE_SNAP_STEPS.get(channel.unit, 0.0)
        if self._is_raised and step and self.modifiers & Modifier.ControlModifier:
            rise = round((old + rise) / step) * step - old
        before = self._drag.before[channel.field]
        changed = with_values(channel, before, {place: float(self._values[place]) + rise for place in self._places})
        self._drag.move(seconds, {channel.field: changed})
        time = self._time + seconds
        value = key_values(channel, changed)[self._grabbed.place]
        text = f"{time_text(time * self.shown.axis.frame_rate, time)}  {channel.name} {value:.4g} {channel.unit}"
        self.mark = DragHint(time, text.strip(), caught.magnet if self._is_moved else None)

    def finish(self) -> None:
        """Finish the drag; the whole clip is solved again."""
        self.shown.live.interactive = False

    def cancel(self) -> None:
        """Restore the keys and drop the undo step."""
        self._drag.cancel()
        self.finish()


class DragTangent(TimelineGesture):
    """Drag of a tangent handle, which sets slope and weight of the tangent, as one undo step.

    The other tangent rotates with it unless the tangents are broken, or Alt breaks them. Shift drags more finely, Ctrl
    keeps the weight.
    """

    def __init__(self, shown: RowContext, curves: ValueCurves, row: QRect, handle: HandleRef, press: QPointF) -> None:
        self.shown, self._curves, self._area, self._handle, self._press = shown, curves, plot_area(row), handle, press
        before = value_in(shown, handle.channel)
        assert before is not None
        assert handle.side is not None
        self._before, self._side = before, handle.side
        begin = curves.handle_point(shown, self._area, handle, before)
        self._begin = begin if begin is not None else press
        self._key = curves.point(shown, self._area, handle.channel, before, handle.place)
        self._gesture = shown.document.new_gesture()
        shown.live.interactive = True

    def update(self, position: QPointF, free: bool) -> None:
        """Move the end of the handle with the mouse."""
        channel, shown = self._handle.channel, self.shown
        share = FINE_KEY_DRAG if self.modifiers & Modifier.ShiftModifier else 1.0
        way = self._begin + (position - self._press) * share - self._key
        begin = own_times(shown, channel.field, shown.axis.time_at(self._key.x()))
        end = own_times(shown, channel.field, shown.axis.time_at(self._key.x() + way.x()))
        seconds, value = float(end - begin), self._curves.value_of(shown, self._area, channel, -way.y())
        if self.modifiers & Modifier.ControlModifier and way.x():
            kept = self._begin.x() - self._key.x()
            seconds, value = seconds * kept / way.x(), value * kept / way.x()
        new = with_handle(channel, self._before, self._handle.place, self._side, seconds, value, free)
        replace_fields(shown.document, {channel.field: new}, "Move tangent", self._gesture)
        time = shown.axis.time_at(self._key.x())
        rate = value / seconds if seconds else 0.0
        self.mark = DragHint(time, f"{channel.name} {rate:.3g} {channel.unit}/s")

    def finish(self) -> None:
        """Finish the drag; the whole clip is solved again."""
        self.shown.live.interactive = False

    def cancel(self) -> None:
        """Restore the tangents and drop the undo step."""
        replace_fields(self.shown.document, {self._handle.channel.field: self._before}, "Move tangent", self._gesture)
        self.finish()


class BoxSelectCurves(TimelineGesture):
    """Drag of a box that selects keys in the curve editor; with ``add`` in addition to those selected before."""

    def __init__(self, shown: RowContext, curves: ValueCurves, row: QRect, press: QPointF, add: bool) -> None:
        self._shown, self._points = shown, list(curves.points(shown, plot_area(row)))
        self._press, self._before = press, shown.document.keys.items
        self._kept = self._before if add else frozenset()
        self.box = QRectF(press, press)

    def update(self, position: QPointF, free: bool) -> None:
        """Select all keys in the box."""
        self.box = QRectF(self._press, position).normalized()
        found = {handle.key for handle, point in self._points if self.box.contains(point)}
        self._shown.document.keys.set(found | self._kept)

    def cancel(self) -> None:
        """Restore the selection from before the drag."""
        self._shown.document.keys.set(self._before)
