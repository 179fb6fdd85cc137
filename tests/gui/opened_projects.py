"""Projects opened, edited, saved and closed one after the other in one window, one a seed; what is held stays flat."""

import gc
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from studio.io.project.project_file import new_document_id, write_project
from studio.startup.process import give_back_freed_memory
from tests.gui.random_actions import act, process_events, slots_raise
from tests.io.spoilt_stages import stage_project

EDITS = 10
SECONDS = 120.0
"""Seconds by the clock in which bodies are solved, however busy the machine is."""
SETTLED = 20
"""Projects after which everything that is made once has been made."""
SLACK, GROWTH = 24_000_000, 100_000
"""Bytes by which memory goes up and down, and bytes that each project may leave behind."""


@dataclass(frozen=True)
class Held:
    """Threads, open file descriptors and resident bytes of this process."""

    threads: int
    handles: int
    memory: int

    @classmethod
    def now(cls) -> "Held":
        """Count after garbage is collected and freed memory is given back."""
        gc.collect()
        give_back_freed_memory()
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        counts = [len(os.listdir(f"/proc/self/{each}")) for each in ("task", "fd")]
        return cls(*counts, pages * os.sysconf("SC_PAGE_SIZE"))


_windows: list[Any] = []
held: list[Held] = []
"""Counts after each project of this process."""


def play(seed: int, folder: Path) -> None:
    """Open a project, edit and save it, and close it.

    Raises AssertionError where threads, file descriptors or memory are more than after the first ``SETTLED`` projects.
    """
    window, random = open_window(folder), Random(seed)
    document, actions = window.bench.document, window.actions_by_id.by_id
    path = folder / "opened.studio"
    shutil.copyfile(folder / random.choice(["stage", "sample"]), path)
    with slots_raise():
        window.open_paths([path])
        wait_until_at_rest(window)
        assert document.path == path
        for _ in range(EDITS):
            act(window, random)
        wait_until_at_rest(window)
        actions["save"].trigger()
        wait_until_at_rest(window)
        assert not document.dirty
        actions["new"].trigger()
        wait_until_at_rest(window)
        assert document.path is None
    held.append(Held.now())
    print(f"{len(held):4} projects: {held[-1]}", flush=True)
    if len(held) > SETTLED:
        first, last = held[SETTLED - 1], held[-1]
        assert last.threads <= first.threads, (first, last)
        assert last.handles <= first.handles, (first, last)
        assert last.memory <= first.memory + SLACK + GROWTH * (len(held) - SETTLED), (first, last)


def open_window(folder: Path) -> Any:
    """The window of this process with all its views; the two projects lie in ``folder``."""
    if not _windows:
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
        from studio.app.application import (
            freeze_loaded_objects,
            import_views,
            make_application,
            make_window,
            show_views,
        )
        from studio.app.sample import read_sample
        from studio.app.settings import Settings
        from studio.document.document import Document

        for name, project in (("stage", stage_project()), ("sample", read_sample()[0])):
            write_project(folder / name, project, new_document_id())
        make_application()
        window = make_window(Settings(folder / "studio.ini"), Document(journal_folder=folder / "journals"))
        window.resize(1000, 640)
        window.show()
        import_views()
        show_views(window)
        freeze_loaded_objects(window)
        _windows.append(window)
    return _windows[0]


def wait_until_at_rest(window: Any) -> None:
    """Wait until no task runs and all bodies are solved."""
    from PySide6.QtTest import QTest

    QTest.qWait(200)
    while window.bench.runner.running:
        QTest.qWait(20)
    assert window.bench.live.wait_until_solved(SECONDS)
    process_events()
