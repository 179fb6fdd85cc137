"""When props are held: a row for each that is picked up or put down, with a bar in its holder's colour."""

from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QPainter

from studio.core.stage.prop import Prop
from studio.document import colours
from studio.timeline.shown import Hit, Part, Shown, label_area
from studio.timeline.tracks.brush import paint_bar, paint_label, translucent
from studio.timeline.tracks.clip import EDGE_REACH, paint_clip_text, seen_part

HEIGHT = 22


def rows_of(shown: Shown) -> list[tuple[str, str, int]]:
    """Kind, id and height of the rows of props that are held for a while."""
    props = shown.project.props.items()
    return [("props", key, HEIGHT) for key, each in props if each.held is not None and not each.held.is_always]


def hold_bar(shown: Shown, row: QRect, prop: Prop) -> QRectF:
    """From where it is picked up to where it is put down, or to the ends of the axis."""
    begin, end = (None, None) if prop.held is None else (prop.held.begin, prop.held.end)
    left = shown.axis.left if begin is None else shown.axis.x_of_time(begin)
    right = shown.axis.left + shown.axis.width if end is None else shown.axis.x_of_time(end)
    return QRectF(left, row.top() + 3, max(right - left, 2.0), row.height() - 6)


def paint_hold(painter: QPainter, row: QRect, shown: Shown, prop_id: str) -> None:
    """A bar that says who holds it."""
    project = shown.project
    prop = project.props[prop_id]
    holder = project.performers[prop.holder or ""]
    colour, bar = project.characters[holder.character_id].colour, hold_bar(shown, row, prop)
    selected = shown.is_selected("props", prop_id)
    paint_bar(
        painter, bar, translucent(colour, 0.6 if selected else 0.35), 3, colours.SELECTED_HANDLE if selected else None
    )
    paint_clip_text(painter, f"held by {holder.name}", seen_part(shown, bar))


def paint_hold_label(painter: QPainter, row: QRect, shown: Shown, prop_id: str) -> None:
    """Which prop it is."""
    paint_label(painter, label_area(row), shown.project.props[prop_id].name, colours.TEXT)


def hold_hit(shown: Shown, row: QRect, prop_id: str, point: QPointF) -> Hit:
    """An end of the bar, its body, or the row's empty place."""
    bar = hold_bar(shown, row, shown.project.props[prop_id])
    reach = min(EDGE_REACH, bar.width() / 4)
    if not bar.adjusted(-reach, 0, reach, 0).contains(point):
        return Hit("props", prop_id, Part.EMPTY)
    if point.x() < bar.left() + reach:
        return Hit("props", prop_id, Part.FIRST)
    return Hit("props", prop_id, Part.LAST if point.x() > bar.right() - reach else Part.BODY)
