"""Actions of a person in the whole window, for tests: drop files, wait, compare."""

from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest

from studio.document.journal import StateHash
from tests.patience import PATIENCE

LEFT = Qt.MouseButton.LeftButton


def drop(window, *paths):
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    event = QDropEvent(QPointF(400, 300), Qt.DropAction.CopyAction, content, LEFT, Qt.KeyboardModifier.NoModifier)
    window.dropEvent(event)


def same(first, second):
    hashes = StateHash()
    return hashes.of(first) == hashes.of(second)


def wait_until_idle(qtbot, window):
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)


def choose_by_keys(choice, steps=1):
    """Open the list of a ``choice`` by an arrow key, go ``steps`` down and take what is there."""
    choice.setFocus()
    QTest.keyClick(choice, Qt.Key.Key_Down)
    for _ in range(steps):
        QTest.keyClick(choice.view(), Qt.Key.Key_Down)
    QTest.keyClick(choice.view(), Qt.Key.Key_Return)
    choice.window().activateWindow()  # as a window manager does when the list has closed
    choice.setFocus()
