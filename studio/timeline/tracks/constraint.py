"""Track of a constraint: its activation curve with four handles, and an error strip for each performer."""

import numpy as np
from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPolygonF

from studio.core.constraints.base import Constraint
from studio.core.constraints.target import key_times
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.performers.stage import constraints_of_performer
from studio.document import colours
from studio.engine.residuals import Inactive, unsolved_words
from studio.timeline.shown import HANDLE_PARTS, Hit, ItemPart, RowContext, clipped_span, frame_words, label_area
from studio.timeline.subject import BodyOnTimeline
from studio.timeline.tracks.brush import hairline, paint_dot, paint_fold, paint_label, translucent
from studio.timeline.tracks.error_strip import STRIP_SPACING_PIXELS, paint_strip, paint_unknown

CURVE_TOP_PX, CURVE_HEIGHT_PX, STRIP_GAP_PX, STRIP_BOTTOM_PX = 6, 19, 2, 3
ACTIVATION_HANDLE_REACH = 6.0
RAMP_POINTS = 48
ROOM_FOR_LABEL = 44
LATER_REPEAT_OPACITY = 0.2
FOLDED_CONSTRAINT_HEIGHT = 22
"""Height in pixels of a collapsed track: a low curve, and the error strip of the performer with the worst residual."""
FOLDED_CURVE_TOP_PX, FOLDED_CURVE_HEIGHT_PX = 2, 11


def height(body_count: int) -> int:
    """Height in pixels of a track with ``body_count`` error strips."""
    return max(
        CURVE_TOP_PX + CURVE_HEIGHT_PX + STRIP_GAP_PX + STRIP_SPACING_PIXELS * body_count + STRIP_BOTTOM_PX,
        ROOM_FOR_LABEL,
    )


def baseline(row: QRect) -> int:
    """Pixel of activation 0 in a track."""
    return row.top() + (FOLDED_CURVE_TOP_PX if is_folded(row) else CURVE_TOP_PX) + curve_height(row)


def curve_height(row: QRect) -> int:
    """Pixels from activation 0 to 1 in a track."""
    return FOLDED_CURVE_HEIGHT_PX if is_folded(row) else CURVE_HEIGHT_PX


def is_folded(row: QRect) -> bool:
    """True if a track is collapsed."""
    return row.height() <= FOLDED_CONSTRAINT_HEIGHT


def handle_points(shown: RowContext, row: QRect, constraint: Constraint) -> dict[ItemPart, QPointF]:
    """Pixel positions of the four handles."""
    curve, low = constraint.activation, baseline(row) + 0.5
    times = (curve.start, curve.full, curve.full_end, curve.end)
    full = low - curve_height(row)
    heights = (low, full, full, low)
    xs = (shown.x_of_motion_time(time) for time in times)
    return {part: QPointF(x, y) for part, x, y in zip(HANDLE_PARTS, xs, heights, strict=True)}


def activation_look(constraint: Constraint | None) -> object:
    """Values of a constraint that its track shows, apart from results; equal values look the same."""
    if constraint is None:
        return None
    return (constraint.name, constraint.enabled, constraint.priority, constraint.activation, *key_times(constraint))


def paint_constraint(painter: QPainter, row: QRect, shown: RowContext, constraint_id: str) -> None:
    """Paint the activation curve, filled in the colour of the constraint's kind; lighter and with larger handles if
    selected.
    """
    constraint = shown.project.constraints[constraint_id]
    colour = colours.kind_colour(constraint.kind) if constraint.enabled else colours.TEXT_THIRD
    line = line_colour(shown, constraint_id)
    path = _curve_path(shown, row, constraint.activation)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    _paint_later_repeats(painter, row, shown, constraint_id, colour)
    painter.setPen(hairline(line, 1.5))
    if not constraint.enabled:
        painter.setPen(Qt.PenStyle.DashLine)
    painter.setBrush(translucent(colour, 0.4 if constraint.enabled else 0.1))
    painter.drawPath(path)
    _paint_strips(painter, row, shown, constraint_id)


def line_colour(shown: RowContext, constraint_id: str) -> str:
    """Colour of the curve and its handles."""
    selected = shown.is_selected("constraints", constraint_id)
    return colours.SELECTED_HANDLE if selected else key_colour(shown, constraint_id)


def key_colour(shown: RowContext, constraint_id: str) -> str:
    """Colour of a constraint's keys."""
    constraint = shown.project.constraints[constraint_id]
    return colours.kind_colour(constraint.kind) if constraint.enabled else colours.TEXT_THIRD


