"""Ready-made behaviours of a fighter: functions that add states around the start state of a behaviour."""

from dataclasses import replace

from studio.core.curves.activation import ActivationCurve
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import Behaviour, State, Transition
from studio.core.stage.behaviour_target import DistanceMeasure, FollowPartner
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import (
    ClipEndCondition,
    Condition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.reactions import ACTIVE_WHOLE_CLIP, FIST_POINT, HEAD_POINT, KeepDistance, LeanAway, Meet

STRIKE_DISTANCE, APPROACH_DISTANCE, DISTANCE_TOLERANCE = 1.42, 1.65, 0.12
"""In leg lengths: distance that two fighters keep, distance below which one strikes, and tolerance of the kept
distance.
"""
ATTACK_EVENT = "attack"
"""Name of the event that a strike sends to the partner."""
PARTNER_FIST_TO_HEAD = DistanceMeasure(FollowPartner(FIST_POINT), HEAD_POINT, flat=False)
"""Distance between the partner's right fist and the own head."""
ANSWER_SECONDS, RETURN_SECONDS = 0.15, 0.3
"""Length in seconds of the blend into an answer, and of the blend back to guard; the second is also the least time of
leaning away.
"""
LEAN_DISTANCE, LEAN_HYSTERESIS = 0.35, 0.15
"""Distance in metres of the head from a fist below which a fighter leans away, and the further metres (hysteresis)
before it comes back.
"""
STATE_SPACING_X, STATE_SPACING_Y = 288.0, 152.0
"""Horizontal and vertical distance between states in the coordinates of the diagram."""


def guard_behaviour(clip: Clip | None) -> Behaviour:
    """Behaviour of a single state, the guard, which loops ``clip``."""
    return Behaviour("Fighter", (State("Guard", clip),))


def with_distance_kept(behaviour: Behaviour) -> Behaviour:
    """Behaviour whose start state keeps the partner at striking distance; a distance kept before is replaced."""
    start = _start(behaviour)
    others = tuple(each for each in start.manners if not isinstance(each, KeepDistance))
    state = replace(
        start, manners=(KeepDistance(FollowPartner(), STRIKE_DISTANCE, DISTANCE_TOLERANCE, legs=True), *others)
    )
    return edits.with_state_put(behaviour, start.name, state)


def with_strike(behaviour: Behaviour, clip: Clip, key: str) -> Behaviour:
    """Behaviour with a strike that plays ``clip`` when ``key`` is pressed and the partner is near enough.

    The strike sends the event ``ATTACK_EVENT`` to the partner.
    """
    state = State("Strike", clip, loop=False, event=ATTACK_EVENT)
    near = DistanceCondition(DistanceMeasure(legs=True), APPROACH_DISTANCE)
    return _answering(behaviour, state, (KeyCondition(key), near), (ClipEndCondition(),), (-1.0, 0.0))


def with_parry(behaviour: Behaviour, clip: Clip, when: ActivationCurve = ACTIVE_WHOLE_CLIP) -> Behaviour:
    """Behaviour with a state that plays ``clip`` and parries the partner's strike, on ``ATTACK_EVENT``.

    ``when`` is the activation of the parry in motion seconds.
    """
    state = State("Block", clip, loop=False, manners=(Meet(activation=when),))
    return _answering(behaviour, state, (EventCondition(ATTACK_EVENT),), (ClipEndCondition(),), (1.0, 0.0))


def with_lean_away(behaviour: Behaviour) -> Behaviour:
    """Behaviour with a state that leans away from the partner's fist when it is near, while the guard clip plays on."""
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
    """Behaviour with ``state`` reached from the start state under ``there`` and left for it under ``back``; ``aside``
    is its offset in the diagram.
    """
    start = _start(behaviour)
    x, y = start.place
    while any(abs(each.place[0] - x) < 200.0 and abs(each.place[1] - y) < 80.0 for each in behaviour.states):
        x, y = x + aside[0] * STATE_SPACING_X, y + aside[1] * STATE_SPACING_Y
    more = edits.with_state(behaviour, replace(state, place=(x, y)))
    name = more.states[-1].name
    ways = (Transition(start.name, name, there, ANSWER_SECONDS), Transition(name, start.name, back, RETURN_SECONDS))
    return replace(more, transitions=(*more.transitions, *ways))


def _start(behaviour: Behaviour) -> State:
    return next(each for each in behaviour.states if each.name == behaviour.start)
