"""What the viewport asks of the engine."""

from typing import Any, Protocol

from studio.core.solver.request import AdaptedMotion


class Live(Protocol):
    """Keeps every visible performer's adapted motion up to date (``studio.engine`` has the real one)."""

    adapted: Any
    """Signal(str): a newer result of that performer is there."""
    solve_milliseconds: float
    interactive: bool

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """The newest adapted motion."""

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """The capture on its actor's own body."""
