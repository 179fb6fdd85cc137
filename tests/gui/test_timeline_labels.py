"""Labels on the timeline, by mouse and keys: added, renamed, moved, trimmed, jumped to, deleted."""

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit

from studio.core.captures.annotations import Label
from studio.timeline.hover import hover_text
from studio.timeline.menus import menu_at
from tests.gui.hand import pixels

LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture
def labels(document):
    """A moment at frame 20 and a stretch from frame 50 to 70."""
    moment = document.add("labels", Label("jump", 20, 20, "motion"), "Add")
    stretch = document.add("labels", Label("flight", 50, 70, "motion"), "Add")
    document.undo_stack.clear()
    return moment, stretch


def at(timeline, frame):
    return QPoint(round(timeline.x_of_frame(frame)), timeline.row_rect("labels").center().y())


def spans(document):
    return {each.name: (each.first, each.last) for each in document.project.labels.values()}


def field_of(timeline):
    [field] = [each for each in timeline.tracks.findChildren(QLineEdit) if each.isVisible()]
    return field


def test_a_motion_without_labels_has_no_row_for_them(document, timeline):
    assert timeline.row_rect("labels").isEmpty()
    timeline.add_label()
    assert timeline.row_rect("labels").height() > 0
    document.undo_stack.undo()
    assert timeline.row_rect("labels").isEmpty()


def test_labels_are_seen_where_they_are(document, timeline, labels):
    row = timeline.row_rect("labels")
    picture = timeline.tracks.grab().toImage()
    ground = picture.pixelColor(QPoint(at(timeline, 93).x(), row.center().y() + 4))
    for frame in (20, 51, 61, 69):
        assert picture.pixelColor(at(timeline, frame) + QPoint(0, 4)) != ground
    words = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(at(timeline, 60)))
    assert words.startswith("flight: frames 50 to 70")


def test_the_name_of_a_label_ends_where_the_next_one_begins(document, timeline, labels):
    def seen_from(frame):
        row = timeline.row_rect("labels")
        left = round(timeline.x_of_frame(frame)) + 1
        return timeline.tracks.grab(row.adjusted(left - row.left(), 0, 0, 0)).toImage()

    key = document.add("labels", Label("touch", 88, 88, "motion"), "Add")
    document.add("labels", Label("x", 92, 92, "motion"), "Add")
    short = seen_from(92)
    document.replace("labels", key, Label("touch down of the other foot", 88, 88, "motion"), "Rename")
    assert seen_from(92) == short


def test_a_double_click_on_the_empty_row_adds_one_there(document, timeline, labels):
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, at(timeline, 90))
    assert spans(document)["Label"] == (90, 90)
    assert document.history == ("Add label",)
    assert document.selection.current[0] == "labels"


def test_the_menus_of_the_ruler_and_of_the_row_add_one_there(document, timeline, labels):
    ruler = QPointF(at(timeline, 30).x(), timeline.row_rect("ruler").center().y())
    for place in (ruler, QPointF(at(timeline, 90))):
        [action] = menu_at(timeline.tracks, place).actions()
        assert action.text() == "Add label here"
        action.trigger()
    assert spans(document) == {"jump": (20, 20), "flight": (50, 70), "Label": (30, 30), "Label 2": (90, 90)}


def test_a_double_click_on_a_label_renames_it_and_esc_leaves_it(qtbot, document, timeline, labels):
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, at(timeline, 60))
    QTest.keyClicks(field_of(timeline), "in the air")
    QTest.keyClick(field_of(timeline), Qt.Key.Key_Return)
    assert spans(document) == {"jump": (20, 20), "in the air": (50, 70)}
    assert document.history == ("Rename label flight",)
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, at(timeline, 20))
    QTest.keyClicks(field_of(timeline), "hop")
    QTest.keyClick(field_of(timeline), Qt.Key.Key_Escape)
    assert spans(document) == {"jump": (20, 20), "in the air": (50, 70)}
    assert document.undo_stack.count() == 1


def test_a_label_is_dragged_by_whole_frames_as_one_step_and_stays_in_the_motion(document, timeline, hand, labels):
    hand.drag(at(timeline, 60), pixels(timeline, 13.3))
    assert spans(document)["flight"] == (63, 83)
    assert document.history == ("Move label flight",)
    hand.drag(at(timeline, 73), pixels(timeline, 40))
    assert spans(document)["flight"] == (80, 100)
    hand.drag(at(timeline, 20), pixels(timeline, -30))
    assert spans(document)["jump"] == (0, 0)


def test_the_ends_of_a_stretch_are_trimmed_and_do_not_cross(document, timeline, hand, labels):
    hand.drag(at(timeline, 70), pixels(timeline, 8))
    assert spans(document)["flight"] == (50, 78)
    hand.drag(at(timeline, 50), pixels(timeline, 45))
    assert spans(document)["flight"] == (78, 78)
    assert document.history == ("Trim label flight",) * 2


def test_a_drag_that_is_cancelled_leaves_the_label_where_it_was(document, timeline, hand, labels):
    hand.press(at(timeline, 20))
    hand.move(pixels(timeline, 15))
    assert spans(document)["jump"] == (35, 35)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    hand.release()
    assert spans(document)["jump"] == (20, 20)
    assert document.undo_stack.count() == 0


def test_delete_and_the_menu_remove_the_label(document, timeline, hand, labels):
    QTest.mouseClick(timeline.tracks, LEFT, NONE, at(timeline, 20))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert spans(document) == {"flight": (50, 70)}
    assert document.history == ("Delete jump",)
    texts = {action.text(): action for action in menu_at(timeline.tracks, QPointF(at(timeline, 60))).actions()}
    assert list(texts) == ["Rename label", "Delete label"]
    texts["Delete label"].trigger()
    assert spans(document) == {}
    document.undo_stack.undo()
    document.undo_stack.undo()
    assert spans(document) == {"jump": (20, 20), "flight": (50, 70)}


def test_the_playhead_jumps_from_label_to_label(document, timeline, labels):
    document.playhead.set_frame(40)
    for direction, frame, chosen in ((1, 50, 1), (1, 50, 1), (-1, 20, 0), (-1, 20, 0)):
        timeline.go_to_label(direction)
        assert document.playhead.frame == frame
        assert document.selection.current == ("labels", labels[chosen])


def test_the_labels_of_a_motion_go_with_it(document, labels):
    document.remove("motions", "motion", "Remove motion")
    assert spans(document) == {}
    document.undo_stack.undo()
    assert len(spans(document)) == 2
