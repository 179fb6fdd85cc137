"""Availability of the solver while its kernels are still being compiled at a first start."""

from collections.abc import Iterable

from PySide6.QtCore import QObject, QTimer, Signal

from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.project import Project
from studio.engine.background_tasks import CLOSE_WAIT_SECONDS
from studio.startup.kernel_warm_up import WarmUp

KERNEL_POLL_MILLISECONDS = 100


class SolverKernels(QObject):
    """Follower of a ``WarmUp`` that tells which performers can be solved already; without one, all kernels count as
    compiled.
    """

    changed = Signal()
    """Emitted when more performers can be solved."""

    def __init__(self, warm_up: WarmUp | None, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._warm_up = warm_up
        self._known = self.grounded, self.ready
        self._looking = QTimer(self, interval=KERNEL_POLL_MILLISECONDS)
        self._looking.timeout.connect(self._look)
        if not self.ready:
            self._looking.start()

    @property
    def ready(self) -> bool:
        """True once all kernels are compiled; calling them earlier would block for seconds."""
        return self._warm_up is None or self._warm_up.ready

    @property
    def grounded(self) -> bool:
        """True once the kernels of grounding are compiled, which suffice for motions without constraints."""
        return self._warm_up is None or self._warm_up.grounded

    @property
    def is_pending(self) -> bool:
        """True if ``changed`` will be emitted again."""
        return self._looking.isActive()

    def can_solve(self, project: Project, performer_ids: Iterable[str]) -> bool:
        """True if the kernels that the given performers need are compiled."""
        return self.ready or (
            self.grounded and not any(constraints_of_performer(project, key) for key in performer_ids)
        )

    def join_grounded(self) -> None:
        """Wait, in a worker, until motions can be grounded. Raises CancelledError if compiling was stopped."""
        if self._warm_up is not None:
            self._warm_up.join_grounded()

    def close(self) -> None:
        """Stop compiling."""
        self._looking.stop()
        if self._warm_up is not None:
            self._warm_up.stop(CLOSE_WAIT_SECONDS)

    def _look(self) -> None:
        known = self.grounded, self.ready
        if self.ready:
            self._looking.stop()
        if known != self._known:
            self._known = known
            self.changed.emit()
