"""The engine's part for views under test: motions are those that a test puts there."""

from PySide6.QtCore import QObject, Signal

from studio.core.solver.request import AdaptedMotion
from studio.document.document import Document
from studio.engine.live_play import LivePlay


class SolvedLive(QObject):
    """``Live`` without a solver; ``results`` by performer are empty at first."""

    adapted = Signal(str)
    reported_changed = Signal()
    interactive_changed = Signal(bool)
    ready = True

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.play = LivePlay(document, lambda _: None, self)
        self.results: dict[str, AdaptedMotion] = {}
        self._interactive = False

    @property
    def interactive(self) -> bool:
        return self._interactive

    @interactive.setter
    def interactive(self, value: bool) -> None:
        self._interactive = value

    def reported_motion(self, performer_id: str) -> AdaptedMotion | None:
        return self.result(performer_id)

    def asked_at(self, performer_id: str) -> float | None:
        return 0.0

    def result(self, performer_id: str) -> AdaptedMotion | None:
        return self.results.get(performer_id)

    def failure(self, performer_id: str) -> str:
        return ""

    def solve_frame(self, seconds: float) -> None:
        pass

    def shown_frame(self, performer_id: str) -> AdaptedMotion | None:
        return self.result(performer_id)

    def is_eased(self, performer_id: str) -> bool:
        return True

    def source(self, motion_id: str) -> AdaptedMotion | None:
        return None
