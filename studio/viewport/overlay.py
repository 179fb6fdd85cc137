"""Painting over the 3D image: constraint handles, joints, markers and names."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from studio.document import colours
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.handles import Handle
from studio.viewport.optical_recording import MarkerFrame
from studio.viewport.paths import TrailKeys
from studio.viewport.strokes import STROKE_SHADOW, draw_disc, draw_line, polygon

GHOST_COLOUR = QColor(196, 204, 214, 215)
MARKER_COLOUR, OTHER_MARKER_COLOUR = QColor("#f0f4f8"), QColor(142, 152, 164, 170)
CHOSEN_MARKER_COLOUR = QColor(colours.STAGE_PLAYHEAD)

NOTICE_BOTTOM_PX = 150.0
"""Distance in pixels from the lower edge to the text on an empty stage, which leaves room for a message of two
lines.
"""


NAME_MARGIN_PX = 21.0
"""Minimum distance in pixels of a name below the chips."""
TRAIL_KEY_CORNERS = 5.0 * np.array([(-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)])
"""Pixels from the centre of a key's diamond on a trail to its corners."""
MIN_GAZE_OPACITY = 0.6
"""Minimum opacity of the line from the eyes to a look-at target."""
JOINT_COLOUR = QColor(colours.STAGE_SELECTED_HANDLE)
"""Radius of the dots at joints that can be picked."""


