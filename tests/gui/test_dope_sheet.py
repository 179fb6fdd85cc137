"""The dope sheet: all keys of the selection in rows, a summary on top, fast with many of them."""

import time
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.core.curves.keyed import KeyedPlace
from studio.document.document import Document
from studio.document.keyed_fields import KeyedField
from studio.timeline import picture
from studio.timeline.timeline import Timeline
from studio.timeline.tracks.keys import sheet_id
from tests.builders import make_constraint, make_project
from tests.gui.hand import LEFT, RATE, Hand, curve, pixels
from tests.gui.test_timeline_keys import keyed
from tests.timeline.fakes import FakeLive

NONE = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def two(document):
    """Two constraints with a key each at frame 36, and others."""
    old = document.project.constraints["kick"]
    document.replace("constraints", "kick", replace(old, target=keyed(24, 36)), "Key")
    other = make_constraint(name="Reach", target=keyed(36, 80), activation=curve(1, 10, 70, 90), priority=1)
    key = document.add("constraints", other, "Add")
    document.undo_stack.clear()
    return key


def row(timeline, key, name):
    return timeline.row_rect("sheet", sheet_id(KeyedField("constraints", key, name)))


def at(timeline, area, frame):
    return QPoint(round(timeline.x_of_frame(frame)), area.center().y())


def test_the_button_switches_the_rows_to_those_of_the_keys_of_the_selection_and_back(document, timeline, two):
    timeline.transport.dope.click()
    kinds = [each.kind for each in timeline.tracks.sheet.rows]
    assert kinds == ["summary", *["sheet"] * 4]
    document.selection.set(("constraints", two))
    assert [each.kind for each in timeline.tracks.sheet.rows] == ["summary", "sheet", "sheet"]
    assert row(timeline, two, "target").height() > 0
    timeline.transport.dope.click()
    assert timeline.row_rect("constraints", two).height() > 0


def test_a_key_of_the_summary_is_all_keys_of_that_time(document, timeline, hand, two):
    timeline.set_dope(True)
    hand.drag(at(timeline, timeline.row_rect("summary"), 36), pixels(timeline, 4))
    constraints = document.project.constraints
    assert constraints["kick"].target.times == pytest.approx((24 / RATE, 40 / RATE))
    assert constraints[two].target.times == pytest.approx((40 / RATE, 80 / RATE))
    assert document.undo_stack.count() == 1
    assert not document.selection.items


def test_a_box_over_rows_and_a_drag_move_activations_and_keys_together(document, timeline, hand, two):
    timeline.set_dope(True)
    low = row(timeline, two, "target")
    hand.press(QPoint(round(timeline.x_of_frame(62)), low.bottom() - 1))
    hand.move(pixels(timeline, 30), dy=-low.height() * 2 + 4)
    hand.release()
    assert {key.field.name for key in document.keys.items} == {"activation", "target"}
    hand.drag(at(timeline, low, 80), pixels(timeline, 6))
    constraint = document.project.constraints[two]
    assert constraint.target.times == pytest.approx((36 / RATE, 86 / RATE))
    assert constraint.activation.times == pytest.approx((1 / RATE, 10 / RATE, 76 / RATE, 96 / RATE))


def test_clicks_in_the_sheet_leave_the_rows_as_they_are(document, timeline, two):
    timeline.set_dope(True)
    before = timeline.tracks.sheet.rows
    QTest.mouseClick(timeline.tracks, LEFT, NONE, at(timeline, row(timeline, "kick", "target"), 24))
    assert len(document.keys.items) == 1
    assert timeline.tracks.sheet.rows == before
    QTest.mouseClick(timeline.tracks, LEFT, NONE, at(timeline, row(timeline, "kick", "target"), 95))
    assert not document.keys.items


