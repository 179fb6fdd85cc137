"""Media tracks: a sound with its waveform and a line at each beat, and reference footage."""

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QColor, QPainter, QPen

from studio.core.stage.footage import Footage
from studio.core.stage.sound_track import PEAK_RATE, SoundTrack
from studio.document import colours
from studio.timeline.shown import ROW_LABEL_WIDTH, Hit, ItemPart, RowContext, label_area
from studio.timeline.tracks.brush import paint_bar, paint_label, translucent

SOUND_ROW_HEIGHT, FOOTAGE_ROW_HEIGHT = 34, 22


def rows_of(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the tracks of footage and sound."""
    return [
        *(("footage", key, FOOTAGE_ROW_HEIGHT) for key in shown.project.footage),
        *(("sounds", key, SOUND_ROW_HEIGHT) for key in shown.project.sounds),
    ]


def media_bar(shown: RowContext, row: QRect, media: SoundTrack | Footage) -> QRectF:
    """Rectangle from the start to the end of the sound or footage."""
    left, right = shown.axis.x_of_time(media.start), shown.axis.x_of_time(media.end)
    return QRectF(left, row.top() + 2, max(right - left, 2.0), row.height() - 4)


def paint_waveform(painter: QPainter, row: QRect, shown: RowContext, sound_id: str) -> None:
    """Paint the waveform, one column per pixel, and a line at each beat."""
    sound, selected = shown.project.sounds[sound_id], shown.is_selected("sounds", sound_id)
    bar = media_bar(shown, row, sound)
    _paint_media_bar(painter, bar, selected)
    columns = np.arange(max(int(bar.left()), ROW_LABEL_WIDTH), min(int(bar.right()), row.right()) + 1)
    if not len(columns):
        return
    begin, end = shown.axis.time_at(float(columns[0])), shown.axis.time_at(float(columns[-1]) + 1.0)
    edges = (np.linspace(begin, end, len(columns) + 1) - sound.start) * PEAK_RATE
    first = np.clip(edges[:-1], 0, len(sound.peaks) - 1).astype(int)
    heights = np.maximum.reduceat(np.append(sound.loudness, 0.0), first) * (bar.height() / 2 - 2)
    painter.setPen(QPen(QColor(colours.TEXT_SECOND), 1.0))
    middle = bar.center().y()
    for x, height in zip(columns.tolist(), heights.tolist(), strict=True):
        painter.drawLine(QPointF(x + 0.5, middle - height), QPointF(x + 0.5, middle + height))
    painter.setPen(QPen(translucent(colours.PARTLY, 0.9), 1.0))
    for beat in sound.stage_beats:
        place = shown.axis.x_of_time(beat)
        if columns[0] <= place <= columns[-1]:
            painter.drawLine(QPointF(place, bar.top()), QPointF(place, bar.bottom()))


def paint_footage(painter: QPainter, row: QRect, shown: RowContext, footage_id: str) -> None:
    """Paint a bar with a line at each second of the footage."""
    footage = shown.project.footage[footage_id]
    bar = media_bar(shown, row, footage)
    _paint_media_bar(painter, bar, shown.is_selected("footage", footage_id))
    painter.setPen(QPen(translucent(colours.TEXT_SECOND, 0.6), 1.0))
    for second in range(1, int(footage.end - footage.start) + 1):
        place = shown.axis.x_of_time(footage.start + second)
        if max(bar.left(), ROW_LABEL_WIDTH) <= place <= min(bar.right(), row.right()):
            painter.drawLine(QPointF(place, bar.top() + 4), QPointF(place, bar.bottom() - 4))


def _paint_media_bar(painter: QPainter, bar: QRectF, selected: bool) -> None:
    edge = colours.SELECTED_HANDLE if selected else None
    paint_bar(painter, bar, translucent(colours.SELECTED_CONTROL, 0.35), 3, edge)


def paint_media_label(painter: QPainter, row: QRect, shown: RowContext, kind: str, media_id: str) -> None:
    """Paint the name of a sound or of footage."""
    paint_label(painter, label_area(row), shown.project.get(kind, media_id).name, colours.TEXT)


def media_hit(shown: RowContext, row: QRect, kind: str, media_id: str, point: QPointF) -> Hit:
    """Bar of the sound or footage, or the empty space of the track."""
    inside = media_bar(shown, row, shown.project.get(kind, media_id)).contains(point)
    return Hit(kind, media_id, ItemPart.BODY if inside else ItemPart.EMPTY)
