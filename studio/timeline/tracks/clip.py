"""The clip bar of the active performer."""

from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from studio.document import colours
from studio.engine.empty_stage import HIDDEN, empty_words
from studio.timeline.figures import rate
from studio.timeline.shown import Hit, Part, Shown, label_area
from studio.timeline.tracks.brush import LABEL_INDENT, font, paint_bar, paint_dot, paint_label

HEIGHT = 24
FILL = colours.mixed(colours.CONTROL, colours.KINDS["position"], 0.28)


def clip_bar(shown: Shown, row: QRect) -> QRectF:
    """Where the clip lies."""
    clip = shown.subject.clip
    left, right = shown.x_of_frame(clip.first), shown.x_of_frame(clip.last)
    return QRectF(left, row.top() + 3, max(right - left, 2.0), row.height() - 6)


def clip_text(shown: Shown) -> str:
    """``front_kick · 70 frames at 30 Hz → 5 bodies``; where all are hidden, that."""
    subject = shown.subject
    frames = subject.clip.last - subject.clip.first + 1
    bodies = len(subject.bodies)
    what = f"{subject.motion.name} · {frames} frame{'' if frames == 1 else 's'} at {rate(subject.frame_rate)}"
    if not bodies:
        return f"{what} · {HIDDEN if empty_words(shown.project) == HIDDEN else 'no body that is shown plays it'}"
    return f"{what} → {bodies} {'body' if bodies == 1 else 'bodies'}"


def other_bars(shown: Shown, row: QRect) -> list[tuple[QRectF, str]]:
    """Where the other clips of the performer lie, and the names of their motions."""
    project, own = shown.project, shown.subject.clip
    bars = []
    for clip in project.performers[shown.subject.performer_id].clips:
        if clip is not own:
            end = clip.start + clip.length(project.frame_rate_of(clip))
            left, right = shown.axis.x_of_time(clip.start), shown.axis.x_of_time(end)
            bar = QRectF(left, row.top() + 3, max(right - left, 2.0), row.height() - 6)
            bars.append((bar, project.motions[clip.motion_id].name))
    return bars


def paint_clip(painter: QPainter, row: QRect, shown: Shown) -> None:
    """A quiet bar that says what plays on how many bodies, among the performer's other clips."""
    for other, name in other_bars(shown, row):
        paint_bar(painter, other, QColor(colours.CONTROL), 3)
        painter.setFont(font())
        painter.setPen(QColor(colours.TEXT_SECOND))
        inside = other.intersected(QRectF(shown.axis.left, other.top(), shown.axis.width, other.height()))
        painter.drawText(inside.adjusted(10, 0, -4, 0), Qt.AlignmentFlag.AlignVCenter, name)
    bar = clip_bar(shown, row)
    paint_bar(painter, bar, QColor(FILL), 3)
    painter.setFont(font())
    painter.setPen(QColor(colours.TEXT))
    visible = bar.intersected(QRectF(shown.axis.left, bar.top(), shown.axis.width, bar.height()))
    painter.drawText(visible.adjusted(10, 0, -4, 0), Qt.AlignmentFlag.AlignVCenter, clip_text(shown))


def paint_clip_label(painter: QPainter, row: QRect, shown: Shown) -> None:
    """Whose clip it is, with the body's colour."""
    performer = shown.project.performers[shown.subject.performer_id]
    colour = shown.project.characters[performer.character_id].colour
    paint_dot(painter, QPointF(LABEL_INDENT + 3.5, row.center().y() + 0.5), 3.5, colour)
    paint_label(painter, label_area(row).adjusted(14, 0, 0, 0), performer.name, colours.TEXT)


def clip_hit(shown: Shown, row: QRect, point: QPointF) -> Hit:
    """The clip's performer."""
    part = Part.BODY if clip_bar(shown, row).contains(point) else Part.EMPTY
    return Hit("performers", shown.subject.performer_id, part)
