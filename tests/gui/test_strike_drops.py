"""A strike that was found is dropped on a body or its row: it hits what is aimed at, wherever that goes, or was."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from studio.app.strike_target import StrikeTarget
from studio.core.curves.keyed import KeyedPlace
from studio.core.stage.prop import Prop
from studio.document.dragging import STRIKE_MIME, row_drag_data
from studio.library.clip_labels import Limb
from studio.viewport import picking
from studio.viewport.dropping import BodyDrops
from tests.gui.striking_use import struck_place
from tests.gui.window_use import PATIENCE, same, wait_until_idle

PLACE = (0.75, -0.1, 1.3)


@pytest.fixture
def striking(window, qtbot, library_folder):
    made = window.striking
    made.folder = library_folder
    window.bench.document.add("props", Prop("Target", (0.1, 0.1, 0.1), PLACE), "Add Target")
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    window.actions_by_id.by_id["find_strike"].trigger()
    wait_until_idle(qtbot, window)
    made.panel.limb.setCurrentIndex(1 + Limb.LEFT_ARM)  # the bodies of this project reach it with that one
    made.search()
    wait_until_idle(qtbot, window)
    return made


def dropped_on(striking, window, qtbot, key, time=0.3):
    striking.play(0, key, time)
    wait_until_idle(qtbot, window)
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)


def test_any_body_can_be_chosen_not_only_the_active_one_and_one_undo_takes_it_back(striking, window, qtbot):
    document = window.bench.document
    other = next(key for key in document.project.performers if key != document.active_performer_id)
    document.replace("performers", other, replace(document.project.performers[other], position=(0.0, 0.0)), "Move")
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    before, steps = document.project, document.undo_stack.count()
    dropped_on(striking, window, qtbot, other)
    assert len(document.project.performers[other].clips) == 2
    assert document.active_performer_id == other
    assert document.undo_stack.count() == steps + 1
    assert struck_place(window, other)[0] == pytest.approx(PLACE, abs=1e-3)
    document.undo_stack.undo()
    assert same(document.project, before)


def test_a_target_that_moves_is_hit_where_it_is_then(striking, window, qtbot):
    document, key = window.bench.document, window.bench.document.active_performer_id
    prop_id, prop = next(iter(document.project.props.items()))
    away = (PLACE[0] + 0.05, PLACE[1] + 0.1, PLACE[2] + 0.1)
    moving = replace(prop, position=KeyedPlace((0.0, 2.0), (PLACE, away)))
    document.replace("props", prop_id, moving, "Move")
    dropped_on(striking, window, qtbot, key)
    place, time = struck_place(window, key)
    there = StrikeTarget("props", prop_id).place(document.project, window.bench.live.result, time)
    assert place == pytest.approx(there, abs=1e-3)
    assert np.linalg.norm(place - PLACE) > 0.01


def test_a_frozen_target_is_hit_where_it_was_when_it_was_asked(striking, window, qtbot):
    document, key = window.bench.document, window.bench.document.active_performer_id
    striking.panel.aim.value_chosen.emit(False)
    wait_until_idle(qtbot, window)
    dropped_on(striking, window, qtbot, key)
    prop_id, prop = next(iter(document.project.props.items()))
    document.replace("props", prop_id, replace(prop, position=(2.0, 1.0, 0.5)), "Move")
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    assert struck_place(window, key)[0] == pytest.approx(PLACE, abs=1e-3)


def test_a_face_can_be_struck_but_not_ones_own(striking, window, qtbot):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    document, panel = window.bench.document, striking.panel
    one, other = list(document.project.performers)[:2]
    striker = replace(document.project.performers[other], position=(0.0, 0.0), heading=0.0)
    opponent = replace(document.project.performers[one], position=(1.9, 0.0), heading=np.pi)
    document.replace("performers", other, striker, "Move")
    document.replace("performers", one, opponent, "Move")
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    panel.target.show_value(StrikeTarget("performers", one))
    striking.play(0, one)
    assert "own face" in said[-1]
    dropped_on(striking, window, qtbot, other)
    place, time = struck_place(window, other)
    assert place == pytest.approx(
        StrikeTarget("performers", one).place(document.project, window.bench.live.result, time), abs=1e-3
    )


def test_a_drop_on_the_row_begins_where_it_fell(striking, window, qtbot):
    from studio.app.application import show_timeline

    show_timeline(window)
    document, tracks = window.bench.document, window.bench.timeline.tracks
    key = document.active_performer_id
    qtbot.waitUntil(lambda: tracks.sheet is not None)
    rect = window.bench.timeline.row_rect("clip", key)
    where = QPointF(tracks.axis.x_of_frame(12), rect.center().y())
    time = tracks.axis.time_at(where.x())
    drop(tracks, where, tracks.dropEvent)
    wait_until_idle(qtbot, window)
    assert document.project.performers[key].clips[-1].start == pytest.approx(time, abs=1 / 60)


def test_over_the_3d_view_the_body_under_the_mouse_is_chosen_and_takes_it(document, qtbot, monkeypatch):
    view, taken = QWidget(), []
    view.posed = view.camera = view.view_size = None
    qtbot.addWidget(view)
    drops = BodyDrops(view, document, STRIKE_MIME)
    drops.dropped.connect(lambda *what: taken.append(what))
    key = next(iter(document.project.performers))
    monkeypatch.setattr(picking, "body_at", lambda *_: None)
    assert not drop(view, QPointF(5, 5), lambda event: drops.eventFilter(view, event), 3).isAccepted()
    monkeypatch.setattr(picking, "body_at", lambda *_: key)
    assert drop(view, QPointF(5, 5), lambda event: drops.eventFilter(view, event), 3).isAccepted()
    assert taken == [(3, key)]


def drop(widget, where, take, row=0):
    left, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    content = row_drag_data(STRIKE_MIME, row)  # the event borrows it
    event = QDropEvent(where, Qt.DropAction.CopyAction, content, left, keys)
    take(event)
    return event


def test_what_is_said_to_hit_hits_and_what_is_said_to_fall_short_does(striking, window, qtbot):
    document, panel = window.bench.document, striking.panel
    key, (prop_id, prop) = document.active_performer_id, next(iter(document.project.props.items()))
    for place, words in ((PLACE, "meets it"), ((2.5, -0.1, 1.3), "short")):
        document.replace("props", prop_id, replace(prop, position=place), "Move")
        assert window.bench.live.wait_until_solved(PATIENCE / 1000)
        striking.search()
        wait_until_idle(qtbot, window)
        assert panel.results.item(0).text().endswith(words)
        dropped_on(striking, window, qtbot, key, 0.0)
        missed = np.linalg.norm(struck_place(window, key)[0] - place)
        assert (missed < 0.005) == striking.found[0].hits
        document.undo_stack.undo()
