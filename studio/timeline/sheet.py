"""Layout of the tracks, from the clips down to the graph, and hit tests."""

from dataclasses import dataclass

from PySide6.QtCore import QPoint, QPointF, QRect, QSize

from studio.timeline.shown import FOLD_WIDTH, ROW_LABEL_WIDTH, Hit, ItemPart, RowContext, TimelineRow
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
    plot,
    ruler,
)

PLAYHEAD_GRAB_PIXELS = 4.0
RIGHT_MARGIN = 12
MIN_CURVE_EDITOR_FRACTION, MIN_CURVE_EDITOR_PX = 0.55, 150
"""Minimum height of the curve editor, as a fraction of the timeline's height and in pixels."""
FOLDABLE_ROW_KINDS = ("constraints", "lane")
"""Kinds of tracks that can be collapsed individually."""


def rows_of(shown: RowContext) -> tuple[TimelineRow, ...]:
    """Tracks in order: media, labels, clips, layers, corrections, proportions, props, contacts, and constraints by
    priority; or those of the dope sheet.
    """
    return _stacked(keys.rows_of(shown) if shown.shows_dope_sheet else _heights(shown))


def _stacked(heights: list[tuple[str, str, int]]) -> tuple[TimelineRow, ...]:
    rows, y = [], 0
    for kind, row_id, height in heights:
        rows.append(TimelineRow(kind, row_id, y, height))
        y += height
    return tuple(rows)