def paint_handles(painter: QPainter, row: QRect, shown: RowContext, constraint_id: str) -> None:
    """Draw the four handles of the activation."""
    constraint, selected = shown.project.constraints[constraint_id], shown.is_selected("constraints", constraint_id)
    line = line_colour(shown, constraint_id)
    for part, point in handle_points(shown, row, constraint).items():
        focused = selected and shown.handle == part
        paint_dot(painter, point, 4.5 if selected else 3.5, line, colours.PLAYHEAD if focused else colours.PANEL)


def paint_constraint_label(painter: QPainter, row: QRect, shown: RowContext, constraint_id: str) -> None:
    """Paint priority and name of the constraint, and the performer with the worst residual."""
    constraint = shown.project.constraints[constraint_id]
    order = shown.project.places_of(constraint.motion_id)[constraint_id]
    area = label_area(row)
    folded = is_folded(row)
    top = QRect(area.left(), area.top() + (1 if folded else CURVE_TOP_PX - 2), area.width(), 20)
    name_colour = colours.TEXT if constraint.enabled else colours.TEXT_THIRD
    paint_fold(painter, top, folded)
    if constraint.scope.is_narrow:  # the dot of whom alone it is asked
        performer = shown.project.performers[shown.subject.performer_id]
        body = shown.project.characters[performer.character_id].colour
        paint_dot(painter, QPointF(area.right() - 12.0, top.center().y() + 0.5), 3.5, body)
        top = top.adjusted(0, 0, -14, 0)
    paint_label(painter, top, f"{order}  {constraint.name}", name_colour)
    if not folded:
        text, colour = residual_text(shown, constraint_id)
        paint_label(painter, QRect(area.left(), top.top() + 18, area.width(), 20), text, colour, 11)


def constraint_hit(shown: RowContext, row: QRect, constraint_id: str, point: QPointF) -> Hit:
    """Nearest handle within reach, else the bar, else the empty space of the track."""
    constraint = shown.project.constraints[constraint_id]
    near = {
        part: place
        for part, place in handle_points(shown, row, constraint).items()
        if clipped_span(point, place.x(), place.y(), ACTIVATION_HANDLE_REACH)
    }
    if near:
        return Hit("constraints", constraint_id, _nearest(near, point))
    inside = _curve_path(shown, row, constraint.activation).contains(point)
    return Hit("constraints", constraint_id, ItemPart.BODY if inside else ItemPart.EMPTY)


def _nearest(near: dict[ItemPart, QPointF], point: QPointF) -> ItemPart:
    """Handle to be grabbed of those at the same pixel: from the left the earlier one, from the right the later one."""
    return min(
        near,
        key=lambda part: (
            round((near[part] - point).manhattanLength()),
            HANDLE_PARTS.index(part) * (1 if point.x() <= near[part].x() else -1),
        ),
    )


def _paint_later_repeats(painter: QPainter, row: QRect, shown: RowContext, constraint_id: str, colour: str) -> None:
    """Paint the activation in later loops of the clip, without handles."""
    performer, subject = shown.project.performers[shown.subject.performer_id], shown.subject
    later = shown.later_repeats
    if not later:
        return
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(translucent(colour, LATER_REPEAT_OPACITY))
    for asked in constraints_of_performer(shown.project, subject.performer_id):
        is_shown = asked.constraint_id == constraint_id and asked.repeat in later
        if is_shown and performer.clips[asked.clip].id == subject.clip.id:
            delay = asked.repeat * subject.repeat_seconds
            begin = shown.axis.x_of_time(subject.clip.start + delay)
            painter.save()
            painter.setClipRect(QRectF(begin, row.top(), subject.repeat_seconds * shown.axis.scale, row.height()))
            painter.drawPath(_curve_path(shown, row, asked.constraint.activation, delay))
            painter.restore()


def _curve_path(shown: RowContext, row: QRect, curve: ActivationCurve, delay: float = 0.0) -> QPainterPath:
    """Path of the activation over the visible pixels, closed along the baseline, shifted by ``delay`` seconds for a
    later loop.
    """
    axis = shown.axis
    corners = (curve.start, curve.full, curve.full_end, curve.end)
    corner_xs = [shown.x_of_motion_time(time) + delay * axis.scale for time in corners]
    left, right = max(corner_xs[0], axis.left - 20), min(corner_xs[-1], axis.right + 20)
    path = QPainterPath()
    if left > right:
        return path
    ramps = [np.linspace(corner_xs[k], corner_xs[k + 1], RAMP_POINTS) for k in (0, 2)]
    xs = np.unique(np.clip([left, *ramps[0], *ramps[1], right], left, right))
    stage_seconds = axis.start + (xs - axis.left) / axis.scale - delay
    times = np.clip(shown.subject.to_motion(stage_seconds), curve.start, curve.end)
    low = baseline(row) + 0.5
    ys = low - curve_height(row) * curve.at(times)
    outline = [QPointF(left, low), *map(QPointF, xs.tolist(), ys.tolist()), QPointF(right, low)]
    path.addPolygon(QPolygonF(outline))
    path.closeSubpath()
    return path


