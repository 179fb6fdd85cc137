"""The inspector's forms, driven by mouse and keys over a real document."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractSpinBox, QCheckBox, QComboBox, QLineEdit, QListWidget, QSlider

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Performer
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from studio.panels.constraint_editors.body_figure import BODY_FIGURE_SCALE, SEGMENT_SHAPES, BodyFigure
from studio.panels.constraint_editors.priority import OrderList
from studio.panels.constraint_editors.worst_residuals import BodyResidual, ResidualTable, residuals_of, words_of
from studio.panels.fields import Choice, NumberField
from studio.panels.inspector import Inspector
from tests.builders import make_morphology, make_project
from tests.solved_live import SolvedLive

LEFT = Qt.MouseButton.LeftButton


def segment_place(part):
    """Place at which a segment of the figure is clicked."""
    return (BODY_FIGURE_SCALE * SEGMENT_SHAPES[part].center()).toPoint()


@pytest.fixture
def document(qapp):
    document = Document(make_project(characters=2, constraints=3))
    yield document
    document.close()


@pytest.fixture
def live(document):
    return SolvedLive(document)


@pytest.fixture
def inspector(qtbot, document, live):
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    inspector.resize(316, 1400)
    inspector.show()
    return inspector


def named(inspector, kind, name):
    return next(widget for widget in inspector.findChildren(kind) if widget.accessibleName() == name)


def drag(widget, start, *steps):
    QTest.mousePress(widget, LEFT, pos=start)
    for step in steps:
        QTest.mouseMove(widget, step)
    QTest.mouseRelease(widget, LEFT, pos=steps[-1])


def test_an_emptied_name_comes_back_and_one_that_is_typed_is_not_replaced(document, inspector):
    document.selection.set(("performers", "performer 0"))
    name = named(inspector, QLineEdit, "Name")
    name.selectAll()
    QTest.keyClick(name, Qt.Key.Key_Delete)
    QTest.keyClick(name, Qt.Key.Key_Return)
    assert name.text() == "Body 0"
    assert document.history == ()
    name.setFocus()
    QTest.keyClicks(name, " and so")
    moved = replace(document.project.performers["performer 0"], heading=1.0)
    document.replace("performers", "performer 0", moved, "Turn performer")
    QTest.keyClicks(name, " on")
    QTest.keyClick(name, Qt.Key.Key_Return)
    assert document.project.performers["performer 0"].name == "Body 0 and so on"


def handle_of(slider):
    return QPoint(round(slider.width() * slider.value() / slider.maximum()), slider.height() // 2)


def test_a_list_of_which_nothing_is_chosen_says_so(qapp):
    assert Choice("Body", ()).value is None
    choice = Choice("Body", [("child", "Child")])
    choice.show_value("gone")
    assert choice.value is None


def test_a_drag_of_a_slider_is_one_undo_step_and_live_on_the_way(inspector, document, live):
    document.selection.set(("performers", "performer 0"))
    slider = named(inspector, QSlider, "Stature")
    seen = []
    document.entity_changed.connect(lambda *item: seen.append((item, live.interactive)))
    start = handle_of(slider)
    QTest.mousePress(slider, LEFT, pos=start)
    for right in (4, 8, 12, 16):
        QTest.mouseMove(slider, start + QPoint(right, 0))
    QTest.mouseRelease(slider, LEFT, pos=start + QPoint(16, 0))
    assert len(seen) >= 3
    assert set(seen) == {(("characters", "character 0"), True)}
    assert document.history == ("Set stature of Body 0",)
    assert document.project.characters["character 0"].proportions.stature > 1.0
    assert not live.interactive


def test_the_hands_of_a_body_are_closed_by_a_slider_as_one_undo_step(inspector, document):
    document.add("performers", Performer("Child", document.add("characters", bundled_characters()["child"], "")), "")
    document.selection.set(("performers", list(document.project.performers)[-1]))
    slider = named(inspector, QSlider, "Finger curl")
    start = handle_of(slider)
    drag(slider, start, start + QPoint(10, 0), start + QPoint(30, 0), QPoint(slider.width(), start.y()))
    character = list(document.project.characters.values())[-1]
    assert character.grip == 1.0
    assert character.shown_skin is not character.skin
    assert document.history[2:] == ("Set finger curl of Child",)
    document.undo_stack.undo()
    assert list(document.project.characters.values())[-1].grip == 0.0


def test_hands_of_one_shape_have_no_slider_to_close_them(inspector, document):
    document.selection.set(("performers", "performer 0"))
    assert not named(inspector, QSlider, "Finger curl").isEnabled()


def test_dragging_a_number_sideways_scrubs_it_as_one_undo_step(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    before = document.project.constraints["constraint 0"].target
    line = named(inspector, NumberField, "Target X").lineEdit()
    drag(line, QPoint(10, 8), QPoint(20, 8), QPoint(30, 8), QPoint(40, 8))
    after = document.project.constraints["constraint 0"].target
    assert after[0] == pytest.approx(before[0] + 0.30)
    assert after[1:] == before[1:]
    assert document.history == ("Move target of Target 0",)


def test_escape_while_scrubbing_puts_the_number_back_and_leaves_no_step(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    before = document.project.constraints["constraint 0"].target
    line = named(inspector, NumberField, "Target X").lineEdit()
    QTest.mousePress(line, LEFT, pos=QPoint(10, 8))
    QTest.mouseMove(line, QPoint(40, 8))
    QTest.keyClick(line, Qt.Key.Key_Escape)
    QTest.mouseRelease(line, LEFT, pos=QPoint(40, 8))
    assert document.project.constraints["constraint 0"].target == before
    assert document.history == ()


def test_a_typed_number_is_taken_on_return(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    field = named(inspector, NumberField, "Target Z")
    field.selectAll()
    QTest.keyClicks(field.lineEdit(), "1.5")
    assert document.history == ()
    QTest.keyClick(field.lineEdit(), Qt.Key.Key_Return)
    assert document.project.constraints["constraint 0"].target[2] == 1.5


def test_a_click_on_the_figure_frees_and_locks_a_part(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    figure = inspector.findChild(BodyFigure)
    trunk = segment_place(BodyPart.THORAX)
    QTest.mouseClick(figure, LEFT, pos=trunk)
    assert document.project.constraints["constraint 0"].chain.trunk == 1.0
    QTest.mouseClick(figure, LEFT, pos=trunk)
    assert document.project.constraints["constraint 0"].chain.trunk == 0.0


def test_a_part_that_is_not_in_the_chain_cannot_be_clicked(inspector, document):
    document.selection.set(("constraints", "constraint 0"))  # a right wrist
    figure = inspector.findChild(BodyFigure)
    QTest.mouseClick(figure, LEFT, pos=segment_place(BodyPart.LEFT_THIGH))
    assert document.history == ()


def test_locking_the_last_free_part_is_refused_in_a_sentence(inspector, document, qtbot):
    document.selection.set(("constraints", "constraint 0"))
    figure = inspector.findChild(BodyFigure)
    QTest.mouseClick(figure, LEFT, pos=segment_place(BodyPart.RIGHT_CLAVICLE))
    with qtbot.waitSignal(document.problem_reported) as told:
        QTest.mouseClick(figure, LEFT, pos=segment_place(BodyPart.RIGHT_FOREARM))
    assert "No part of the IK chain may move" in told.args[0]
    assert document.project.constraints["constraint 0"].chain.limb == 1.0


def test_an_activation_is_shown_and_set_in_the_time_of_the_stage(inspector, document):
    key, performer = next(iter(document.project.performers.items()))
    clip = performer.clips[0]
    later = replace(clip, start=clip.start + 5.0, speed=2.0)
    document.replace("performers", key, replace(performer, clips=(later, *performer.clips[1:])), "Move")
    document.selection.set(("performers", key), ("constraints", "constraint 0"))
    document.playhead.set_time(5.1)
    curve = document.project.constraints["constraint 0"].activation
    start, end = (named(inspector, NumberField, name) for name in ("Start", "End"))
    rate = document.project.frame_rate_of(later)
    assert start.value() == pytest.approx(later.stage_seconds(curve.start, rate), abs=1e-3)
    assert end.value() == pytest.approx(later.stage_seconds(curve.end, rate), abs=1e-3)
    assert f"({curve.end:.3f} s of the clip)" in end.toolTip()
    end.setValue(end.value() + 0.5)
    changed = document.project.constraints["constraint 0"].activation
    assert changed.end == pytest.approx(curve.end + 1.0, abs=2e-3)
    assert named(inspector, NumberField, "Fade out").value() == pytest.approx(
        0.5 * (curve.end - curve.full_end), abs=1e-3
    )


def test_the_order_of_priorities_can_be_changed_by_keys_as_one_step(inspector, document):
    document.selection.set(("constraints", "constraint 2"))
    order = inspector.findChild(OrderList)
    QTest.keyClick(order, Qt.Key.Key_Up, Qt.KeyboardModifier.AltModifier)
    assert list(document.project.constraints_of("motion")) == ["constraint 0", "constraint 2", "constraint 1"]
    assert document.history == ("Reorder priority of Target 2",)
    assert [order.item(k).text().split()[-1] for k in range(3)] == ["0", "2", "1"]


def test_a_constraint_dropped_between_two_of_one_priority_joins_them(inspector, document):
    wrist, elbow = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND)
    for key, priority, point in (("constraint 0", 0, wrist), ("constraint 1", 0, elbow)):
        document.replace(
            "constraints", key, replace(document.project.constraints[key], priority=priority, point=point), "Tie"
        )
    document.selection.set(("constraints", "constraint 2"))
    first, second, _ = document.project.constraints_of("motion")
    inspector.findChild(OrderList).move_row(2, 1)
    priorities = {key: each.priority for key, each in document.project.constraints_of("motion").items()}
    assert priorities == {first: 0, second: 0, "constraint 2": 0}


def test_a_tied_constraint_shares_the_place_of_the_one_above_and_has_a_weight_among_equals(inspector, document):
    constraint = document.project.constraints["constraint 1"]
    document.replace("constraints", "constraint 1", replace(constraint, point=BodyPoint(BodyPart.LEFT_HAND)), "Other")
    document.selection.set(("constraints", "constraint 1"))
    weight, tie = named(inspector, NumberField, "Weight (same priority)"), inspector.findChild(QCheckBox, "tie")
    assert not weight.isVisible()
    QTest.mouseClick(tie, LEFT, pos=QPoint(8, 8))
    constraints = document.project.constraints_of("motion")
    assert [each.priority for each in constraints.values()] == [0, 0, 1]
    assert [inspector.findChild(OrderList).item(k).text().split()[0] for k in range(3)] == ["1", "1", "2"]
    weight.setValue(3.0)
    assert document.project.constraints["constraint 1"].weight == 3.0
    QTest.mouseClick(tie, LEFT, pos=QPoint(8, 8))
    assert [each.priority for each in document.project.constraints_of("motion").values()] == [0, 1, 2]
    assert not weight.isVisible()
    assert len(document.history) == 4
    document.undo_stack.setIndex(1)
    assert document.project.constraints["constraint 1"].weight == 1.0


def test_all_rows_of_the_order_are_in_sight(inspector, document, qtbot):
    """The last one hid the first while it was selected."""
    document.selection.set(("constraints", "constraint 2"))
    order = inspector.findChild(OrderList)
    qtbot.wait(20)
    assert order.verticalScrollBar().maximum() == 0
    assert order.visualItemRect(order.item(0)).top() >= 0


def test_a_keyed_weight_lets_a_second_target_of_one_point_share_a_priority(inspector, document, qtbot):
    first = document.project.constraints["constraint 0"]
    other = replace(document.project.constraints["constraint 1"], point=first.point, target=(0.3, 0.1, 1.2))
    document.replace("constraints", "constraint 1", other, "Other")
    document.selection.set(("constraints", "constraint 1"))
    weight, tie = named(inspector, NumberField, "Weight (same priority)"), inspector.findChild(QCheckBox, "tie")
    with qtbot.waitSignal(document.problem_reported) as told:
        QTest.mouseClick(tie, LEFT, pos=QPoint(8, 8))
    assert "or a keyed weight" in told.args[0]
    assert weight.isVisible()
    box = named(inspector, QCheckBox, "Weight is animated")
    QTest.mouseClick(box, LEFT, pos=QPoint(8, 8))
    QTest.mouseClick(tie, LEFT, pos=QPoint(8, 8))
    assert document.project.constraints["constraint 1"].priority == first.priority
    document.playhead.set_time(0.5)
    weight.setValue(0.0)
    keyed = document.project.constraints["constraint 1"].weight
    assert (keyed.values, keyed.times[-1]) == ((1.0, 0.0), pytest.approx(0.5, abs=0.02))
    document.playhead.set_time(0.0)
    assert weight.value() == 1.0
    document.undo_stack.setIndex(1)
    assert document.project.constraints["constraint 1"].weight == 1.0


def test_a_tie_that_would_double_a_constraint_is_refused_in_a_sentence(inspector, document, qtbot):
    document.selection.set(("constraints", "constraint 1"))
    tie = inspector.findChild(QCheckBox, "tie")
    with qtbot.waitSignal(document.problem_reported) as told:
        QTest.mouseClick(tie, LEFT, pos=QPoint(8, 8))
    assert "duplicates 'Target 0'" in told.args[0]
    assert not tie.isChecked()
    assert document.history == ()


def test_the_segments_of_the_points_own_limb_get_weights_of_their_own(inspector, document):
    document.selection.set(("constraints", "constraint 0"))  # a right wrist
    add = named(inspector, QComboBox, "Segment")
    offered = {add.itemText(place) for place in range(add.count())}
    assert {"Right upper arm", "Right forearm", "Head"} <= offered
    assert not {"Left forearm", "Right thigh", "Right hand"} & offered
    place = add.findText("Right forearm")
    add.setCurrentIndex(place)
    add.activated.emit(place)
    chain = lambda: document.project.constraints["constraint 0"].chain  # noqa: E731
    assert chain().segments == ((BodyPart.RIGHT_FOREARM, 1.0),)
    QTest.mouseClick(inspector.findChild(BodyFigure), LEFT, pos=segment_place(BodyPart.RIGHT_FOREARM))
    assert (chain().segments, chain().limb) == (((BodyPart.RIGHT_FOREARM, 0.0),), 1.0)


def test_a_segment_gets_a_weight_of_its_own_and_loses_it_again(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    segments = lambda: document.project.constraints["constraint 0"].chain.segments  # noqa: E731
    add = named(inspector, QComboBox, "Segment")
    place = add.findText("Right clavicle")
    add.setCurrentIndex(place)
    add.activated.emit(place)
    assert segments() == ((BodyPart.RIGHT_CLAVICLE, 1.0),)
    assert add.findText("Right clavicle") == -1
    named(inspector, NumberField, "Weight override of Right clavicle").setValue(0.25)
    assert segments() == ((BodyPart.RIGHT_CLAVICLE, 0.25),)
    QTest.mouseClick(inspector.findChild(BodyFigure), LEFT, pos=segment_place(BodyPart.RIGHT_CLAVICLE))
    assert segments() == ((BodyPart.RIGHT_CLAVICLE, 0.0),)
    assert document.project.constraints["constraint 0"].chain.clavicle == 1.0
    QTest.mouseClick(named(inspector, QAbstractButton, "Remove weight override of Right clavicle"), LEFT)
    assert segments() == ()
    document.undo_stack.undo()
    assert segments() == ((BodyPart.RIGHT_CLAVICLE, 0.0),)


def test_an_ease_never_crosses_the_other_one(inspector, document):
    document.selection.set(("constraints", "constraint 0"))
    field = named(inspector, NumberField, "Fade in")
    field.setValue(100.0)
    curve = document.project.constraints["constraint 0"].activation
    assert curve.start <= curve.full <= curve.full_end <= curve.end


def test_a_contact_is_trimmed_by_its_frames(inspector, document):
    document.selection.set(("contacts", "contact 0"))
    named(inspector, NumberField, "Last frame").setValue(20)
    assert document.project.contacts["contact 0"].last == 20
    named(inspector, NumberField, "First frame").setValue(25)
    assert document.project.contacts["contact 0"].first == 20


def test_the_ground_follows_its_number(inspector, document):
    document.selection.set(("grounds", "ground"))
    named(inspector, NumberField, "Height").setValue(0.25)
    assert document.project.ground.height == 0.25


def test_a_guess_about_the_frame_rate_can_be_overruled(inspector, document):
    document.selection.set(("captures", "capture"))
    named(inspector, NumberField, "Frame rate").setValue(30.0)
    assert document.project.captures["capture"].frame_rate == 30.0


def test_another_unit_asks_for_the_file_to_be_read_again(inspector, document, qtbot):
    document.selection.set(("captures", "capture"))
    unit = named(inspector, QComboBox, "Unit")
    with qtbot.waitSignal(inspector.reimport_requested) as asked:
        unit.setCurrentIndex(unit.findText("centimetres"))
        unit.activated.emit(unit.currentIndex())
    assert asked.args == ["capture", {"unit": "cm"}]


def test_undo_is_shown_in_the_form(inspector, document):
    document.selection.set(("grounds", "ground"))
    field = named(inspector, NumberField, "Height")
    field.setValue(0.25)
    document.undo_stack.undo()
    assert field.value() == 0.0


def test_the_table_of_bodies_leaves_their_names_whole(qapp):
    table = ResidualTable()
    table.resize(284, 200)
    table.show_residuals([BodyResidual(name, "#ffffff", None) for name in ("Ann", "Bo", "Cy", "Di")])
    assert (table.columns, table.sizeHint().height()) == (2, 36)
    table.show_residuals([BodyResidual(name, "#ffffff", None) for name in ("The adult woman", "Bo", "Cy", "Di")])
    assert (table.columns, table.sizeHint().height()) == (1, 72)


def test_residuals_tell_who_misses_the_target_by_how_much_and_when(document, live):
    residuals = np.zeros((3, 30))
    residuals[0, 15] = 0.042
    nothing = np.zeros((30, 26, 3))
    live.results["performer 1"] = AdaptedMotion(make_morphology(), 60.0, 0, nothing, nothing, residuals)
    first, second = residuals_of(document.project, live, "constraint 0")
    assert words_of(first) == "not solved yet"
    assert words_of(second) == "not met, 42 mm at 15"


@pytest.mark.parametrize(
    "item",
    [
        ("constraints", "constraint 0"),
        ("performers", "performer 0"),
        ("characters", "character 0"),
        ("contacts", "contact 0"),
        ("captures", "capture"),
        ("grounds", "ground"),
    ],
)
def test_everything_that_takes_the_keyboard_has_a_name(inspector, document, item):
    document.selection.set(item)
    kinds = (QAbstractSpinBox, QComboBox, QAbstractButton, QSlider, QListWidget)
    nameless = [
        widget
        for kind in kinds
        for widget in inspector.findChildren(kind)
        if not (widget.accessibleName() or getattr(widget, "text", str)())
    ]
    lines = [line for line in inspector.findChildren(QLineEdit) if not line.objectName()]
    assert nameless == []
    assert [line for line in lines if not line.accessibleName()] == []


def test_jolts_of_a_character_are_eased_or_left_by_a_tick_that_can_be_undone(inspector, document):
    document.selection.set(("performers", "performer 0"))
    tick = next(box for box in inspector.editor.findChildren(QCheckBox) if box.text() == "Smooth pops")
    assert tick.isChecked()
    QTest.mouseClick(tick, LEFT, pos=QPoint(8, tick.height() // 2))
    assert [each.eased for each in document.project.performers.values()][:2] == [False, True]
    assert document.history[-1] == "Disable smoothing of Body 0"
    document.undo_stack.undo()
    assert tick.isChecked()


def test_the_joints_of_a_character_are_freed_and_limited_by_a_tick_that_can_be_undone(inspector, document):
    document.selection.set(("performers", "performer 0"))
    tick = next(box for box in inspector.editor.findChildren(QCheckBox) if box.text() == "Limit to human range")
    assert tick.isChecked()
    QTest.mouseClick(tick, LEFT, pos=QPoint(8, tick.height() // 2))
    assert not document.project.performers["performer 0"].limited
    assert document.project.performers["performer 1"].limited
    assert document.history[-1] == "Disable joint limits of Body 0"
    document.undo_stack.undo()
    assert tick.isChecked()
    assert document.project.performers["performer 0"].limited


def test_a_body_keyed_over_time_takes_what_a_slider_says_at_the_playhead(inspector, document):
    document.selection.set(("performers", "performer 0"))
    document.playhead.set_frame(0)
    QTest.mouseClick(named(inspector, QCheckBox, "Proportions are animated"), LEFT, pos=QPoint(8, 8))
    slider = named(inspector, QSlider, "Stature")
    document.playhead.set_frame(30)
    start = handle_of(slider)
    drag(slider, start, start + QPoint(8, 0), start + QPoint(16, 0))
    keyed = document.project.characters["character 0"].proportions
    assert keyed.times == (0.0, 30 / document.playhead.frame_rate)
    assert keyed.values[0].stature == 1.0 < keyed.values[1].stature
    assert document.history == ("Animate the proportions of Body 0", "Set stature of Body 0")
    grown = slider.value()
    document.playhead.set_frame(0)
    assert slider.value() < grown
    QTest.mouseClick(named(inspector, QCheckBox, "Proportions are animated"), LEFT, pos=QPoint(8, 8))
    assert document.project.characters["character 0"].proportions.stature == 1.0


def test_a_form_outlives_the_event_that_puts_another_in_its_place(inspector, document, qtbot):
    document.selection.set(("constraints", "constraint 0"))
    gone = []
    inspector.editor.destroyed.connect(lambda: gone.append(True))
    document.selection.set(("constraints", "constraint 1"))
    assert not gone
    qtbot.waitUntil(lambda: gone == [True])
