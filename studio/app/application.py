"""The application: the window first, then 3D and kernels, then the sample or the named files."""

import gc
import logging
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from studio.app import recovery_offer, sample
from studio.app.main_thread_gc import Collector
from studio.app.main_window import MainWindow
from studio.app.preferences import Preferences, load_preferences
from studio.app.problems import ProblemHooks, start_log
from studio.app.settings import Settings
from studio.app.terminal_interrupt import TerminalInterrupt
from studio.app.theme import apply_theme
from studio.app.workbench import Workbench
from studio.document import colours
from studio.document.document import Document
from studio.document.file_lock import journal_folder
from studio.document.length_units import use_lengths
from studio.engine.background_tasks import TaskRunner
from studio.engine.live_adaptation import LiveAdaptation
from studio.startup.kernel_warm_up import WarmUp


def main(argv: Sequence[str] | None = None, warm_up: WarmUp | None = None) -> NoReturn:
    """Open the window with the files named in ``argv`` (without the program's name), else the sample.

    The process ends when the window is closed. A ``warm_up`` that was started before continues.
    """
    names = list(sys.argv[1:] if argv is None else argv)
    gc.disable()  # what is loaded stays: looking for what is lost among it costs a tenth of the start
    start_log()
    settings = Settings()
    apply_look(load_preferences(settings))
    application = make_application()
    problems = ProblemHooks()
    warm_up = warm_up or WarmUp(held=True)
    journals = journal_folder()
    window = make_window(settings, Document(journal_folder=journals), warm_up)
    problems.message_posted.connect(window.bench.post_message)
    TerminalInterrupt(window).pressed.connect(window.close_without_saving)
    window.show()
    QTimer.singleShot(0, window, lambda: fill_window(window, [Path(name) for name in names], journals, warm_up))
    code = application.exec()
    problems.close()
    end_process(code)


def apply_look(preferences: Preferences) -> None:
    """Apply the user's theme, units and scale; called before the QApplication exists, because Qt reads the scale only
    once.
    """
    colours.use_theme(preferences.theme)
    use_lengths(preferences.lengths)
    if preferences.interface_scale != 100:
        os.environ.setdefault("QT_SCALE_FACTOR", str(preferences.interface_scale / 100.0))


def end_process(code: int) -> NoReturn:
    """Exit at once, after everything is written; the interpreter would wait for threads inside a
    compiler or an import.
    """
    logging.shutdown()
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # a window started from a desktop icon may have none
            stream.flush()
    os._exit(code)


def freeze_loaded_objects(window: MainWindow) -> None:
    """Exclude all loaded objects from garbage collection, whose full run would block the window for 0.2 s.

    Hardly any of them becomes garbage: 3,500 objects of half a million.
    """
    gc.freeze()
    Collector(window)


def make_application() -> QApplication:
    """The QApplication, in the studio's theme."""
    found = QApplication.instance()
    application = found if isinstance(found, QApplication) else QApplication(["Morpho Studio"])
    application.setApplicationName("Morpho Studio")
    application.setDesktopFileName("morpho-studio")
    apply_theme(application)
    return application


def make_window(settings: Settings, document: Document | None = None, warm_up: WarmUp | None = None) -> MainWindow:
    """Window with its document and solver, still without the 3D view and the timeline."""
    document = document or Document()
    live = LiveAdaptation(document, warm_up=warm_up)
    return MainWindow(Workbench(document, live, TaskRunner(), settings))


def fill_window(
    window: MainWindow, paths: list[Path], journals: Path | None = None, warm_up: WarmUp | None = None
) -> None:
    """Offer recovery, open files and create the views: everything that takes longer than the empty window."""
    bench = window.bench
    if journals is not None:
        recovery_offer.offer_recovery(bench, journals)
    bench.document.new(sample.empty_project())  # somebody stands on the stage while the motion is read
    if paths:
        window.open_paths(paths)
    else:
        sample.open_sample(bench)
    # The imports take a second or more; the interpreter does them beside the window.
    bench.runner.run("Starting the 3D view", lambda _: import_viewport(warm_up), lambda _: show_first(window, warm_up))
    if warm_up is not None and warm_up.running:
        bench.runner.run("Preparing the solver" if warm_up.cold else "Loading the solver", warm_up.follow)


def show_first(window: MainWindow, warm_up: WarmUp | None) -> None:
    """Add the 3D view to the window, and load the rest after it has been painted once."""
    show_viewport(window)

    def drawn() -> None:
        if warm_up is not None:
            warm_up.release()
        window.bench.runner.run("Starting the timeline", lambda _: import_timeline(), lambda _: show_last(window))

    window.bench.viewport.started.connect(drawn)
    QTimer.singleShot(0, window.bench.viewport, window.bench.viewport.start)


def show_last(window: MainWindow) -> None:
    """Add the timeline, which completes the window."""
    show_timeline(window)
    freeze_loaded_objects(window)


def import_views() -> None:
    """Import all modules of the views."""
    import_viewport()
    import_timeline()


def import_viewport(warm_up: WarmUp | None = None) -> None:
    """Import the modules of the 3D view, and those that draw characters before the solver is compiled."""
    import_module("studio.viewport.widget")
    import_module("studio.viewport.stage_picture")  # VTK, which the first picture would load otherwise
    if warm_up is not None:
        warm_up.join_picture()
    import_module("studio.startup.first_picture").run()


def import_timeline() -> None:
    """Import the modules of the timeline, and those that draw the first trail in the 3D view."""
    import_module("studio.timeline.timeline")
    import_module("scipy.interpolate")


def show_views(window: MainWindow) -> None:
    """Make the views and add them to the window."""
    show_timeline(window)
    show_viewport(window)


def show_viewport(window: MainWindow) -> None:
    """Make the 3D view and add it to the window."""
    from studio.viewport.widget import Viewport

    window.show_viewport(Viewport(window.bench.document, window.bench.live))


def show_timeline(window: MainWindow) -> None:
    """Make the timeline and add it to the window."""
    from studio.timeline.timeline import Timeline

    window.show_timeline(Timeline(window.bench.document, window.bench.live))