class Overlay:
    """Painter of stage items, for one camera; sizes are in logical pixels."""

    def __init__(self, painter: QPainter, camera: OrbitCamera, size: tuple[float, float]) -> None:
        self._painter, self._camera, self._size = painter, camera, size
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def handles(self, handles: Iterable[Handle], selected: set[str]) -> None:
        """Paint figures and targets of constraints in the colour of their kind, with lines to targets that are not
        reached.
        """
        for handle in handles:
            chosen = handle.constraint_id in selected
            self._figure(handle, chosen)
            if handle.target is None:
                continue
            pixels, depth = self._camera.project(handle.target, self._size)
            if depth[0] <= 0:
                continue
            colour = QColor(colours.kind_colour(handle.kind))
            if not handle.is_primary:
                colour.setAlpha(220 if handle.activation > 0 else 90)
                draw_disc(self._painter, pixels[0], 3.5, colour)
                continue
            colour.setAlpha(255 if handle.activation > 0 else 130)
            self._target(pixels[0], colour, chosen)

    def ghost(self, points: FloatArray, pairs: NDArray[np.intp]) -> None:
        """Paint the source as grey sticks, visible through everything: ``pairs`` (B, 2) of ``points`` (N, 3)."""
        pixels, depth = self._camera.project(points, self._size)
        if (depth <= 0).any():
            return
        sticks = [QLineF(QPointF(*pixels[begin]), QPointF(*pixels[end])) for begin, end in pairs]
        for colour, width in ((STROKE_SHADOW, 4.5), (GHOST_COLOUR, 2.5)):
            self._painter.setPen(QPen(colour, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            self._painter.drawLines(sticks)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(GHOST_COLOUR)
        for x, y in pixels:
            self._painter.drawEllipse(QPointF(x, y), 2.8, 2.8)

    def trail_keys(self, keys: Iterable[TrailKeys]) -> None:
        """Paint diamonds on motion trails at the times of keys."""
        for each in keys:
            pixels, depth = self._camera.project(each.points, self._size)
            self._painter.setPen(QPen(STROKE_SHADOW, 1.5))
            self._painter.setBrush(QColor(each.colour))
            for place in pixels[depth > 0]:
                self._painter.drawPolygon(polygon(place + TRAIL_KEY_CORNERS))

    def markers(self, recording: MarkerFrame, marked: Collection[str], named: bool) -> None:
        """Paint dots, visible through everything and fainter for markers outside the map; labels of highlighted ones,
        or of all if ``named``.
        """
        if not len(recording.points):
            return
        pixels, depth = self._camera.project(recording.points, self._size)
        self._painter.setPen(Qt.PenStyle.NoPen)
        for label, used, pixel, ahead in zip(recording.labels, recording.used, pixels, depth, strict=True):
            if ahead <= 0:
                continue
            chosen = label in marked
            draw_disc(
                self._painter,
                pixel,
                5.5 if chosen else 3.2,
                CHOSEN_MARKER_COLOUR if chosen else MARKER_COLOUR if used else OTHER_MARKER_COLOUR,
            )
            if chosen or named:
                self._name(pixel, label, CHOSEN_MARKER_COLOUR if chosen else MARKER_COLOUR, 12 if chosen else 10)

    def _name(self, position: FloatArray, words: str, colour: QColor, height: int) -> None:
        font = self._painter.font()
        font.setPixelSize(height)
        self._painter.setFont(font)
        where = QPointF(*position) + QPointF(8.0, -5.0)
        self._painter.setPen(STROKE_SHADOW)
        self._painter.drawText(where + QPointF(1.0, 1.0), words)
        self._painter.setPen(colour)
        self._painter.drawText(where, words)

    def names(self, tops: Mapping[str, FloatArray], least: float = 0.0) -> None:
        """Paint names above the tops of heads ``tops`` (3,), at least ``least`` pixels below the upper edge."""
        for name, top in tops.items():
            pixels, depth = self._camera.project(top, self._size)
            if depth[0] > 0:
                x, y = (pixels[0] + [-3.3 * len(name) - 8.0, -10.0]).tolist()
                self._name(np.array([x, max(y, least + NAME_MARGIN_PX)]), name, MARKER_COLOUR, 12)

    def joints(self, positions: FloatArray) -> None:
        """Paint dots at the pickable joints ``positions`` (J, 3)."""
        pixels, depth = self._camera.project(positions, self._size)
        for pixel, ahead in zip(pixels, depth, strict=True):
            if ahead > 0:
                draw_disc(self._painter, pixel, 3.0, JOINT_COLOUR)

    def joint(self, position: FloatArray, colour: str, strong: bool) -> None:
        """Paint a ring around a joint: ``strong`` for the picked one, thin for the hovered one."""
        pixels, depth = self._camera.project(position, self._size)
        if depth[0] <= 0:
            return
        centre = QPointF(*pixels[0])
        self._painter.setBrush(Qt.BrushStyle.NoBrush)
        for width, hue in ((4.0, STROKE_SHADOW), (2.0, QColor(colour))) if strong else ((1.4, QColor(colour)),):
            self._painter.setPen(QPen(hue, width))
            self._painter.drawEllipse(centre, 8.0 if strong else 6.0, 8.0 if strong else 6.0)
        if strong:
            draw_disc(self._painter, pixels[0], 2.5, QColor(colour))

    def notice(self, words: str, share: float | None) -> None:
        """Paint one line of text, with a progress bar for a running task whose progress is ``share`` (0 to 1)."""
        font = self._painter.font()
        font.setPixelSize(13)
        self._painter.setFont(font)
        width = self._painter.fontMetrics().horizontalAdvance(words) + 40.0
        middle, top = self._size[0] / 2, self._size[1] - NOTICE_BOTTOM_PX
        plate = QRectF(middle - width / 2, top, width, 34.0 if share is None else 46.0)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(QColor(22, 25, 29, 225))
        self._painter.drawRoundedRect(plate, 11.0, 11.0)
        self._painter.setPen(QColor(colours.STAGE_TEXT))
        self._painter.drawText(QRectF(plate.topLeft(), QSizeF(width, 34.0)), Qt.AlignmentFlag.AlignCenter, words)
        if share is not None:
            self._painter.setPen(Qt.PenStyle.NoPen)
            for colour, part in ((colours.STAGE_CONTROL, 1.0), (colours.KIND_COLOURS["position"], share)):
                self._painter.setBrush(QColor(colour))
                bar = QRectF(plate.left() + 20.0, top + 33.0, (width - 40.0) * part, 4.0)
                self._painter.drawRoundedRect(bar, 2.0, 2.0)

    def _figure(self, handle: Handle, chosen: bool) -> None:
        """Paint the lines of a figure; fainter on performers that are not active, and while the constraint is
        inactive.
        """
        figure, colour = handle.figure, colours.kind_colour(handle.kind)
        if figure.only_chosen and not (chosen and handle.is_primary):
            return
        strength = (0.95 if chosen else 0.6) if handle.is_primary else 0.3
        strength *= 0.4 if figure.only_chosen else 1.0
        strength *= 1.0 if handle.activation > 0 else 0.5
        for face in figure.faces:
            self._face(face, colour, 0.25 * strength)
        for line in figure.lines:
            self._thin(
                line, colours.STAGE_NOT_REACHED if handle.is_missed and figure.link is None else colour, strength
            )
        if figure.link is not None and (handle.is_missed or figure.link_always):
            gazes = handle.kind == "look_at" and handle.activation > 0.0
            self._link(handle, figure.link, colour, max(strength, MIN_GAZE_OPACITY) if gazes else strength)

    def _link(self, handle: Handle, link: FloatArray, colour: str, strength: float) -> None:
        """Paint a line from the current state to the target: red and strong if it is not reached, else faint with a dot
        at each end.
        """
        pixels, depth = self._camera.project(link, self._size)
        if (depth <= 0).any():
            return
        if handle.is_missed:
            draw_line(self._painter, pixels[0], pixels[1], colours.STAGE_NOT_REACHED, 2.0 if handle.is_primary else 1.2)
            return
        self._thin(link, colour, strength)
        dot = QColor(colour)
        dot.setAlphaF(strength)
        for pixel in pixels if handle.is_primary or handle.kind == "look_at" else ():
            draw_disc(self._painter, pixel, 3.0, dot)

    def _thin(self, points: FloatArray, colour: str, strength: float) -> None:
        """Paint a line through ``points`` (N, 3), as far as they are in front of the camera."""
        pixels, depth = self._camera.project(points, self._size)
        if (depth <= 0).any():
            return
        corners = polygon(pixels)
        self._painter.setBrush(Qt.BrushStyle.NoBrush)
        for hue, width, alpha in ((STROKE_SHADOW, 3.4, 0.6), (QColor(colour), 1.8, 1.0)):
            hue = QColor(hue)
            hue.setAlphaF(hue.alphaF() * strength * alpha)
            self._painter.setPen(QPen(hue, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            self._painter.drawPolyline(corners)

    def _face(self, points: FloatArray, colour: str, strength: float) -> None:
        pixels, depth = self._camera.project(points, self._size)
        if (depth <= 0).any():
            return
        fill = QColor(colour)
        fill.setAlphaF(strength)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(fill)
        self._painter.drawPolygon(polygon(pixels))

    def _target(self, position: FloatArray, colour: QColor, selected: bool) -> None:
        draw_disc(self._painter, position, 6.0, colour)
        x, y = position
        self._painter.setPen(QPen(QColor(255, 255, 255, 200), 1.2))
        self._painter.drawLine(QPointF(x - 3, y), QPointF(x + 3, y))
        self._painter.drawLine(QPointF(x, y - 3), QPointF(x, y + 3))
        if selected:
            self._painter.setBrush(Qt.BrushStyle.NoBrush)
            self._painter.setPen(QPen(QColor("#ffffff"), 2.0))
            self._painter.drawEllipse(QPointF(x, y), 10.0, 10.0)


def twin_heads(posed: Mapping[str, PosedPerformer]) -> dict[str, FloatArray]:
    """(3,) tops of the heads, in metres, of performers that share a character, by their distinguishing names."""
    seen = Counter(pose.performer.character_id for pose in posed.values())
    return {
        pose.performer.name: pose.points[pose.motion.morphology.layout.head_end]
        for pose in posed.values()
        if seen[pose.performer.character_id] > 1
    }
