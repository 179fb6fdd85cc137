"""Clip track of a performer: a bar for each clip; where two overlap, the upper one plays."""

from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPainterPath, QPen, QPolygonF

from studio.core.curves.activation import EaseShape, ease
from studio.core.curves.keyed import KeyedNumber
from studio.core.stage.clip import Clip
from studio.document import colours
from studio.engine.empty_stage import ALL_HIDDEN_PROMPT, empty_words
from studio.timeline.shown import Hit, ItemPart, RowContext, label_area
from studio.timeline.time_words import rate_text
from studio.timeline.tracks.brush import LABEL_INDENT, font, hairline, paint_dot, paint_fold, paint_label, translucent
from studio.timeline.tracks.change import clip_transition, paint_take_over

CLIP_ROW_HEIGHT = 24
CLIP_EDGE_REACH = 5.0
"""Width in pixels of the ends by which a bar is trimmed; at most a quarter of the bar."""
BAR_OPACITY, SELECTED_BAR_OPACITY = 0.28, 0.6
CURVE_STEPS = 16
TEXT_SEPARATOR = " · "


def clip_bar(shown: RowContext, row: QRect, clip: Clip) -> QRectF:
    """Rectangle of a clip with all its loops."""
    left = shown.axis.x_of_time(clip.start)
    right = shown.axis.x_of_time(clip.start + clip.length(shown.project.frame_rate_of(clip)))
    return QRectF(left, row.top() + 3, max(right - left, 2.0), row.height() - 6)


def bars_of(shown: RowContext, row: QRect, performer_id: str) -> list[tuple[Clip, QRectF]]:
    """Clips of a performer with their bars, in painting order: later ones over earlier ones."""
    clips = sorted(shown.project.performers[performer_id].clips, key=lambda clip: clip.start)
    return [(clip, clip_bar(shown, row, clip)) for clip in clips]


def clip_text(shown: RowContext, clip: Clip) -> str:
    """Text of a clip: ``front_kick · 70 frames at 30 fps``, and changes of its playback."""
    motion, frames = shown.project.motions[clip.motion_id], clip.last - clip.first + 1
    words = [
        motion.name,
        f"{frames} frame{'' if frames == 1 else 's'} at {rate_text(shown.project.frame_rate_of(clip))}",
    ]
    if isinstance(clip.speed, KeyedNumber):
        words.append("keyed speed")
    elif clip.speed != 1.0:
        words.append(f"Speed × {clip.speed:g}")
    words += [f"{clip.repeats} loops"] if clip.repeats > 1 else []
    words += ["mirrored"] if clip.mirrored else []
    return TEXT_SEPARATOR.join(words)


def row_text(shown: RowContext, clip: Clip) -> str:
    """Text of a clip's bar: as in ``clip_text``, and the number of performers if the track stands for several, or that
    none is visible.
    """
    text = clip_text(shown, clip)
    if shown.rows_per_performer:
        return text
    bodies = len(shown.subject.bodies)
    if not bodies:
        hidden = empty_words(shown.project) == ALL_HIDDEN_PROMPT
        return f"{text} · {ALL_HIDDEN_PROMPT if hidden else 'not used by a visible character'}"
    return f"{text} → {bodies} character{'' if bodies == 1 else 's'}"


def paint_clips(painter: QPainter, row: QRect, shown: RowContext, performer_id: str) -> None:
    """Paint the bars of the clips; each covers the previous one from its transition on."""
    bars = bars_of(shown, row, performer_id)
    failure = shown.live.failure(performer_id)
    if failure:
        _paint_failure(painter, row, shown, bars, failure)
        return
    end, comings = -1e9, [clip_transition(shown, performer_id, clip) for clip, _ in bars]
    afters = [
        0.0 if comes is None or comes.fades else min(max(comes.after * shown.axis.scale, 0.0), bar.width())
        for comes, (_, bar) in zip(comings, bars, strict=True)
    ]
    begins = [bar.left() + after for after, (_, bar) in zip(afters, bars, strict=True)]
    for index, ((clip, bar), comes, after) in enumerate(zip(bars, comings, afters, strict=True)):
        overlap = min(max(end - bar.left(), 0.0), bar.width())
        fades = comes is not None and comes.fades
        if fades:
            paint_clip_bar(painter, shown, performer_id, clip, _rising(bar, overlap))
        else:
            _paint_unplayed(painter, bar.adjusted(0, 0, after - bar.width(), 0))
            paint_clip_bar(painter, shown, performer_id, clip, _rounded(bar.adjusted(after, 0, 0, 0)))
        _paint_repeats(painter, clip, bar)
        if comes is not None and not fades and (overlap >= 2.0 or comes.cut):
            paint_take_over(painter, bar, begins[index], comes.cut)
        nearest = min(begins[index + 1 :], default=bar.right())
        room = bar.adjusted(overlap if fades else after, 0, min(nearest - bar.right(), 0.0), 0)
        paint_clip_text(painter, row_text(shown, clip), visible_part(shown, room))
        end = max(end, bar.right())


