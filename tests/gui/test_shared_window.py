"""A window that tests share is a new one to each of them."""

from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.app.application import show_timeline
from studio.app.preferences import Preferences
from studio.app.settings import Settings
from tests.builders import make_project
from tests.gui.shared_window import close_window, new_window, state_of


def test_a_project_that_is_opened_anew_makes_a_used_window_a_new_one(window, shared_window, project, tmp_path):
    first, settings = state_of(window), window.bench.settings
    window.bench.document.selection.set(("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_D, Qt.KeyboardModifier.ControlModifier)
    window.bench.post_message("The disk is full.")
    window.library.search_field.setText("Target")
    window.set_preferences(replace(Preferences(), key_map="maya"))
    window.docks["History"].hide()
    window.resize(1200, 800)
    QTest.qWait(20)
    assert state_of(window) != first
    assert shared_window.opened(tmp_path / "other.ini", project) is window
    assert state_of(window) == first
    assert window.bench.settings is not settings


def test_a_window_that_stays_different_is_closed_for_a_new_one(window, shared_window, project, tmp_path):
    first = state_of(window)
    show_timeline(window)
    other = shared_window.opened(tmp_path / "other.ini", project)
    assert other is not window
    assert state_of(other)[:-1] == first[:-1]  # of other objects


def test_a_new_window_shows_every_menu(qapp, tmp_path):
    """Its bar was fitted to texts as wide as before they had the theme's font."""
    window = new_window(Settings(tmp_path / "studio.ini"), make_project())
    menus = window.top_bar.menus
    room, needed = menus.width(), menus.sizeHint().width()
    close_window(window)
    assert room >= needed
