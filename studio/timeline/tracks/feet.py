"""A foot's contacts: two thin lines, the heel above, the ball below."""

from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QPainter

from studio.core.contacts import ContactInterval, ContactPoint
from studio.document import colours
from studio.timeline.shown import EDGES, Hit, Part, Shown, label_area
from studio.timeline.tracks.brush import paint_bar, paint_label, translucent

HEIGHT = 24
LINE = 7
EDGE_REACH = 5.0
SIDES = {
    "left": (ContactPoint.LEFT_HEEL, ContactPoint.LEFT_TOE),
    "right": (ContactPoint.RIGHT_HEEL, ContactPoint.RIGHT_TOE),
}
FILLS = {
    True: colours.mixed(colours.KINDS["contact"], colours.PANEL, 0.30),
    False: colours.KINDS["contact"],
}


def side_of(point: ContactPoint) -> str:
    """The row's id of a foot point."""
    return "left" if point.side == 0 else "right"


def lane(row: QRect, point: ContactPoint) -> QRectF:
    """The height at which a point's contacts lie in its foot's row."""
    middle = row.top() + row.height() / 2
    top = middle - LINE - 0.5 if point.is_heel else middle + 0.5
    return QRectF(row.left(), round(top), row.width(), LINE)


def contact_bar(shown: Shown, row: QRect, contact: ContactInterval) -> QRectF:
    """Where a contact lies: from its first frame to its last, three pixels at least."""
    line = lane(row, contact.point)
    left, right = shown.x_of_frame(contact.first), shown.x_of_frame(contact.last)
    spare = max(3.0 - (right - left), 0.0) / 2
    return QRectF(left - spare, line.top(), right - left + 2 * spare, line.height())


def paint_feet(painter: QPainter, row: QRect, shown: Shown, side: str) -> None:
    """The selected contact has a light edge. Of an hour on a thousand pixels most bars lie on one another."""
    painted: set[QRect] = set()
    for key, contact in _contacts(shown, side):
        bar = contact_bar(shown, row, contact)
        edge = colours.SELECTED_HANDLE if shown.is_selected("contacts", key) else None
        pixels = bar.toRect()
        if edge is None and pixels in painted:
            continue
        painted.add(pixels)
        paint_bar(painter, bar, translucent(FILLS[contact.point.is_heel], 1.0), 2, None)
        if edge:
            paint_bar(painter, bar.adjusted(0.5, 0.5, -0.5, -0.5), translucent(edge, 0.25), 2, edge)
            _paint_edge(painter, bar, shown.handle)


def paint_feet_label(painter: QPainter, row: QRect, side: str) -> None:
    """Which foot; the two lines are named when pointed at."""
    paint_label(painter, label_area(row), f"{side.capitalize()} foot", colours.TEXT)


def feet_hit(shown: Shown, row: QRect, side: str, point: QPointF) -> Hit:
    """A contact or its end; else the lane, named by its foot point."""
    heel, toe = SIDES[side]
    foot_point = heel if point.y() < row.top() + row.height() / 2 else toe
    hits = [
        (distance, Hit("contacts", key, part))
        for key, contact in _contacts(shown, side)
        if contact.point == foot_point
        for distance, part in _grip(contact_bar(shown, row, contact), point.x())
    ]
    if hits:
        return min(hits, key=lambda pair: pair[0])[1]
    return Hit("feet", foot_point.value, Part.EMPTY)


def _grip(bar: QRectF, x: float) -> list[tuple[float, Part]]:
    """The part of a bar at ``x`` with its distance; ends reach beyond the bar, and leave a third as body."""
    reach = min(EDGE_REACH, bar.width() / 3)
    if bar.left() - EDGE_REACH <= x <= bar.left() + reach:
        return [(abs(x - bar.left()), Part.FIRST)]
    if bar.right() - reach <= x <= bar.right() + EDGE_REACH:
        return [(abs(x - bar.right()), Part.LAST)]
    return [(0.0, Part.BODY)] if bar.left() < x < bar.right() else []


def _paint_edge(painter: QPainter, bar: QRectF, handle: Part | None) -> None:
    if handle in EDGES:
        x = bar.left() if handle == Part.FIRST else bar.right()
        paint_bar(
            painter,
            QRectF(x - 2, bar.top() - 2, 4, bar.height() + 4),
            translucent(colours.SELECTED_HANDLE, 1.0),
            2,
        )


def _contacts(shown: Shown, side: str) -> list[tuple[str, ContactInterval]]:
    own = shown.project.contacts_of(shown.subject.motion_id)
    return [(key, contact) for key, contact in own.items() if contact.point in SIDES[side]]
