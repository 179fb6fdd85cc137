"""A monkey at the real window: ``python -m tests.monkey [--events N] [--round N] [--seed S]``, or ``make soak``.

Seeded clicks, drags, keys, menus, fields, drops and answers to dialogs, in rounds; each round ends by closing the
window at whatever moment it is, and the next one opens another. Told are exceptions, faults that the studio tells of
itself, turns of the event loop that took more than a second, and memory that grew after the first rounds. The exit
code is 1 when there was any.
"""

import argparse
import contextlib
import gc
import json
import logging
import os
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from studio.core.errors import INTERNAL_ERROR
from tests.monkey.events import Monkey
from tests.monkey.report import GAP, Clock, Report, resident, slowness

if TYPE_CHECKING:
    from studio.panels.message_strip import UserMessage

EVENTS, ROUND = 100_000, 1000
"""Events in all, and in a round in the mean."""
BEAT, PATIENCE = 20, 0.3
"""Milliseconds between two looks at the event loop; seconds after which an event is known to have a loop of its own."""


class Soak:
    """Rounds of the monkey, each with a window of its own, in one event loop."""

    def __init__(self, events: int, mean_round: int, seed: int, folder: Path, tell: Callable[[str], object]) -> None:
        from PySide6.QtCore import QTimer, qInstallMessageHandler

        from studio.app.application import make_application
        from studio.app.problems import ProblemHooks
        from studio.startup import first_run

        gc.disable()  # as ``studio.app.application.main`` does
        first_run.run()
        first_run.run_seldom()
        self.application, self.report, self.tell = make_application(), Report(), tell
        self.events, self.mean_round, self.seed, self.folder = events, mean_round, seed, folder
        self.application.setQuitOnLastWindowClosed(False)
        self.hooks, self.clock, self.later = ProblemHooks(), Clock(), QTimer.singleShot
        files = folder / "files"
        files.mkdir()
        self.monkey = Monkey(seed, files, self.report)
        logging.getLogger().addHandler(_Faults(self.fault))
        qInstallMessageHandler(self.complained)
        self.left, self.stepping = 0, 0.0
        self.heart = QTimer(interval=BEAT)
        self.heart.timeout.connect(self.beat)

    def run(self) -> Report:
        self.clock.start()
        self.heart.start()
        self.later(0, self.open)
        self.application.exec()
        self.clock.stopped.set()
        self.hooks.close()
        return self.report

    def fault(self, sentence: str) -> None:
        self.report.faults.append(f"event {self.report.events}: {sentence}")
        self.tell(self.report.faults[-1])

    def complained(self, _kind: object, _context: object, text: str) -> None:
        """Take a message of Qt about how it is used; not about what the platform without a screen lacks."""
        if "plugin does not support" not in text:
            self.fault(f"{text}\n{''.join(traceback.format_stack())}")

    def said(self, message: "UserMessage") -> None:
        """Only what is no sentence for the user: that was logged, with its stack, or comes from a task."""
        if INTERNAL_ERROR in message.sentence:
            self.fault(message.sentence)

    def open(self) -> None:
        """A window with its real engine, journal and views."""
        from studio.app.application import fill_window, import_views, make_window
        from studio.app.settings import Settings
        from studio.document.document import Document

        self.left = min(self.monkey.random.randint(1, 2 * self.mean_round), self.events - self.report.events)
        journals = self.folder / "state"
        shutil.rmtree(journals, ignore_errors=True)
        settings = Settings(self.folder / "studio.ini")
        settings.folder = self.folder / "files"
        import_views()
        window = make_window(settings, Document(journal_folder=journals))
        window.bench.message_posted.connect(self.said)
        window.show()
        window.resize(1000, 640)
        fill_window(window, [], journals)
        self.monkey.window = window
        self.clock.turn()
        self.later(0, self.turn)

    def turn(self) -> None:
        """One event, and the next one after all that it brought."""
        self.left -= 1
        if self.left < 0 or not self.monkey.window.isVisible():
            self.later(0, self.close)
            return
        self.stepping = time.monotonic()
        try:
            self.monkey.step()
        finally:
            self.stepping = 0.0
            self.later(0, self.turn)

    def beat(self) -> None:
        """The event loop turns; within an event it is a menu's own, in which the monkey goes on."""
        self.measure("a turn of the event loop")
        if self.stepping and time.monotonic() - self.stepping > PATIENCE and self.monkey.window is not None:
            self.stepping = time.monotonic()
            self.monkey.step()

    def measure(self, what: str) -> None:
        took, stack = self.clock.turn()
        if took > GAP and took > GAP * slowness():
            self.report.gaps.append(f"event {self.report.events}: {what} took {took:.2f} s\n{stack}")
            self.tell(self.report.gaps[-1])

    def close(self) -> None:
        """At once, whatever is under way."""
        from PySide6.QtCore import QCoreApplication, QEvent
        from PySide6.QtWidgets import QApplication

        window = self.monkey.window
        self.monkey.window = self.monkey.held = self.monkey.seen = None
        self.clock.turn()
        for each in QApplication.topLevelWidgets():
            if each is not window and each.isVisible():
                each.close()
        window.close_without_saving()
        self.measure("closing")
        window.deleteLater()
        del window
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        gc.unfreeze()  # what an open window has frozen for good; here more than one is opened in a process
        gc.collect()
        gc.freeze()  # the next one is not to look through what all before it have loaded, as the only one does not
        self.report.memory.append(resident())
        self.clock.turn()
        self.tell(f"{self.report.events:,} of {self.events:,} events, {resident() / 1e6:.0f} MB")
        self.later(0, self.open if self.report.events < self.events else self.application.quit)


class _Faults(logging.Handler):
    """Errors that are logged, each with its stack."""

    def __init__(self, fault: Callable[[str], object]) -> None:
        super().__init__(logging.ERROR)
        self._fault = fault

    def emit(self, record: logging.LogRecord) -> None:
        self._fault(logging.Formatter().format(record))


def main() -> int:
    """Print the report as JSON; what is found on the way goes to standard error."""
    from studio.startup.process import has_display, prepare_process

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--events", type=int, default=EVENTS)
    parser.add_argument("--round", type=int, default=ROUND, help="events between two windows, in the mean")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    prepare_process()
    if not has_display():
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory(prefix="morpho-studio-monkey-") as name, contextlib.chdir(name):
        for kind in ("CACHE", "CONFIG", "DATA", "STATE"):
            os.environ[f"XDG_{kind}_HOME"] = str(Path(name) / kind.lower())
        report = Soak(
            arguments.events,
            arguments.round,
            arguments.seed,
            Path(name),
            lambda text: print(text, file=sys.stderr, flush=True),
        ).run()
    print(json.dumps({**vars(report), "growth": report.growth, "seconds": time.process_time()}))
    return 0 if report.right else 1


if __name__ == "__main__":
    sys.exit(main())