def strip_top(row: QRect, index: int) -> int:
    """Top pixel of the error strip with an index."""
    return baseline(row) + 1 + STRIP_GAP_PX + STRIP_SPACING_PIXELS * index


def _paint_strips(painter: QPainter, row: QRect, shown: RowContext, constraint_id: str) -> None:
    constraint = shown.project.constraints[constraint_id]
    left, right = (shown.x_of_motion_time(time) for time in (constraint.activation.start, constraint.activation.end))
    for index, body in enumerate(bodies_of(shown, row, constraint_id) if constraint.enabled else ()):
        strip, top = shown.strip(constraint_id, body.performer_id), strip_top(row, index)
        if not shown.applies_to(constraint_id, body.performer_id):
            continue
        if strip is not None:
            begin, end = (shown.axis.x_of_time(time) for time in strip.span or (0.0, 0.0))
            ends = (min(left, begin), max(right, end)) if strip.span else (left, right)
            paint_strip(painter, shown, strip, *ends, top, body.colour)
        else:
            paint_unknown(painter, shown.axis.right, left, right, top, body.colour)


def bodies_of(shown: RowContext, row: QRect, constraint_id: str) -> tuple[BodyOnTimeline, ...]:
    """Performers with error strips in a track: all, or in a collapsed track the one with the worst or an unknown
    residual.
    """
    bodies = tuple(shown.subject.bodies)
    asked = [body for body in bodies if shown.applies_to(constraint_id, body.performer_id)]
    if not is_folded(row) or not asked:
        return bodies

    def weight(body: BodyOnTimeline) -> float:
        if shown.strip(constraint_id, body.performer_id) is None:
            return float("inf")
        worst = shown.residual(constraint_id, body.performer_id)
        return worst.weight if worst else 0.0

    return (max(asked, key=weight),)


def strip_body(shown: RowContext, row: QRect, constraint_id: str, y: float) -> str | None:
    """Id of the performer whose error strip is at the pixel ``y``; None if there is none."""
    bodies, place = bodies_of(shown, row, constraint_id), int((y - strip_top(row, 0)) // STRIP_SPACING_PIXELS)
    return bodies[place].performer_id if 0 <= place < len(bodies) else None


def residual_text(shown: RowContext, constraint_id: str) -> tuple[str, str]:
    """Worst residual as text, ``Child 42 mm at frame 23``, or that the constraint is held by all or not solved; and the
    colour of the state.
    """
    if not shown.project.constraints[constraint_id].enabled:
        return "off", colours.TEXT_THIRD
    bodies = [body for body in shown.subject.bodies if shown.applies_to(constraint_id, body.performer_id)]
    strips = [shown.strip(constraint_id, body.performer_id) for body in bodies]
    unknown = strips.count(None)
    if unknown:
        who = "" if unknown == len(strips) else f" for {unknown} of {len(strips)}"
        return f"{unsolved_words(shown.live)}{who}", colours.TEXT_THIRD
    found = [(shown.residual(constraint_id, body.performer_id), body.name) for body in bodies]
    missed = [(residual, name) for residual, name in found if residual is not None and not residual.is_invisible]
    if not missed:
        acting = sum(residual is not None for residual, _ in found)
        if not acting:
            reasons = {shown.inactivity(constraint_id, body.performer_id) for body in bodies}
            reason = max(reasons, key=list(Inactive).index, default=Inactive.ELSEWHERE)
            return reason, reason.colour
        if any(strip.yields for strip in strips if strip):
            return Inactive.OVERRIDDEN, Inactive.OVERRIDDEN.colour
        eases = any(strip.misses for strip in strips if strip)
        which = "all" if acting == len(strips) else f"{acting} of {len(strips)}"
        on = f" on {which} characters" if len(strips) > 1 else ""
        return f"met{on}{' at full activation' if eases else ''}", colours.TEXT_THIRD
    worst, name = max(missed, key=lambda each: each[0].weight)
    text = f"{name} {worst.text} at {frame_words(worst.stage_frame, worst.frame)}"
    colour = (
        colours.PARTLY if worst.is_hardly_visible else colours.mixed_colour(colours.NOT_REACHED, colours.TEXT, 0.25)
    )
    return f"{text}, {worst.remark}" if worst.remark else text, colour


def row_background(selected: bool) -> QColor:
    """Background colour of a track's name."""
    return QColor(colours.SELECTED_ROW if selected else colours.PANEL)
