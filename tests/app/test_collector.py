"""Objects lost while a window is open end on the window's thread, as Qt needs it."""

import gc
import threading

import pytest
from PySide6.QtCore import QObject

from studio.app import main_thread_gc
from studio.app.application import freeze_loaded_objects, make_application, make_window
from studio.app.main_thread_gc import Collector
from studio.app.settings import Settings
from studio.core.stage.project import Project
from studio.document.document import Document


class Lost:
    """In a circle with a thing of Qt, as forms and what they call are."""

    def __init__(self, ended: list[int]) -> None:
        self.ended, self.itself, self.part = ended, self, QObject()

    def __del__(self) -> None:
        self.ended.append(threading.get_ident())


@pytest.fixture
def threshold():
    before = gc.get_threshold()
    gc.set_threshold(500, 1, 1)
    yield
    gc.set_threshold(*before)


def test_what_is_lost_is_ended_on_the_thread_of_the_window_alone(qtbot, tmp_path, threshold):
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    Collector(window)
    ended: list[int] = []
    made: list[list[int]] = []  # kept: only what is made and not let go counts
    Lost(ended)
    worker = threading.Thread(target=lambda: made.extend([k] for k in range(20_000)))
    worker.start()
    worker.join()
    assert ended == []
    qtbot.waitUntil(lambda: bool(ended))
    assert ended == [threading.get_ident()]
    window.close_without_saving()
    assert not gc.isenabled()  # workers may go on for a moment
    window.deleteLater()


def test_what_the_start_has_loaded_is_never_looked_through(qtbot, tmp_path):
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    looked: list[int] = []
    watch = lambda _phase, info: looked.append(info["generation"])  # noqa: E731 - to be taken off again
    gc.callbacks.append(watch)
    freeze_loaded_objects(window)
    gc.callbacks.remove(watch)
    assert looked == []
    assert gc.get_freeze_count() > 10_000
    gc.unfreeze()
    window.close_without_saving()
    window.deleteLater()


def test_what_a_project_took_goes_back_to_the_system_when_another_is_opened(qtbot, tmp_path, monkeypatch):
    given: list[bool] = []
    monkeypatch.setattr(main_thread_gc, "SETTLE_MS", 50)
    monkeypatch.setattr(main_thread_gc, "give_back_freed_memory", lambda: given.append(True))
    make_application()
    window = make_window(Settings(tmp_path / "studio.ini"), Document())
    Collector(window)
    qtbot.waitUntil(lambda: len(given) == 1)
    window.bench.document.new(Project())
    qtbot.waitUntil(lambda: len(given) == 2)
    window.close_without_saving()
    window.deleteLater()
