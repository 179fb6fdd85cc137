"""The viewport driven as a person would: mouse and keys on the widget, looking at the document."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QEvent, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton

from studio.document.document import Document
from studio.engine.empty_stage import ALL_HIDDEN_PROMPT
from studio.viewport.stage_picture import StageScene
from studio.viewport.widget import Viewport
from tests.builders import make_project
from tests.gui.viewport_use import LEFT, chip, settle
from tests.patience import PATIENCE
from tests.viewport.standing import StandingLive


def test_the_problem_chip_goes_to_the_worst_frame_and_selects_the_constraint(studio):
    viewport, document, live = studio
    live.adapt()
    settle(viewport)
    problem = chip(viewport, "most_important_problem")
    assert problem.isVisible()
    assert "'Target 0' has an error of" in problem.text()
    QTest.mouseClick(problem, LEFT)
    assert document.playhead.frame == int(problem.text().rsplit(" ", 1)[1])
    assert document.selection.current == ("constraints", "constraint 0")


def test_chips_turn_bones_ghost_and_parallel_view_on_and_off(studio):
    viewport, _, _ = studio
    picture = viewport.grab().toImage()
    for name in ("skin_or_bones", "ghost_of_the_source", "perspective_or_orthographic_view"):
        QTest.mouseClick(chip(viewport, name), LEFT)
        settle(viewport)
        assert viewport.grab().toImage() != picture
    assert viewport.ghost_shown
    assert viewport.camera.parallel
    assert chip(viewport, "skin_or_bones").text() == "Bones"
    assert chip(viewport, "perspective_or_orthographic_view").text() == "Orthographic"


def test_everything_to_click_has_an_accessible_name_and_can_be_reached_by_tab(studio):
    viewport, _, _ = studio
    assert viewport.accessibleName()
    for button in viewport.findChildren(QPushButton):
        assert button.accessibleName()
        assert button.focusPolicy() & Qt.FocusPolicy.TabFocus


def test_the_bodies_follow_the_playhead_frame_by_frame(studio):
    viewport, document, _ = studio
    document.playhead.set_frame(5)
    settle(viewport)
    shown = viewport.posed["performer 0"]
    assert shown.row == 5
    document.playhead.set_time(5.3 / 60)
    settle(viewport)
    assert viewport.posed["performer 0"] is shown
    document.playhead.set_time(5.7 / 60)
    settle(viewport)
    assert viewport.posed["performer 0"].row == 6


def test_a_narrow_view_leaves_out_chips_instead_of_cutting_them(studio):
    viewport, _, _ = studio
    viewport.resize(300, 300)
    settle(viewport)
    for button in (one for one in viewport.findChildren(QPushButton) if one.isVisible()):
        assert button.width() >= button.sizeHint().width()
        assert viewport.rect().contains(button.geometry())


@pytest.mark.parametrize("width", [300, 500, 700, 900, 1100, 1300, 1700])
def test_statistics_drop_the_parts_that_do_not_fit(studio, width):
    viewport, _, _ = studio
    viewport.resize(width, 300)
    settle(viewport)
    chips = viewport._chips
    chips.show_work(4, "12 fps · latency 1085 ms", False)
    viewport.layout().activate()
    shown = [one for one in viewport.findChildren(QPushButton) if one.isVisible()]
    shown += [chips.work] if chips.work.isVisible() else []
    for each in shown:
        assert each.width() >= each.sizeHint().width()
        assert viewport.rect().contains(each.geometry())
    parts = ("4 characters", "12 fps", "latency 1085 ms", "anti-aliased when idle")
    assert chips.work.text() in [" · ".join(parts[:count]) for count in range(len(parts) + 1)]
    assert chips.work.isVisible() == bool(chips.work.text())
    assert chips.work.text() or width < 1300


def test_another_project_takes_the_place_of_this_one(studio):
    viewport, document, _ = studio
    document.new(make_project(characters=1))
    settle(viewport)
    assert list(viewport.posed) == ["performer 0"]
    document.new(make_project(characters=0, constraints=0))
    settle(viewport)
    assert viewport.posed == {}


def test_the_image_for_thumbnails_has_the_size_of_the_widget_and_no_chips(studio):
    viewport, _, _ = studio
    image = viewport.grab_image()
    assert (image.width(), image.height()) == (600, 400)
    assert image.pixelColor(30, 23).lightness() < 60


def test_a_viewport_opens_and_closes_many_times_and_leaves_document_and_engine_usable(qtbot):
    document = Document(make_project(characters=1))
    live = StandingLive(document)
    for _ in range(4):
        viewport = Viewport(document, live)
        viewport.resize(300, 200)
        viewport.show()
        viewport.start()
        viewport.close()
        viewport.stop()
        viewport.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        document.playhead.step(1)
        live.adapt()
        QTest.qWait(5)
    assert document.playhead.frame == 4
    assert all(live.result(performer) is not None for performer in document.project.performers)


def test_a_viewport_starts_vtk_then_draws_the_stage_then_the_bodies_each_in_a_turn_of_its_own(qtbot, monkeypatch):
    turns, turn = [], [0]
    beat = QTimer(interval=0)
    beat.timeout.connect(lambda: turn.__setitem__(0, turn[0] + 1))
    for owner, name in ((StageScene, "__init__"), (StageScene, "render"), (StageScene, "sync")):
        real = getattr(owner, name)

        def noted(*known, name=name, real=real, **named):
            turns.append((name, turn[0]))
            return real(*known, **named)

        monkeypatch.setattr(owner, name, noted)
    document = Document(make_project(characters=2))
    viewport = Viewport(document, StandingLive(document))
    beat.start()
    with qtbot.waitSignal(viewport.started, timeout=PATIENCE):
        viewport.show()
    beat.stop()
    assert [name for name, _ in turns] == ["__init__", "render", "sync", "render"]
    begun, stage, bodies, drawn = (when for _, when in turns)
    assert begun < stage < bodies == drawn
    viewport.close()
    viewport.deleteLater()


def test_a_picture_is_of_the_whole_stage_even_of_a_viewport_that_was_never_shown(qtbot):
    document = Document(make_project(characters=1))
    viewport = Viewport(document, StandingLive(document))
    viewport.resize(300, 200)
    image = viewport.grab_image()
    assert viewport.posed
    assert image.size() == viewport.size()
    viewport.close()
    viewport.deleteLater()


def test_a_viewport_closed_before_it_has_started_stays_closed(qtbot):
    document = Document(make_project(characters=1))
    viewport = Viewport(document, StandingLive(document))
    started = []
    viewport.started.connect(lambda: started.append(True))
    viewport.show()
    viewport.stop()
    viewport.repaint()
    QTest.qWait(20)
    assert not started
    viewport.close()
    viewport.deleteLater()


def test_a_body_whose_motion_is_not_there_yet_stands_in_its_rest_pose(studio):
    viewport, document, live = studio
    live.late = {"performer 1"}
    viewport.redraw()
    settle(viewport)
    assert set(viewport.posed) == {"performer 0"}
    assert set(viewport.resting) == {"performer 1"}
    [placed] = viewport.resting.values()
    assert placed.points[0, 1] == pytest.approx(document.project.performers["performer 1"].position[1])


def test_while_nobody_performs_the_view_says_what_is_under_way_and_else_what_to_do(studio):
    viewport, document, live = studio
    assert viewport.notice == ""
    live.late = set(document.project.performers)
    viewport.redraw()
    settle(viewport)
    viewport.show_progress("Opening walk.bvh", 0.4)
    assert viewport.notice == "Opening walk.bvh"
    viewport.show_progress("", 0.0)
    assert viewport.notice == ""
    for key, performer in document.project.performers.items():
        document.replace("performers", key, replace(performer, visible=False), "Hide")
    assert viewport.notice == ALL_HIDDEN_PROMPT


def test_the_playhead_may_move_when_what_is_shown_is_gone(studio):
    viewport, document, _ = studio
    assert viewport.posed
    document.new(make_project(characters=0, constraints=0, contacts=0))
    document.playhead.set_time(0.1)
    settle(viewport)
    assert not viewport.posed
