"""Interaction with the tracks by mouse, wheel, context menu and keyboard."""

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QEvent, QPoint, QPointF, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QDragEnterEvent,
    QDragMoveEvent,
    QDropEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QToolTip, QWidget

from studio.core.captures.contacts import contact_point
from studio.document.document import Document
from studio.document.dragging import STRIKE_MIME, capture_in, row_in
from studio.engine.live_interface import Live
from studio.timeline import edits
from studio.timeline.clip_actions import add_clip, try_edit
from studio.timeline.gestures.begin import cursor_at, gesture_at, items_of
from studio.timeline.gestures.gesture import TimelineGesture
from studio.timeline.gestures.keys import BoxSelect, DragKeys
from studio.timeline.gestures.value_curves import BoxSelectCurves, DragCurveKeys, DragTangent
from studio.timeline.gestures.view import Pan, Scrub
from studio.timeline.hover import hover_text, shows_value
from studio.timeline.keyboard import handles_key, press_key
from studio.timeline.menus import menu_at
from studio.timeline.name_field import NameField
from studio.timeline.shown import ROW_LABEL_WIDTH, Hit, ItemPart
from studio.timeline.snapping import snapped_time
from studio.timeline.time_words import time_text
from studio.timeline.track_view import TrackView
from studio.timeline.tracks.labels import flags
from studio.timeline.tracks.value_curves import HandleRef, plot_area

TRACK_DRAG_START_PIXELS = 3
ZOOM_PER_DEGREE = 1.0125
SCROLL_PER_DEGREE = 3.2
Modifier = Qt.KeyboardModifier


