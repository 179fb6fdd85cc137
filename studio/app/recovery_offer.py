"""Offer to recover the unsaved work of a crashed session. Declining never deletes it."""

from collections.abc import Callable
from pathlib import Path

from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.document.recovery import (
    Session,
    move_damaged_session,
    put_damaged_aside,
    recoverable_sessions,
    remove_useless_sessions,
)


def offer_recovery(bench: Workbench, folder: Path) -> None:
    """Offer to recover the newest session that crashed, if there is one; sessions without unsaved edits are removed."""
    bench.journals = folder
    try:
        for sentence in put_damaged_aside(folder):
            bench.post_message(sentence)
        sessions = recoverable_sessions(folder)
        remove_useless_sessions(folder)
    except OSError as error:
        bench.post_message(f"The backup folder '{folder}' cannot be read: {error.strerror}.")
        return
    if sessions:
        bench.window.recovery.offer(session_message(sessions[0]), lambda: _recover(bench, sessions[0]))


def choose_recovery(bench: Workbench) -> None:
    """Show a list of all unsaved work, newest first, including sessions whose recovery was declined."""
    sessions = recoverable_sessions(bench.journals, declined=True) if bench.journals else ()
    if not sessions:
        raise StudioError("There is no unsaved work of the last 30 days to recover.")
    bench.window.choose("Recover unsaved work", [(session_title(each), _recovery(bench, each)) for each in sessions])


def session_title(session: Session) -> tuple[str, str]:
    """Name, and time with number of edits, of a session, for example ``walk.studio`` and ``4 May 14:32 · 12 edits``."""
    begun = session.begun.astimezone()
    return session.path.name if session.path else "Untitled", f"{begun.day} {begun:%b %H:%M} · {_edits(session)}"


def _recovery(bench: Workbench, session: Session) -> Callable[[], object]:
    return lambda: bench.window.run_when_saved(lambda: _recover(bench, session))


def _recover(bench: Workbench, session: Session) -> None:
    """Recover a session; an unreadable one is moved aside and reported."""
    try:
        bench.document.recover(session)
    except StudioError as error:
        raise StudioError(move_damaged_session(session, str(error))) from error


def session_message(session: Session) -> str:
    """Sentence that offers a session, for example ``Unsaved work on walk.studio from 14:32 was found: 12 edits.``"""
    name = f" on {session.path.name}" if session.path else ""
    return f"Unsaved work{name} from {session.begun.astimezone():%H:%M} was found: {_edits(session)}."


def _edits(session: Session) -> str:
    return f"{session.edits} edit" + ("" if session.edits == 1 else "s")
