"""Closed windows are gone with all that they hold."""

import gc
import os
import subprocess
import sys
import weakref
from collections import Counter
from dataclasses import replace

from PySide6.QtCore import QCoreApplication, QEvent, QObject
from PySide6.QtTest import QTest

from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.sample import read_sample
from studio.app.settings import Settings
from studio.core.mesh.skin import with_grip
from studio.core.stage.project import COLLECTIONS, Project
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from tests.gui.window_use import wait_until_idle
from tests.patience import PATIENCE, SECONDS


def use_a_window(qtbot, folder):
    """Open one with the example, show a form of every kind in it, and close it."""
    window = make_window(Settings(folder / "studio.ini"), Document(journal_folder=folder / "journals"))
    with qtbot.waitExposed(window):
        window.show()
    window.actions_by_id.by_id["open_sample"].trigger()
    show_views(window)
    wait_until_idle(qtbot, window)
    document = window.bench.document
    for collection in COLLECTIONS:
        for key in list(getattr(document.project, collection))[:1]:
            document.selection.set((collection, key))
            QTest.qWait(10)
    assert window.bench.live.wait_until_solved(SECONDS)
    QTest.qWait(50)
    window.close_without_saving()
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


def objects_of_qt():
    gc.collect()
    return Counter(type(each).__qualname__ for each in gc.get_objects() if issubclass(type(each), QObject))


def test_closed_windows_leave_nothing_of_themselves(qtbot, tmp_path):
    make_application()
    import_views()
    use_a_window(qtbot, tmp_path)  # what is made once for all of them
    before = objects_of_qt()
    for _ in range(2):
        use_a_window(qtbot, tmp_path)
    assert objects_of_qt() - before == Counter()


LEFT_OPEN = """
import sys
from dataclasses import replace
from pathlib import Path

from studio.app.application import make_application, make_window, show_views
from studio.app.settings import Settings
from studio.document.document import Document
from tests.builders import make_project

application = make_application()
window = make_window(Settings(Path(sys.argv[1]) / "studio.ini"), Document(make_project()))
show_views(window)
window.show()
document = window.bench.document
key, performer = next(iter(document.project.performers.items()))
document.replace("performers", key, replace(performer, name="Somebody"), "Rename")
"""


def test_a_window_that_is_left_open_says_nothing_at_the_end_of_its_process(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-c", LEFT_OPEN, str(tmp_path)],
        capture_output=True,
        text=True,
        env=os.environ | {"QT_QPA_PLATFORM": "offscreen"},
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert "Error" not in ended.stderr


def test_the_skins_of_a_project_are_let_go_when_another_is_opened(window, qtbot):
    """Up to 64 of each kind stayed, of projects long closed."""
    import_views()
    show_views(window)
    character = bundled_characters()["child"]
    made = weakref.ref(with_grip(character.skin, 0.37))
    window.bench.document.new(Project())
    gc.collect()
    assert made() is None


def use_the_example(bench):
    """Open it, let every body play it mirrored and faster; returns references to all that was held for that."""
    document, live = bench.document, bench.live
    document.new(read_sample()[0])
    assert live.wait_until_solved(PATIENCE / 1000.0)
    for key, performer in document.project.performers.items():
        clip = replace(performer.clips[0], mirrored=True, speed=1.5)
        document.replace("performers", key, replace(performer, clips=(clip,)), "Mirror")
        document.selection.set(("performers", key))
        QTest.qWait(50)
    assert live.wait_until_solved(PATIENCE / 1000.0)
    project = document.project
    motions = [live.shown_frame(key) for key in project.performers]
    held = [project, *project.captures.values(), *motions, *(each.composite.motion for each in motions)]
    return [weakref.ref(each) for each in held]


def test_nothing_of_a_closed_project_is_held(window, qtbot):
    """Workers held what they had solved last, caches up to 64 motions, bodies and skins of each kind."""
    import_views()
    show_views(window)
    held = use_the_example(window.bench)
    window.bench.document.new(Project())
    assert window.bench.live.wait_until_solved(PATIENCE / 1000.0)

    def nothing_is_held():
        gc.collect()
        assert [type(each()).__name__ for each in held if each() is not None] == []

    qtbot.waitUntil(nothing_is_held, timeout=PATIENCE // 10)
