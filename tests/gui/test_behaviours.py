"""Behaviours in the window: those that are ready made build a fighter, and Delete removes what is selected."""

from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.core.captures.reaching import farthest_reach_frame
from studio.core.stage.behaviour import advanced_progress, initial_progress
from studio.core.stage.conditions import ConditionInput
from studio.core.stage.project import Motion
from studio.core.stage.reactions import KeepDistance, LeanAway, Meet
from studio.document.behaviour_commands import state_key, transition_key

FIRST, SECOND = "performer 0", "performer 1"


def fighter_of(window, performer_id):
    """The id of a body's behaviour once it has all that is ready made."""
    document = window.bench.document
    for key, name in (("kick", "Front kick"), ("ward", "Ward off")):
        if key not in document.project.motions:
            document.put_all("motions", {key: Motion(name, "capture")}, "Add motion")
    document.selection.set(("performers", performer_id))
    for action in ("keep_distance", "strike_on_key", "ward_off", "lean_away"):
        window.actions_by_id.by_id[action].trigger()
        assert window.strip.text == ""
    return document.project.behaviour_of(performer_id)


def test_four_actions_build_a_fighter_each_one_undo_step(window):
    document = window.bench.document
    behaviour_id = fighter_of(window, FIRST)
    behaviour = document.project.behaviours[behaviour_id]
    assert [each.name for each in behaviour.states] == ["Guard", "Strike", "Block", "Lean away"]
    manners = [type(manner) for state in behaviour.states for manner in state.manners]
    assert manners == [KeepDistance, Meet, LeanAway]
    assert behaviour.role_of(FIRST).partner_id == SECOND
    assert {each.place for each in behaviour.states} == {(0, 0), (-288, 0), (288, 0), (0, 152)}
    assert window.docks["Behaviour"].isVisible()
    document.undo_stack.setIndex(document.undo_stack.index() - 4)
    assert not document.project.behaviours


def test_two_ready_made_fighters_attack_and_ward_off(window):
    document = window.bench.document
    keys = [fighter_of(window, key) for key in (FIRST, SECOND)]
    attacker, defender = (document.project.behaviours[key] for key in keys)
    gap = attacker.gaps_from("Guard")[0]
    strike = advanced_progress(
        attacker, initial_progress(attacker), ConditionInput(0.02, {gap: 0.9}, keys=frozenset({"X"}))
    )
    assert strike.state == "Strike"
    told = frozenset({attacker.state(strike.state).event})
    ward = advanced_progress(defender, initial_progress(defender), ConditionInput(0.02, events=told))
    assert ward.state == "Block"
    assert advanced_progress(defender, ward, ConditionInput(0.02, clip_ended=True)).state == "Guard"


def test_a_warding_arm_comes_when_the_partners_blow_hits(window):
    document = window.bench.document
    attacker, other = fighter_of(window, FIRST), fighter_of(window, SECOND)
    defender = document.project.behaviours[other]
    blow = document.project.behaviours[attacker].state("Strike").clip
    capture = document.project.captures["capture"]
    ward = defender.state("Block")
    hit = (farthest_reach_frame(capture, blow.first, blow.last) - blow.first) / capture.frame_rate
    [meet] = ward.manners
    assert meet.activation.full < ward.clip.first / capture.frame_rate + hit < meet.activation.full_end


def test_delete_removes_the_state_that_is_selected_and_the_body_stays(window):
    document = window.bench.document
    behaviour_id = fighter_of(window, FIRST)
    document.selection.set(("performers", FIRST), ("states", state_key(behaviour_id, "Strike")))
    window.behaviour.diagram.setFocus()
    QTest.keyClick(window.behaviour.diagram, Qt.Key.Key_Delete)
    assert [each.name for each in document.project.behaviours[behaviour_id].states] == [
        "Guard",
        "Block",
        "Lean away",
    ]
    assert document.history[-1] == "Delete Strike"
    assert FIRST in document.project.performers


def test_states_are_duplicated_with_what_leads_from_one_to_another(window):
    document = window.bench.document
    behaviour_id = fighter_of(window, FIRST)
    chosen = [("states", state_key(behaviour_id, name)) for name in ("Guard", "Strike")]
    document.selection.set(("performers", FIRST), *chosen)
    before = document.project.behaviours[behaviour_id]
    window.actions_by_id.by_id["duplicate"].trigger()
    behaviour = document.project.behaviours[behaviour_id]
    assert [each.name for each in behaviour.states[-2:]] == ["Guard 2", "Strike 2"]
    assert [(each.source, each.target) for each in behaviour.transitions[len(before.transitions) :]] == [
        ("Guard 2", "Strike 2"),
        ("Strike 2", "Guard 2"),
    ]
    assert document.selection.of("states") == (f"{behaviour_id}/Guard 2", f"{behaviour_id}/Strike 2")
    document.undo_stack.undo()
    assert document.project.behaviours[behaviour_id] == before


def test_who_plays_nothing_is_told_what_to_do_first(window):
    document = window.bench.document
    performer = document.project.performers[FIRST]
    document.replace("performers", FIRST, replace(performer, clips=()), "")
    document.selection.set(("performers", FIRST))
    window.actions_by_id.by_id["lean_away"].trigger()
    assert "has no clip yet. Add a clip first" in window.strip.text
    assert not document.project.behaviours


def test_a_body_that_is_removed_leaves_the_behaviour_of_its_partner(window):
    document = window.bench.document
    behaviour_id = fighter_of(window, FIRST)
    document.remove("performers", SECOND, "Delete")
    behaviour = document.project.behaviours[behaviour_id]
    assert behaviour.role_of(FIRST).partner_id == ""
    assert window.behaviour.diagram.states.keys() == {each.name for each in behaviour.states}


def test_forms_of_states_and_transitions_are_not_cut(window):
    document = window.bench.document
    behaviour_id = fighter_of(window, FIRST)
    behaviour = document.project.behaviours[behaviour_id]
    window.resize(1280, 684)
    states = [("states", state_key(behaviour_id, each.name)) for each in behaviour.states]
    for item in (
        *states,
        *(("transitions", transition_key(behaviour_id, k)) for k in range(len(behaviour.transitions))),
    ):
        document.selection.set(("performers", FIRST), item)
        QTest.qWait(20)
        form = window.inspector.current_form()
        assert form.minimumSizeHint().width() <= window.inspector.viewport().width(), item
