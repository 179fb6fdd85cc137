"""Work that a crashed session left is offered beside the new one; no answer deletes it."""

from collections.abc import Callable
from typing import Any

from studio.app.workbench import Workbench


def offer(bench: Workbench) -> None:
    """Ask about the newest session that ended without being closed, if there is one."""
    find: Callable[[], list[Any]] | None = getattr(bench.document, "recoverable_sessions", None)
    found = find() if find is not None else []
    if found:
        session = found[0]
        words = f"Unsaved work from {session.when:%H:%M} was found."
        bench.window.recovery.offer(words, lambda: bench.document.recover(session))
