"""TrackCanvas: the widget that shows the rows over time and takes mouse and keys."""

from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QScrollBar, QToolTip, QWidget

from studio.core.contacts import FootPoint
from studio.document.document import Document
from studio.timeline import edits, overlay
from studio.timeline.axis import TimeAxis
from studio.timeline.gestures.begin import cursor_at, gesture_at, item_of
from studio.timeline.gestures.gesture import Gesture
from studio.timeline.gestures.view import Pan, Scrub
from studio.timeline.hover import hover_text, is_value
from studio.timeline.menus import menu_at
from studio.timeline.picture import PLOT, Picture
from studio.timeline.sheet import RIGHT_MARGIN, Sheet, rows_of
from studio.timeline.shown import LABEL_WIDTH, Hit, Live, Part, Shown
from studio.timeline.subject import stage_extent, subject_of
from studio.timeline.tracks.plot import Quantity

FOLLOW_MILLISECONDS = 100
DRAG_BEGINS = 3
ZOOM_PER_DEGREE = 1.0125
SCROLL_PER_DEGREE = 0.8
PROMPT = "Drop a BVH here"
Modifier = Qt.KeyboardModifier


class TrackCanvas(QWidget):
    """Rows, ruler and plot. ``told`` carries what is under the mouse, in words."""

    told = Signal(str)

    def __init__(self, document: Document, live: Live, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.document, self.live = document, live
        self.axis = TimeAxis(self)
        self.picture = Picture()
        self.sheet: Sheet | None = None
        self.gesture: Gesture | None = None
        self.handle: Part | None = None
        self._pending: tuple[Hit, QPointF] | None = None
        self._mouse = QPointF()
        self._playhead_area = QRect()
        self._scroll_bar = QScrollBar(Qt.Orientation.Vertical, self)
        self._follow = QTimer(self, singleShot=True, interval=FOLLOW_MILLISECONDS)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName("Timeline")
        self._scroll_bar.setAccessibleName("Scroll the timeline's rows")
        self._connect()
        self.lay_out()

    def _connect(self) -> None:
        document, playhead = self.document, self.document.playhead
        document.entity_changed.connect(self._show_change)
        document.project_opened.connect(self._show_project)
        document.selection.changed.connect(self._show_selection)
        playhead.changed.connect(self._move_playhead)
        playhead.range_changed.connect(self.lay_out)
        self.live.adapted.connect(self._expect_results)
        self._follow.timeout.connect(self._show_results)
        self.axis.changed.connect(self._redraw_all)
        self._scroll_bar.valueChanged.connect(self._scrolled)

    def close_view(self) -> None:
        """Stop following the document."""
        if self.gesture is not None:
            self.gesture.cancel()
        self._follow.stop()
        self.live.adapted.disconnect(self._expect_results)
        self.picture.plot.close()

    # What is shown

    @property
    def shown(self) -> Shown | None:
        """What the rows show, or None while no performer plays a motion."""
        return self.sheet.shown if self.sheet else None

    def lay_out(self) -> None:
        """Fetch which rows there are, place them, and draw everything again."""
        subject = subject_of(self.document)
        if subject is None:
            self.sheet = None
            self._scroll_bar.hide()
            self.update()
            return
        shown = Shown(self.document, self.live, self.axis, subject, self.handle)
        sheet = Sheet(shown, rows_of(shown), self.size())
        hidden = max(sheet.content_height - sheet.viewport.height(), 0)
        with QSignalBlocker(self._scroll_bar):
            self._scroll_bar.setRange(0, hidden)
            self._scroll_bar.setPageStep(sheet.viewport.height())
        self._scroll_bar.setVisible(hidden > 0)
        self._scroll_bar.setGeometry(self.width() - 9, sheet.viewport.top(), 9, sheet.viewport.height())
        self.sheet = Sheet(shown, sheet.rows, self.size(), self._scroll_bar.value())
        with QSignalBlocker(self.axis):
            self.axis.place(LABEL_WIDTH, self.width() - LABEL_WIDTH - RIGHT_MARGIN)
            self.axis.set_extent(0.0, stage_extent(self.document.project), self.document.playhead.frame_rate)
        self._redraw_all()

    def _redraw_all(self) -> None:
        self.picture.expire()
        self.update()

    def _redraw(self, *rows: tuple[str, str]) -> None:
        self.picture.expire(*rows)
        self.update()

    def _scrolled(self) -> None:
        self.lay_out()

    def _show_project(self) -> None:
        self.handle = None
        self.axis.fit()
        self.lay_out()

    def _show_selection(self) -> None:
        self.set_handle(None)
        self.lay_out()

    def _show_change(self, collection: str, entity_id: str) -> None:
        """Draw the row of a changed constraint or contact; anything else may change which rows there are."""
        if self.sheet is None or collection not in ("constraints", "contacts"):
            self.lay_out()
        elif collection == "contacts":
            self._redraw(("feet", "left"), ("feet", "right"))
        elif rows_of(self.sheet.shown) != self.sheet.rows:
            self.lay_out()
        else:
            self._redraw(("constraints", entity_id))

    def _expect_results(self) -> None:
        if not self._follow.isActive():
            self._follow.start()

    def _show_results(self) -> None:
        rows = self.sheet.rows if self.sheet else ()
        self._redraw(PLOT, *((row.kind, row.id) for row in rows if row.kind == "constraints"))

    def _move_playhead(self) -> None:
        """Only the pixels the playhead leaves and takes."""
        if self.shown is None:
            return
        if self.document.playhead.playing:
            self.axis.reveal(self.document.playhead.time)
        area = overlay.playhead_area(self.shown, self.height())
        self.update(self._playhead_area)
        self.update(area)
        self._playhead_area = area

    def set_quantity(self, quantity: Quantity) -> None:
        """Plot something else."""
        self.picture.plot.quantity = quantity
        self._redraw(PLOT)

    def set_handle(self, handle: Part | None) -> None:
        """Give the keyboard to a handle of the selected thing."""
        if self.handle != handle:
            self.handle = handle
            self.lay_out()
            if self.shown:
                self.setAccessibleName(edits.handle_words(self.shown))

    # Painting

    def paintEvent(self, event: QPaintEvent) -> None:
        """The picture, then what lies over it."""
        with QPainter(self) as painter:  # an error inside must not leave a painter on a widget that goes on
            if self.sheet is None:
                overlay.paint_prompt(painter, self.rect(), PROMPT)
            else:
                self._paint(painter, self.sheet, event.rect())

    def _paint(self, painter: QPainter, sheet: Sheet, area: QRect) -> None:
        scale = self.devicePixelRatioF()
        self.picture.refresh(sheet, scale)
        painter.drawPixmap(area, self.picture.pixmap, QRect(area.topLeft() * scale, area.size() * scale))
        overlay.paint_playhead(painter, sheet.shown, self.height())
        if self.gesture is not None and self.gesture.mark is not None:
            overlay.paint_mark(painter, sheet.shown, self.gesture.mark, self._mouse, self.rect())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Place everything anew."""
        self.lay_out()

    def sizeHint(self) -> QSize:
        """A third of a large window."""
        return QSize(1200, 318)

    # Mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Select, and take hold of what is under the mouse."""
        if self.sheet is None or self.gesture is not None:
            return
        self._mouse = event.position()
        if event.button() == Qt.MouseButton.MiddleButton:
            self.gesture = Pan(self.axis, self._scroll_bar, event.position())
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
        elif event.button() == Qt.MouseButton.LeftButton:
            hit = self.sheet.hit(event.position())
            self._select(hit, bool(event.modifiers() & Modifier.ControlModifier))
            if hit.part == Part.TIME:
                self.gesture = gesture_at(hit, self.sheet.shown, event.position())
                self._drag(event)
            elif hit.kind == "plot":
                self._show_menu(event.position(), event.globalPosition().toPoint())
            else:
                self._pending = (hit, event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, or say what is under the mouse."""
        if self.sheet is None:
            return
        self._mouse = event.position()
        if self._pending is not None:
            hit, press = self._pending
            if (event.position() - press).manhattanLength() >= DRAG_BEGINS:
                self._pending = None
                self.gesture = gesture_at(hit, self.sheet.shown, press)
                if hit.part == Part.BODY:
                    self.setCursor(Qt.CursorShape.ClosedHandCursor)
        if self.gesture is not None:
            self._drag(event)
        elif not event.buttons():
            self._hover(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Finish the drag."""
        self._pending = None
        if self.gesture is not None:
            self.gesture.finish()
            self._end_gesture()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Add a contact at an empty place of a foot."""
        hit = self.sheet.hit(event.position()) if self.sheet else None
        if self.sheet and hit and hit.kind == "feet" and hit.part == Part.EMPTY:
            frame = round(self.sheet.shown.frame_at(event.position().x()))
            edits.add_contact(self.sheet.shown, FootPoint(hit.id), frame)
        else:
            self.mousePressEvent(event)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """What can be done here."""
        self._show_menu(QPointF(event.pos()), event.globalPos())

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Ctrl zooms about the mouse, Shift scrolls in time, the plain wheel scrolls the rows."""
        step = event.angleDelta() / 8
        degrees = step.y() or step.x()
        if event.modifiers() & Modifier.ControlModifier:
            self.axis.zoom(ZOOM_PER_DEGREE**degrees, max(event.position().x(), LABEL_WIDTH))
        elif event.modifiers() & Modifier.ShiftModifier or not step.y():
            self.axis.scroll(-degrees * SCROLL_PER_DEGREE * 4)
        else:
            self._scroll_bar.setValue(round(self._scroll_bar.value() - degrees * SCROLL_PER_DEGREE * 4))
        event.accept()

    def _select(self, hit: Hit, add: bool) -> None:
        item, selection = item_of(hit), self.document.selection
        if item is None:
            if hit.part == Part.EMPTY and hit.kind != "ruler":
                selection.clear()
        elif add:
            selection.toggle(item)
        elif selection.items != (item,):
            selection.set(item)

    def _drag(self, event: QMouseEvent) -> None:
        if self.gesture is None:
            return
        self.gesture.update(event.position(), bool(event.modifiers() & Modifier.AltModifier))
        if self.gesture.mark is not None:
            self.told.emit(self.gesture.mark.text)
        if not isinstance(self.gesture, Scrub):
            self.update()

    def _end_gesture(self) -> None:
        self.gesture = None
        self.told.emit("")
        self._set_cursor(self._mouse)
        self.update()

    def _set_cursor(self, position: QPointF) -> None:
        if self.sheet is not None:
            self.setCursor(cursor_at(self.sheet.hit(position)))

    def _hover(self, event: QMouseEvent) -> None:
        if self.sheet is None:
            return
        self._set_cursor(event.position())
        text = hover_text(self.sheet, self.picture.plot, event.position())
        self.told.emit(text)
        if text and is_value(self.sheet, event.position()):
            QToolTip.showText(event.globalPosition().toPoint() + QPoint(4, -2), text, self)
        elif QToolTip.isVisible():
            QToolTip.hideText()

    def _show_menu(self, position: QPointF, place: QPoint) -> None:
        menu = menu_at(self, position)
        if menu is not None:
            menu.popup(place)

    # Keys

    def event(self, event: QEvent) -> bool:
        """Keys that mean something here go before the window's shortcuts."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            if self._wants(event.key()):
                event.accept()
                return True
        elif event.type() == QEvent.Type.ToolTip and isinstance(event, QHelpEvent) and self.sheet:
            QToolTip.showText(
                event.globalPos(), hover_text(self.sheet, self.picture.plot, QPointF(event.pos())), self
            )
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Frames, handles, deletion, Esc."""
        if not self._key(Qt.Key(event.key()), event.modifiers()):
            super().keyPressEvent(event)

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Tab goes through the handles of the selected thing before it leaves."""
        handle = edits.next_handle(self.shown, forward) if self.shown else None
        if handle is None:
            self.set_handle(None)
            return super().focusNextPrevChild(forward)
        self.set_handle(handle)
        return True

    def _wants(self, key: int) -> bool:
        if key == Qt.Key.Key_Escape:
            return self.gesture is not None or self.handle is not None
        return key in (Qt.Key.Key_Left, Qt.Key.Key_Right) and self.handle is not None

    def _key(self, key: Qt.Key, modifiers: Qt.KeyboardModifier) -> bool:
        playhead, shown = self.document.playhead, self.shown
        if shown is None:
            return False
        frames = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(key)
        if frames and self.handle is not None:
            edits.nudge(shown, frames)
            self.setAccessibleName(edits.handle_words(shown))
        elif key == Qt.Key.Key_Home or (frames == -1 and modifiers & Modifier.ShiftModifier):
            playhead.set_frame(playhead.first)
        elif key == Qt.Key.Key_End or (frames == 1 and modifiers & Modifier.ShiftModifier):
            playhead.set_frame(playhead.last)
        elif frames:
            playhead.step(frames)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            return edits.delete_selected(shown)
        elif key == Qt.Key.Key_Escape and self.gesture is not None:
            self.gesture.cancel()
            self._end_gesture()
        elif key == Qt.Key.Key_Escape and self.handle is not None:
            self.set_handle(None)
        else:
            return False
        return True
