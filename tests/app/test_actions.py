from collections import Counter

from PySide6.QtGui import QKeySequence

from studio.app.actions import ACTIONS, MENUS
from studio.document import colours


def test_no_shortcut_belongs_to_two_actions():
    keys = Counter(QKeySequence(key).toString() for action in ACTIONS for key in action.shortcuts)
    assert [key for key, count in keys.items() if count > 1] == []


def test_every_shortcut_is_one_that_qt_knows():
    assert [key for action in ACTIONS for key in action.shortcuts if not QKeySequence(key).toString()] == []


def test_every_action_has_an_id_of_its_own_a_text_and_a_menu():
    ids = [action.id for action in ACTIONS]
    assert len(set(ids)) == len(ids)
    assert all(action.text and action.menu in MENUS for action in ACTIONS)


def luminance(colour):
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_text_stands_out_from_every_ground_it_is_written_on():
    for text in (colours.TEXT, colours.TEXT_SECOND, colours.TEXT_THIRD):
        for ground in (colours.WELL, colours.PANEL, colours.BAR):
            assert contrast(text, ground) >= 4.5, (text, ground)
    assert contrast("#ffffff", colours.SELECTED_CONTROL) >= 4.5
