"""The diagram of a behaviour, by a mouse: states are moved, joined, named and removed; each time one undo step."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QLineEdit, QPushButton

from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import ClipEndCondition, DistanceCondition, EventCondition, KeyCondition
from studio.core.stage.reactions import KeepDistance
from studio.document.behaviour_commands import remove_parts
from studio.document.document import Document
from studio.panels.behaviour.panel import BehaviourPanel
from studio.panels.fields import NumberField
from studio.panels.inspector import Inspector
from tests.builders import make_project
from tests.timeline.fakes import FakeLive

FIRST, SECOND = "performer 0", "performer 1"
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
FIGHTER = Behaviour(
    "Fighter",
    (State("Guard", Clip("motion", 0, 29, id="g")), State("Strike", loop=False, place=(300.0, 0.0))),
    (Transition("Guard", "Strike", (KeyCondition("X"),)), Transition("Strike", "Guard", (ClipEndCondition(),))),
    cast=(Role(FIRST, SECOND),),
)


@pytest.fixture
def document(qapp):
    document = Document(make_project(characters=2).with_entity("behaviours", "fighter", FIGHTER))
    document.selection.set(("performers", FIRST))
    yield document
    document.close()


@pytest.fixture
def panel(document, qtbot):
    panel = BehaviourPanel(document, [("ward_off", "Block when attacked", "")])
    qtbot.addWidget(panel)
    panel.resize(1100, 420)
    with qtbot.waitExposed(panel):
        panel.show()
    return panel


@pytest.fixture
def inspector(document, qtbot):
    inspector = Inspector(document, FakeLive(document))
    qtbot.addWidget(inspector)
    return inspector


class Hand:
    """A mouse on the diagram."""

    def __init__(self, panel):
        self.view = panel.diagram
        self.port = panel.diagram.viewport()

    def at(self, name, dx=0.0, dy=0.0):
        """On a state, so far from its middle in halves of its size."""
        rect = self.view.states[name].rect
        place = rect.center() + QPointF(dx * rect.width() / 2, dy * rect.height() / 2)
        return self.view.mapFromScene(place)

    def move(self, place, buttons=LEFT, modifiers=NONE):
        event = QMouseEvent(
            QEvent.Type.MouseMove, QPointF(place), self.port.mapToGlobal(QPointF(place)), buttons, buttons, modifiers
        )
        QApplication.sendEvent(self.port, event)

    def drag(self, start, *way, button=LEFT, modifiers=NONE, release=True):
        QTest.mousePress(self.port, button, modifiers, start)
        for place in way:
            self.move((start + place) / 2, button, modifiers)
            self.move(place, button, modifiers)
        if release:
            QTest.mouseRelease(self.port, button, modifiers, way[-1])

    def click(self, place, modifiers=NONE):
        QTest.mouseClick(self.port, LEFT, modifiers, place)


@pytest.fixture
def hand(panel):
    return Hand(panel)


def fighter(document):
    return document.project.behaviours["fighter"]


def test_a_state_that_is_dragged_stays_there_and_one_undo_brings_it_back(document, panel, hand):
    start = hand.at("Strike")
    hand.drag(start, start + QPoint(40, 80), start + QPoint(80, 64))
    assert fighter(document).state("Strike").place == pytest.approx((384.0, 64.0), abs=8.0)
    assert document.history == ("Move Strike",)
    document.undo_stack.undo()
    assert fighter(document) == FIGHTER
    assert panel.diagram.states["Strike"].box.place == (300.0, 0.0)


def test_all_states_in_a_rectangle_are_moved_together(document, hand):
    corner = hand.at("Guard", -1.0, -1.0) - QPoint(40, 30)
    hand.drag(corner, hand.at("Strike", 1.0, 1.0) + QPoint(30, 30))
    assert document.selection.of("states") == ("fighter/Guard", "fighter/Strike")
    start = hand.at("Guard")
    hand.drag(start, start + QPoint(0, 48))
    assert [each.place for each in fighter(document).states] == [(0.0, 48.0), (304.0, 48.0)]
    assert document.history == ("Move 2 states",)


def test_a_behaviour_that_is_removed_while_a_state_of_it_is_dragged_leaves_nothing_behind(document, panel, hand):
    start = hand.at("Strike")
    hand.drag(start, start + QPoint(80, 64), release=False)
    document.remove("behaviours", "fighter", "Delete Fighter")
    panel.refresh()
    QTest.mouseRelease(hand.port, LEFT, NONE, start)
    assert panel.diagram.behaviour is None
    assert not document.project.behaviours


def test_escape_leaves_a_drag_and_all_is_as_it_was(document, panel, hand):
    start = hand.at("Strike")
    hand.drag(start, start + QPoint(80, 64), release=False)
    QTest.keyClick(panel.diagram, Qt.Key.Key_Escape)
    assert fighter(document) == FIGHTER
    assert document.history == ()
    QTest.mouseRelease(hand.port, LEFT, NONE, start)


def test_a_drag_from_an_edge_to_another_state_makes_a_transition(document, hand):
    hand.move(hand.at("Guard", 0.0, 1.0), Qt.MouseButton.NoButton)
    assert hand.port.cursor().shape() is Qt.CursorShape.CrossCursor
    hand.drag(hand.at("Guard", 0.0, 1.0), hand.at("Strike"))
    new = fighter(document).transitions[-1]
    assert (new.source, new.target) == ("Guard", "Strike")
    assert document.selection.of("transitions") == ("fighter/2",)
    assert document.undo_stack.count() == 1


def test_a_drag_from_an_edge_to_nowhere_makes_a_state_too_in_one_step(document, hand):
    hand.drag(hand.at("Guard", 0.0, 1.0), hand.at("Guard", 0.0, 1.0) + QPoint(40, 120))
    assert [each.name for each in fighter(document).states] == ["Guard", "Strike", "State"]
    assert fighter(document).transitions[-1].target == "State"
    document.undo_stack.undo()
    assert fighter(document) == FIGHTER


def test_a_slip_on_an_edge_makes_nothing(document, hand):
    edge = hand.at("Guard", 1.0, 0.0)
    hand.drag(edge, edge + QPoint(-9, 0))
    assert document.history == ()
    assert document.selection.of("states") == ("fighter/Guard",)


def test_a_double_click_renames_a_state_and_its_transitions_follow(document, panel, hand):
    QTest.mouseDClick(hand.port, LEFT, NONE, hand.at("Strike"))
    [field] = hand.port.findChildren(QLineEdit)
    QTest.keyClicks(field, "Kick")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert [each.target for each in fighter(document).transitions] == ["Kick", "Guard"]
    assert document.selection.of("states") == ("fighter/Kick",)
    assert document.history == ("Rename Strike",)


def test_a_state_that_is_added_covers_no_other_no_arrow_and_no_words(panel, qtbot):
    for count in (3, 4, 5):
        qtbot.mouseClick(next(each for each in panel.findChildren(QPushButton) if each.text() == "Add state"), LEFT)
        boxes = [item.rect for item in panel.diagram.states.values()]
        assert len(boxes) == count
        taken = boxes[:-1] + [each.label for each in panel.diagram.arrows]
        taken += [each.boundingRect() for each in panel.diagram.arrows]
        assert not any(boxes[-1].intersects(each) for each in taken)


def test_a_state_that_could_not_be_added_has_no_name_to_type(panel, document, qtbot):
    [add] = [each for each in panel.findChildren(QPushButton) if each.text() == "Add state"]
    document.new(make_project(characters=0))
    add.click()
    assert panel.findChildren(QLineEdit) == []


def test_a_name_that_is_taken_is_refused_in_a_sentence(document, panel, hand):
    told = []
    document.problem_reported.connect(told.append)
    QTest.mouseDClick(hand.port, LEFT, NONE, hand.at("Strike"))
    [field] = hand.port.findChildren(QLineEdit)
    QTest.keyClicks(field, "Guard")
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert fighter(document) == FIGHTER
    assert told == ["'Fighter': two states are called 'Guard'. Rename one of them."]


def test_a_double_click_beside_everything_adds_a_state_there(document, panel, hand):
    place = hand.at("Guard", 0.0, 1.0) + QPoint(10, 90)
    QTest.mouseDClick(hand.port, LEFT, NONE, place)
    state = fighter(document).states[-1]
    assert panel.diagram.mapFromScene(QPointF(*state.place)).toTuple() == pytest.approx(place.toTuple(), abs=2)


def test_a_click_on_the_words_of_an_arrow_selects_it(document, panel, hand):
    label = panel.diagram.arrows[0].label
    hand.click(panel.diagram.mapFromScene(label.center()))
    assert document.selection.of("transitions") == ("fighter/0",)
    assert document.selection.of("performers") == (FIRST,)
    hand.click(hand.at("Guard", 0.0, 1.0) + QPoint(0, 90))
    assert document.selection.current == ("behaviours", "fighter")


def test_the_wheel_zooms_about_the_mouse_and_the_middle_button_pans(panel, hand):
    place = hand.at("Strike")
    before = panel.diagram.transform().m11()
    wheel = QWheelEvent(
        QPointF(place), hand.port.mapToGlobal(QPointF(place)), QPoint(), QPoint(0, 240), Qt.MouseButton.NoButton, NONE,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(hand.port, wheel)
    assert panel.diagram.transform().m11() > 1.2 * before
    assert (hand.at("Strike") - place).manhattanLength() <= 2
    start = QPoint(20, 20)
    hand.drag(start, start + QPoint(50, -30), button=Qt.MouseButton.MiddleButton)
    assert (hand.at("Strike") - place - QPoint(50, -30)).manhattanLength() <= 3


def test_all_of_it_stays_in_view_at_any_size_until_somebody_zooms_or_pans(panel, hand):
    for size in ((300, 160), (1300, 700)):
        panel.resize(*size)
        QApplication.processEvents()
        corners = [hand.at(name, x, x) for name in ("Guard", "Strike") for x in (-1.0, 1.0)]
        assert all(hand.port.rect().contains(place) for place in corners)
    assert panel.diagram.transform().m11() == pytest.approx(1.0)
    hand.drag(QPoint(20, 20), QPoint(220, 20), button=Qt.MouseButton.MiddleButton)
    before = hand.at("Guard")
    panel.resize(1310, 700)
    QApplication.processEvents()
    assert (hand.at("Guard") - before).manhattanLength() < 20


def test_the_running_state_is_lit_in_the_colour_of_the_body_that_is_worked_on(document, panel):
    document.replace("behaviours", "fighter", replace(FIGHTER, cast=(*FIGHTER.cast, Role(SECOND, FIRST))), "")
    panel.show_running(FIRST, "Guard")
    panel.show_running(SECOND, "Guard")
    guard = panel.diagram.states["Guard"].box
    colours = [document.project.characters[f"character {k}"].colour for k in range(2)]
    assert (guard.lit, guard.dots) == (colours[0], (colours[1],))
    panel.show_running(FIRST, "Strike")
    assert panel.diagram.states["Strike"].box.lit == colours[0]
    for key in (FIRST, SECOND):
        panel.show_running(key, "")
    assert not any(item.box.lit or item.box.dots for item in panel.diagram.states.values())


def test_a_body_gets_a_behaviour_and_a_partner_in_the_bar(document, panel):
    document.selection.set(("performers", SECOND))
    assert panel.diagram.behaviour is None
    choose(panel, "Behaviour", "Fighter")
    choose(panel, "Partner", document.project.performers[FIRST].name)
    assert fighter(document).role_of(SECOND) == Role(SECOND, FIRST)
    assert document.undo_stack.count() == 2
    choose(panel, "Behaviour", "No behaviour")
    assert fighter(document) == FIGHTER


def test_who_has_none_is_offered_ready_made_ones(document, panel, qtbot):
    document.selection.set(("performers", SECOND))
    button = next(each for each in panel.findChildren(QPushButton) if each.text() == "Block when attacked")
    assert button.isVisible()
    with qtbot.waitSignal(panel.action_requested) as asked:
        QTest.mouseClick(button, LEFT)
    assert asked.args == ["ward_off"]


def test_states_and_transitions_that_are_removed_leave_the_rest(document):
    remove_parts(document, ["fighter/Strike"], [], "Delete Strike")
    assert (len(fighter(document).states), fighter(document).transitions) == (1, ())
    document.undo_stack.undo()
    remove_parts(document, [], ["fighter/0"], "Delete")
    assert fighter(document).transitions == FIGHTER.transitions[1:]


# Forms


def choose(form, name, text):
    field = next(each for each in form.findChildren(QComboBox) if each.accessibleName() == name and not each.isHidden())
    assert field.findText(text) >= 0, [field.itemText(index) for index in range(field.count())]
    field.setCurrentIndex(field.findText(text))
    field.activated.emit(field.currentIndex())


def number(form, name):
    return next(each for each in form.findChildren(NumberField) if each.accessibleName() == name)


def test_a_transition_waits_for_what_its_form_says(document, inspector):
    document.selection.set(("performers", FIRST), ("transitions", "fighter/0"))
    form = inspector.current_form()
    choose(form, "Condition", "Closer than")
    QApplication.processEvents()
    number(form, "Distance").setValue(0.8)
    assert fighter(document).transitions[0].conditions == (DistanceCondition(distance=0.8),)
    QTest.mouseClick(next(each for each in form.findChildren(QPushButton) if each.text() == "Add condition"), LEFT)
    assert len(fighter(document).transitions[0].conditions) == 2
    choose(inspector.current_form(), "To", "Guard")
    assert fighter(document).transitions[0].target == "Guard"
    assert document.undo_stack.count() == 4


def test_the_only_condition_cannot_be_removed(document, inspector):
    told = []
    document.problem_reported.connect(told.append)
    document.selection.set(("performers", FIRST), ("transitions", "fighter/0"))
    form = inspector.current_form()
    QTest.mouseClick(next(each for each in form.findChildren(QPushButton) if each.text() == "Remove"), LEFT)
    assert fighter(document) == FIGHTER
    assert "needs a condition" in told[0]


def test_what_is_tried_first_is_chosen_in_the_form(document, inspector):
    more = (*FIGHTER.transitions, Transition("Guard", "Guard", (EventCondition("rest"),)))
    document.replace("behaviours", "fighter", replace(FIGHTER, transitions=more), "")
    document.selection.set(("performers", FIRST), ("transitions", "fighter/2"))
    form = inspector.current_form()
    QTest.mouseClick(next(each for each in form.findChildren(QPushButton) if each.text() == "Move up"), LEFT)
    assert [each.target for each in fighter(document).transitions_from("Guard")] == ["Guard", "Strike"]
    assert document.selection.of("transitions") == ("fighter/0",)


def test_a_state_plays_what_its_form_says(document, inspector):
    document.selection.set(("performers", FIRST), ("states", "fighter/Strike"))
    form = inspector.current_form()
    choose(form, "Clip", "Walk")
    number(form, "Last frame").setValue(12)
    number(form, "Speed").setValue(2.0)
    clip = fighter(document).state("Strike").clip
    assert (clip.motion_id, clip.first, clip.last, clip.speed) == ("motion", 0, 12, 2.0)
    number(form, "Last frame").setValue(500)
    assert fighter(document).state("Strike").clip.last == 29
    choose(form, "Add reaction", "Keep distance")
    QApplication.processEvents()
    number(form, "Distance").setValue(1.5)
    assert fighter(document).state("Strike").manners == (KeepDistance(distance=1.5),)
    name = next(each for each in form.findChildren(QLineEdit) if each.accessibleName() == "Name")
    name.setText("Kick")
    name.editingFinished.emit()
    assert document.selection.of("states") == ("fighter/Kick",)
    assert inspector.current_form().entity.name == "Kick"


def test_a_clip_of_a_row_that_is_trimmed_in_a_state_is_the_states_own(document, inspector):
    document.selection.set(("performers", FIRST), ("states", "fighter/Strike"))
    form = inspector.current_form()
    choose(form, "Clip", f"Walk · {document.project.performers[FIRST].name}")
    assert fighter(document).state("Strike").clip.id == "clip"
    number(form, "First frame").setValue(5)
    assert fighter(document).state("Strike").clip.id != "clip"
    assert document.project.clips["clip"].first == 0


def test_a_behaviour_begins_where_its_form_says(document, inspector):
    document.selection.set(("performers", FIRST), ("behaviours", "fighter"))
    choose(inspector.current_form(), "Start state", "Strike")
    assert fighter(document).start == "Strike"
    button = next(each for each in inspector.findChildren(QPushButton) if each.text() == "Delete behaviour")
    QTest.mouseClick(button, LEFT)
    assert not document.project.behaviours
    document.undo_stack.undo()
    assert fighter(document).start == "Strike"


def test_a_behaviour_that_two_play_becomes_ones_own(document, inspector):
    document.replace("behaviours", "fighter", replace(FIGHTER, cast=(Role(SECOND, FIRST), *FIGHTER.cast)), "")
    document.selection.set(("performers", FIRST), ("behaviours", "fighter"))
    name = document.project.performers[FIRST].name
    QTest.mouseClick(next(each for each in inspector.findChildren(QPushButton) if name in each.text()), LEFT)
    own = document.project.behaviours[document.project.behaviour_of(FIRST)]
    assert (own.name, own.cast, own.states) == ("Fighter 2", FIGHTER.cast, FIGHTER.states)
    assert fighter(document).cast == (Role(SECOND, FIRST),)
    assert document.undo_stack.count() == 2


def test_a_button_that_is_down_while_its_behaviour_is_removed_does_nothing_when_it_is_let_go(document, inspector):
    document.selection.set(("behaviours", "fighter"))
    inspector.show()
    delete = next(each for each in inspector.findChildren(QPushButton) if each.text() == "Delete behaviour")
    QTest.mousePress(delete, LEFT)
    document.remove("behaviours", "fighter", "Delete Fighter")
    before = document.project
    QTest.mouseRelease(delete, LEFT)
    assert document.project is before


def test_a_name_that_is_typed_while_its_performer_is_removed_renames_nobody(document, inspector):
    inspector.show()
    name = next(
        each for each in inspector.findChildren(QLineEdit) if each.text() == document.project.performers[FIRST].name
    )
    name.setFocus()
    name.setText("Somebody else")
    document.remove("performers", FIRST, "Remove performer")
    before = document.project
    name.editingFinished.emit()
    assert document.project is before
