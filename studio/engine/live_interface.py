"""Interface of the solver front end for the views."""

from typing import TYPE_CHECKING, Protocol

from PySide6.QtCore import SignalInstance

from studio.core.solver.request import AdaptedMotion

if TYPE_CHECKING:
    from studio.engine.live_play import LivePlay


class Live(Protocol):
    """Source of every visible performer's adapted motion, kept up to date; implemented by ``LiveAdaptation``."""

    interactive: bool
    """True during a drag; whole motions are then solved only while it pauses."""

    @property
    def adapted(self) -> SignalInstance:
        """Signal(str): a newer adapted motion of the performer with this id is available."""

    @property
    def ready(self) -> bool:
        """True once the kernels of constraints are compiled."""

    @property
    def interactive_changed(self) -> SignalInstance:
        """Signal(bool): a drag has begun or ended."""

    @property
    def play(self) -> "LivePlay":
        """Live play of the document's stage."""

    @property
    def reported_changed(self) -> SignalInstance:
        """Signal(): ``reported_motion`` has a new value."""

    def reported_motion(self, performer_id: str) -> AdaptedMotion | None:
        """Motion from which all views report residuals, so that they agree at any moment.

        None while the whole motion is not solved for the current request; during a drag, the newest result.
        """

    def asked_at(self, performer_id: str) -> float | None:
        """Clock time (``time.monotonic``) of the latest request that ``shown_frame`` was solved for; None if there is
        none.

        During a drag it is the time of the mouse move, not the time at which the window handles the event.
        """

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """Newest adapted motion of a performer; None if there is none."""

    def failure(self, performer_id: str) -> str:
        """Sentence why a performer cannot be adapted; empty if it can be, or is being solved."""

    def solve_frame(self, seconds: float) -> None:
        """Solve the frame at the stage time ``seconds`` of every performer whose newest motion is out of date.

        Frames that take too long for one image are solved in the background; ``adapted`` is emitted for them.
        """

    def shown_frame(self, performer_id: str) -> AdaptedMotion | None:
        """Motion to display: the frame solved by ``solve_frame``, else the newest adapted motion. None if there is
        none.
        """

    def is_eased(self, performer_id: str) -> bool:
        """True if the motion of ``shown_frame`` is smoothed as requested; a single solved frame is not."""

    def source(self, motion_id: str) -> AdaptedMotion | None:
        """Source motion on the actor's own body; None until it is ready."""
