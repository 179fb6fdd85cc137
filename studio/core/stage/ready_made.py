"""Ready-made behaviours of a fighter: each adds states to a behaviour around its start state."""

from dataclasses import replace

from studio.core.curves.activation import ActivationCurve
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import Behaviour, State, Transition
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import (
    ClipEndCondition,
    Condition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.manners import FIST_POINT, HEAD_POINT, WHOLE_CLIP, KeepDistance, LeanAway, Meet
from studio.core.stage.whom import DistanceMeasure, FollowPartner

STRIKE_DISTANCE, APPROACH_DISTANCE, DISTANCE_TOLERANCE = 1.42, 1.65, 0.12
"""Leg lengths: distance kept by two fighters, distance below which one strikes, and tolerance of the kept distance."""
ATTACK = "attack"
"""Name of the event that a strike sends to the partner."""
PARTNER_FIST_TO_HEAD = DistanceMeasure(FollowPartner(FIST_POINT), HEAD_POINT, flat=False)
ANSWER_SECONDS, RETURN_SECONDS = 0.15, 0.3
"""Seconds of the blends into an answer and back to guard; the second is also the least time of leaning away."""
LEAN_DISTANCE, LEAN_HYSTERESIS = 0.35, 0.15
"""Metres that the head keeps from a fist, and further metres (hysteresis) before it comes back."""
ACROSS, DOWN = 288.0, 152.0
"""Horizontal and vertical spacing of states in the diagram."""


def guard_behaviour(clip: Clip | None) -> Behaviour:
    """Behaviour of a single state, the guard."""
    return Behaviour("Fighter", (State("Guard", clip),))


def with_distance_kept(behaviour: Behaviour) -> Behaviour:
    """Behaviour whose start state keeps its partner at striking distance, in place of other distances."""
    start = _start(behaviour)
    others = tuple(each for each in start.manners if not isinstance(each, KeepDistance))
    state = replace(
        start, manners=(KeepDistance(FollowPartner(), STRIKE_DISTANCE, DISTANCE_TOLERANCE, legs=True), *others)
    )
    return edits.with_state_put(behaviour, start.name, state)


def with_strike(behaviour: Behaviour, clip: Clip, key: str) -> Behaviour:
    """Behaviour with a strike when a key is pressed and the partner is near enough, with an event to the partner."""
    state = State("Strike", clip, loop=False, event=ATTACK)
    near = DistanceCondition(DistanceMeasure(legs=True), APPROACH_DISTANCE)
    return _answering(behaviour, state, (KeyCondition(key), near), (ClipEndCondition(),), (-1.0, 0.0))


def with_parry(behaviour: Behaviour, clip: Clip, when: ActivationCurve = WHOLE_CLIP) -> Behaviour:
    """Behaviour with a state that parries the partner's strike on ``ATTACK``; ``when`` in seconds of the motion."""
    state = State("Block", clip, loop=False, manners=(Meet(activation=when),))
    return _answering(behaviour, state, (EventCondition(ATTACK),), (ClipEndCondition(),), (1.0, 0.0))


def with_lean_away(behaviour: Behaviour) -> Behaviour:
    """Behaviour with a state that leans away from the partner's near fist while it plays the start state's clip."""
    state = State("Lean away", _start(behaviour).clip, manners=(LeanAway(metres=LEAN_DISTANCE),))
    near = DistanceCondition(PARTNER_FIST_TO_HEAD, LEAN_DISTANCE)
    far = DistanceCondition(PARTNER_FIST_TO_HEAD, LEAN_DISTANCE + LEAN_HYSTERESIS, closer=False)
    return _answering(behaviour, state, (near,), (TimeCondition(RETURN_SECONDS), far), (0.0, 1.0))


def _answering(
    behaviour: Behaviour,
    state: State,
    there: tuple[Condition, ...],
    back: tuple[Condition, ...],
    aside: tuple[float, float],
) -> Behaviour:
    """Behaviour with a state reached from the start state and leading back to it, beside it in the diagram."""
    start = _start(behaviour)
    x, y = start.place
    while any(abs(each.place[0] - x) < 200.0 and abs(each.place[1] - y) < 80.0 for each in behaviour.states):
        x, y = x + aside[0] * ACROSS, y + aside[1] * DOWN
    more = edits.with_state(behaviour, replace(state, place=(x, y)))
    name = more.states[-1].name
    ways = (Transition(start.name, name, there, ANSWER_SECONDS), Transition(name, start.name, back, RETURN_SECONDS))
    return replace(more, transitions=(*more.transitions, *ways))


def _start(behaviour: Behaviour) -> State:
    return next(each for each in behaviour.states if each.name == behaviour.start)
