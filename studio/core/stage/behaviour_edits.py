"""Edits of a behaviour: functions that return a changed copy. An invalid edit raises ValueError, as
``Behaviour`` does.
"""

from collections.abc import Collection
from dataclasses import replace

from studio.core.names import free_name
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.conditions import ClipEndCondition


def with_state(behaviour: Behaviour, state: State) -> Behaviour:
    """Copy with one more state, under a free name."""
    name = free_name(state.name, {each.name for each in behaviour.states})
    return replace(behaviour, states=(*behaviour.states, replace(state, name=name)))


def with_copies(behaviour: Behaviour, names: Collection[str], away: tuple[float, float]) -> Behaviour:
    """Copy in which the states ``names`` are duplicated, with the transitions between them; the duplicates lie ``away``
    from them in the diagram.
    """
    copied = behaviour
    called: dict[str, str] = {}
    for state in behaviour.states:
        if state.name in names:
            place = state.place[0] + away[0], state.place[1] + away[1]
            copied = with_state(copied, replace(state, place=place))
            called[state.name] = copied.states[-1].name
    between = [
        replace(each, source=called[each.source], target=called[each.target])
        for each in behaviour.transitions
        if each.source in called and each.target in called
    ]
    return replace(copied, transitions=(*copied.transitions, *between))


def with_state_put(behaviour: Behaviour, name: str, state: State) -> Behaviour:
    """Copy in which ``state`` replaces the state ``name``; transitions follow a change of name."""

    def now(each: str) -> str:
        return state.name if each == name else each

    states = tuple(state if each.name == name else each for each in behaviour.states)
    ends = tuple(replace(each, source=now(each.source), target=now(each.target)) for each in behaviour.transitions)
    return replace(behaviour, states=states, transitions=ends, start=now(behaviour.start))


def without_states(behaviour: Behaviour, names: Collection[str]) -> Behaviour:
    """Copy without the states ``names`` and all transitions from or to them.

    If the start state is removed, the first remaining state becomes the start.
    """
    states = tuple(each for each in behaviour.states if each.name not in names)
    if not states:
        raise ValueError(f"The last state of '{behaviour.name}' cannot be deleted. Delete the behaviour instead.")
    kept = tuple(each for each in behaviour.transitions if not {each.source, each.target} & set(names))
    start = states[0].name if behaviour.start in names else behaviour.start
    return replace(behaviour, states=states, transitions=kept, start=start)


def with_new_transition(behaviour: Behaviour, source: str, target: str) -> Behaviour:
    """Copy with a new transition from ``source`` to ``target``, on the default condition that the clip ends."""
    new = Transition(source, target, (ClipEndCondition(),))
    return replace(behaviour, transitions=(*behaviour.transitions, new))


def with_transition_replaced(behaviour: Behaviour, index: int, transition: Transition) -> Behaviour:
    """Copy in which ``transition`` replaces the transition at ``index``."""
    transitions = list(behaviour.transitions)
    transitions[index] = transition
    return replace(behaviour, transitions=tuple(transitions))


def without_transitions(behaviour: Behaviour, indices: Collection[int]) -> Behaviour:
    """Copy without the transitions at ``indices``."""
    kept = tuple(each for index, each in enumerate(behaviour.transitions) if index not in indices)
    return replace(behaviour, transitions=kept)


def transition_rank(behaviour: Behaviour, index: int) -> tuple[int, int]:
    """Rank of a transition among those from the same state, from 1, and the number of these transitions."""
    source = behaviour.transitions[index].source
    places = [k for k, each in enumerate(behaviour.transitions) if each.source == source]
    return places.index(index) + 1, len(places)


def with_transition_moved_up(behaviour: Behaviour, index: int) -> tuple[Behaviour, int]:
    """Copy in which a transition has changed places with the previous one of the same state, and its new index."""
    source = behaviour.transitions[index].source
    before = [k for k in range(index) if behaviour.transitions[k].source == source]
    if not before:
        return behaviour, index
    order = list(behaviour.transitions)
    order[before[-1]], order[index] = order[index], order[before[-1]]
    return replace(behaviour, transitions=tuple(order)), before[-1]


def with_performer(behaviour: Behaviour, performer_id: str, partner_id: str = "") -> Behaviour:
    """Copy with a performer added to the cast, with ``partner_id`` as its partner."""
    role = Role(performer_id, partner_id)
    if behaviour.role_of(performer_id) is None:
        return replace(behaviour, cast=(*behaviour.cast, role))
    return replace(
        behaviour, cast=tuple(role if each.performer_id == performer_id else each for each in behaviour.cast)
    )


def without_performer(behaviour: Behaviour, performer_id: str) -> Behaviour:
    """Copy without a performer in the cast."""
    return replace(behaviour, cast=tuple(each for each in behaviour.cast if each.performer_id != performer_id))
