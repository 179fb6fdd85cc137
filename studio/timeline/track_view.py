"""Widget that shows the tracks and follows the document."""

from functools import partial

from PySide6.QtCore import QPointF, QRect, QSignalBlocker, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QScrollBar, QWidget

from studio.core.captures.capture import Capture
from studio.core.captures.remarks import Remark, remarks_on
from studio.document.document import Document
from studio.document.keyed_fields import KEYED_COLLECTIONS, fields_of
from studio.engine.empty_stage import empty_words
from studio.engine.live_interface import Live
from studio.timeline import edits, track_overlay
from studio.timeline.axis import TimeAxis
from studio.timeline.curve_fields import CURVE_FIELDS_HEIGHT as FIELDS_HEIGHT
from studio.timeline.curve_fields import CurveFields
from studio.timeline.curves import Plotted
from studio.timeline.gestures.gesture import TimelineGesture
from studio.timeline.gestures.keys import BoxSelect
from studio.timeline.gestures.value_curves import BoxSelectCurves
from studio.timeline.picture import PLOT_ROW, TimelineImage
from studio.timeline.sheet import FOLDABLE_ROW_KINDS, RIGHT_MARGIN, TimelineLayout, rows_of
from studio.timeline.shown import ROW_LABEL_WIDTH, ItemPart, RowContext
from studio.timeline.subject import play_different_rows, stage_extent, subject_of
from studio.timeline.tracks.constraint import activation_look
from studio.timeline.tracks.keys import SHEET_KIND, SUMMARY_KIND, sheet_id

UNSOLVED_ROWS = ("characters", "grounds", "props")
"""Collections whose changes during a drag appear only in the tracks ``ROWS_WHILE_DRAGGED`` until they are solved."""
ROWS_WHILE_DRAGGED = ("growth", "props", "summary", "sheet")


