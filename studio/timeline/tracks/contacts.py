"""Contact tracks: a thin line for each contact point of feet, knees, seat and hands, heel above ball, left above
right.
"""

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QColor, QPainter

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.document import colours
from studio.timeline.shown import EDGE_PARTS, Hit, ItemPart, RowContext, label_area
from studio.timeline.tracks.brush import paint_bar, paint_fold, paint_label, translucent

CONTACT_LINE_HEIGHT, FOLDED_CONTACT_HEIGHT = 24, 13
CONTACT_LINE_PX, FOLDED_CONTACT_LINE_PX = 7, 3
"""Height in pixels of a line of contacts, in an expanded and in a collapsed track."""
CONTACT_EDGE_GRAB_PIXELS = 5.0
MIN_CONTACT_BAR_PX = 3.0
REPEATED_CONTACT_OPACITY = 0.4
"""Opacity of contacts in later loops of a clip."""
EDGE_FIELDS = {ItemPart.FIRST: "first", ItemPart.LAST: "last"}
LANES: dict[str, tuple[ContactPoint | Touch, ...]] = {
    "left foot": (ContactPoint.LEFT_HEEL, ContactPoint.LEFT_TOE),
    "right foot": (ContactPoint.RIGHT_HEEL, ContactPoint.RIGHT_TOE),
    "hands": (ContactPoint.LEFT_HAND, ContactPoint.RIGHT_HAND),
    "knees": (ContactPoint.LEFT_KNEE, ContactPoint.RIGHT_KNEE),
    "seat": (ContactPoint.SEAT,),
    "hands together": (Touch.HANDS_TOGETHER,),
    "hands on object": (Touch.HANDS_ON_THING,),
    **{
        f"hands on {words}": (Touch(f"left_hand_on_{part}"), Touch(f"right_hand_on_{part}"))
        for part, words in (("head", "head"), ("trunk", "torso"), ("hips", "hips"), ("thigh", "thigh"))
    },
}
"""Contact points by track, from top to bottom."""
PERMANENT_ROWS = ("left foot", "right foot")
"""Tracks that are shown even without contacts."""
CONTACT_FILLS = (
    colours.mixed_colour(colours.KIND_COLOURS["contact"], colours.PANEL, 0.30),
    colours.KIND_COLOURS["contact"],
)


def rows_with(points: set[ContactPoint | Touch]) -> tuple[str, ...]:
    """Names of the tracks for contacts of these points: those of the feet always, others if they have contacts."""
    return tuple(row for row, lanes in LANES.items() if row in PERMANENT_ROWS or not points.isdisjoint(lanes))


def row_of(point: ContactPoint | Touch) -> str:
    """Name of the track with the contacts of a point."""
    return next(row for row, lanes in LANES.items() if point in lanes)


def lane_rect(row: QRect, point: ContactPoint | Touch) -> QRectF:
    """Rectangle of the line of a contact point within its track."""
    lanes, line = LANES[row_of(point)], FOLDED_CONTACT_LINE_PX if is_folded(row) else CONTACT_LINE_PX
    middle = row.top() + row.height() / 2
    top = middle - line / 2 if len(lanes) == 1 else middle + 0.5 - (line + 1) * (1 - lanes.index(point))
    return QRectF(row.left(), round(top), row.width(), line)


def is_folded(row: QRect) -> bool:
    """True if a track is collapsed."""
    return row.height() <= FOLDED_CONTACT_HEIGHT


def contact_bar(shown: RowContext, row: QRect, contact: ContactInterval) -> QRectF:
    """Rectangle of a contact from its first to its last frame, at least three pixels wide."""
    line, (first, last) = lane_rect(row, contact.point), played_frames(shown, contact)
    left, right = shown.x_of_frame(first), shown.x_of_frame(last)
    spare = max(MIN_CONTACT_BAR_PX - (right - left), 0.0) / 2
    return QRectF(left - spare, line.top(), right - left + 2 * spare, line.height())


def played_frames(shown: RowContext, contact: ContactInterval) -> tuple[int, int]:
    """First and last frame of a contact, clipped to the clip."""
    clip = shown.subject.clip
    return max(contact.first, clip.first), min(contact.last, clip.last)


def paint_contacts(painter: QPainter, row: QRect, shown: RowContext, row_id: str) -> None:
    """Paint a bar for each contact, with a light edge if selected; bars that overlap in pixels are joined."""
    contacts = _contacts(shown, row_id)
    for point, fill in zip(LANES[row_id], CONTACT_FILLS, strict=False):
        line = lane_rect(row, point)
        own = [played_frames(shown, each) for _, each in contacts if each.point == point]
        for left, right in seen_bars(shown, own):
            bar = QRectF(left, line.top(), right - left, line.height())
            paint_bar(painter, bar, translucent(fill, 1.0), 2, None)
        for repeat in shown.later_repeats:
            for left, right in seen_bars(shown, own, repeat * shown.subject.repeat_seconds):
                bar = QRectF(left, line.top(), right - left, line.height())
                paint_bar(painter, bar, translucent(fill, REPEATED_CONTACT_OPACITY), 2, None)
    for key, contact in contacts:
        if contact.scope.is_narrow:
            _paint_own(painter, contact_bar(shown, row, contact), shown)
        if shown.is_selected("contacts", key):
            bar, edge = contact_bar(shown, row, contact), colours.SELECTED_HANDLE
            paint_bar(painter, bar.adjusted(0.5, 0.5, -0.5, -0.5), translucent(edge, 0.25), 2, edge)
            _paint_edge(painter, bar, shown.handle)


