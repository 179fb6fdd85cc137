"""The map of the library's poses: groups as figures, a ghost of the one under the mouse, its clips on a click."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.core.clip_search import pose_distances
from studio.document import colours
from studio.library.clusters import LEAST_CLUSTER_DISTANCE
from studio.panels import pose_map, strikes
from tests.gui.window_use import PATIENCE, wait_until_idle


@pytest.fixture
def view(window, qtbot, library_folder):
    window.striking.folder = library_folder
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    window.actions_by_id.by_id["pose_map"].trigger()
    wait_until_idle(qtbot, window)
    made = window.striking.mapping.view
    qtbot.waitUntil(lambda: bool(made._groups), timeout=PATIENCE)
    made.resize(1000, 260)
    return made


def test_every_group_has_a_place_of_its_own_in_the_view(view):
    cells = [view.cell(number) for number in range(len(view._groups))]
    assert 6 <= len(cells) <= 24
    for number, cell in enumerate(cells):
        assert view.rect().toRectF().contains(cell)
        assert not any(cell.adjusted(1, 1, -1, -1).intersects(other) for other in cells[:number])


def test_a_click_lists_the_clips_of_the_group(view, window):
    striking = window.striking
    QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=view.cell(5).center().toPoint())
    wanted = striking.mapping._map.clips_of(5, striking.library.table)
    assert [clip.number for clip in striking.listed] == [striking.library.clips[each].number for each in wanted]
    assert striking.panel.hint.text() == strikes.POSE_CLIPS_HINT


def test_the_group_under_the_mouse_is_a_ghost_on_the_active_body(view, window):
    seen = []
    preview = SimpleNamespace(show=lambda points, pairs=None: seen.append(points))
    window.bench.set_viewport(SimpleNamespace(preview=preview))
    QTest.mouseMove(view, view.cell(3).center().toPoint())
    view._look(3)
    root = window.bench.live.result(window.bench.document.active_performer_id).positions[0, 0]
    assert np.linalg.norm(seen[-1][0, 0, :2] - root[:2]) < 0.3
    view._look(-1)
    assert seen[-1] is None
    window.bench.set_viewport(None)


def test_similar_poses_lie_side_by_side(view, window):
    striking = window.striking
    rows = striking.library.table.rows
    places = striking.mapping._map.places(rows)
    order = np.argsort(places[:, 0])
    poses = rows[striking.mapping._map.representatives]
    neighbours = [pose_distances(poses[a], poses[b : b + 1])[0][0] for a, b in pairwise(order)]
    ends = pose_distances(poses[order[0]], poses[order[-1] : order[-1] + 1])[0][0]
    assert np.mean(neighbours) < ends


def test_letters_tell_left_from_right_and_a_tooltip_says_so_and_names_the_clips(view, monkeypatch):
    letters = []
    monkeypatch.setattr(view, "_paint_letters", lambda *given: letters.append(given[3]))
    view.grab()
    assert letters.count("L") == letters.count("R") == len(view._groups)
    QTest.mouseMove(view, view.cell(2).center().toPoint())
    view._look(2)
    assert view._groups[2].clips[0] in view.toolTip()
    assert view.toolTip().endswith(pose_map.SIDES_HINT)
    view._look(-1)
    assert view.toolTip() == ""


def test_no_two_figures_are_alike(view, window):
    poses = window.striking.library.table.rows[window.striking.mapping._map.representatives]
    apart = [pose_distances(pose, np.delete(poses, number, axis=0))[0].min() for number, pose in enumerate(poses)]
    assert min(apart) > LEAST_CLUSTER_DISTANCE


def test_figures_tell_left_from_right_by_colour_too(view):
    image = view.grab().toImage()
    seen = {image.pixelColor(x, y).name() for x in range(0, image.width(), 2) for y in range(image.height())}
    assert {colours.LEFT, colours.RIGHT} <= seen
