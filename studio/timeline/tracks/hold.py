"""Track of a prop that is picked up or put down: a bar for each hold, in the colour of the holder."""

from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QPainter

from studio.core.stage.prop import Carried, Hold, InHand, Prop
from studio.document import colours
from studio.document.keyed_fields import fields_of
from studio.timeline.shown import Hit, ItemPart, RowContext, label_area
from studio.timeline.tracks.brush import paint_bar, paint_label, translucent
from studio.timeline.tracks.clip import CLIP_EDGE_REACH, paint_clip_text, visible_part

HOLD_ROW_HEIGHT = 22


def rows_of(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the tracks of props that are held temporarily or have keys."""
    props = shown.project.props.items()
    return [
        ("props", key, HOLD_ROW_HEIGHT)
        for key, each in props
        if any(not hold.is_always for hold in each.holds) or fields_of("props", key, each)
    ]


def hold_bar(shown: RowContext, row: QRect, hold: Hold) -> QRectF:
    """Rectangle from pick-up to put-down, or to the ends of the axis."""
    left = shown.axis.left if hold.begin is None else shown.axis.x_of_time(hold.begin)
    right = shown.axis.left + shown.axis.width if hold.end is None else shown.axis.x_of_time(hold.end)
    return QRectF(left, row.top() + 3, max(right - left, 2.0), row.height() - 6)


def paint_hold(painter: QPainter, row: QRect, shown: RowContext, prop_id: str) -> None:
    """Paint a bar with the holder's name for each hold."""
    project, selected = shown.project, shown.is_selected("props", prop_id)
    edge = colours.SELECTED_HANDLE if selected else None
    for hold in project.props[prop_id].holds:
        holder, bar = project.performers[hold.performer_id], hold_bar(shown, row, hold)
        colour = project.characters[holder.character_id].colour
        paint_bar(painter, bar, translucent(colour, 0.6 if selected else 0.35), 3, edge)
        paint_clip_text(painter, f"carried by {holder.name}", visible_part(shown, bar))


def paint_hold_label(painter: QPainter, row: QRect, shown: RowContext, prop_id: str) -> None:
    """Draw the prop's name."""
    paint_label(painter, label_area(row), shown.project.props[prop_id].name, colours.TEXT)


def hold_hit(shown: RowContext, row: QRect, prop_id: str, point: QPointF) -> Hit:
    """End or body of a hold's bar under the mouse, else the empty space of the track."""
    hold = hold_under(shown, shown.project.props[prop_id], point.x())
    if hold is None:
        return Hit("props", prop_id, ItemPart.EMPTY)
    bar = hold_bar(shown, row, hold)
    reach = _reach(bar)
    if point.x() < bar.left() + reach:
        return Hit("props", prop_id, ItemPart.FIRST)
    return Hit("props", prop_id, ItemPart.LAST if point.x() > bar.right() - reach else ItemPart.BODY)


def hold_under(shown: RowContext, prop: Prop, x: float) -> InHand | Carried | None:
    """Hold whose bar, or an end of it, is at the pixel ``x``; None if there is none."""
    for hold in prop.holds:
        bar = hold_bar(shown, QRect(0, 0, 1, HOLD_ROW_HEIGHT), hold)
        if bar.left() - _reach(bar) <= x <= bar.right() + _reach(bar):
            return hold
    return None


def _reach(bar: QRectF) -> float:
    return min(CLIP_EDGE_REACH, bar.width() / 4)
