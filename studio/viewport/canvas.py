"""Widget that paints off-screen images rendered by VTK, at most once per event loop iteration."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QCloseEvent,
    QColor,
    QImage,
    QLinearGradient,
    QPainter,
    QPaintEvent,
    QResizeEvent,
)
from PySide6.QtWidgets import QWidget

from studio.document import colours
from studio.viewport.camera import OrbitCamera
from studio.viewport.eyes import ONE_EYE, StereoScene, StereoView
from studio.viewport.resolution_scaling import SLOW_DRAG_SECONDS, SLOW_PLAY_SECONDS, ResolutionScaling

if TYPE_CHECKING:
    from studio.viewport.stage_picture import Pixels, StageScene
    from studio.viewport.stills import AveragedPicture

ANTI_ALIASING_DELAY_MS = 160
"""Milliseconds without motion after which the image is anti-aliased."""
REDRAW_DELAY_MILLISECONDS = 5


class Canvas(QWidget):
    """Widget that shows a scene through a camera. VTK is loaded and started only after the widget was shown."""

    started = Signal()
    """Emitted when the scene was rendered for the first time with its whole content."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.camera = OrbitCamera()
        self.stereo_view = ONE_EYE
        self._scene: StageScene | None = None
        self._still: AveragedPicture | None = None
        self._image = QImage()
        self._sharp_in_hand, self._sharp_at_play = (
            ResolutionScaling(SLOW_DRAG_SECONDS),
            ResolutionScaling(SLOW_PLAY_SECONDS),
        )
        self._stale = True
        self._has_started, self._stopped = False, False
        self._frame_timer = self._single_shot(0, self._draw)
        self._rest_timer = self._single_shot(ANTI_ALIASING_DELAY_MS, self._refine)
        self.setMinimumSize(240, 160)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)

    @property
    def view_size(self) -> tuple[float, float]:
        """Width and height in logical pixels."""
        return float(max(self.width(), 1)), float(max(self.height(), 1))

    @property
    def moving(self) -> bool:
        """True if the next image will soon replace this one, so that anti-aliasing is not worthwhile."""
        return False

    @property
    def is_interacting(self) -> bool:
        """True during a drag, in which the user waits for each image."""
        return False

    def start(self) -> None:
        """Start VTK, unless it runs or was stopped.

        The next two event loop iterations render the empty stage, then its content; compiling all shaders at once would
        freeze the window.
        """
        if self._scene is None and not self._stopped:
            from studio.viewport.stage_picture import StageScene  # heavy: the window is shown before it

            self._scene = StageScene()
            self._frame_timer.start(0)

    def stop(self) -> None:
        """Release VTK; nothing is rendered from now on. May be called twice."""
        self._stopped = True
        self._frame_timer.stop()
        self._rest_timer.stop()
        self._still = None
        if self._scene is not None:
            self._scene.close()
            self._scene = None

    def redraw(self, *_: object) -> None:
        """Update scene and image, once in this event loop iteration."""
        self._stale = True
        self._frame_timer.start(0)

    def schedule_redraw(self) -> None:
        """Update scene and image after a short delay, in which further changes are collected."""
        self._stale = True
        if not self._frame_timer.isActive():
            self._frame_timer.start(REDRAW_DELAY_MILLISECONDS)

    def set_camera(self, camera: OrbitCamera) -> None:
        """Set the camera."""
        if camera != self.camera:
            self.camera = camera
            self._frame_timer.start(0)

    def set_stereo_view(self, sight: StereoView) -> None:
        """Set one or two eyes, and the position of the head."""
        if sight != self.stereo_view:
            self.stereo_view = sight
            self._frame_timer.start(0)

    @property
    def drawn_image(self) -> QImage:
        """Stage as last rendered, without handles and chips; null before the first time."""
        return self._image

    def grab_image(self) -> QImage:
        """Anti-aliased image of the stage, without handles and chips."""
        self.start()
        if self._image.isNull():
            self._draw()
        self._draw()
        while self._still is None or not self._still.complete:
            self._smooth()
        self._take(self._still.pixels)
        return self._image.copy()

    def bring_up_to_date(self, scene: StageScene) -> None:
        """Update the scene; to be overridden."""

    def paint_over(self, painter: QPainter) -> None:
        """Paint over the image in logical pixels; to be overridden."""

    def closeEvent(self, event: QCloseEvent) -> None:
        """Release VTK."""
        self.stop()
        super().closeEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Render in the new size."""
        super().resizeEvent(event)
        self._frame_timer.start(0)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the image and what lies over it."""
        with QPainter(self) as painter:
            if self._image.isNull():
                self._paint_waiting(painter)
                QTimer.singleShot(0, self, self.start)  # VTK comes when the window has been seen
            else:
                fewer = self._image.size() != QSize(*self._device_size())
                painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, fewer)
                painter.drawImage(self.rect(), self._image)
                if self.stereo_view.is_plain:  # else nothing on the stage is where one eye's camera says
                    self.paint_over(painter)
                if self.hasFocus():
                    painter.setPen(QColor(colours.STAGE_SELECTED_CONTROL))
                    painter.setBrush(Qt.BrushStyle.NoBrush)
                    painter.drawRect(self.rect().adjusted(0, 0, -1, -1))

    def sizeHint(self) -> QSize:
        """Minimum useful size."""
        return QSize(960, 600)

    def _paint_waiting(self, painter: QPainter) -> None:
        ground = QLinearGradient(0, 0, 0, self.height())
        ground.setColorAt(0, QColor(colours.VIEWPORT_TOP))
        ground.setColorAt(1, QColor(colours.VIEWPORT_BOTTOM))
        painter.fillRect(self.rect(), ground)
        painter.setPen(QColor(colours.STAGE_TEXT_THIRD))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "Starting the 3D view …")

    def _single_shot(self, milliseconds: int, slot: Callable[[], None]) -> QTimer:
        timer = QTimer(self)
        timer.setSingleShot(True)
        timer.setInterval(milliseconds)
        timer.timeout.connect(slot)
        return timer

    def _device_size(self) -> tuple[int, int]:
        ratio = self.devicePixelRatioF()
        return max(round(self.width() * ratio), 1), max(round(self.height() * ratio), 1)

    def _draw(self) -> None:
        if self._scene is None:
            return
        if self._image.isNull():
            self._take(self.stereo_view.render(self._scene, self.camera, self._device_size()))
            self._frame_timer.start(0)
            return
        if self._stale:
            self._stale = False
            self.bring_up_to_date(self._scene)
        self._still = None
        self._take(self._render(self._scene))
        self._rest_timer.start(ANTI_ALIASING_DELAY_MS)
        if not self._has_started:
            self._has_started = True
            self.started.emit()

    def _render(self, scene: StageScene) -> Pixels:
        """Render the view; in a lower resolution while it moves and rendering is slow."""
        if not self.moving:
            return self.stereo_view.render(scene, self.camera, self._device_size())
        sharpness = self._sharp_in_hand if self.is_interacting else self._sharp_at_play
        begun = time.monotonic()
        pixels = self.stereo_view.render(scene, self.camera, sharpness.size(self._device_size()))
        sharpness.note_duration(time.monotonic() - begun)
        return pixels

    def _take(self, pixels: Pixels) -> None:
        pixels = np.ascontiguousarray(pixels)
        height, width = pixels.shape[:2]
        image = QImage(pixels.data, width, height, 4 * width, QImage.Format.Format_RGBX8888)
        self._image = image.convertToFormat(QImage.Format.Format_RGB32)  # painting, and widening most, takes half then
        if self.moving:
            self.repaint()  # at once: the next move of the mouse would be worked on before
        else:
            self.update()

    def _refine(self) -> None:
        """Add one anti-aliasing sample per event loop iteration while nothing moves."""
        if self._scene is None or self.moving:
            return
        if self._still is not None and self._still.complete:
            return
        if self._still is None:
            self._sharp_in_hand.note_rest()
            self._sharp_at_play.note_rest()
        self._smooth()
        if self._still is not None and self._still.complete:
            self._take(self._still.pixels)
        self._rest_timer.start(0)

    def _smooth(self) -> None:
        from studio.viewport.stills import AveragedPicture

        assert self._scene is not None
        if self._still is None:
            self._still = AveragedPicture(StereoScene(self._scene, self.stereo_view), self.camera, self._device_size())
        else:
            self._still.refine()
