"""Short animation of the camera from one view to another."""

from collections.abc import Callable

from PySide6.QtCore import QEasingCurve, QObject, QVariantAnimation

from studio.viewport.camera import OrbitCamera

ANIMATION_MILLISECONDS = 120


class CameraAnimation(QObject):
    """Animation of ``ANIMATION_MILLISECONDS``; starting a new one replaces it."""

    def __init__(self, show: Callable[[OrbitCamera], None], parent: QObject) -> None:
        super().__init__(parent)
        self._show = show
        self._begin = self._end = OrbitCamera()
        self._animation = QVariantAnimation(self)
        self._animation.setDuration(ANIMATION_MILLISECONDS)
        self._animation.setEasingCurve(QEasingCurve.Type.OutCubic)
        self._animation.setStartValue(0.0)
        self._animation.setEndValue(1.0)
        self._animation.valueChanged.connect(self._step)

    def start(self, begin: OrbitCamera, end: OrbitCamera) -> None:
        """Animate the camera from ``begin`` to ``end``; does nothing if they are equal."""
        if begin == end:
            return
        self._animation.stop()
        self._begin, self._end = begin, end
        self._animation.start()

    def stop(self) -> None:
        """Stop the animation."""
        self._animation.stop()

    @property
    def moving(self) -> bool:
        """True during an animation."""
        return self._animation.state() == QVariantAnimation.State.Running

    def _step(self, share: float) -> None:
        self._show(self._end if share >= 1.0 else self._begin.towards(self._end, share))
