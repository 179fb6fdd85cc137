"""What the views ask of the engine."""

from typing import Any, Protocol

from studio.core.solver.request import AdaptedMotion


class Live(Protocol):
    """Keeps every visible performer's adapted motion up to date (``LiveAdaptation`` is the real one)."""

    adapted: Any
    """Signal(str): a newer result of that performer is there."""
    interactive: bool
    """Whether something is being dragged: then the frames round the playhead are solved first."""

    told_changed: Any
    """Signal(): what ``told`` gives is to be read anew."""

    def told(self, performer_id: str) -> AdaptedMotion | None:
        """The motion by which every view tells how well constraints hold, so that all say one number at one moment.

        None while what is asked now is not solved for the whole clip; while something is dragged, the newest answers.
        """

    def asked_at(self, performer_id: str) -> float | None:
        """When (``time.monotonic``) that was asked which the newest result answers; None while there is none."""

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """The newest adapted motion."""

    def failure(self, performer_id: str) -> str:
        """Why a performer cannot be adapted, in a sentence; empty for who is, or is on the way."""

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """The capture on its actor's own body."""
