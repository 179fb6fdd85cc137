"""Reference footage panel: the frame at the playhead, scaled to the panel, with a text below."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QShowEvent
from PySide6.QtWidgets import QWidget

from studio.document import colours

FOOTAGE_TEXT_HEIGHT_PX = 20
NO_FOOTAGE_HINT = "No footage yet. File > Add footage… adds a video or an image sequence."


class FootageView(QWidget):
    """Widget that shows one image until another one replaces it."""

    opened = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setAccessibleName("Reference footage")
        self.setMinimumHeight(190)
        self._image = QImage()
        self.words = NO_FOOTAGE_HINT
        """Words below the picture."""

    def sizeHint(self) -> QSize:
        return QSize(316, 210)

    def show_picture(self, picture: NDArray[np.uint8] | None, words: str) -> None:
        """Show an image (height, width, 3) or none, and a text below it."""
        self.words = words
        self.setAccessibleDescription(words)
        self.update()
        if picture is None:
            self._image = QImage()
        else:
            height, width, _ = picture.shape
            image = QImage(np.ascontiguousarray(picture).data, width, height, 3 * width, QImage.Format.Format_RGB888)
            self._image = image.copy()  # its own memory: the frame may go

    @property
    def image(self) -> QImage:
        """Shown image; null if there is none."""
        return self._image

    def showEvent(self, event: QShowEvent) -> None:
        """Emit ``opened``, so that the current frame is loaded."""
        super().showEvent(event)
        self.opened.emit()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the image in its aspect ratio, above the text."""
        area = self.rect().adjusted(0, 0, 0, -FOOTAGE_TEXT_HEIGHT_PX)
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            if not self._image.isNull():
                size = self._image.size().scaled(area.size(), Qt.AspectRatioMode.KeepAspectRatio)
                place = QRect(QPoint(), size)
                place.moveCenter(area.center())
                painter.drawImage(place, self._image)
            below = self.rect().adjusted(8, 0 if self._image.isNull() else area.height(), -8, 0)
            painter.setPen(QColor(colours.TEXT_SECOND))
            painter.drawText(below, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self.words)
