"""Garbage collection on the window's thread only, while a window is open."""

import gc

from PySide6.QtCore import QObject, QTimer

from studio.app.main_window import MainWindow
from studio.startup.process import give_back_freed_memory

COLLECT_INTERVAL_MS = 1000
"""Milliseconds between two checks if a collection is due."""
SETTLE_MS = 5_000
"""Milliseconds after which the previous project is no longer in use and can be collected."""


class Collector(QObject):
    """Replacement of Python's automatic garbage collection, which runs on whatever thread allocates an object.

    A worker thread that collected a widget would crash, because Qt requires its objects to be deleted on their own
    thread. Automatic collection is never restored: the process ends with the window.
    """

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        gc.disable()
        timer = QTimer(self, interval=COLLECT_INTERVAL_MS)
        timer.timeout.connect(collect_what_is_due)
        timer.start()
        emptied = QTimer(self, interval=SETTLE_MS, singleShot=True)
        emptied.timeout.connect(give_back_freed_memory)
        emptied.start()
        window.bench.document.project_opened.connect(emptied.start)


def collect_what_is_due() -> None:
    """Collect the oldest generation that has reached its threshold, and all younger ones."""
    for generation, (count, most) in reversed([*enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))]):
        if count > most:
            gc.collect(generation)
            return