def _heights(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of each track outside of the dope sheet."""
    visible = [key for key, each in shown.project.performers.items() if each.visible]
    players = visible if shown.rows_per_performer else (shown.subject.performer_id,)
    constraints = shown.project.constraints_for(shown.subject.performer_id, shown.subject.clip)
    touching = {each.point for each in shown.project.contacts_of(shown.subject.motion_id).values()}
    lanes = contacts.rows_with(touching)
    tall = constraint.height(len(shown.subject.bodies))
    heights_of = {
        key: constraint.FOLDED_CONSTRAINT_HEIGHT if ("constraints", key) in shown.folded else tall
        for key in constraints
    }
    return [
        *media.rows_of(shown),
        *labels.rows_of(shown),
        *(
            each
            for key in players
            for each in (
                ("clip", key, clip.CLIP_ROW_HEIGHT),
                *layer.rows_of(shown, key),
                *correction.rows_of(shown, key),
                *keys.growth_rows(shown, key),
            )
        ),
        *hold.rows_of(shown),
        *(
            (
                "lane",
                row,
                contacts.FOLDED_CONTACT_HEIGHT if ("lane", row) in shown.folded else contacts.CONTACT_LINE_HEIGHT,
            )
            for row in lanes
        ),
        *(("constraints", key, high) for key, high in heights_of.items()),
    ]


@dataclass(frozen=True, eq=False)
class TimelineLayout:
    """Layout of tracks in a widget of ``size``, scrolled down by ``scroll`` pixels."""

    context: RowContext
    rows: tuple[TimelineRow, ...]
    size: QSize
    scroll: int = 0

    @property
    def ruler(self) -> QRect:
        """Rectangle of the ruler at the top."""
        return QRect(0, 0, self.size.width(), ruler.RULER_HEIGHT)

    @property
    def content_height(self) -> int:
        """Height in pixels of all tracks between the ruler and the graph."""
        return self.rows[-1].y + self.rows[-1].height

    @property
    def plot(self) -> QRect:
        """Rectangle of the graph at the bottom, which fills the space below the tracks."""
        if ("plot", "") in self.context.folded:
            return QRect(0, self.size.height() - plot.FOLDED_PLOT_HEIGHT, self.size.width(), plot.FOLDED_PLOT_HEIGHT)
        if self.context.curves:
            most = self.size.height() - ruler.RULER_HEIGHT
            height = max(
                round(MIN_CURVE_EDITOR_FRACTION * most), min(MIN_CURVE_EDITOR_PX, most), most - self.content_height
            )
            return QRect(0, self.size.height() - height, self.size.width(), height)
        spare = self.size.height() - ruler.RULER_HEIGHT - self.content_height
        height = min(max(spare, plot.MIN_PLOT_HEIGHT_PX), plot.MAX_PLOT_HEIGHT_PX)
        return QRect(0, self.size.height() - height, self.size.width(), height)

    @property
    def viewport(self) -> QRect:
        """Rectangle in which tracks are visible."""
        return QRect(0, ruler.RULER_HEIGHT, self.size.width(), max(self.plot.top() - ruler.RULER_HEIGHT, 0))

    def rect(self, row: TimelineRow) -> QRect:
        """Rectangle of a track, which may be outside of the viewport."""
        return QRect(0, ruler.RULER_HEIGHT + row.y - self.scroll, self.size.width(), row.height)

    def find(self, kind: str, row_id: str) -> TimelineRow | None:
        """Track of a kind and id; None if there is none."""
        return next((row for row in self.rows if (row.kind, row.id) == (kind, row_id)), None)

    def row_at(self, point: QPoint) -> TimelineRow | None:
        """Track at a point of the viewport; None if there is none."""
        if not self.viewport.contains(point):
            return None
        return next((row for row in self.rows if self.rect(row).contains(point)), None)

    def hit(self, position: QPointF) -> Hit:
        """Part under the mouse: entities first, then the line of the playhead, then empty space."""
        hit = self.part_under_playhead(position)
        line = self.context.axis.x_of_time(self.context.document.playhead.time)
        over_line = position.x() >= ROW_LABEL_WIDTH and abs(position.x() - line) <= PLAYHEAD_GRAB_PIXELS
        return Hit("playhead", "", ItemPart.TIME) if hit.part == ItemPart.EMPTY and over_line else hit

    def part_under_playhead(self, position: QPointF) -> Hit:
        """Part under the mouse, behind the line of the playhead."""
        point = position.toPoint()
        if self.ruler.contains(point):
            return Hit("ruler", "", ItemPart.TIME if point.x() >= ROW_LABEL_WIDTH else ItemPart.EMPTY)
        if self.plot.contains(point) and point.x() < FOLD_WIDTH:
            return Hit("plot", "", ItemPart.FOLD)
        if self.plot.contains(point):
            if point.x() < ROW_LABEL_WIDTH:
                return Hit("plot", "", ItemPart.LABEL)
            return Hit("curves", "", ItemPart.EMPTY) if self.context.curves else Hit("plot", "", ItemPart.TIME)
        row = self.row_at(point)
        return self._hit_row(row, position) if row else Hit("", "", ItemPart.EMPTY)

    def _hit_row(self, row: TimelineRow, position: QPointF) -> Hit:
        if position.x() < FOLD_WIDTH and (row.kind in FOLDABLE_ROW_KINDS or self._folds(row)):
            return Hit(row.kind, row.id, ItemPart.FOLD)
        if position.x() < ROW_LABEL_WIDTH:
            return self._label_hit(row)
        area = self.rect(row)
        under = self._hit_part(row, area, position)
        if under.part in (ItemPart.EMPTY, ItemPart.BODY) and (found := keys.keys_at(self.context, row, area, position)):
            return Hit(row.kind, row.id, ItemPart.KEY, keys=found)
        return under

    def _hit_part(self, row: TimelineRow, area: QRect, position: QPointF) -> Hit:
        match row.kind:
            case "growth" | "summary" | "sheet":
                return Hit(row.kind, row.id, ItemPart.EMPTY)
            case "clip":
                return clip.clip_hit(clip.bars_of(self.context, area, row.id), row.id, position)
            case "layer":
                return clip.clip_hit(layer.clip_bars(self.context, area, row.id), layer.performer_of(row.id), position)
            case "sounds" | "footage":
                return media.media_hit(self.context, area, row.kind, row.id, position)
            case "corrections":
                return correction.correction_hit(self.context, area, row.id, position)
            case "labels":
                return labels.labels_hit(self.context, area, position)
            case "props":
                return hold.hold_hit(self.context, area, row.id, position)
            case "lane":
                return contacts.contacts_hit(self.context, area, row.id, position)
        return constraint.constraint_hit(self.context, area, row.id, position)

    def _label_hit(self, row: TimelineRow) -> Hit:
        match row.kind:
            case "clip" | "growth":
                return Hit("performers", row.id, ItemPart.LABEL)
            case "layer":
                return Hit("performers", layer.performer_of(row.id), ItemPart.LABEL)
        return Hit(row.kind, row.id, ItemPart.LABEL)

    def _folds(self, row: TimelineRow) -> bool:
        return row.kind == "clip" and clip.is_foldable(self.context, row.id)
