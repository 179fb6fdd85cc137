"""Collector: looks for what is lost while a window is open, on the window's thread alone."""

import gc

from PySide6.QtCore import QObject, QTimer

from studio.app.main_window import MainWindow

INTERVAL = 1000
"""Milliseconds between two looks at whether there is enough to look for."""


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


def collect_what_is_due() -> None:
    """Look through the oldest generation of which enough has been made, and all that are younger."""
    for generation, (count, most) in reversed([*enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True))]):
        if count > most:
            gc.collect(generation)
            return
