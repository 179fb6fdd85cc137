"""Layers in the user's hands: added, dragged, trimmed, changed in their form, saved, and solved."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF

from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.stage.layer import Layer, Region
from studio.document import clip_edits
from studio.engine.body_request import body_request_of
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.jobs.performances import prepared_capture
from studio.panels.inspector import Inspector
from studio.timeline.hover import hover_text
from tests.gui.hand import RATE, pixels
from tests.gui.test_timeline_clips import FIRST, SECOND, choose, document, place  # noqa: F401 - a fixture is used


@pytest.fixture
def layer(document):  # noqa: F811
    """The clip of a layer over the second one's upper body, from frame 20 on."""
    name = clip_edits.add_layer(document, [SECOND], "other", 20 / RATE)
    document.selection.set(("performers", SECOND), ("clips", name))
    document.undo_stack.clear()
    return name


def layer_of(document, performer_id=SECOND):  # noqa: F811
    [found] = document.project.performers[performer_id].layers
    return found


def layer_place(timeline, frame, region=Region.UPPER_BODY):
    row = timeline.row_rect("layer", f"{SECOND}/{region}")
    return QPoint(round(timeline.x_of_frame(frame)), row.center().y())


def test_a_layer_is_added_from_the_menu_and_has_a_row_under_its_performers(document, timeline):  # noqa: F811
    choose(timeline, place(timeline, SECOND, 70), "Add layer", "Other")
    added = layer_of(document)
    assert ("clips", added.clip.id) in document.selection
    assert added.clip.start * RATE == pytest.approx(70, abs=0.5)
    row, above = (timeline.row_rect(*which) for which in (("layer", f"{SECOND}/upper body"), ("clip", SECOND)))
    assert row.top() == above.bottom() + 1
    assert timeline.row_rect("layer", f"{FIRST}/upper body").isEmpty()
    document.undo_stack.undo()
    assert document.project.performers[SECOND].layers == ()


def test_its_bar_is_moved_and_trimmed_as_clips_are(document, timeline, hand, layer):  # noqa: F811
    hand.drag(layer_place(timeline, 70), pixels(timeline, 7))
    assert layer_of(document).clip.start * RATE == pytest.approx(27)
    hand.drag(layer_place(timeline, 27) + QPoint(1, 0), pixels(timeline, 10))
    assert layer_of(document).clip.first == 10
    assert document.undo_stack.count() == 2
    row = document.project.performers[SECOND].clips
    assert [each.id for each in row] == ["walk", "kick"]
    words = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(layer_place(timeline, 90)))
    assert words.startswith("Other")


def test_its_form_changes_it_and_undo_takes_it_back(document, timeline, live, layer, qtbot):  # noqa: F811
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    before = layer_of(document)
    section = inspector.current_form()._layer
    section._region.setCurrentIndex(section._region.findText("Left arm"))
    section._region.activated.emit(section._region.currentIndex())
    section._weight.setValue(40.0)
    section._fades[0].setValue(0.5)
    section._additive.click()
    section._reference.setValue(12)
    after = layer_of(document)
    assert (after.region, after.weight, after.fade_in) == (Region.LEFT_ARM, 0.4, 0.5)
    assert (after.additive, after.reference) == (True, 12)
    assert not timeline.row_rect("layer", f"{SECOND}/left arm").isEmpty()
    assert inspector.current_form()._place.isHidden()
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert layer_of(document) == before


def test_it_is_split_duplicated_and_deleted_as_clips_are(document, layer):  # noqa: F811
    clip_edits.split_clip(document, layer, 50 / RATE)
    clip_edits.duplicate_clip(document, layer)
    assert len(document.project.performers[SECOND].layers) == 3
    clip_edits.remove_clips(document, [layer], "Delete")
    assert len(document.project.performers[SECOND].layers) == 2
    document.remove("motions", "other", "Delete")
    assert document.project.performers[SECOND].layers == ()


def test_whose_layers_change_is_solved_anew(document, layer):  # noqa: F811
    def wanted():
        return body_request_of(document.project, SECOND, (SECOND,), lambda _: None)

    before = wanted()
    clip_edits.edit_layer(document, layer, "Weight", weight=0.5)
    assert wanted() != before
    assert not wanted().has_same_grounding(before)


def test_a_project_keeps_its_layers_and_plays_them(document, layer, tmp_path):  # noqa: F811
    clip_edits.edit_layer(document, layer, "Arm", region=Region.RIGHT_ARM, weight=0.7, fade_out=0.2)
    write_project(tmp_path / "layers.studio", document.project, new_document_id())
    opened = read_project(tmp_path / "layers.studio")
    assert opened.problems == ()
    assert opened.project.performers == document.project.performers
    plain = document.project.with_entity("performers", SECOND, replace(document.project.performers[SECOND], layers=()))
    over, without = (
        adapt_performers(project, [SECOND], prepared_capture, adapt).performances[SECOND]
        for project in (opened.project, plain)
    )
    assert over.composite.timing == without.composite.timing
    assert isinstance(opened.project.performers[SECOND].layers[0], Layer)
