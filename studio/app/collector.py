"""Collector: looks for what is lost while a window is open, on the window's thread alone, and gives it back."""

import gc

from PySide6.QtCore import QObject, QTimer

from studio.app.main_window import MainWindow
from studio.startup.process import give_back_freed_memory

INTERVAL = 1000
"""Milliseconds between two looks at whether there is enough to look for."""
SETTLES = 5_000
"""Milliseconds after which nothing of the project before is in use any more."""


class Collector(QObject):
    """Takes over from Python's collector, which looks in whatever thread happens to make an object.

    A worker that finds a part of the window there would end it, and Qt ends its things on their own thread only. It is
    not given back: the window closes with the program, which ends threads and window at once.
    """

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        gc.disable()
        timer = QTimer(self, interval=INTERVAL)
        timer.timeout.connect(collect_what_is_due)
        timer.start()
        emptied = QTimer(self, interval=SETTLES, singleShot=True)
        emptied.timeout.connect(give_back_freed_memory)
        emptied.start()
        window.bench.document.project_opened.connect(emptied.start)


def collect_what_is_due() -> None:
    """Look through the oldest generation of which enough has been made, and all that are younger."""
    for generation, (count, most) in reversed([*enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))]):
        if count > most:
            gc.collect(generation)
            return
