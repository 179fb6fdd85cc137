"""Sparring of two fighters whose behaviours keep their distance, strike on a key, ward off and lean away."""

import math
from dataclasses import replace

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.mesh import hand_shapes
from studio.core.stage import behaviour_edits as edits
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.behaviour_target import FollowPartner
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import ClipEndCondition, Condition, DistanceCondition, EventCondition, KeyCondition
from studio.core.stage.project import Performer, Project
from studio.core.stage.reactions import ARM_POINT, FIST_POINT, HEAD_POINT, KeepDistance, LeanAway, Meet
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, hit_activation, source_motions, varied_characters

ARM_STRETCHED_FRAME = 181
"""Frame of the capture at which the arm is stretched most."""
PUNCH_FIRST_FRAME, PUNCH_LAST_FRAME, GUARD_FIRST_FRAME = 140, 230, 240
"""Frames at which a punch begins and ends, and from which on the fighter only stands on guard."""
PUNCH_HIT_SECONDS = (ARM_STRETCHED_FRAME - PUNCH_FIRST_FRAME) / BUNDLED_FRAME_RATE
"""Seconds from the beginning of a punch to its hit."""
SPARRING_DISTANCE = 1.25
"""Distance between the fighters in metres."""
PUNCH_DISTANCE = 1.7
"""Distance in metres below which a fighter punches."""
HEAD_CLEARANCE = 0.3
"""Distance in metres that a head keeps from a fist."""
CHEST_TARGET_POINT = BodyPoint(BodyPart.THORAX, (0.24, 0.0, 0.0))
LOW_PUNCH, HIGH_PUNCH = "low punch", "high punch"
"""Names of the states of the two punches."""
PUNCH_KEYS = {"adult_woman": ("X", "C"), "tall_man": ("N", "M")}
"""Keys of a low and of a high punch, by fighter."""
PUNCH_CHAIN = Chain(trunk=1.0, root=1.0)


def sparring() -> Project:
    """Project of the scene. Raises StudioError if a bundled file cannot be read."""
    stuff = source_motions(rest=("Guard", "straight_punch"), punch=("Punch", "straight_punch"))
    people = {
        key: replace(each, grip=hand_shapes.FIST_GRIP)
        for key, each in varied_characters(5).items()
        if key in PUNCH_KEYS
    }
    performers, behaviours = {}, {}
    for index, (key, other) in enumerate((tuple(PUNCH_KEYS), tuple(PUNCH_KEYS)[::-1])):
        guard = Clip("rest", GUARD_FIRST_FRAME, GUARD_FIRST_FRAME + 99, id=f"{key} guard")
        x, heading = index * SPARRING_DISTANCE, index * math.pi
        performers[key] = Performer(people[key].name, key, (guard,), (x, 0.0), heading)
        behaviours[key] = replace(
            fighter(*PUNCH_KEYS[key], upright_head(people[other].morphology)), cast=(Role(key, other),)
        )
    return Project(stuff.captures, stuff.motions, people, performers, contacts=stuff.contacts, behaviours=behaviours)


def upright_head(body: Morphology) -> BodyPoint:
    """Middle of the upright head as a point of the pelvis, so that it does not move when the body leans."""
    height = float(np.linalg.norm(body.spine, axis=1).sum()) + body.neck + 0.5 * body.head
    return BodyPoint(BodyPart.PELVIS, (0.1, 0.0, height))


def fighter(low: str, high: str, head: BodyPoint) -> Behaviour:
    """Behaviour of a fighter, which stands on guard until a key makes it punch or its partner punches.

    ``low`` and ``high`` are the keys of a punch at the chest and at the point ``head``.
    """
    guard = Clip("rest", GUARD_FIRST_FRAME, GUARD_FIRST_FRAME + 99, id="guard")
    punch, answer = (
        Clip("punch", PUNCH_FIRST_FRAME, PUNCH_LAST_FRAME, id="punch"),
        Clip("rest", GUARD_FIRST_FRAME, GUARD_FIRST_FRAME + 60, id="answer"),
    )
    met = GUARD_FIRST_FRAME + round(PUNCH_HIT_SECONDS * BUNDLED_FRAME_RATE)
    at_chest = Meet(FollowPartner(CHEST_TARGET_POINT), FIST_POINT, hit_activation(ARM_STRETCHED_FRAME), PUNCH_CHAIN)
    at_head = Meet(FollowPartner(head), FIST_POINT, hit_activation(ARM_STRETCHED_FRAME), PUNCH_CHAIN)
    behaviour = Behaviour("Fighter", (State("Guard", guard, manners=(KeepDistance(distance=SPARRING_DISTANCE),)),))
    near, fist = DistanceCondition(distance=PUNCH_DISTANCE), FollowPartner(FIST_POINT)
    for state, conditions in (
        (State("Ward off", answer, False, (Meet(fist, ARM_POINT, hit_activation(met, 9)),), "", (288.0, -104.0)),
         (EventCondition(LOW_PUNCH),)),
        (State("Lean away", answer, False, (LeanAway(fist, HEAD_POINT, HEAD_CLEARANCE),), "", (288.0, 104.0)),
         (EventCondition(HIGH_PUNCH),)),
        (State("Low punch", punch, False, (at_chest,), LOW_PUNCH, (-288.0, -104.0)), (KeyCondition(low), near)),
        (State("High punch", punch, False, (at_head,), HIGH_PUNCH, (-288.0, 104.0)), (KeyCondition(high), near)),
    ):  # fmt: skip
        behaviour = _with_answer(behaviour, state, conditions)
    return behaviour


def _with_answer(behaviour: Behaviour, state: State, conditions: tuple[Condition, ...]) -> Behaviour:
    """Behaviour with ``state`` added, which follows the guard on ``conditions`` and returns to it when its
    clip ends.
    """
    more = edits.with_state(behaviour, state)
    ways = (
        Transition("Guard", state.name, conditions, 0.2),
        Transition(state.name, "Guard", (ClipEndCondition(),), 0.3),
    )
    return replace(more, transitions=(*more.transitions, *ways))
