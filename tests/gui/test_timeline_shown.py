"""Contents of the timeline: errors, plots, words where there is nothing, the transport."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from studio.core.body.pose import PoseSequence
from studio.core.constraints.scope import Scope
from studio.core.stage.project import Project
from studio.document import colours
from studio.engine.empty_stage import ALL_HIDDEN_PROMPT
from studio.timeline.curves import Quantity
from studio.timeline.hover import hover_text
from studio.timeline.strip_states import StripState
from studio.timeline.tracks import constraint, contacts
from tests.builders import make_constraint
from tests.gui.hand import LEFT, NONE, RATE, frames, pixels


def test_the_strip_of_a_body_follows_its_residual(timeline, live):
    live.errors["performer 1"] = {"kick": 0.042}
    assert timeline.strip_state("kick", "performer 0", 40) == StripState.HELD
    assert timeline.strip_state("kick", "performer 1", 40) == StripState.NOT_REACHED
    assert timeline.strip_state("kick", "performer 1", 80) == StripState.INACTIVE


def test_pointing_at_a_strip_tells_the_millimetres(timeline, live, qtbot):
    live.errors["performer 1"] = {"kick": 0.042}
    timeline.tracks.document.playhead.set_frame(43)  # its line does not hide what it lies over
    with qtbot.waitSignal(timeline.message_posted) as told:
        QTest.mouseMove(timeline.tracks, timeline.strip_point("kick", "performer 1", 43))
    assert told.args == ["Body 1: 42 mm at frame 43"]


def test_pointing_at_a_name_tells_who_misses_the_constraint_most(timeline, live, qtbot):
    live.errors = {"performer 0": {"kick": 0.004}, "performer 1": {"kick": 0.042}}
    row = timeline.row_rect("constraints", "kick")
    with qtbot.waitSignal(timeline.message_posted) as told:
        QTest.mouseMove(timeline.tracks, QPoint(60, row.center().y()))
    assert told.args == ["Kick target: Body 1 42 mm at frame 30"]


def strip_colour(timeline, frame):
    place = timeline.strip_point("kick", "performer 1", frame)
    return timeline.tracks.grab().toImage().pixelColor(place)


def test_strips_are_painted_anew_soon_after_a_result(qtbot, timeline, live):
    held = strip_colour(timeline, 40)
    live.errors["performer 1"] = {"kick": 0.042}
    live.reported_changed.emit()
    qtbot.waitUntil(lambda: strip_colour(timeline, 40).red() > 150 > held.red())


def test_a_row_warns_of_a_constraint_that_a_cut_clip_leaves_out(document, timeline, live):
    live.errors = {key: {"kick": np.nan} for key in document.project.performers}
    live.reported_changed.emit()
    assert constraint.residual_text(timeline.tracks.shown, "kick") == ("fade cut by the clip", colours.PARTLY)


def test_a_body_that_is_not_solved_yet_is_hatched_and_nobody_says_held(timeline, live):
    green = strip_colour(timeline, 40)
    live.unsolved.add("performer 1")
    live.reported_changed.emit()
    place = timeline.strip_point("kick", "performer 1", 40)
    picture = timeline.tracks.grab().toImage()
    line = {picture.pixelColor(place + QPoint(dx, 0)).name() for dx in range(12)}
    assert green.name() not in line
    assert len(line) > 1  # a hatch, no plain line
    assert timeline.strip_state("kick", "performer 1", 40) == StripState.UNKNOWN
    shown = timeline.tracks.shown
    assert constraint.residual_text(shown, "kick")[0] == "not solved yet for 1 of 2"
    text = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place))
    assert text == "Body 1: not solved yet"
    live.unsolved.add("performer 0")
    assert constraint.residual_text(shown, "kick")[0] == "not solved yet"
    live.unsolved.clear()
    assert constraint.residual_text(shown, "kick")[0] == "met on all characters"


def test_a_moved_playhead_draws_no_row_again(document, timeline, monkeypatch):
    timeline.grab()
    drawn = []
    monkeypatch.setattr("studio.timeline.picture._paint_content", lambda *each: drawn.append(each))
    document.playhead.set_frame(33)
    timeline.grab()
    assert drawn == []


def test_a_dragged_curve_is_drawn_with_every_move_and_its_label_when_results_are_told(timeline, live, monkeypatch):
    timeline.grab()
    drawn = []
    for name in ("_paint_content", "_paint_label"):
        monkeypatch.setattr(f"studio.timeline.picture.{name}", lambda *each, name=name: drawn.append(name))
    document = timeline.tracks.document
    live.interactive = True
    asked = document.project.constraints["kick"]
    later = replace(asked, activation=replace(asked.activation, end=asked.activation.end + 0.1))
    document.replace("constraints", "kick", later, "Drag")
    timeline.grab()
    assert drawn == ["_paint_content"]
    document.selection.set(("constraints", "kick"))
    timeline.grab()
    drawn.clear()
    live.reported_changed.emit()
    timeline.grab()
    assert sorted(drawn) == ["_paint_content", "_paint_label"]


def test_rows_follow_the_constraints_in_order_of_priority(document, timeline):
    added = document.add("constraints", make_constraint(name="First", priority=0), "")
    document.replace("constraints", "kick", make_constraint(name="Kick", priority=1), "")
    first, second = timeline.row_rect("constraints", added), timeline.row_rect("constraints", "kick")
    assert first.bottom() + 1 == second.top()
    document.remove("constraints", added, "")
    assert timeline.row_rect("constraints", added).isEmpty()
    assert timeline.row_rect("constraints", "kick") == first


def test_the_plot_can_show_the_error_of_a_constraint(timeline, live):
    live.errors["performer 1"] = {"kick": 0.042}
    timeline.tracks.set_quantity(Quantity.ERROR)
    timeline.grab()
    plot = timeline.tracks.picture.plot
    assert [round(curve.at(40 / RATE), 6) for curve in plot.curves] == [0.0, 42.0]
    assert plot.top == pytest.approx(42.0)


def test_what_is_rounding_alone_is_plotted_at_nought(timeline, live):
    live.errors["performer 1"] = {"kick": 4.2e-14}
    timeline.tracks.set_quantity(Quantity.ERROR)
    timeline.grab()
    assert timeline.tracks.picture.plot.top == 1.0


def test_curves_of_long_motions_are_made_beside_the_window_and_are_the_same(timeline, live, qtbot, monkeypatch):
    results = {body.performer_id: live.result(body.performer_id) for body in timeline.tracks.shown.subject.bodies}
    monkeypatch.setattr(live, "result", results.get)
    plot = timeline.tracks.picture.plot
    timeline.grab()
    at_once = {curve.name: curve.values for curve in plot.curves}
    monkeypatch.setattr("studio.timeline.tracks.plot.MOST_FRAMES_AT_ONCE", 0)
    plot.drop_curves()
    timeline.tracks.set_quantity(Quantity.KNEE_SPEED)
    timeline.grab()
    assert plot.curves == []
    timeline.tracks.set_quantity(Quantity.FOOT_SPEED)  # what was asked before is of no use any more
    with qtbot.waitSignal(plot.arrived):
        timeline.grab()

    def all_there():
        timeline.grab()
        return len(plot.curves) == len(results)

    qtbot.waitUntil(all_there)
    assert {curve.name: curve.values.tolist() for curve in plot.curves} == {
        name: values.tolist() for name, values in at_once.items()
    }


@pytest.mark.parametrize("quantity", Quantity)
def test_every_quantity_is_plotted_for_every_body_with_its_unit(timeline, quantity):
    timeline.tracks.set_quantity(quantity)
    timeline.grab()
    plot, shown = timeline.tracks.picture.plot, timeline.tracks.shown
    assert len(plot.curves) == len(shown.subject.bodies)
    assert all(np.isfinite(curve.values).all() and curve.values.min() >= -0.1 for curve in plot.curves)
    assert quantity.unit(shown) in plot.words(shown, 1.0)


def test_without_a_motion_one_line_says_what_to_do_and_nothing_breaks(document, timeline):
    document.new(Project())
    assert timeline.row_rect("ruler").isEmpty()
    assert not timeline.tracks.grab().isNull()
    QTest.mouseClick(timeline.tracks, LEFT, NONE, QPoint(300, 100))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert timeline.tracks.prompt == "Drop a capture here"


def test_with_nobody_shown_the_line_asks_for_a_character(document, timeline):
    for key, performer in document.project.performers.items():
        document.replace("performers", key, replace(performer, visible=False), "")
    assert timeline.row_rect("ruler").isEmpty()
    assert timeline.tracks.prompt == ALL_HIDDEN_PROMPT


def test_the_transport_plays_steps_and_goes_to_the_ends(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    for button, frame in (
        (transport.next, 1),
        (transport.previous, 0),
        (transport.to_end, 100),
        (transport.to_start, 0),
    ):
        QTest.mouseClick(button, LEFT)
        assert playhead.frame == frame
    QTest.mouseClick(transport.play, LEFT)
    assert playhead.playing
    assert transport.play.toolTip() == "Pause"
    QTest.mouseClick(transport.play, LEFT)
    assert not playhead.playing


def test_the_fields_show_and_take_frame_and_seconds(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    playhead.set_frame(30)
    assert (transport.frame.value(), transport.seconds.value()) == (30, 0.5)
    for field, typed, frame in ((transport.frame, "45", 45), (transport.seconds, "1.0", 60)):
        field.selectAll()
        QTest.keyClicks(field, typed)
        QTest.keyClick(field, Qt.Key.Key_Return)
        assert playhead.frame == frame


def test_a_timecode_is_shown_at_the_rate_of_the_stage_and_typed(document, timeline):
    field, playhead = timeline.transport.timecode, document.playhead
    playhead.set_frame(150)
    assert field.text() == "00:00:02:30"
    playhead.frame_rate = 50
    assert field.text() == "00:00:02:25"
    for typed, frame in (
        ("00:00:03:07", 157),
        ("1:00", 50),
        ("4", 4),
        ("1:x2", 52),
        ("3:", 52),
        ("99999999999999", 9999999),
    ):
        field.selectAll()
        QTest.keyClicks(field, typed)
        QTest.keyClick(field, Qt.Key.Key_Return)
        assert playhead.frame == frame
    field.selectAll()
    QTest.keyClicks(field, "2:00")
    QTest.keyClick(field, Qt.Key.Key_Return)
    QTest.keyClick(field, Qt.Key.Key_Up)
    assert (playhead.frame, field.text()) == (101, "00:00:02:01")
    playhead.frame_rate = 30000 / 1001
    playhead.set_frame(1800)
    assert field.text() == "00:01:00;02"


def test_another_rate_shows_the_same_frame_by_its_timecode(document, timeline):
    document.playhead.set_frame(0)
    document.playhead.frame_rate = 30000 / 1001
    assert timeline.transport.timecode.text() == "00:00:00;00"


def test_a_speed_set_by_keys_is_shown_when_playback_begins(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    for speed, shown in ((2.0, "2×"), (-4.0, "-4×")):
        playhead.speed = speed
        playhead.play()
        playhead.pause()
        assert (transport.speed.currentText() or transport.speed.placeholderText()) == shown
        assert playhead.speed == speed


def test_loop_speed_and_range_reach_the_playhead(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    QTest.mouseClick(transport.loop, LEFT)
    assert playhead.loop is False
    transport.speed.setCurrentIndex(0)
    assert playhead.speed == 0.25
    transport.first.setValue(10)
    transport.last.setValue(50)
    assert (playhead.first, playhead.last) == (10, 50)
    playhead.set_range(0, 100)
    assert (transport.first.value(), transport.last.value()) == (0, 100)


def test_a_closed_timeline_follows_nothing_any_more(document, live, timeline, hand):
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 10))
    timeline.close()
    assert frames(document.project.constraints["kick"].activation)[1] == 30
    assert not live.interactive
    sheet = timeline.tracks.sheet
    document.remove("constraints", "kick", "")
    document.playhead.set_frame(50)
    live.adapted.emit("performer 0")
    assert timeline.tracks.sheet is sheet
    assert timeline.transport.frame.value() == 0


def test_a_body_of_which_a_constraint_is_not_asked_is_neither_hatched_nor_counted(document, timeline, live):
    live.unsolved.add("performer 1")
    kick = document.project.constraints["kick"]
    document.replace("constraints", "kick", replace(kick, scope=Scope(performer_id="performer 0")), "Scope")
    assert timeline.strip_state("kick", "performer 1", 40) == StripState.INACTIVE
    assert constraint.residual_text(timeline.tracks.shown, "kick")[0] == "met"


def test_rows_of_contacts_are_folded_by_their_arrow_and_contacts_are_still_dragged(document, timeline, hand):
    tall = timeline.row_rect("lane", "left foot")
    hand.drag(QPoint(6, tall.center().y()), 0)
    low = timeline.row_rect("lane", "left foot")
    assert low.height() == contacts.FOLDED_CONTACT_HEIGHT < tall.height()
    assert (
        timeline.row_rect("constraints", "kick").top()
        < timeline.row_rect("lane", "left foot").top() + 2 * tall.height()
    )
    end = contacts.contact_bar(timeline.tracks.shown, low, document.project.contacts["early"])
    hand.drag(QPointF(end.right(), end.center().y()).toPoint(), pixels(timeline, 3))
    assert document.project.contacts["early"].last == 18
    hand.drag(QPoint(6, low.center().y()), 0)
    assert timeline.row_rect("lane", "left foot") == tall


def test_rows_are_folded_by_their_arrow_or_all_at_once_and_unfolded_again(document, timeline, hand, live):
    tall, plot = timeline.row_rect("constraints", "kick"), timeline.row_rect("plot")
    live.errors["performer 1"] = {"kick": 0.042}
    hand.press(QPoint(6, tall.center().y()))
    hand.release()
    low = timeline.row_rect("constraints", "kick")
    assert low.height() == constraint.FOLDED_CONSTRAINT_HEIGHT
    assert document.selection.items == ()
    shown = timeline.tracks.shown
    assert [body.name for body in constraint.bodies_of(shown, low, "kick")] == ["Body 1"]  # who misses it most
    hand.drag(timeline.handle_point("kick", "fade-in end"), pixels(timeline, 10))
    assert frames(document.project.constraints["kick"].activation) == (20, 40, 50, 60)
    hand.press(QPoint(6, low.center().y()))
    hand.release()
    assert timeline.row_rect("constraints", "kick") == tall
    timeline.fold_rows()
    assert timeline.row_rect("constraints", "kick").height() == constraint.FOLDED_CONSTRAINT_HEIGHT
    assert timeline.row_rect("plot").height() < plot.height()
    timeline.grab()
    timeline.fold_rows()
    assert (timeline.row_rect("constraints", "kick"), timeline.row_rect("plot")) == (tall, plot)


def test_what_is_selected_elsewhere_is_scrolled_to(document, timeline):
    keys = [document.add("constraints", make_constraint(name=f"T{k}", priority=k + 1), "Add") for k in range(12)]
    document.selection.set(("constraints", keys[-1]))
    row = timeline.row_rect("constraints", keys[-1])
    assert timeline.tracks.sheet.viewport.contains(row.center())
    document.selection.set(("constraints", "kick"))
    assert timeline.tracks.sheet.viewport.contains(timeline.row_rect("constraints", "kick").center())


def jumping(document, frame):
    """Let the hips of the document's capture jump by half a metre into a frame."""
    key, capture = next(iter(document.project.captures.items()))
    translations = capture.poses.local_translations.copy()
    translations[frame:, 0, 0] += 0.5
    poses = PoseSequence(capture.poses.local_rotations, translations)
    document.replace("captures", key, replace(capture, poses=poses), "Jump")


