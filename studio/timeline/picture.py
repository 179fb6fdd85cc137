"""Cached image of the timeline. Only changed tracks are painted again; the playhead is painted over it."""

from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtGui import QColor, QPainter, QPixmap
from PySide6.QtWidgets import QWidget

from studio.document import colours
from studio.timeline.sheet import TimelineLayout
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext, TimelineRow, label_area
from studio.timeline.tracks import (
    clip,
    constraint,
    contacts,
    correction,
    hold,
    keys,
    labels,
    layer,
    media,
    remarks,
    ruler,
)
from studio.timeline.tracks.brush import time_area, translucent
from studio.timeline.tracks.plot import FOLDED_PLOT_HEIGHT, PlotPicture
from studio.timeline.tracks.value_curves import ValueCurves

PLOT_ROW = ("plot", "")
REFERENCE_CURVE_OPACITY = 0.3
"""Opacity of measured curves behind the animation curves in the curve editor."""
RULER_ROW = ("ruler", "")


class TimelineImage:
    """Cached image of the timeline, and the set of its outdated tracks."""

    def __init__(self, parent: QWidget) -> None:
        self.plot = PlotPicture(parent)
        self.curves = ValueCurves()
        self.pixmap = QPixmap()
        self._stale: set[tuple[str, str]] = set()
        self._stale_lanes: set[tuple[str, str]] = set()
        self._all_stale = True

    def close(self) -> None:
        """Release the graphics resources."""
        self.plot.close()

    def invalidate(self, *rows: tuple[str, str]) -> None:
        """Mark tracks, or all without arguments, to be painted again."""
        self._stale.update(rows)
        self._all_stale |= not rows

    def invalidate_rows(self, *rows: tuple[str, str]) -> None:
        """Mark tracks to be painted again except for their names."""
        self._stale_lanes.update(rows)

    def refresh(self, sheet: TimelineLayout, scale: float) -> None:
        """Paint outdated tracks, at ``scale`` device pixels per logical pixel."""
        size = QSize(round(sheet.size.width() * scale), round(sheet.size.height() * scale))
        if self.pixmap.size() != size:
            self.pixmap = QPixmap(size)
            self.pixmap.setDevicePixelRatio(scale)
            self._all_stale = True
        if not (self._all_stale or self._stale or self._stale_lanes):
            return
        with QPainter(self.pixmap) as painter:
            self._paint_stale(painter, sheet)
        self._stale.clear()
        self._stale_lanes.clear()
        self._all_stale = False

    def _paint_stale(self, painter: QPainter, sheet: TimelineLayout) -> None:
        if self._all_stale:
            painter.fillRect(QRect(QPoint(), sheet.size), QColor(colours.PANEL))
            _paint_ground(painter, sheet.viewport, sheet.context)
        if self._is_stale(RULER_ROW):
            shown = sheet.context
            ruler.paint_ruler(painter, sheet.ruler, shown.axis, shown.document.playhead, shown.live.play.running)
            remarks.paint_remarks(painter, sheet.ruler, sheet.context)
        for row in sheet.rows:
            labelled = self._is_stale((row.kind, row.id))
            if labelled or (row.kind, row.id) in self._stale_lanes:
                _paint_row(painter, sheet, row, labelled)
        if self._is_stale(PLOT_ROW):
            self._paint_plot(painter, sheet)

    def _is_stale(self, row: tuple[str, str]) -> bool:
        return self._all_stale or row in self._stale

    def _paint_plot(self, painter: QPainter, sheet: TimelineLayout) -> None:
        painter.save()
        painter.setClipRect(sheet.plot)
        _paint_ground(painter, sheet.plot, sheet.context)
        self.plot.fetch(sheet.context)
        if sheet.plot.height() > FOLDED_PLOT_HEIGHT:
            painter.setOpacity(REFERENCE_CURVE_OPACITY if sheet.context.curves else 1.0)
            self.plot.paint(painter, sheet.plot, sheet.context)
            painter.setOpacity(1.0)
            if sheet.context.curves:
                self.curves.paint(painter, sheet.plot, sheet.context)
        self.plot.paint_label(painter, sheet.plot, sheet.context)
        painter.fillRect(0, sheet.plot.top(), sheet.size.width(), 1, QColor(colours.EDGE))
        painter.restore()