def _paint_own(painter: QPainter, bar: QRectF, shown: RowContext) -> None:
    """Paint a line in the performer's colour under contacts that apply only to that performer."""
    performer = shown.project.performers[shown.subject.performer_id]
    colour = shown.project.characters[performer.character_id].colour
    painter.fillRect(QRectF(bar.left(), bar.bottom() - 2, bar.width(), 2), QColor(colour))


def seen_bars(shown: RowContext, spans: list[tuple[int, int]], delay: float = 0.0) -> list[tuple[float, float]]:
    """First and last pixel of the visible bars of ``spans`` (first and last frame, in order of time), overlapping ones
    joined, shifted by ``delay`` seconds for a later loop.
    """
    ends = shown.xs_of_frames(np.array(spans, dtype=np.float64).reshape(-1, 2)) + delay * shown.axis.scale
    spare = np.maximum(MIN_CONTACT_BAR_PX - (ends[:, 1] - ends[:, 0]), 0.0) / 2
    ends += spare[:, None] * [-1.0, 1.0]
    ends = ends[(ends[:, 1] >= shown.axis.left) & (ends[:, 0] <= shown.axis.right + MIN_CONTACT_BAR_PX)]
    if not len(ends):
        return []
    begins = np.flatnonzero(np.append(True, ends[1:, 0] >= np.maximum.accumulate(ends[:-1, 1])))
    rights = np.maximum.reduceat(ends[:, 1], begins)
    return list(zip(ends[begins, 0].tolist(), rights.tolist(), strict=True))


def paint_contacts_label(painter: QPainter, row: QRect, row_id: str) -> None:
    """Paint the name of a contact track."""
    folded = is_folded(row)
    paint_fold(painter, row, folded)
    colour, pixels = (colours.TEXT_SECOND, 10) if folded else (colours.TEXT, 12)
    paint_label(painter, label_area(row), row_id.capitalize(), colour, pixels)


def contacts_hit(shown: RowContext, row: QRect, row_id: str, point: QPointF) -> Hit:
    """Contact, or end of one, under the mouse; else the empty line of its contact point."""
    lanes = LANES[row_id]
    touching = lanes[0] if point.y() < row.top() + row.height() / 2 else lanes[-1]
    reach = CONTACT_EDGE_GRAB_PIXELS + MIN_CONTACT_BAR_PX
    first, last = shown.frame_at(point.x() - reach), shown.frame_at(point.x() + reach)
    hits = [
        (distance, Hit("contacts", key, part))
        for key, contact in _contacts(shown, row_id)
        if contact.point == touching and contact.last >= first and contact.first <= last
        for distance, part in _grip(contact_bar(shown, row, contact), point.x())
        if part == ItemPart.BODY or getattr(contact, EDGE_FIELDS[part]) in played_frames(shown, contact)
    ]
    if hits:
        return min(hits, key=lambda pair: pair[0])[1]
    return Hit("lane", touching.value, ItemPart.EMPTY)


def _grip(bar: QRectF, x: float) -> list[tuple[float, ItemPart]]:
    """Parts of a bar that can be grabbed at ``x``, with their distances; ends extend beyond the bar and leave a third
    of it as body.
    """
    reach = min(CONTACT_EDGE_GRAB_PIXELS, bar.width() / 3)
    if bar.left() - CONTACT_EDGE_GRAB_PIXELS <= x <= bar.left() + reach:
        return [(abs(x - bar.left()), ItemPart.FIRST)]
    if bar.right() - reach <= x <= bar.right() + CONTACT_EDGE_GRAB_PIXELS:
        return [(abs(x - bar.right()), ItemPart.LAST)]
    return [(0.0, ItemPart.BODY)] if bar.left() < x < bar.right() else []


def _paint_edge(painter: QPainter, bar: QRectF, handle: ItemPart | None) -> None:
    if handle in EDGE_PARTS:
        x = bar.left() if handle == ItemPart.FIRST else bar.right()
        paint_bar(
            painter,
            QRectF(x - 2, bar.top() - 2, 4, bar.height() + 4),
            translucent(colours.SELECTED_HANDLE, 1.0),
            2,
        )


def _contacts(shown: RowContext, row_id: str) -> list[tuple[str, ContactInterval]]:
    own = shown.project.contacts_for(shown.subject.performer_id, shown.subject.clip)
    clip = shown.subject.clip
    return [
        (key, contact)
        for key, contact in own.items()
        if contact.point in LANES[row_id] and contact.last >= clip.first and contact.first <= clip.last
    ]