def _paint_failure(
    painter: QPainter, row: QRect, shown: RowContext, bars: list[tuple[Clip, QRectF]], failure: str
) -> None:
    """Paint the outlines of the clips, and the reason why the performer cannot be adapted."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for _, bar in bars:
        painter.setBrush(translucent(colours.NOT_REACHED, 0.12))
        painter.setPen(hairline(colours.NOT_REACHED))
        painter.drawRoundedRect(bar, 3, 3)
    room = QRectF(shown.axis.left, row.top(), shown.axis.width, row.height())
    paint_clip_text(painter, failure, room, colours.TEXT)


def _rounded(bar: QRectF) -> QPainterPath:
    path = QPainterPath()
    path.addRoundedRect(bar, 3, 3)
    return path


def _rising(bar: QRectF, fade: float) -> QPainterPath:
    """Path of a bar that rises over ``fade`` pixels, like a blend."""
    shares = [step / CURVE_STEPS for step in range(CURVE_STEPS + 1)]
    heights = [bar.bottom() - float(ease(share, EaseShape.QUINTIC)) * bar.height() for share in shares]
    rise = [QPointF(bar.left() + share * fade, height) for share, height in zip(shares, heights, strict=True)]
    path = QPainterPath()
    path.addPolygon(QPolygonF([*rise, bar.topRight(), bar.bottomRight()]))
    path.closeSubpath()
    return path


def _paint_unplayed(painter: QPainter, bar: QRectF) -> None:
    """Paint only the outline of the part of a clip before its transition."""
    if bar.width() >= 2.0:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(translucent(colours.TEXT, 0.7), 1.0, Qt.PenStyle.DotLine))
        painter.drawRoundedRect(bar, 3, 3)


def paint_clip_bar(painter: QPainter, shown: RowContext, performer_id: str, clip: Clip, path: QPainterPath) -> None:
    """Paint a bar in the colour of its performer, or in a neutral one if it stands for all; stronger if selected."""
    project = shown.project
    colour = colours.KIND_COLOURS["position"]
    if shown.rows_per_performer:
        colour = project.characters[project.performers[performer_id].character_id].colour
    selected = shown.is_selected("clips", clip.id)
    tint = SELECTED_BAR_OPACITY if selected else BAR_OPACITY
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(QColor(colours.mixed_colour(colours.CONTROL, colour, tint)))
    painter.setPen(hairline(colours.SELECTED_HANDLE if selected else colours.PANEL, 1.2 if selected else 1.0))
    painter.drawPath(path)


def _paint_repeats(painter: QPainter, clip: Clip, bar: QRectF) -> None:
    """Paint a notch at the start of each loop."""
    painter.setPen(hairline(translucent(colours.TEXT, 0.6)))
    for repeat in range(1, clip.repeats):
        x = bar.left() + bar.width() * repeat / clip.repeats
        painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.top() + 5))
        painter.drawLine(QPointF(x, bar.bottom() - 5), QPointF(x, bar.bottom()))


def visible_part(shown: RowContext, room: QRectF) -> QRectF:
    """Part of a rectangle between the ends of the axis."""
    return room.intersected(QRectF(shown.axis.left, room.top(), shown.axis.width, room.height()))


def paint_clip_text(painter: QPainter, words: str, room: QRectF, colour: str = colours.TEXT) -> None:
    """Paint as many parts of a text as fit at the left of a bar."""
    painter.setFont(font())
    painter.setPen(QColor(colour))
    area = room.adjusted(10, 0, -4, 0)
    painter.drawText(
        area, Qt.AlignmentFlag.AlignVCenter, elided_text(words, painter.fontMetrics(), round(area.width()))
    )


def elided_text(words: str, metrics: QFontMetrics, width: int) -> str:
    """As many of the parts between dots as fit as a whole; the first part is elided if necessary."""
    parts = words.split(TEXT_SEPARATOR)
    for count in range(len(parts), 1, -1):
        if metrics.horizontalAdvance(TEXT_SEPARATOR.join(parts[:count])) <= width:
            return TEXT_SEPARATOR.join(parts[:count])
    return metrics.elidedText(parts[0], Qt.TextElideMode.ElideRight, width)


def paint_clip_label(painter: QPainter, row: QRect, shown: RowContext, performer_id: str) -> None:
    """Paint the performer's name in its colour; the arrow of the first one collapses the clip tracks of all."""
    performer = shown.project.performers[performer_id]
    colour = shown.project.characters[performer.character_id].colour
    paint_dot(painter, QPointF(LABEL_INDENT + 3.5, row.center().y() + 0.5), 3.5, colour)
    text = colours.TEXT if performer.visible else colours.TEXT_THIRD
    name = performer.name if performer.visible else f"{performer.name}, hidden"
    paint_label(painter, label_area(row).adjusted(14, 0, 0, 0), name, text)
    if is_foldable(shown, performer_id):
        paint_fold(painter, row, not shown.rows_per_performer)


def is_foldable(shown: RowContext, performer_id: str) -> bool:
    """True if the arrow of this performer's track collapses and expands the clip tracks of all."""
    performers = list(shown.project.performers)
    return len(performers) > 1 and (not shown.rows_per_performer or performer_id == performers[0])


def clip_hit(bars: list[tuple[Clip, QRectF]], performer_id: str, point: QPointF) -> Hit:
    """End or body of one of the ``bars`` under the mouse, else the empty space of the track."""
    for clip, bar in reversed(bars):
        reach = min(CLIP_EDGE_REACH, bar.width() / 4)
        if not bar.adjusted(-reach / 2, 0, reach / 2, 0).contains(point):
            continue
        part = ItemPart.BODY
        if point.x() < bar.left() + reach:
            part = ItemPart.FIRST
        elif point.x() > bar.right() - reach:
            part = ItemPart.LAST
        return Hit("clips", clip.id, part, performer_id)
    return Hit("clip", performer_id, ItemPart.EMPTY)
