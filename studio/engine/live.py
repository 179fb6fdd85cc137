"""Interface of the engine for the views."""

from typing import Any, Protocol

from studio.core.solver.request import AdaptedMotion


class Live(Protocol):
    """Keeps every visible performer's adapted motion up to date (``LiveAdaptation`` is the real one)."""

    adapted: Any
    """Signal(str): a newer result of that performer is there."""
    ready: bool
    """True once the kernels of constraints are compiled."""
    interactive: bool
    """True during a drag: whole clips are then solved when it rests."""
    interactive_changed: Any
    """Signal(bool): a drag has begun or ended."""

    play: Any
    """The stage as it plays live (``LivePlay``)."""

    told_changed: Any
    """Signal(): what ``told`` gives is to be read anew."""

    def told(self, performer_id: str) -> AdaptedMotion | None:
        """The motion by which every view tells how well constraints hold, so that all say one number at one moment.

        None while what is asked now is not solved for the whole clip; while something is dragged, the newest answers.
        """

    def asked_at(self, performer_id: str) -> float | None:
        """When (``time.monotonic``) that was asked last which ``shown`` answers; None while there is none.

        What is dragged is asked when the mouse is moved, not when the window comes to hear of it.
        """

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """The newest adapted motion."""

    def failure(self, performer_id: str) -> str:
        """Reason why a performer cannot be adapted, in a sentence; empty if it can, or is being solved."""

    def bring(self, seconds: float) -> None:
        """Solve the frame at ``seconds`` of the stage of all whose newest motion answers an older question.

        Those for whom a picture has no time are solved beside it; ``adapted`` tells of them.
        """

    def shown(self, performer_id: str) -> AdaptedMotion | None:
        """Pose for a picture: the frame that ``bring`` has solved, else the newest adapted motion."""

    def is_eased(self, performer_id: str) -> bool:
        """True if the result of ``shown`` is smoothed as requested; a solved frame is not."""

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """The capture on its actor's own body."""
