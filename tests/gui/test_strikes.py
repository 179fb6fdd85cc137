"""The Strikes panel: folders into the library, a strike for the box, played and driven to it, undone."""

from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.app.strike_target import StrikeTarget
from studio.core.constraints.position import PositionConstraint
from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.engine.background_tasks import Progress
from studio.engine.live_adaptation import LiveAdaptation
from studio.library.clip_labels import Limb
from studio.panels import strikes
from studio.resources_folder import example_captures_folder
from tests.gui.striking_use import struck_place
from tests.gui.window_use import PATIENCE, choose_by_keys, same, wait_until_idle


def opened(window, qtbot, folder):
    made = window.striking
    made.folder = folder
    window.actions_by_id.by_id["find_strike"].trigger()
    wait_until_idle(qtbot, window)
    return made


@pytest.fixture
def striking(window, qtbot, library_folder):
    return opened(window, qtbot, library_folder)


def add_box(window, place=(0.75, -0.1, 1.3)):
    return window.bench.document.add("props", Prop("Target", (0.1, 0.1, 0.1), place), "Add Target")


def solved(window, qtbot):
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    return window.bench.live.result(window.bench.document.active_performer_id)


def test_a_new_library_has_the_bundled_strikes(window, qtbot, tmp_path):
    striking = opened(window, qtbot, tmp_path / "new")
    assert window.docks["Strikes"].isVisible()
    assert striking.panel.hint.text() == strikes.NO_TARGET_HINT
    assert len(striking.library.clips) == 14


def test_a_strike_is_found_played_and_made_to_hit_and_one_undo_takes_it_back(striking, window, qtbot):
    document = window.bench.document
    add_box(window)
    striking.add_folder(example_captures_folder())
    wait_until_idle(qtbot, window)
    document.playhead.set_frame(20)
    striking.panel.limb.setCurrentIndex(1 + Limb.LEFT_ARM)  # the body of this project reaches the box with it
    solved(window, qtbot)
    qtbot.mouseClick(find_button(striking.panel), Qt.MouseButton.LeftButton)
    assert striking.panel.hint.text() == strikes.EVALUATING_HINT
    wait_until_idle(qtbot, window)
    assert striking.panel.hint.text() == strikes.READY_HINT
    assert "from the target" in striking.panel.results.item(0).text()
    ranks = [(not each.hits, each.found.cost) for each in striking.found]
    assert ranks == sorted(ranks)
    before, steps = document.project, document.undo_stack.count()
    striking.panel.results.itemActivated.emit(striking.panel.results.item(0))
    wait_until_idle(qtbot, window)
    performer = document.project.performers[document.active_performer_id]
    assert len(performer.clips) == 2
    assert performer.clips[0].last == 20
    assert document.undo_stack.count() == steps + 1
    solved(window, qtbot)
    assert struck_place(window, document.active_performer_id)[0] == pytest.approx((0.75, -0.1, 1.3), abs=1e-3)
    document.undo_stack.undo()
    assert same(document.project, before)
    QTest.qWait(0)


def test_the_limb_that_is_chosen_is_the_only_one_that_is_found(striking, window, qtbot):
    add_box(window)
    striking.add_folder(example_captures_folder())
    wait_until_idle(qtbot, window)
    solved(window, qtbot)
    striking.panel.limb.setCurrentIndex(1 + Limb.RIGHT_LEG)
    striking.search()
    wait_until_idle(qtbot, window)
    assert {each.found.clip.label.limb for each in striking.found} == {Limb.RIGHT_LEG}
    striking.panel.limb.setCurrentIndex(0)
    striking.panel.kind.setCurrentIndex(striking.panel.kind.findText("Grasp"))
    striking.search()
    wait_until_idle(qtbot, window)
    assert striking.panel.hint.text() == strikes.NO_MATCH_HINT


def test_what_is_chosen_is_searched_for_at_once(striking, window, qtbot):
    solved(window, qtbot)
    panel, key = striking.panel, add_box(window)
    wait_until_idle(qtbot, window)
    assert panel.hint.text() == strikes.READY_HINT
    assert "from the target" in panel.results.item(0).text()
    choose_by_keys(panel.limb, 1 + Limb.RIGHT_LEG)
    wait_until_idle(qtbot, window)
    assert {clip.label.limb for clip in striking.listed} == {Limb.RIGHT_LEG}
    window.bench.document.remove("props", key, "Delete box")
    assert panel.hint.text() == strikes.NO_TARGET_HINT


def test_a_new_project_lists_no_clips_of_a_pose_that_was_selected_before(striking, window, qtbot):
    striking.list_clips(striking.library.clips[:2])
    window.bench.document.new(Project())
    wait_until_idle(qtbot, window)
    assert striking.panel.hint.text() == strikes.NO_TARGET_HINT
    assert striking.panel.results.count() == len(striking.library.clips)


