"""The keys of a body that grows, on the timeline: seen, dragged, jumped to, deleted."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.timeline.hover import hover_text
from studio.timeline.menus import menu_at
from tests.gui.hand import RATE, pixels

FIRST = "performer 0"


@pytest.fixture
def growing(document):
    """The character of the first performer, of which each has its own."""
    key = document.project.performers[FIRST].character_id
    keyed = KeyedProportions((20 / RATE, 80 / RATE), (Proportions(), Proportions(stature=1.4)))
    document.replace("characters", key, replace(document.project.characters[key], proportions=keyed), "Key")
    document.selection.set(("performers", FIRST))
    document.undo_stack.clear()
    return key


def place(timeline, frame):
    return QPoint(round(timeline.x_of_frame(frame)), timeline.row_rect("growth", FIRST).center().y())


def frames_of(document, growing):
    return [time * RATE for time in document.project.characters[growing].proportions.times]


def test_a_body_that_grows_has_a_row_with_its_keys(document, timeline, growing):
    assert timeline.row_rect("growth", FIRST).height() > 0
    assert timeline.row_rect("growth", "performer 1").height() == 0
    picture = timeline.tracks.grab().toImage()
    colour = QColor(document.project.characters[growing].colour)
    assert picture.pixelColor(place(timeline, 20)) == colour
    assert picture.pixelColor(place(timeline, 80)) == colour
    document.undo_stack.undo()
    words = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place(timeline, 80)))
    assert words.startswith("Key of")
    fixed = replace(document.project.characters[growing], proportions=Proportions())
    document.replace("characters", growing, fixed, "Fix")
    assert timeline.row_rect("growth", FIRST).height() == 0


def test_a_key_is_dragged_and_does_not_pass_its_neighbour(document, timeline, hand, growing):
    hand.drag(place(timeline, 80), pixels(timeline, -20))
    assert frames_of(document, growing) == pytest.approx([20, 60])
    assert document.undo_stack.count() == 1
    hand.drag(place(timeline, 20), pixels(timeline, 70))
    first, last = frames_of(document, growing)
    assert first == pytest.approx(60, abs=0.1)
    assert first < last
    assert ("performers", FIRST) in document.selection


def test_what_is_dragged_is_drawn_while_the_hand_moves(document, timeline, hand, growing):
    colour = QColor(document.project.characters[growing].colour)
    hand.press(place(timeline, 80))
    hand.move(pixels(timeline, -20))
    try:
        assert timeline.tracks.grab().toImage().pixelColor(place(timeline, 60)) == colour
    finally:
        hand.release()


def test_the_playhead_jumps_from_key_to_key(document, timeline, growing):
    document.playhead.set_frame(72)
    for key, frame in ((Qt.Key.Key_Down, 80), (Qt.Key.Key_Up, 70), (Qt.Key.Key_Up, 60)):
        QTest.keyClick(timeline.tracks, key)
        assert document.playhead.frame == frame


def test_a_key_is_deleted_from_its_menu_but_not_the_last_one(document, timeline, growing):
    menu_at(timeline.tracks, QPointF(place(timeline, 80))).actions()[0].trigger()
    assert frames_of(document, growing) == pytest.approx([20])
    assert not menu_at(timeline.tracks, QPointF(place(timeline, 20))).actions()[0].isEnabled()
