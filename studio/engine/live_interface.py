"""Interface of the engine for the views."""

from typing import TYPE_CHECKING, Protocol

from PySide6.QtCore import SignalInstance

from studio.core.solver.request import AdaptedMotion

if TYPE_CHECKING:
    from studio.engine.live_play import LivePlay


class Live(Protocol):
    """Keeps every visible performer's adapted motion up to date (``LiveAdaptation`` is the real one)."""

    interactive: bool
    """True during a drag: whole clips are then solved when it rests."""

    @property
    def adapted(self) -> SignalInstance:
        """Signal(str): a newer result of that performer is available."""

    @property
    def ready(self) -> bool:
        """True once the kernels of constraints are compiled."""

    @property
    def interactive_changed(self) -> SignalInstance:
        """Signal(bool): a drag has begun or ended."""

    @property
    def play(self) -> "LivePlay":
        """The stage as it plays live."""

    @property
    def reported_changed(self) -> SignalInstance:
        """Signal(): ``reported_motion`` has a new value."""

    def reported_motion(self, performer_id: str) -> AdaptedMotion | None:
        """Motion from which every view reports the residuals, so that all show the same number at one moment.

        None while the present request is not solved for the whole clip; during a drag, the newest result.
        """

    def asked_at(self, performer_id: str) -> float | None:
        """Time (``time.monotonic``) of the latest request that ``shown`` answers; None while there is none.

        A drag is requested when the mouse moves, not when the window handles the event.
        """

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """The newest adapted motion."""

    def failure(self, performer_id: str) -> str:
        """Reason why a performer cannot be adapted, in a sentence; empty if it can, or is being solved."""

    def solve_frame(self, seconds: float) -> None:
        """Solve the frame at ``seconds`` of the stage of every performer whose newest motion is out of date.

        Frames that take too long for one picture are solved in the background; ``adapted`` is emitted for them.
        """

    def shown_frame(self, performer_id: str) -> AdaptedMotion | None:
        """Pose for a picture: the frame solved by ``bring``, else the newest adapted motion."""

    def is_eased(self, performer_id: str) -> bool:
        """True if the result of ``shown`` is smoothed as requested; a solved frame is not."""

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """The capture on its actor's own body."""
