"""A short run of what ``make soak`` does at length."""

from tests.gui import random_actions


def test_any_actions_of_the_menus_are_undone_redone_and_recovered_to_the_byte(qapp, tmp_path):
    try:
        random_actions.play(3, tmp_path, steps=8)
    finally:
        window = random_actions._windows.pop()
        window.close_without_saving()
        window.deleteLater()