def test_without_a_box_it_says_that_one_is_needed(striking, window, qtbot):
    striking.add_folder(example_captures_folder())
    wait_until_idle(qtbot, window)
    striking.search()
    assert striking.panel.hint.text() == strikes.NO_TARGET_HINT
    add_box(window)
    assert striking.panel.target.currentText() == "Target"


def test_strikes_are_ranked_as_soon_as_the_body_is_solved(striking, window, qtbot, monkeypatch):
    add_box(window)
    with monkeypatch.context() as patch:
        patch.setattr(LiveAdaptation, "ready", False)  # what searches is still being compiled
        striking.search()
        assert striking.panel.hint.text() == strikes.UNSOLVED_HINT
        assert striking.panel.results.count() == 14
    window.bench.live.adapted.emit(window.bench.document.active_performer_id)
    wait_until_idle(qtbot, window)
    assert striking.panel.hint.text() == strikes.READY_HINT
    assert "from the target" in striking.panel.results.item(0).text()


def test_who_aims_at_its_own_face_is_told_to_choose_another_target(striking, window):
    striking.panel.target.show_value(StrikeTarget("performers", window.bench.document.active_performer_id))
    striking.search()
    assert striking.panel.hint.text() == strikes.OWN_FACE_HINT


def test_a_folder_without_use_is_told_and_nothing_changes(striking, window, qtbot, tmp_path):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    (tmp_path / "takes").mkdir()
    (tmp_path / "takes" / "broken.bvh").write_text("HIERARCHY nothing")
    before = window.bench.document.project
    striking.add_folder(tmp_path / "takes")
    wait_until_idle(qtbot, window)
    assert said[-1].startswith("broken.bvh")
    assert said[-1].count("broken.bvh") == 1
    assert window.bench.document.project is before


def test_a_folder_that_is_cancelled_leaves_what_was_read_by_then_in_the_list(striking, window, qtbot, monkeypatch):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    report = Progress.report

    def cancelled_before_the_third(progress, fraction, text=""):
        if text == "reach_grasp.bvh":
            progress.cancel()
        report(progress, fraction, text)

    monkeypatch.setattr(Progress, "__call__", cancelled_before_the_third)
    striking.add_folder(example_captures_folder())
    wait_until_idle(qtbot, window)
    assert "front_kick" in [clip.take.motion.name for clip in striking.library.clips]
    assert "straight_punch" not in [clip.take.motion.name for clip in striking.library.clips]
    assert said == ["Adding captures was cancelled. Clips indexed by then are in the library."]


def test_a_constraint_of_the_strike_belongs_to_its_clip_alone(striking, window, qtbot):
    prop = add_box(window)
    striking.add_folder(example_captures_folder())
    wait_until_idle(qtbot, window)
    solved(window, qtbot)
    striking.search()
    wait_until_idle(qtbot, window)
    striking.play(0)
    wait_until_idle(qtbot, window)
    document = window.bench.document
    made = list(document.project.constraints.values())[-1]
    assert isinstance(made, PositionConstraint)
    assert made.target.prop_id == prop
    assert made.scope.clip_id == document.project.performers[document.active_performer_id].clips[-1].id


class SeenPreview:
    """A viewport's preview, which tells what it is asked to show."""

    points = None

    def show(self, points, pairs=None):
        self.points = points


def test_a_result_under_the_mouse_is_a_ghost_that_passes_the_target_and_no_edit(striking, window, qtbot):
    place = (0.75, -0.1, 1.3)
    add_box(window, place)
    solved(window, qtbot)
    striking.search()
    wait_until_idle(qtbot, window)
    seen, results, before = SeenPreview(), striking.panel.results, window.bench.document.project
    window.bench.set_viewport(SimpleNamespace(preview=seen))
    results.itemEntered.emit(results.item(0))
    assert np.linalg.norm(seen.points[-1] - place, axis=1).min() < striking.found[0].found.reach + 0.25
    assert window.bench.document.project is before
    results.viewportEntered.emit()
    assert seen.points is None
    window.bench.set_viewport(None)


def test_the_button_uses_the_chosen_result(striking, window, qtbot):
    add_box(window)
    solved(window, qtbot)
    striking.search()
    wait_until_idle(qtbot, window)
    assert not striking.panel.use.isEnabled()
    striking.panel.results.setCurrentRow(1)
    steps = window.bench.document.undo_stack.count()
    qtbot.mouseClick(striking.panel.use, Qt.MouseButton.LeftButton)
    wait_until_idle(qtbot, window)
    assert window.bench.document.undo_stack.count() == steps + 1
    solved(window, qtbot)
    place, _ = struck_place(window, window.bench.document.active_performer_id)
    assert place == pytest.approx((0.75, -0.1, 1.3), abs=1e-3)


def find_button(panel):
    return next(each for each in panel.findChildren(QPushButton) if each.text() == "Find")