class TrackView(QWidget):
    """Ruler, tracks and graph; only changed parts are painted again."""

    def __init__(self, document: Document, live: Live, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.document, self.live = document, live
        self.axis = TimeAxis(self)
        self.picture = TimelineImage(self)
        self.sheet: TimelineLayout | None = None
        self.gesture: TimelineGesture | None = None
        self.handle: ItemPart | None = None
        self.mouse = QPointF()
        self.folded: frozenset[tuple[str, str]] = frozenset()
        self.editing = False
        """True if the plot is the curve editor."""
        self.fields = CurveFields(self.picture.curves, self)
        self.fields.hide()
        self.dope = False
        """True if the rows are those of the dope sheet."""
        self.apart: bool | None = None
        """True if every performer has its row of clips; None while that follows from what they play."""
        self._looks: dict[str, object] = {}
        self._progress = ("", 0.0)
        self._remarked: tuple[Capture, tuple[Remark, ...]] | None = None
        self._playhead_area = QRect()
        self._played: set[str] = set()
        """Motions on the stage when rows were laid out last."""
        self.scroll_bar = QScrollBar(Qt.Orientation.Vertical, self)
        self.scroll_bar.setAccessibleName("Scroll the timeline's tracks")
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName("Timeline")
        self._connect()
        self.lay_out()

    def _connect(self) -> None:
        document, playhead = self.document, self.document.playhead
        document.entity_changed.connect(self._show_change)
        document.project_opened.connect(self._show_project)
        document.selection.changed.connect(self._show_selection)
        document.keys.changed.connect(self._redraw_all)
        playhead.changed.connect(self._move_playhead)
        playhead.range_changed.connect(self.lay_out)
        self.live.reported_changed.connect(self._show_results)
        self.live.play.running_changed.connect(self._redraw_all)
        self.axis.changed.connect(self._redraw_all)
        self.picture.plot.arrived.connect(partial(self._redraw, PLOT_ROW))
        self.scroll_bar.valueChanged.connect(self.lay_out)

    def leave(self) -> None:
        """Disconnect from the document and the results."""
        document, playhead = self.document, self.document.playhead
        document.entity_changed.disconnect(self._show_change)
        document.project_opened.disconnect(self._show_project)
        document.selection.changed.disconnect(self._show_selection)
        document.keys.changed.disconnect(self._redraw_all)
        playhead.changed.disconnect(self._move_playhead)
        playhead.range_changed.disconnect(self.lay_out)
        self.live.reported_changed.disconnect(self._show_results)
        self.live.play.running_changed.disconnect(self._redraw_all)
        self.picture.close()

    @property
    def shown(self) -> RowContext | None:
        """Context of the tracks; None if there is no motion to show."""
        return self.sheet.context if self.sheet else None

    @property
    def prompt(self) -> str:
        """Text on an empty timeline: the running task, or what to do next."""
        return self._progress[0] or empty_words(self.document.project)

    def show_progress(self, words: str, share: float) -> None:
        """Show the text and progress (0 to 1) of a task; an empty text if none runs."""
        self._progress = (words, share)
        if self.sheet is None:
            self.update()

    def lay_out(self) -> None:
        """Update the list of tracks and their layout, and paint everything again."""
        subject = subject_of(self.document)
        if subject is None:
            self.sheet = None
            self.picture.plot.drop_curves()
            self.scroll_bar.hide()
            self.update()
            return
        apart = play_different_rows(self.document.project) if self.apart is None else self.apart
        remarks = self._remarks_on(self.document.project.captures[subject.motion.capture_id])
        shown = RowContext(
            self.document,
            self.live,
            self.axis,
            subject,
            self.handle,
            self.folded,
            apart,
            remarks,
            self.dope,
            self.editing,
        )
        sheet = TimelineLayout(shown, rows_of(shown), self.size())
        hidden = max(sheet.content_height - sheet.viewport.height(), 0)
        with QSignalBlocker(self.scroll_bar):
            self.scroll_bar.setRange(0, hidden)
            self.scroll_bar.setPageStep(sheet.viewport.height())
        self.scroll_bar.setVisible(hidden > 0)
        self.scroll_bar.setGeometry(self.width() - 9, sheet.viewport.top(), 9, sheet.viewport.height())
        self.sheet = TimelineLayout(shown, sheet.rows, self.size(), self.scroll_bar.value())
        with QSignalBlocker(self.axis):
            self.axis.set_position(ROW_LABEL_WIDTH, self.width() - ROW_LABEL_WIDTH - RIGHT_MARGIN)
            if self.gesture is None:  # time does not move under a hand that drags in it
                project, playhead = self.document.project, self.document.playhead
                played = {clip.motion_id for each in project.performers.values() for clip in each.clips}
                self.axis.set_extent(0.0, stage_extent(project), playhead.frame_rate, played == self._played)
                self._played = played
        self.fields.setGeometry(0, self.sheet.plot.top() + 44, ROW_LABEL_WIDTH, FIELDS_HEIGHT)
        self.fields.setVisible(self.editing and self.sheet.plot.height() > 44 + FIELDS_HEIGHT)
        self._redraw_all()

    def _remarks_on(self, capture: Capture) -> tuple[Remark, ...]:
        """Remarks on the capture, cached, since tracks are laid out again with every edit."""
        if self._remarked is None or self._remarked[0] is not capture:
            self._remarked = capture, remarks_on(capture)
        return self._remarked[1]

    def _redraw_all(self) -> None:
        if self.editing:
            self.fields.show_keys(self.shown)
        self.picture.invalidate()
        self.update()

    def _redraw(self, *rows: tuple[str, str]) -> None:
        """Paint the given tracks again."""
        if not rows or self.sheet is None:
            return
        self.picture.invalidate(*rows)
        for row in rows:
            self._update_row(row)

    def _update_row(self, row: tuple[str, str]) -> None:
        found = self.sheet.find(*row) if self.sheet else None
        if self.sheet is not None and (row == PLOT_ROW or found is not None):
            self.update(self.sheet.rect(found) if found is not None else self.sheet.plot)

    def _show_project(self) -> None:
        self.handle = self.apart = self._remarked = None
        self.lay_out()
        self.axis.fit()

    def _show_selection(self) -> None:
        self.set_handle(None)
        self.picture.curves.ranges.clear()
        self.lay_out()
        row = self.sheet.find(*self.document.selection.current or ("", "")) if self.sheet else None
        if row is not None and self.sheet is not None:
            high, low = row.y, row.y + row.height - self.sheet.viewport.height()
            self.scroll_bar.setValue(max(min(self.scroll_bar.value(), high), low))

    def set_editing(self, editing: bool) -> None:
        """Show the curve editor in place of the graph, or the graph again."""
        if self.editing != editing:
            self.editing = editing
            self.folded -= {PLOT_ROW}
            self.lay_out()

    def frame_curves(self, selected: bool) -> None:
        """Fit all values of the curve editor into view, or those of the selected keys."""
        if self.shown is not None:
            if not selected:
                self.axis.fit()
            self.picture.curves.frame(self.shown, selected)
            self._redraw(PLOT_ROW)

    def set_normalized(self, normalized: bool) -> None:
        """Scale each curve of the curve editor to the full height, or show curves of the same unit on one scale."""
        self.picture.curves.set_normalized(normalized)
        self._redraw(PLOT_ROW)

    def set_dope(self, dope: bool) -> None:
        """Show the dope sheet, or the usual tracks."""
        if self.dope != dope:
            self.dope = dope
            self.lay_out()

    def fold(self, kind: str, row_id: str = "") -> None:
        """Collapse or expand a track of ``FOLDABLE_ROW_KINDS``, the clip tracks, or the graph."""
        if kind == "clip":
            self.apart = not (self.shown and self.shown.rows_per_performer)
        else:
            self.folded ^= {(kind, row_id)}
        self.lay_out()

    def fold_all(self) -> None:
        """Collapse every track that can be; expand them if all are collapsed."""
        rows = self.sheet.rows if self.sheet else ()
        foldable = frozenset({PLOT_ROW} | {(row.kind, row.id) for row in rows if row.kind in FOLDABLE_ROW_KINDS})
        self.folded = frozenset() if foldable <= self.folded else foldable
        self.lay_out()

    def _show_change(self, collection: str, entity_id: str) -> None:
        """Paint the track of a changed constraint or contact again; after other changes, lay out all tracks."""
        if collection == "behaviours":
            return
        if self.editing and collection in KEYED_COLLECTIONS:
            self._redraw(PLOT_ROW)
            self.fields.show_keys(self.shown)
        if self.dope and collection == "constraints" and self.sheet and entity_id:
            own = [row.key for row in self.sheet.rows if row.id.startswith(f"{collection}/{entity_id}/")]
            fields = fields_of(collection, entity_id, self.document.project.get(collection, entity_id))
            if own == [(SHEET_KIND, sheet_id(field)) for field in fields]:
                self._redraw((SUMMARY_KIND, ""), *own)
                return
        if self.live.interactive and collection in UNSOLVED_ROWS:
            rows = self.sheet.rows if self.sheet else ()
            self._redraw(*((row.kind, row.id) for row in rows if row.kind in ROWS_WHILE_DRAGGED))
        elif (
            self.sheet is None
            or collection not in ("constraints", "contacts", "corrections")
            or (collection == "corrections" and self.dope)
            or rows_of(self.sheet.context) != self.sheet.rows
        ):
            self.lay_out()
        elif collection == "corrections":
            self._redraw((collection, entity_id))
        elif collection == "contacts":
            self._redraw(*((row.kind, row.id) for row in self.sheet.rows if row.kind == "lane"))
        elif self._looks.get(entity_id) != (look := activation_look(self.document.project.constraints.get(entity_id))):
            self._looks[entity_id] = look  # a target that is dragged changes nothing here until it is solved
            row = ("constraints", entity_id)
            if self.live.interactive:  # how well it holds is told some times a second, in its label as well
                self.picture.invalidate_rows(row)
                self._update_row(row)
            else:
                self._redraw(row)

    def _show_results(self) -> None:
        """Paint tracks that show results again; during a drag, only those of the dragged entity."""
        all_rows = self.sheet.rows if self.sheet else ()
        rows = [(row.kind, row.id) for row in all_rows if row.kind in ("constraints", "clip")]
        if self.live.interactive:
            selection = self.document.selection
            rows = [row for row in rows if row in selection or (row[0] == "clip" and selection.of("clips"))]
        else:
            rows.append(PLOT_ROW)
        self._redraw(*rows)

    def _move_playhead(self) -> None:
        """Paint only the pixels of the old and the new playhead."""
        if self.shown is None:
            return
        if self.document.playhead.playing:
            self.axis.reveal(self.document.playhead.time)
        self.update(self._playhead_area)
        self.update(track_overlay.playhead_area(self.shown, self.height()))

    def set_quantity(self, quantity: Plotted) -> None:
        """Plot another quantity in the graph."""
        self.picture.plot.quantity = quantity
        self._redraw(PLOT_ROW)

    def set_handle(self, handle: ItemPart | None) -> None:
        """Focus a handle of the selected entity."""
        if self.handle != handle:
            self.handle = handle
            self.lay_out()
            if self.shown:
                self.setAccessibleName(edits.handle_words(self.shown))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the cached image, and over it playhead and drag."""
        with QPainter(self) as painter:  # an error inside must not leave a painter on a widget that goes on
            if self.sheet is None:
                track_overlay.paint_prompt(
                    painter, self.rect(), self.prompt, self._progress[1] if self._progress[0] else None
                )
            else:
                self._paint(painter, self.sheet)

    def _paint(self, painter: QPainter, sheet: TimelineLayout) -> None:
        self.picture.refresh(sheet, self.devicePixelRatioF())
        # At a scale of 1.5 a part of the picture would not begin on whole pixels; Qt clips the whole to the area.
        painter.drawPixmap(QPointF(), self.picture.pixmap)
        track_overlay.paint_playhead(painter, sheet.context, self.height())
        self._playhead_area = track_overlay.playhead_area(
            sheet.context, self.height()
        )  # where it is left from, also by a zoom
        if isinstance(self.gesture, BoxSelect | BoxSelectCurves):
            track_overlay.paint_box(painter, self.gesture.box)
        if self.gesture is not None and self.gesture.mark is not None:
            track_overlay.paint_mark(painter, sheet.context, self.gesture.mark, self.mouse, self.rect())
        if self.hasFocus():
            track_overlay.paint_focus(painter, self.rect())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Lay out everything again."""
        self.lay_out()

    def sizeHint(self) -> QSize:
        """Height of a third of a large window."""
        return QSize(1200, 318)
