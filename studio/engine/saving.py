"""Saving in the background: a snapshot is taken immediately, written by a worker, and recorded by the document."""

from collections.abc import Callable
from pathlib import Path

from studio.core.errors import StudioError
from studio.document.document import Document
from studio.engine.background_tasks import TaskRunner
from studio.io.project.archive import Stamp


def save_in_background(
    document: Document,
    tasks: TaskRunner,
    path: Path | None = None,
    thumbnail: bytes | None = None,
    overwrite: bool = False,
    on_saved: Callable[[], None] = lambda: None,
    on_error: Callable[[StudioError], None] = lambda _error: None,
) -> int:
    """Start saving and return the id of the task. Raises StudioError immediately if the project has no file to save
    to.
    """
    saving = document.make_save(path, thumbnail, overwrite)

    def saved(stamp: Stamp) -> None:
        document.note_saved(saving, stamp)
        on_saved()

    return tasks.run(f"Saving {saving.path.name}", saving.write, saved, on_error)
