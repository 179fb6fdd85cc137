"""A behaviour goes from state to state by what a performer senses, and by nothing else."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowPerformer, FollowProp
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.behaviour import (
    Behaviour,
    BehaviourProgress,
    Role,
    State,
    Transition,
    advanced_progress,
    initial_progress,
    without_references,
)
from studio.core.stage.behaviour_target import BehaviourTarget, DistanceMeasure, FollowPartner
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import (
    ClipEndCondition,
    Condition,
    ConditionInput,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.project import Project, references
from studio.core.stage.prop import Prop
from studio.core.stage.reactions import KeepDistance, LeanAway, Meet, Reaction, reaction_constraints
from studio.io.project.entity_json import entity_of, entity_record, project_json, project_of
from tests.builders import make_project

NEAR = DistanceCondition(distance=1.0)
GUARD, STRIKE, WARD = (State(name, Clip("motion", 0, 20, id=name)) for name in ("Guard", "Strike", "Ward off"))
FIGHTER = Behaviour(
    "Fighter",
    (GUARD, replace(STRIKE, loop=False, event="attack"), replace(WARD, loop=False)),
    (
        Transition("Guard", "Ward off", (EventCondition("attack"),)),
        Transition("Guard", "Strike", (KeyCondition("k"), NEAR), 0.2),
        Transition("Strike", "Guard", (ClipEndCondition(),)),
        Transition("Ward off", "Guard", (TimeCondition(0.5),)),
    ),
    cast=(Role("performer 0", "performer 1"),),
)

names = st.text(st.characters(codec="ascii", categories=["L"]), min_size=1, max_size=6)
metres = st.floats(0.01, 10.0)
points = st.builds(BodyPoint, st.sampled_from(BodyPart), st.tuples(metres, metres, metres), st.booleans())
whoms: st.SearchStrategy[BehaviourTarget] = st.one_of(
    st.builds(FollowPartner, points),
    st.builds(FollowPerformer, st.just("performer 1"), points),
    st.builds(FollowProp, st.just("box")),
)
gaps = st.builds(DistanceMeasure, whoms, points, st.booleans(), st.booleans())
conditions: st.SearchStrategy[Condition] = st.one_of(
    st.builds(DistanceCondition, gaps, metres, st.booleans()),
    st.builds(TimeCondition, metres),
    st.just(ClipEndCondition()),
    st.builds(EventCondition, names),
    st.builds(KeyCondition, names),
)
curves = st.lists(metres, min_size=4, max_size=4).map(lambda times: ActivationCurve(*sorted(times)))
manners: st.SearchStrategy[Reaction] = st.one_of(
    st.builds(KeepDistance, whoms, metres, metres, st.booleans()),
    st.builds(LeanAway, whoms, points, metres),
    st.builds(Meet, whoms, points, curves, st.just(Chain(trunk=0.5))),
)


@st.composite
def behaviours(draw: st.DrawFn) -> Behaviour:
    """Any behaviour of the project that ``stage`` makes."""
    called = draw(st.lists(names, min_size=1, max_size=5, unique=True))
    clips = st.none() | st.builds(Clip, st.just("motion"), st.just(0), st.integers(0, 29), id=names)
    asked = st.lists(manners, max_size=2).map(tuple)
    states = [
        State(name, draw(clips), draw(st.booleans()), draw(asked), draw(st.just("") | names), (draw(metres), 0.0))
        for name in called
    ]
    ends = st.sampled_from(called)
    all_of = st.lists(conditions, min_size=1, max_size=3).map(tuple)
    transitions = draw(st.lists(st.builds(Transition, ends, ends, all_of, st.floats(0.0, 5.0)), max_size=8))
    cast = draw(st.sampled_from([(), (Role("performer 0"),), (Role("performer 0", "performer 1"),)]))
    return Behaviour(draw(names), tuple(states), tuple(transitions), draw(ends), cast)


@st.composite
def sensed(draw: st.DrawFn) -> list[ConditionInput]:
    """Some frames of anything."""
    frame = st.builds(
        ConditionInput,
        st.floats(0.0, 1.0),
        st.dictionaries(gaps, metres, max_size=2),
        st.booleans(),
        st.frozensets(names, max_size=2),
        st.frozensets(names, max_size=2),
    )
    return draw(st.lists(frame, max_size=10))


def stage() -> Project:
    return make_project().with_entity("props", "box", Prop("Box"))


@given(behaviours(), sensed())
def test_what_is_sensed_decides_alone_where_it_goes(behaviour: Behaviour, frames: list[ConditionInput]) -> None:
    runs = []
    for _ in range(2):
        running = initial_progress(behaviour)
        for senses in frames:
            before, running = running, advanced_progress(behaviour, running, senses)
            assert behaviour.state(running.state) is not None
            if running.through is not before.through or running.seconds < before.seconds:
                assert running.through in behaviour.transitions_from(before.state)
                assert running.seconds == 0.0
        runs.append(running)
    assert runs[0] == runs[1]


@given(behaviours(), sensed())
def test_the_first_transition_of_which_all_conditions_hold_is_taken(
    behaviour: Behaviour, frames: list[ConditionInput]
) -> None:
    for senses in frames:
        running = BehaviourProgress(behaviour.start, 0.3)
        after = advanced_progress(behaviour, running, senses)
        seconds = running.seconds + senses.step
        ready = [
            each
            for each in behaviour.transitions_from(running.state)
            if all(one.is_met(senses, seconds) for one in each.conditions)
        ]
        assert after == (
            BehaviourProgress(ready[0].target, through=ready[0]) if ready else BehaviourProgress(running.state, seconds)
        )


@pytest.mark.parametrize("targets", [("Strike", "Ward off"), ("Ward off", "Strike")])
def test_of_two_transitions_whose_conditions_hold_the_first_is_taken(targets: tuple[str, str]) -> None:
    both = tuple(Transition("Guard", target, (TimeCondition(0.0),)) for target in targets)
    fighter = replace(FIGHTER, transitions=both)
    assert advanced_progress(fighter, initial_progress(fighter), ConditionInput(0.1)).state == targets[0]


@given(behaviours())
def test_a_behaviour_is_stored_as_it_is(behaviour: Behaviour) -> None:
    record = entity_record("behaviours", "b", behaviour, {})
    assert entity_of("behaviours", record, lambda _: None) == behaviour  # type: ignore[arg-type, return-value]
    project = stage().with_entity("behaviours", "b", behaviour)
    assert not project.missing_references(behaviour)


@given(behaviours(), st.sampled_from([("performers", "performer 1"), ("motions", "motion"), ("props", "box")]))
def test_a_behaviour_goes_on_without_what_is_gone(behaviour: Behaviour, gone: tuple[str, str]) -> None:
    left = without_references(behaviour, *gone)
    assert gone not in references(left)
    assert [each.name for each in left.states] == [each.name for each in behaviour.states]
    assert set(left.transitions) <= set(behaviour.transitions)
    assert without_references(left, *gone) == left


def test_a_fighter_wards_off_when_attacked_even_where_it_was_about_to_strike() -> None:
    near = ConditionInput(0.1, gaps={NEAR.gap: 0.8}, keys=frozenset({"K"}), events=frozenset({"attack"}))
    running = advanced_progress(FIGHTER, initial_progress(FIGHTER), near)
    assert (running.state, running.seconds) == ("Ward off", 0.0)
    waiting = [advanced_progress(FIGHTER, running, ConditionInput(step)).state for step in (0.4, 0.5)]
    assert waiting == ["Ward off", "Guard"]


def test_a_key_alone_does_not_strike_at_who_is_far_or_not_there() -> None:
    far, alone = ({NEAR.gap: 1.2}, {})
    for gaps in (far, alone):
        assert (
            advanced_progress(
                FIGHTER, initial_progress(FIGHTER), ConditionInput(0.1, gaps, keys=frozenset({"K"}))
            ).state
            == "Guard"
        )


def test_what_plays_a_state_that_is_removed_begins_again() -> None:
    assert advanced_progress(
        FIGHTER, BehaviourProgress("Nap", 3.0), ConditionInput(0.1, clip_ended=True)
    ) == BehaviourProgress("Guard")


def test_what_has_to_be_measured_is_what_leads_away() -> None:
    assert FIGHTER.gaps_from("Guard") == (NEAR.gap,)
    assert FIGHTER.gaps_from("Strike") == ()


def test_manners_are_constraints_after_the_partner() -> None:
    meet, lean, keep = Meet(), LeanAway(metres=0.3), KeepDistance()
    first, second = reaction_constraints((meet, lean, keep), "motion", "other", "Guard")
    assert isinstance(first, PositionConstraint)
    assert first.target == FollowPerformer("other", meet.whom.point)  # type: ignore[union-attr]
    assert isinstance(second, AreaConstraint)
    assert second.size[0] == pytest.approx(2 * lean.metres)
    assert reaction_constraints((meet, lean, keep), "motion", "", "Guard") == ()


def test_a_project_of_before_there_were_behaviours_opens_with_none() -> None:
    members: dict[str, object] = {}
    record = json.loads(project_json(make_project(), members))  # type: ignore[arg-type]
    del record["behaviours"]
    read = project_of(record, lambda name: members[name])  # type: ignore[arg-type, return-value]
    assert (read.losses, read.remarks) == ([], [])
    assert not read.project.behaviours