@pytest.fixture
def crowded(qtbot):
    """A hundred constraints, two rows each, over 20,000 frames; three of them with a key in every frame."""
    frames = 20_000
    project = make_project(characters=1, constraints=0, contacts=0, frames=frames)
    every = KeyedPlace(
        tuple(frame / RATE for frame in range(frames)),
        tuple((0.001 * (frame % 7), 0.0, 1.0) for frame in range(frames)),
    )
    for k in range(100):
        start = 10 + 190 * k
        target = every if k in (0, 1, 50) else keyed(*range(start, start + 150, 10))
        each = make_constraint(
            name=f"Target {k}", priority=k, target=target, activation=curve(start, start + 20, start + 90, start + 120)
        )
        project = project.with_entity("constraints", f"c{k}", each)
    document = Document(project)
    live = FakeLive(document)
    kept = live.result("performer 0")
    live.result = lambda _performer_id: kept  # as the engine's, it is the same until it is solved again
    timeline = Timeline(document, live)
    qtbot.addWidget(timeline)
    timeline.resize(1296, 700)
    timeline.show()
    timeline.set_dope(True)
    timeline.tracks.fold("plot")
    QApplication.processEvents()
    yield timeline, document
    document.close()


@pytest.fixture
def painted(monkeypatch):
    """The rows whose content was painted since the list was last cleared."""
    rows = []

    def count(painter, area, shown, row):
        rows.append(row.key)
        paint(painter, area, shown, row)

    paint = picture._paint_content
    monkeypatch.setattr(picture, "_paint_content", count)
    return rows


def test_only_rows_that_change_are_painted_of_two_hundred_over_twenty_thousand_frames(crowded, painted):
    """None while the playhead moves, those of its constraint and the summary while a key is dragged."""
    timeline, document = crowded
    tracks = timeline.tracks
    assert len(tracks.sheet.rows) == 201
    painted.clear()
    for frame in range(100):
        document.playhead.set_frame(frame)
        tracks.grab()
    assert not painted
    tracks.axis.zoom(40.0, 200.0)
    tracks.grab()
    in_view = [row for row in tracks.sheet.rows if tracks.sheet.rect(row).intersects(tracks.sheet.viewport)]
    assert len(painted) == len(in_view) < 40
    row = next(row for row in in_view if row.id == sheet_id(KeyedField("constraints", "c2", "target")))
    frame = round(document.project.constraints["c2"].target.times[3] * RATE)
    tracks.axis.show((frame - 30) / RATE, (frame + 30) / RATE)
    hand = Hand(timeline)
    hand.press(at(timeline, tracks.sheet.rect(row), frame))
    hand.move(12)
    tracks.grab()
    painted.clear()
    for _ in range(10):
        hand.move(8)
        tracks.grab()
    assert {key for key in painted if key[0] == "sheet"} == {
        (row.kind, sheet_id(KeyedField("constraints", "c2", name))) for name in ("activation", "target")
    }
    assert len(painted) <= 3 * 10 * 2  # of two moves each
    hand.release()


def test_all_sixty_thousand_keys_are_dragged_at_once(crowded):
    """In processor time of the window's thread: two moves took twenty seconds, field by field."""
    timeline, document = crowded
    tracks = timeline.tracks
    tracks.axis.show(1.0, 11.0)
    tracks.setFocus()
    QTest.keyClick(tracks, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    assert len(document.keys.items) > 60_000
    before = document.project.constraints["c50"].target.times
    hand, summary = Hand(timeline), tracks.sheet.rect(tracks.sheet.rows[0])
    hand.press(QPoint(round(timeline.x_of_frame(300)), summary.center().y()))
    hand.move(60)
    begin = time.thread_time()
    hand.move(30)
    tracks.grab()
    assert time.thread_time() - begin < 4.0
    hand.release()
    moved = np.array(document.project.constraints["c50"].target.times) - before
    assert moved == pytest.approx(moved[0], abs=1e-9)
    assert moved[0] > 0.5
    assert len(document.keys.items) > 60_000
    document.undo_stack.undo()
    assert document.project.constraints["c50"].target.times == before


def test_a_paint_of_two_hundred_rows_takes_less_than_a_sixtieth_of_a_second(crowded):
    """In processor time of the window's thread, while the playhead moves, of which there is one for each picture."""
    timeline, document = crowded
    frames = iter(range(1000))
    costs = []
    for _ in range(9):
        begin = time.thread_time()
        document.playhead.set_frame(next(frames))
        timeline.tracks.update()
        QApplication.processEvents()
        costs.append(time.thread_time() - begin)
    assert min(costs) < 1.0 / 60.0
