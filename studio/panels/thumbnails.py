"""Thumbnails of captures, characters, poses and scenes; those of the library are drawn in the background and cached."""

import weakref
from collections.abc import Callable, Hashable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPixmap

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.standing import standing_points
from studio.core.body.sticks import bone_pairs
from studio.core.captures.capture import Capture
from studio.core.mannequin.physique import Physique
from studio.core.mesh.character import Character
from studio.core.stage.local_pose import LocalPose, posed_rotations
from studio.document import colours
from studio.document.document import Document
from studio.io.project.project_file import read_thumbnail
from studio.library.scenes import SCENES
from studio.panels.library_rows import BUNDLED_SCENE, SAVED_PROJECT

FloatArray = NDArray[np.float64]

THUMBNAIL_PIXELS = 72
"""Width and height in pixels, twice the size in the list for high resolution screens."""
_POLL_MS = 30
"""Milliseconds between two looks for drawn pictures, while any is being drawn."""
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_MARGIN = 4
_POINTS = 24_000
_LIGHT = np.array([0.8, 0.3, 0.52])
_DARKEST = 0.4
_POSES = ((0.2, -0.3, 70), (0.8, 0.3, 70), (0.5, 0.0, 255))
"""Moment as a fraction of the take, horizontal offset and opacity of each pose in the thumbnail of a capture."""
_POSED_STATURE, _LEAST_HEIGHT = 1.75, 1.2
"""Stature in metres of the body that shows a pose, and minimum height in metres that fills the thumbnail."""
_FROM_AHEAD = np.array([[-0.5, 0.866, 0.0], [-0.13, -0.075, 0.989], [0.857, 0.494, 0.149]])
"""View of a pose thumbnail: the rows are its right, up and towards-viewer axes."""
_FARTHEST = 0.35
"""Brightness of the farthest bone of a pose relative to the nearest."""


class Thumbnails(QObject):
    """Cache of thumbnails by entity. A thumbnail is None until it is drawn; then ``drawn`` is emitted.

    The drawing thread holds only values: an object of Qt whose last reference went on that thread would be destroyed
    there, while the window's thread still delivers its signals.
    """

    drawn = Signal()

    def __init__(self, document: Document) -> None:
        super().__init__()
        self._document = document
        self._pictures: dict[Hashable, tuple[object, QPixmap | None]] = {}
        self._drawings: dict[Hashable, Future[QImage]] = {}
        self._closed = False
        self._executor = ThreadPoolExecutor(1, "thumbnails")
        weakref.finalize(self, self._executor.shutdown, wait=False, cancel_futures=True)
        self._poll = QTimer(self, interval=_POLL_MS)
        self._poll.timeout.connect(self._take)
        document.project_opened.connect(self._pictures.clear)

    def close(self) -> None:
        """Draw no more pictures; the thread ends with the one that it is drawing."""
        self._poll.stop()
        self._closed = True
        self._executor.shutdown(wait=False, cancel_futures=True)

    def of(self, collection: str, entity_id: str) -> QPixmap | None:
        """Thumbnail of a capture, character, performer or scene; None if there is none, or it is not drawn yet."""
        if collection == BUNDLED_SCENE:
            return self._picture((collection, entity_id), None, lambda: bundled_picture(entity_id))
        if collection == SAVED_PROJECT:
            return self._picture((collection, entity_id), None, lambda: saved_picture(Path(entity_id)))
        project = self._document.shown_project
        if collection == "performers" and entity_id in project.performers:
            collection, entity_id = "characters", project.performers[entity_id].character_id
        entity = project.get(collection, entity_id)
        if isinstance(entity, Capture):
            return self._picture(id(entity.poses), entity.poses, lambda: capture_picture(entity))
        if isinstance(entity, Character):
            return self._picture(id(entity.skin), entity.skin, lambda: character_picture(entity))
        return None

    def forget_saved(self) -> None:
        """Read the thumbnails of project files again when they are next shown."""
        for key in [key for key in self._pictures if isinstance(key, tuple) and key[0] == SAVED_PROJECT]:
            del self._pictures[key]

    def _picture(self, key: Hashable, drawn: object, draw: Callable[[], QImage]) -> QPixmap | None:
        """Thumbnail cached by ``key``; ``draw`` is called again only if the object ``drawn`` (poses or skin) is another
        one.
        """
        if key in self._pictures or self._closed:
            return self._pictures.get(key, (None, None))[1]
        self._pictures[key] = (drawn, None)  # kept, so that its id stays its own
        self._drawings[key] = self._executor.submit(draw)
        self._poll.start()
        return None

    def _take(self) -> None:
        """Keep the pictures that have been drawn since the last call."""
        for key in [key for key, drawing in self._drawings.items() if drawing.done()]:
            picture = self._drawings.pop(key).result()
            if key in self._pictures and not picture.isNull():
                self._pictures[key] = (self._pictures[key][0], QPixmap.fromImage(picture))
                self.drawn.emit()
        if not self._drawings:
            self._poll.stop()


