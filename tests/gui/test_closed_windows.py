"""What is closed is gone: windows with all that they hold."""

import gc
import weakref
from collections import Counter

from PySide6.QtCore import QCoreApplication, QEvent, QObject
from PySide6.QtTest import QTest

from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.settings import Settings
from studio.core.mesh.skin import gripping
from studio.core.project import COLLECTIONS, Project
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from tests.gui.window_use import wait_until_idle


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
    assert window.bench.live.wait(100.0)
    QTest.qWait(50)
    window.leave()
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


def test_the_skins_of_a_project_are_let_go_when_another_is_opened(window, qtbot):
    """Up to 64 of each kind stayed, of projects long closed."""
    import_views()
    show_views(window)
    character = bundled_characters()["child"]
    made = weakref.ref(gripping(character.skin, 0.37))
    window.bench.document.new(Project())
    gc.collect()
    assert made() is None
