"""Waveforms: a row for each sound track, its loudness over time, and a line at each beat."""

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QColor, QPainter, QPen

from studio.core.stage.sound_track import PEAK_RATE, SoundTrack
from studio.document import colours
from studio.timeline.shown import ROW_LABEL_WIDTH, Hit, ItemPart, RowContext, label_area
from studio.timeline.tracks.brush import paint_bar, paint_label, translucent

SOUND_ROW_HEIGHT = 34


def rows_of(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height of the rows of sound tracks."""
    return [("sounds", key, SOUND_ROW_HEIGHT) for key in shown.project.sounds]


def sound_bar(shown: RowContext, row: QRect, sound: SoundTrack) -> QRectF:
    """From where the sound begins to where it ends."""
    left, right = shown.axis.x_of_time(sound.start), shown.axis.x_of_time(sound.end)
    return QRectF(left, row.top() + 2, max(right - left, 2.0), row.height() - 4)


def paint_waveform(painter: QPainter, row: QRect, shown: RowContext, sound_id: str) -> None:
    """Draw the loudness, a column a pixel, and a line at each beat."""
    sound, selected = shown.project.sounds[sound_id], shown.is_selected("sounds", sound_id)
    bar = sound_bar(shown, row, sound)
    paint_bar(
        painter, bar, translucent(colours.SELECTED_CONTROL, 0.35), 3, colours.SELECTED_HANDLE if selected else None
    )
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


def paint_waveform_label(painter: QPainter, row: QRect, shown: RowContext, sound_id: str) -> None:
    """Draw the sound's name."""
    paint_label(painter, label_area(row), shown.project.sounds[sound_id].name, colours.TEXT)


def waveform_hit(shown: RowContext, row: QRect, sound_id: str, point: QPointF) -> Hit:
    """The bar of the sound, or the row's empty place."""
    inside = sound_bar(shown, row, shown.project.sounds[sound_id]).contains(point)
    return Hit("sounds", sound_id, ItemPart.BODY if inside else ItemPart.EMPTY)
