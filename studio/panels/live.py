"""What the panels ask of the engine."""

from typing import Any, Protocol

from studio.core.solver.request import AdaptedMotion


class Live(Protocol):
    """Keeps every visible performer's adapted motion up to date (``studio.engine`` has the real one)."""

    adapted: Any
    """Signal(str): a newer result of that performer is there."""
    interactive: bool

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """The newest adapted motion."""