def bundled_picture(key: str) -> QImage:
    """Thumbnail of a bundled scene by its key."""
    return _square(next(scene.picture for scene in SCENES if scene.key == key).read_bytes())


def saved_picture(path: Path) -> QImage:
    """Thumbnail stored in a project file; null if there is none."""
    return _square(read_thumbnail(path) or b"")


def _square(content: bytes) -> QImage:
    """Centre square of a PNG file; null if ``content`` is none.

    Qt must not look for another format: its reader of SVG connects signals, and waits for a lock of the window's thread
    that may itself wait for Python.
    """
    image = QImage()
    if content.startswith(_PNG_SIGNATURE):
        image.loadFromData(content, "PNG")
    side = min(image.width(), image.height())
    middle = image.copy((image.width() - side) // 2, (image.height() - side) // 2, side, side)
    smooth = Qt.TransformationMode.SmoothTransformation
    return middle.scaledToWidth(THUMBNAIL_PIXELS, smooth) if side else QImage()


def character_picture(character: Character, size: int = THUMBNAIL_PIXELS) -> QImage:
    """Front view of a character in its bind pose, in its material colours."""
    skin = character.skin
    corner, *others = skin.vertices.astype(np.float64)[skin.triangles].swapaxes(0, 1)
    first, second = (other - corner for other in others)
    crossed = np.cross(first, second)
    areas = np.linalg.norm(crossed, axis=1)
    light = _DARKEST + (1.0 - _DARKEST) * np.clip(crossed @ _LIGHT / np.maximum(areas, 1e-12), 0.0, 1.0)
    materials = skin.appearance.triangle_materials if skin.appearance else np.zeros(len(areas), np.int64)
    shown = np.clip(_colours(character)[materials] * light[:, None], 0.0, 255.0)
    # As many points on each triangle as its share of the surface, the fractions carried on to the next.
    up_to = np.cumsum(areas)
    counts = np.diff((_POINTS / max(up_to[-1], 1e-12) * up_to).astype(np.int64), prepend=0)
    chosen = np.repeat(np.arange(len(areas)), counts) if counts.any() else np.zeros(1, np.int64)
    along = np.random.default_rng(0).random((2, len(chosen), 1))
    along = np.where(along.sum(axis=0) > 1.0, 1.0 - along, along)  # those beyond the triangle, mirrored into it
    points = corner[chosen] + along[0] * first[chosen] + along[1] * second[chosen]
    low, high = points.min(axis=0), points.max(axis=0)
    scale = (size - 2 * _MARGIN - 1) / max(high[1] - low[1], high[2] - low[2], 1e-6)
    column = size / 2 + scale * (points[:, 1] - (low[1] + high[1]) / 2)
    row = size / 2 - scale * (points[:, 2] - (low[2] + high[2]) / 2)
    nearest_last = np.argsort(points[:, 0])
    place = np.clip(np.stack([row, column]).astype(np.int64), 0, size - 1)[:, nearest_last]
    pixels = np.zeros((size, size, 4), np.uint8)
    pixels[place[0], place[1], :3] = shown[chosen[nearest_last]]
    pixels[place[0], place[1], 3] = 255
    return QImage(pixels.tobytes(), size, size, 4 * size, QImage.Format.Format_RGBA8888).copy()


def capture_picture(capture: Capture, size: int = THUMBNAIL_PIXELS) -> QImage:
    """Front view of three poses of a capture, of which the middle one is brightest."""
    picture = QImage(size, size, QImage.Format.Format_ARGB32_Premultiplied)
    picture.fill(Qt.GlobalColor.transparent)
    skeleton = capture.skeleton
    shown = capture.body_map.with_descendants(skeleton) if capture.body_map else list(range(skeleton.joint_count))
    bones = [(joint, parent) for joint in shown if (parent := int(skeleton.parents[joint])) in shown]
    with QPainter(picture) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for moment, across, opacity in _POSES:
            frame = round(moment * (capture.frame_count - 1))
            places = joint_positions(skeleton, capture.poses.frames(frame, frame))[0]
            seen = np.stack([places @ _left_of(capture, places), places[:, 2]], axis=1)
            low, high = seen[shown].min(axis=0), seen[shown].max(axis=0)
            scale = (size - 2 * _MARGIN) / max(float((high - low).max()), 1e-6)
            points = size / 2 + scale * (seen - (low + high) / 2) * [1.0, -1.0] + [across * size, 0.0]
            colour = QColor(colours.TEXT)
            colour.setAlpha(opacity)
            painter.setPen(QPen(colour, size / 28.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawLines([QLineF(*points[parent], *points[joint]) for joint, parent in bones])
    return picture


def pose_picture(pose: LocalPose, size: int = THUMBNAIL_PIXELS) -> QImage:
    """Stick figure of an average body in a pose, seen from the front left; farther bones are darker."""
    body = Physique(_POSED_STATURE).morphology()
    points = standing_points(body, posed_rotations(body.layout, pose))
    seen, depth = points @ _FROM_AHEAD[:2].T, points @ _FROM_AHEAD[2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    scale = (size - 2 * _MARGIN) / max(float((high - low).max()), _LEAST_HEIGHT)
    drawn = size / 2 + scale * (seen - (low + high) / 2) * [1.0, -1.0]
    pairs = bone_pairs(body.layout)
    near = depth[pairs].mean(axis=1)
    shade = _FARTHEST + (1.0 - _FARTHEST) * (near - near.min()) / max(float(np.ptp(near)), 1e-6)
    ends = [QColor(name) for name in (colours.TEXT, colours.PANEL)]
    front, back = np.array([(each.redF(), each.greenF(), each.blueF()) for each in ends])
    picture = QImage(size, size, QImage.Format.Format_ARGB32_Premultiplied)
    picture.fill(Qt.GlobalColor.transparent)
    head = body.layout.segment_of_part(BodyPart.HEAD)
    with QPainter(picture) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for bone in np.argsort(near).tolist():
            colour = QColor.fromRgbF(*(back + shade[bone] * (front - back)))
            painter.setPen(QPen(colour, size / 18.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            begin, end = (QPointF(*drawn[point]) for point in pairs[bone])
            painter.drawLine(begin, end)
            if bone == head:
                painter.setBrush(colour)
                painter.drawEllipse((begin + end) / 2, size / 24.0, size / 24.0)
    return picture


def _colours(character: Character) -> FloatArray:
    """(M, 3) material colours, 0 to 255; the character's colour if it has no materials."""
    look = character.skin.appearance
    names = [material.colour for material in look.materials] if look else [character.colour]
    return np.array([[int(name[place : place + 2], 16) for place in (1, 3, 5)] for name in names], dtype=np.float64)


def _left_of(capture: Capture, positions: FloatArray) -> FloatArray:
    """(3,) horizontal unit vector to the left of a body with joints at ``positions`` (J, 3)."""
    if capture.body_map is None:
        return np.array([0.0, 1.0, 0.0])
    left, right = (positions[capture.body_map[part]] for part in (BodyPart.LEFT_THIGH, BodyPart.RIGHT_THIGH))
    level: FloatArray = (left - right) * [1.0, 1.0, 0.0]
    level /= max(float(np.linalg.norm(level)), 1e-9)
    return level
