"""Random actions of the menus in the window, undone and redone to the byte, one sequence a seed."""

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import Any

from studio.core.stage.project import COLLECTIONS
from studio.document.recovery import recoverable_sessions, recovered_session
from studio.io.project.entity_json import project_json
from tests.io.spoilt_stages import stage_project

STEPS = 100
MENUS = "Edit", "Character", "Clip", "Constraint", "Prop", "Behaviour"
ALSO = ("add_label", "store_camera_1", "store_camera_2", "add_camera", "correct_pose", "select_tool")
"""Actions of other menus that change the project, or what others change."""
ASKING = "…"
"""End of the text of actions that open a dialog."""

_windows: list[Any] = []


def open_window(folder: Path) -> Any:
    """The window of this process, with its journal in ``folder``."""
    if not _windows:
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
        from studio.app.application import make_application, make_window
        from studio.app.settings import Settings
        from studio.document.document import Document

        make_application()
        window = make_window(Settings(folder / "studio.ini"), Document(journal_folder=folder / "journals"))
        window.resize(320, 240)
        window.show()
        _windows.append(window)
    return _windows[0]


def process_events() -> None:
    """Process what is pending as an event loop does; ``processEvents`` alone never deletes what is deleted later."""
    from PySide6.QtCore import QCoreApplication, QEvent

    QCoreApplication.processEvents()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@contextmanager
def slots_raise() -> Iterator[None]:
    """Raise in the end what a slot of Qt has raised, which would only be printed."""
    raised: list[BaseException] = []
    hook, sys.excepthook = sys.excepthook, lambda _kind, error, _stack: raised.append(error)
    try:
        yield
    finally:
        sys.excepthook = hook
    if raised:
        raise raised[0]


def act(window: Any, random: Random) -> None:
    """Trigger an action on a random selection at a random time."""
    from studio.app.actions import ACTIONS

    document, actions = window.bench.document, window.actions_by_id.by_id
    possible = [
        actions[each.id] for each in ACTIONS if (each.menu in MENUS and ASKING not in each.text) or each.id in ALSO
    ]
    collection = random.choice(COLLECTIONS)
    keys = list(getattr(document.project, collection))
    chosen = random.sample(keys, min(len(keys), random.choice([1, 1, 2])))
    document.selection.set(*((collection, key) for key in chosen))
    document.playhead.set_time(random.uniform(0.0, 1.5))
    process_events()
    random.choice([each for each in possible if each.isEnabled()]).trigger()


def play(seed: int, folder: Path, steps: int = STEPS) -> int:
    """Trigger actions on random selections; returns the number of steps on the undo stack.

    Raises AssertionError where undoing all, redoing all, or recovering the journal gives other bytes.
    """
    window, random = open_window(folder), Random(seed)
    document = window.bench.document
    document.new(stage_project())
    first = project_json(document.project, {})
    for _ in range(steps):
        with slots_raise():
            act(window, random)
            if random.random() < 0.1:
                document.undo_stack.setIndex(random.randrange(document.undo_stack.count() + 1))
            process_events()
    last, index = project_json(document.project, {}), document.undo_stack.index()
    with slots_raise():
        document.undo_stack.setIndex(0)
    assert project_json(document.project, {}) == first, "undo"
    with slots_raise():
        document.undo_stack.setIndex(index)
    assert project_json(document.project, {}) == last, "redo"
    copy = folder / "killed"
    assert document.journal is not None
    assert document.journal.flush()
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(folder / "journals", copy)
    [session] = recoverable_sessions(copy)
    assert project_json(recovered_session(session).project, {}) == last, "recovery"
    return document.undo_stack.count()
