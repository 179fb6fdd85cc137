"""When a body's measures are keyed: a row under its clips, with a diamond for each key."""

from PySide6.QtCore import QPointF, QRect
from PySide6.QtGui import QPainter

from studio.core.body.growth import KeyedProportions
from studio.document import colours
from studio.timeline.shown import Hit, Part, Shown, label_area, within
from studio.timeline.tracks.brush import KEY_REACH, hairline, paint_key, paint_label
from studio.timeline.tracks.layer import INDENT

HEIGHT = 22


def rows_of(shown: Shown, performer_id: str) -> list[tuple[str, str, int]]:
    """Kind, id and height of the row of a performer whose body grows."""
    return [("growth", performer_id, HEIGHT)] if keys_of(shown, performer_id) is not None else []


def keys_of(shown: Shown, performer_id: str) -> KeyedProportions | None:
    """A performer's keyed measures; None of a body that stays as it is."""
    proportions = shown.project.characters[shown.project.performers[performer_id].character_id].proportions
    return proportions if isinstance(proportions, KeyedProportions) else None


def nearest_key(shown: Shown, keyed: KeyedProportions, x: float) -> int:
    """Which key lies nearest to a pixel."""
    return min(range(len(keyed.times)), key=lambda place: abs(shown.axis.x_of_time(keyed.times[place]) - x))


def paint_growth(painter: QPainter, row: QRect, shown: Shown, performer_id: str) -> None:
    """The keys in the character's colour, on a line from the first to the last."""
    keyed = keys_of(shown, performer_id)
    if keyed is None:
        return
    colour = shown.project.characters[shown.project.performers[performer_id].character_id].colour
    points = [_point(shown, row, time) for time in keyed.times]
    painter.setPen(hairline(colour, 1.5))
    painter.drawLine(points[0], points[-1])
    for point in points:
        paint_key(painter, point, colour)


def paint_growth_label(painter: QPainter, row: QRect) -> None:
    """What is keyed."""
    paint_label(painter, label_area(row).adjusted(INDENT, 0, 0, 0), "Measures", colours.TEXT_SECOND)


def growth_hit(shown: Shown, row: QRect, performer_id: str, point: QPointF) -> Hit:
    """A key within reach, or the row's empty place."""
    keyed = keys_of(shown, performer_id)
    near = keyed is not None and any(
        within(point, place.x(), place.y(), KEY_REACH + 1.0) for place in (_point(shown, row, t) for t in keyed.times)
    )
    return Hit("growth", performer_id, Part.KEY if near else Part.EMPTY)


def _point(shown: Shown, row: QRect, time: float) -> QPointF:
    return QPointF(shown.axis.x_of_time(time), row.center().y() + 0.5)
