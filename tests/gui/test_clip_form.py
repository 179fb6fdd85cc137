"""A clip of the library is opened, corrected on its small timeline, confirmed, and stays so."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.stage.prop import Prop
from studio.library.catalogue import Catalogue
from studio.library.clip_labels import HitSegment, Kind, Limb
from studio.library.indexing import index_folders
from studio.panels.clip_line import ClipMark
from studio.resources_folder import bundled_strikes_folder
from tests.gui.window_use import wait_until_idle

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def striking(window, qtbot, library_folder):
    made = window.striking
    made.folder = library_folder
    window.actions_by_id.by_id["find_strike"].trigger()
    wait_until_idle(qtbot, window)
    made.panel.results.setCurrentRow(0)
    qtbot.mouseClick(made.panel.correct, LEFT)
    wait_until_idle(qtbot, window)
    return made


def drag(form, mark, pixels):
    line = form.line
    start = line.place_of(mark).toPoint()
    QTest.mousePress(line, LEFT, pos=start)
    for step in range(1, 5):
        QTest.mouseMove(line, start + QPoint(pixels * step // 4, 0))
    QTest.mouseRelease(line, LEFT, pos=start + QPoint(pixels, 0))


def test_without_a_target_all_strikes_are_listed_and_one_opens(striking):
    assert striking.panel.results.count() == len(striking.library.clips)
    assert striking.pages.currentWidget() is striking.labelling.form
    assert striking.labelling.form.label == striking.library.clips[0].label


def test_what_a_mark_says_is_whole_at_both_ends_of_the_take(striking):
    form = striking.labelling.form
    end = int(form.frames[ClipMark.LAST].maximum())
    for first in (0, end - 2):
        form.line.show_label(replace(form.label, first=first, hit=first + 1, last=first + 2))
        for mark in ClipMark:
            caption = form.line.caption(mark, 52.0)
            assert 0.0 <= caption.left() < caption.right() <= form.line.width()


def test_marks_are_dragged_and_keep_their_order_and_a_drag_is_one_step_back(striking):
    form = striking.labelling.form
    before = form.label
    drag(form, ClipMark.HIT, -12)
    assert form.label.hit < before.hit
    drag(form, ClipMark.FIRST, 400)
    assert form.label.first == form.label.hit - 1
    QTest.mouseClick(form.undo, LEFT)
    assert form.label.first == before.first
    QTest.mouseClick(form.undo, LEFT)
    assert form.label == before
    assert not form.undo.isEnabled()


def test_ctrl_z_after_a_drag_takes_back_the_drag_and_no_edit_of_the_project(striking, window):
    form, document = striking.labelling.form, window.bench.document
    document.add("props", Prop("Box", (0.1, 0.1, 0.1), (1.0, 0.0, 0.1)), "Add Box")
    before, edits = form.label, document.undo_stack.index()
    drag(form, ClipMark.HIT, -12)
    assert form.label != before
    QTest.keyClick(form.line, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert form.label == before
    assert document.undo_stack.index() == edits


def test_another_limb_brings_its_own_kind_and_segments(striking):
    form = striking.labelling.form
    other = Limb.RIGHT_LEG if form.label.limb.is_arm else Limb.LEFT_ARM
    form.limb.value_chosen.emit(other)
    wanted = (Kind.KICK, HitSegment.BALL) if other is Limb.RIGHT_LEG else (Kind.PUNCH, HitSegment.FIST)
    assert (form.label.limb, form.label.kind, form.label.segment) == (other, *wanted)
    assert form.kind.value is wanted[0]


def test_what_is_confirmed_is_in_the_catalogue_and_outlasts_indexing(striking, window, qtbot):
    form = striking.labelling.form
    drag(form, ClipMark.HIT, -12)
    form.tags.setText("high,  spinning, high")
    form.tags.editingFinished.emit()
    wanted = replace(form.label, tags=("high", "spinning"), confirmed=True)
    qtbot.mouseClick(form.confirm, LEFT)
    wait_until_idle(qtbot, window)
    assert not form.confirm.isEnabled()
    with Catalogue(striking.folder) as catalogue:
        count = len(catalogue.clips())
        for name in catalogue.files():  # as if every file had changed
            with catalogue.write_transaction():
                catalogue._database.execute("UPDATE files SET changed = 0 WHERE path = ?", (name,))
        index_folders(catalogue, [bundled_strikes_folder()])
        assert [each.label for each in catalogue.clips() if each.label.confirmed] == [wanted]
        assert len(catalogue.clips()) == count


def test_what_is_no_strike_is_found_no_more(striking, window, qtbot):
    form = striking.labelling.form
    count = len(striking.library.clips)
    form.kind.value_chosen.emit(Kind.NONE)
    qtbot.mouseClick(form.confirm, LEFT)
    wait_until_idle(qtbot, window)
    assert len(striking.library.clips) == count - 1
    assert striking.panel.results.count() == count - 1