def test_what_no_body_does_is_marked_on_the_ruler_and_told_there(qtbot, document, timeline):
    jumping(document, 50)
    ruler, there = timeline.tracks.sheet.ruler, round(timeline.x_of_frame(50))
    picture = timeline.tracks.grab().toImage()
    assert picture.pixelColor(there, ruler.bottom()) == QColor(colours.PARTLY)
    assert picture.pixelColor(there + round(pixels(timeline, 5)), ruler.bottom()) != QColor(colours.PARTLY)
    with qtbot.waitSignal(timeline.message_posted) as told:
        QTest.mouseMove(timeline.tracks, QPoint(there, ruler.center().y()))
    assert told.args == ["The hips jump by up to 51 cm in a frame. Frame 50."]


def test_the_ruler_of_a_sound_capture_tells_nothing(timeline):
    place = QPointF(timeline.x_of_frame(50), timeline.tracks.sheet.ruler.center().y())
    assert hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, place) == ""


def test_a_narrow_row_of_the_transport_hides_parts_and_never_widens_the_window(timeline):
    """It was 1055 pixels wide at least: at 200 % the window was wider than a screen of 1600 pixels."""
    transport = timeline.transport
    parts = (transport.timecode, transport.rate, transport.seconds, transport.speed)
    assert timeline.minimumSizeHint().width() <= 720
    shown = []
    for width in (1400, 1000, 860, 720):
        timeline.resize(width, timeline.height())
        QTest.qWait(0)
        assert transport.width() == width
        assert transport.minimumSizeHint().width() <= 720
        shown.append(sum(not each.isHidden() for each in parts))
        assert not transport.frame.isHidden()
    assert shown == sorted(shown, reverse=True)
    assert (shown[0], shown[-1]) == (4, 0)