class TrackCanvas(TrackView):
    """Interactive tracks; ``message_posted`` is emitted with a text about the part under the mouse."""

    message_posted = Signal(str)
    strike_dropped = Signal(int, str, float)
    """Emitted with the index of a dropped strike in its list, the performer's id, and the stage time in seconds."""

    def __init__(self, document: Document, live: Live, parent: QWidget | None = None) -> None:
        super().__init__(document, live, parent)
        self._pending: tuple[Hit, QPointF] | None = None
        self._grip: HandleRef | None = None
        self._hovered = ""
        document.entity_changed.connect(self._hover_again)
        document.project_opened.connect(self._hover_again)
        live.reported_changed.connect(self._hover_again)
        self.axis.changed.connect(self._hover_again)
        self.scroll_bar.valueChanged.connect(self._hover_again)
        self.setMouseTracking(True)
        self.setAcceptDrops(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def leave(self) -> None:
        """End a drag, and disconnect from the document."""
        if self.gesture is not None:
            self.gesture.cancel()
            self.gesture = None
        self.document.entity_changed.disconnect(self._hover_again)
        self.document.project_opened.disconnect(self._hover_again)
        self.live.reported_changed.disconnect(self._hover_again)
        super().leave()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Select, and start a drag of, the part under the mouse."""
        if self.sheet is None or self.gesture is not None:
            return
        self.mouse = event.position()
        if event.button() == Qt.MouseButton.MiddleButton:
            over_curves = self.sheet.hit(event.position()).kind == "curves"
            height = plot_area(self.sheet.plot).height()
            scroll = partial(self._scroll_curves, height) if over_curves else self._scroll_rows
            self.gesture = Pan(self.axis, scroll, event.position())
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
        elif event.button() == Qt.MouseButton.LeftButton:
            hit = self.hit(event.position())
            if hit.part == ItemPart.FOLD:
                self.fold(hit.kind, hit.id)
                return
            add = bool(event.modifiers() & Modifier.ControlModifier)
            if hit.kind == "curves":
                self._press_curves(event.position(), add)
            elif hit.keys:
                self.select_keys(hit, add)
            else:
                self.document.keys.clear()
                self._select(hit, add)
            if hit.part == ItemPart.TIME:
                self.gesture = gesture_at(hit, self.sheet.context, event.position())
                self._drag(event)
            elif hit.kind == "plot":
                self._show_menu(event.position(), event.globalPosition().toPoint())
            else:
                self._pending = (hit, event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the drag, or describe the part under the mouse."""
        if self.sheet is None:
            return
        self.mouse = event.position()
        if self._pending is not None:
            hit, press = self._pending
            if (event.position() - press).manhattanLength() >= TRACK_DRAG_START_PIXELS:
                self._pending = None
                self.gesture = self._gesture_at(hit, press, event.modifiers())
                if hit.part == ItemPart.BODY:
                    self.setCursor(Qt.CursorShape.ClosedHandCursor)
        if self.gesture is not None:
            self._drag(event)
        elif not event.buttons():
            self._hover(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Finish the drag once no button is pressed."""
        if event.buttons():
            return
        pending, self._pending = self._pending, None
        if self.gesture is not None:
            self.finish_gesture()
        elif pending is not None and event.modifiers() & Modifier.ControlModifier:
            return
        elif pending is not None and pending[0].keys:
            self.document.keys.set(pending[0].keys)
        elif pending is not None and items_of(pending[0]):
            self.document.selection.set(*items_of(pending[0]))  # a click, not a drag

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Add a contact or label in empty space, or rename a label."""
        hit = self.hit(event.position()) if self.sheet else None
        if self.sheet and hit and hit.kind == "lane" and hit.part == ItemPart.EMPTY:
            frame = round(self.sheet.context.frame_at(event.position().x()))
            edits.add_contact(self.sheet.context, contact_point(hit.id), frame)
        elif self.sheet and hit and hit.kind == "labels" and hit.id:
            self._pending = None
            self.rename_label(hit.id)
        elif self.sheet and hit and hit.kind == "labels" and hit.part == ItemPart.EMPTY:
            edits.add_label(self.sheet.context, round(self.sheet.context.frame_at(event.position().x())))
        else:
            self.mousePressEvent(event)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show the context menu of the part under the mouse."""
        if self.gesture is None:
            self._show_menu(QPointF(event.pos()), event.globalPos())

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse with Ctrl, scroll in time with Shift, else scroll the tracks."""
        step = event.angleDelta() / 8
        degrees = step.y() or step.x()
        if event.modifiers() & Modifier.ControlModifier:
            self.axis.zoom(ZOOM_PER_DEGREE**degrees, max(event.position().x(), ROW_LABEL_WIDTH))
        elif event.modifiers() & Modifier.ShiftModifier or not step.y():
            self.axis.scroll(-degrees * SCROLL_PER_DEGREE)
        elif self.editing and self.sheet is not None and self.sheet.plot.contains(event.position().toPoint()):
            area = plot_area(self.sheet.plot)
            self.picture.curves.zoom(ZOOM_PER_DEGREE**degrees, (area.bottom() - event.position().y()) / area.height())
            self._redraw_all()
        else:
            self.scroll_bar.setValue(round(self.scroll_bar.value() - degrees * SCROLL_PER_DEGREE))
        event.accept()

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept dragged captures and strikes; files are left to the window."""
        event.setAccepted(self._dropped(event) is not None or row_in(STRIKE_MIME, event.mimeData()) is not None)

    def dragMoveEvent(self, event: QDragMoveEvent) -> None:
        """Accept captures everywhere and strikes over clip tracks, and show the start time of the new clip."""
        motion_id, strike = self._dropped(event), row_in(STRIKE_MIME, event.mimeData()) is not None
        event.setAccepted(self._clip_row(event) is not None if strike else motion_id is not None)
        if event.isAccepted() and self.sheet is not None:
            time = self._dropped_at(event)
            name = "Strike" if motion_id is None else self.document.project.motions[motion_id].name
            self.message_posted.emit(f"{name} from {time_text(time * self.axis.frame_rate, time)}")

    def dropEvent(self, event: QDropEvent) -> None:
        """Add the dropped motion to the track under the mouse, from that time on; outside of tracks, at the end of the
        active one.
        """
        motion_id, strike, row = self._dropped(event), row_in(STRIKE_MIME, event.mimeData()), self._clip_row(event)
        event.setAccepted(motion_id is not None or (strike is not None and row is not None))
        self.message_posted.emit("")
        if strike is not None and row is not None:
            self.strike_dropped.emit(strike, row, self._dropped_at(event))
        if motion_id is None or self.sheet is None:
            return
        shown = self.sheet.context
        if row is not None:
            add = partial(add_clip, shown, row, motion_id, self._dropped_at(event))
        else:
            add = partial(add_clip, shown, shown.subject.performer_id, motion_id, None)
        try_edit(shown, add)

    def _clip_row(self, event: QDropEvent) -> str | None:
        """Id of the performer whose clip track is under the mouse; None if there is none."""
        if self.sheet is None or event.position().x() < ROW_LABEL_WIDTH:
            return None
        row = self.sheet.row_at(event.position().toPoint())
        return row.id if row is not None and row.kind == "clip" else None

    def _dropped_at(self, event: QDropEvent) -> float:
        """Stage time in seconds under the mouse, snapped to frames and the playhead."""
        time = self.axis.time_at(event.position().x())
        return snapped_time(self.axis, time, (self.document.playhead.time,)).time

    def _dropped(self, event: QDropEvent) -> str | None:
        """Id of a motion of the dragged capture; None if nothing usable is dragged."""
        capture_id = capture_in(event.mimeData())
        motions = self.document.project.motions.items()
        return next((key for key, motion in motions if motion.capture_id == capture_id), None)

    def _select(self, hit: Hit, add: bool) -> None:
        items, selection = items_of(hit), self.document.selection
        if not items:
            if hit.part == ItemPart.EMPTY and hit.kind != "ruler":
                selection.clear()
        elif add and items[-1] in selection:
            selection.toggle(items[-1])
        elif add or (items[-1] in selection and len(selection.of(items[-1][0])) > 1):  # one of several drags all
            selection.set(*(item for item in selection.items if item not in items), *items)
        else:
            selection.set(*items)

    def hit(self, position: QPointF) -> Hit:
        """Part under the mouse; keys and handles of the curve editor come before the line of the playhead."""
        sheet = self.sheet
        assert sheet is not None
        under: Hit = sheet.part_under_playhead(position)
        if under.kind == "curves" and self.picture.curves.hit(sheet.context, plot_area(sheet.plot), position):
            return under
        return sheet.hit(position)

    def _press_curves(self, position: QPointF, add: bool) -> None:
        """Start a drag of a handle or key in the curve editor, or of a selection box."""
        curves, keys = self.picture.curves, self.document.keys
        assert self.sheet is not None
        grip = self._grip = curves.hit(self.sheet.context, plot_area(self.sheet.plot), position)
        if grip is None:
            if not add:
                keys.clear()
            return
        curves.active = grip.channel
        if grip.side is None and add:
            keys.toggle([grip.key])
        elif grip.side is None and grip.key not in keys:
            keys.set([grip.key])
        self._redraw_all()

    def select_keys(self, hit: Hit, add: bool) -> None:
        """Select the keys of a diamond, with ``add`` in addition to others; pressing a selected key keeps the
        selection.
        """
        keys, items = self.document.keys, items_of(hit)
        if not set(items) <= set(self.document.selection.items):
            self.document.selection.set(*(self.document.selection.items if add else ()), *items)
        if add:
            keys.toggle(hit.keys)
        elif not keys.items.issuperset(hit.keys):
            keys.set(hit.keys)

    def _gesture_at(self, hit: Hit, press: QPointF, modifiers: Modifier) -> TimelineGesture | None:
        """Drag that a press on ``hit`` starts: of keys, an entity, or a selection box. None if it starts none."""
        if self.sheet is None:
            return None
        shown, add = self.sheet.context, bool(modifiers & Modifier.ControlModifier)
        if hit.kind == "curves":
            curves, plot = self.picture.curves, self.sheet.plot
            if self._grip is None:
                return BoxSelectCurves(shown, curves, plot, press, add)
            if self._grip.side is not None:
                return DragTangent(shown, curves, plot, self._grip, press)
            return (
                DragCurveKeys(shown, curves, plot, self._grip, press) if self._grip.key in self.document.keys else None
            )
        if hit.keys and self.document.keys.items.issuperset(hit.keys):
            return DragKeys(shown, hit.keys[0], press, bool(modifiers & Modifier.ShiftModifier))
        if (
            hit.part == ItemPart.EMPTY
            and press.x() >= ROW_LABEL_WIDTH
            and self.sheet.viewport.contains(press.toPoint())
        ):
            return BoxSelect(self.sheet, press, add)
        return gesture_at(hit, shown, press, bool(modifiers & Modifier.ShiftModifier))

    def _scroll_rows(self, pixels: float) -> None:
        self.scroll_bar.setValue(round(self.scroll_bar.value() + pixels))

    def _scroll_curves(self, height: int, pixels: float) -> None:
        self.picture.curves.scroll(-pixels / height)
        self._redraw_all()

    def _drag(self, event: QMouseEvent) -> None:
        if self.gesture is None:
            return
        self.gesture.modifiers = event.modifiers()
        self.gesture.update(event.position(), bool(event.modifiers() & Modifier.AltModifier))
        if self.gesture.mark is not None:
            self.message_posted.emit(self.gesture.mark.text)
        if not isinstance(self.gesture, Scrub):
            self.update()

    def finish_gesture(self) -> None:
        """Finish the current drag, if any, and keep its edit."""
        if self.gesture is not None:
            self.gesture.finish()
            self.end_gesture()

    def end_gesture(self) -> None:
        """Clean up after a drag that was finished or cancelled."""
        self.gesture = None
        self.message_posted.emit("")
        self._set_cursor(self.mouse)
        self.lay_out()

    def _set_cursor(self, position: QPointF) -> None:
        if self.sheet is not None:
            self.setCursor(cursor_at(self.hit(position)))

    def _hover(self, event: QMouseEvent) -> None:
        if self.sheet is None:
            return
        self._set_cursor(event.position())
        text = self._hovered = hover_text(self.sheet, self.picture.plot, event.position())
        self.message_posted.emit(text)
        if text and shows_value(self.sheet, event.position()):
            self._show_tooltip(event.position().toPoint(), text)
        elif QToolTip.isVisible():
            QToolTip.hideText()

    def _show_tooltip(self, point: QPoint, text: str) -> None:
        """Show a tooltip below the track at ``point``, or beside the mouse outside of tracks."""
        row = self.sheet.row_at(point) if self.sheet else None
        place = point + QPoint(4, -2)
        if self.sheet is not None and row is not None:
            place.setY(self.sheet.rect(row).bottom())
        QToolTip.showText(self.mapToGlobal(place), text, self)

    def _hover_again(self) -> None:
        """Update highlight and tooltip, because the part under the mouse may have changed."""
        if not self._hovered or self.gesture is not None:
            return
        text = hover_text(self.sheet, self.picture.plot, self.mouse) if self.sheet and self.underMouse() else ""
        if text != self._hovered:
            self._hovered = text
            self.message_posted.emit(text)
            QToolTip.hideText()

    def leaveEvent(self, event: QEvent) -> None:
        """Remove the highlight."""
        if self._hovered and self.gesture is None:
            self._hovered = ""
            self.message_posted.emit("")
            QToolTip.hideText()
        super().leaveEvent(event)

    def rename_label(self, label_id: str) -> None:
        """Show a text field over a label for editing its name."""
        label, row = self.document.project.labels.get(label_id), self.sheet and self.sheet.find("labels", "")
        if label is None or self.sheet is None or not row:
            return

        def take(name: str) -> None:
            now = self.document.project.labels.get(label_id)
            if now is not None:
                self.document.replace("labels", label_id, replace(now, name=name), f"Rename label {now.name}")

        area = flags(self.sheet.context, self.sheet.rect(row))[label_id].area
        NameField(self, area.toRect(), label.name, take)

    def _show_menu(self, position: QPointF, place: QPoint) -> None:
        menu = menu_at(self, position)
        if menu is not None:
            menu.popup(place)

    def event(self, event: QEvent) -> bool:
        """Reserve the keys of the timeline from shortcuts."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            if handles_key(self, event.key(), event.modifiers()):
                event.accept()
                return True
        elif event.type() == QEvent.Type.ToolTip and isinstance(event, QHelpEvent) and self.sheet:
            self._show_tooltip(event.pos(), hover_text(self.sheet, self.picture.plot, QPointF(event.pos())))
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Handle keys for frames, handles, deletion, Esc."""
        if not press_key(self, Qt.Key(event.key()), event.modifiers()):
            super().keyPressEvent(event)

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Move the focus with Tab through the handles of the selected entity before it leaves the widget."""
        handle = edits.next_handle(self.shown, forward) if self.shown else None
        if handle is None:
            self.set_handle(None)
            return super().focusNextPrevChild(forward)
        self.set_handle(handle)
        return True
