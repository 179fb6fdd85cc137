"""Transition from one clip of a track to the next: a mark on the bar, and a sentence about it."""

from dataclasses import dataclass
from itertools import pairwise

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter, QPolygonF

from studio.core.normalized.compose import Composite
from studio.core.normalized.joining import FOOT_STEP_LIMIT
from studio.core.normalized.pieces import PlayedPiece
from studio.core.stage.clip import Clip
from studio.document import colours
from studio.timeline.shown import RowContext
from studio.timeline.tracks.brush import hairline, translucent

CHANGE_HALF_WIDTH = 4.0
"""Half of the width in pixels of the mark."""


@dataclass(frozen=True)
class ClipTransition:
    """Transition into a clip, ``after`` seconds from its start: a ``cut`` without blend, a cross-fade if it ``fades``,
    else an inertialised one.
    """

    after: float
    cut: bool
    fades: bool
    overlaps: bool

    def words(self, clip: Clip) -> str:
        """Sentence about the transition, with advice if it looks wrong."""
        at = f"{clip.start + self.after:.3f} s"
        if self.cut:
            return (
                f"Pop at {at}: the clip starts more than {FOOT_STEP_LIMIT:g} leg lengths away, farther than a step."
                " Choose Match previous clip, or move it nearer"
            )
        if self.fades:
            return f"Cross-fades from {at}, because hands, knees or seat are in ground contact on this track or a layer"
        alike = ", at the best matching frame" if self.overlaps else ""
        return f"Transition at {at}{alike}: continues from the current pose; planted feet stay until they are lifted"


def clip_transition(shown: RowContext, performer_id: str, clip: Clip) -> ClipTransition | None:
    """Transition into a clip of a performer; None for the first clip, and until it is solved.

    During a drag of the clip it is the last solved transition, which moves with the clip.
    """
    result, clips = shown.result(performer_id), shown.project.performers[performer_id].clips
    if result is None or result.composite is None or clip not in clips:
        return None
    for before, played in pairwise(result.composite.played):
        if played.piece.origin == (clips.index(clip), 0):
            return _from(before, played, result.composite)
    return None


def _from(before: PlayedPiece, played: PlayedPiece, composite: Composite) -> ClipTransition | None:
    """Transition between two pieces of a composite; None if the second continues the first, as parts of a split clip
    do.
    """
    after = composite.timing.stage_time(played.first) - played.piece.start
    overlaps, changes = before.piece.end > played.piece.start, composite.motion.changes
    change = next((each for each in changes if each.first == played.first), None)
    if change is None and (changes or not overlaps):
        return None
    return ClipTransition(after, change is not None and change.cut, change is None, overlaps)


def paint_take_over(painter: QPainter, bar: QRectF, x: float, cut: bool) -> None:
    """Paint a line with a head across a bar at its transition; amber for a pop."""
    colour = colours.PARTLY if cut else colours.TEXT
    painter.setPen(hairline(translucent(colour, 0.9), 1.2))
    painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.bottom()))
    painter.setBrush(QColor(colour))
    corners = ((-CHANGE_HALF_WIDTH, 0.0), (CHANGE_HALF_WIDTH, 0.0), (0.0, CHANGE_HALF_WIDTH))
    painter.drawPolygon(QPolygonF([QPointF(x + dx, bar.top() + dy) for dx, dy in corners]))
