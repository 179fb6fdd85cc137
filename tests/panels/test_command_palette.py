from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QAction, QKeyEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMainWindow

from studio.panels.command_palette import CommandPalette, ranked_actions


def found(words, *texts):
    actions = [QAction(text) for text in texts]
    return [action.text() for action in ranked_actions(actions, words)]


def test_words_that_stand_together_come_before_letters_that_only_follow_each_other(qapp):
    assert found("fra", "Far ahead", "Next frame", "Frame all") == ["Frame all", "Next frame", "Far ahead"]


def test_letters_in_their_order_are_enough(qapp):
    assert found("sinc", "Save increment", "Save") == ["Save increment"]


def test_words_of_a_tooltip_come_after_names_and_before_scattered_letters(qapp):
    scattered, told, named = QAction("Save as"), QAction("Export", toolTip="Write a sea film"), QAction("Sea")
    assert ranked_actions([scattered, told, named], "sea") == [named, told, scattered]


def test_nothing_typed_finds_everything_in_the_order_of_the_table(qapp):
    assert found("", "B", "A") == ["B", "A"]


def test_arrow_keys_walk_the_list_before_they_are_shortcuts_of_the_window(qtbot):
    window, ran = QMainWindow(), []
    qtbot.addWidget(window)
    offered = [QAction(text, window, triggered=lambda _=False, text=text: ran.append(text)) for text in ("Box", "Ball")]
    palette = CommandPalette(window, offered)
    palette.open()
    asked = QKeyEvent(QEvent.Type.ShortcutOverride, Qt.Key.Key_Down, Qt.KeyboardModifier.NoModifier)
    asked.ignore()
    QApplication.sendEvent(palette.field, asked)
    assert asked.isAccepted()
    QTest.keyClick(palette.field, Qt.Key.Key_Down)
    QTest.keyClick(palette.field, Qt.Key.Key_Return)
    assert ran == ["Ball"]


def test_a_list_in_which_nothing_matches_says_so_and_return_runs_nothing(qtbot):
    window, ran = QMainWindow(), []
    qtbot.addWidget(window)
    palette = CommandPalette(window, [QAction("Box", window, triggered=lambda: ran.append("Box"))])
    palette.open()
    palette.field.setText("zebra")
    [item] = [palette.list.topLevelItem(row) for row in range(palette.list.topLevelItemCount())]
    assert item.text(0) == "Nothing matches “zebra”"
    assert item.isDisabled()
    QTest.keyClick(palette.field, Qt.Key.Key_Return)
    assert ran == []
    palette.field.setText("b")
    assert palette.list.topLevelItem(0).text(0) == "Box"
