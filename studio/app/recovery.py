"""Work that a crashed session left is offered beside the new one; no answer deletes it."""

from pathlib import Path

from studio.app.workbench import Workbench
from studio.document.recovery import Session, recoverable_sessions


def offer(bench: Workbench, folder: Path) -> None:
    """Ask about the newest session that ended without being closed, if there is one."""
    sessions = recoverable_sessions(folder)
    if sessions:
        bench.window.recovery.offer(words_of(sessions[0]), lambda: bench.document.recover(sessions[0]))


def words_of(session: Session) -> str:
    """``Unsaved work on walk.studio from 14:32 was found: 12 edits.``"""
    name = f" on {session.path.name}" if session.path else ""
    edits = f"{session.edits} edit" + ("" if session.edits == 1 else "s")
    return f"Unsaved work{name} from {session.begun.astimezone():%H:%M} was found: {edits}."