def _paint_row(painter: QPainter, sheet: TimelineLayout, row: TimelineRow, labelled: bool) -> None:
    """Paint a track, with its name only if ``labelled``."""
    area = sheet.rect(row)
    lane = time_area(area)
    drawn = (area if labelled else lane).intersected(sheet.viewport)
    if drawn.isEmpty():
        return
    painter.save()
    painter.setClipRect(drawn)
    _paint_ground(painter, area, sheet.context)
    if labelled:
        _paint_label(painter, area, sheet.context, row)
    painter.save()
    painter.setClipRect(lane.intersected(sheet.viewport))
    _paint_content(painter, area, sheet.context, row)
    painter.restore()
    painter.fillRect(area.left(), area.bottom(), area.width(), 1, translucent(colours.EDGE, 0.5))
    painter.restore()


def _paint_ground(painter: QPainter, area: QRect, shown: RowContext) -> None:
    """Paint the background with a faint line at each number of the ruler."""
    painter.fillRect(area, QColor(colours.PANEL))
    line = translucent(colours.EDGE, 0.6)
    for frame in ruler.major_frames(shown.axis):
        x = round(shown.axis.x_of_frame(frame))
        if x >= ROW_LABEL_WIDTH:
            painter.fillRect(x, area.top(), 1, area.height(), line)


def _paint_label(painter: QPainter, area: QRect, shown: RowContext, row: TimelineRow) -> None:
    collection = "performers" if row.kind == "clip" else row.kind
    if shown.is_selected(collection, row.id):
        painter.fillRect(label_area(area), QColor(colours.SELECTED_ROW))
    match row.kind:
        case "sounds" | "footage":
            media.paint_media_label(painter, area, shown, row.kind, row.id)
        case "labels":
            labels.paint_labels_label(painter, area)
        case "clip":
            clip.paint_clip_label(painter, area, shown, row.id)
        case "layer":
            layer.paint_layer_label(painter, area, row.id)
        case "corrections":
            correction.paint_correction_label(painter, area, shown, row.id)
        case "growth":
            keys.paint_growth_label(painter, area)
        case "summary" | "sheet":
            keys.paint_sheet_label(painter, row, area, shown)
        case "props":
            hold.paint_hold_label(painter, area, shown, row.id)
        case "lane":
            contacts.paint_contacts_label(painter, area, row.id)
        case "constraints":
            constraint.paint_constraint_label(painter, area, shown, row.id)


def _paint_content(painter: QPainter, area: QRect, shown: RowContext, row: TimelineRow) -> None:
    match row.kind:
        case "footage":
            media.paint_footage(painter, area, shown, row.id)
        case "sounds":
            media.paint_waveform(painter, area, shown, row.id)
        case "labels":
            labels.paint_labels(painter, area, shown)
        case "clip":
            clip.paint_clips(painter, area, shown, row.id)
            keys.paint_keys(painter, shown, row, area, colours.TEXT)
        case "layer":
            layer.paint_layers(painter, area, shown, row.id)
        case "corrections":
            correction.paint_correction(painter, area, shown, row.id)
            keys.paint_keys(painter, shown, row, area, correction.key_colour(shown, row.id))
            correction.paint_correction_handles(painter, area, shown, row.id)
        case "growth":
            performer = shown.project.performers[row.id]
            keys.paint_keys(painter, shown, row, area, shown.project.characters[performer.character_id].colour)
        case "summary" | "sheet":
            keys.paint_sheet(painter, row, area, shown)
        case "props":
            hold.paint_hold(painter, area, shown, row.id)
            keys.paint_keys(painter, shown, row, area, colours.TEXT)
        case "lane":
            contacts.paint_contacts(painter, area, shown, row.id)
        case "constraints":
            constraint.paint_constraint(painter, area, shown, row.id)
            keys.paint_keys(painter, shown, row, area, constraint.key_colour(shown, row.id))
            constraint.paint_handles(painter, area, shown, row.id)
