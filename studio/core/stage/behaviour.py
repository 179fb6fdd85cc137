"""Behaviour: a state machine that chooses the clips of a performer while the stage runs live.

States play clips. A transition leads from one state to another when all of its conditions hold. Several performers may
play one behaviour, each against a partner of its own. ``advanced_progress`` runs the state machine as a pure function
of values that the project stores. State-machine libraries keep the current state in objects of their own, so none is
used.
"""

import math
from dataclasses import dataclass, replace

from studio.core.plausible import PLACE_RANGE
from studio.core.stage.behaviour_target import BehaviourTarget, DistanceMeasure, reference_of
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import Condition, ConditionInput, DistanceCondition
from studio.core.stage.reactions import Reaction

LONGEST_BLEND_SECONDS = 5.0
"""Longest blend from one state to another, in seconds."""


@dataclass(frozen=True)
class State:
    """State of a behaviour: plays ``clip`` (its start on the stage is ignored) or, without a clip, holds the present
    pose.

    ``loop`` repeats the clip until a transition leads away; otherwise its last frame is held. ``event`` is sent to the
    partner when the state begins. In this state the constraints and contacts of the clip's id apply, and the reactions
    ``manners`` in addition. ``place`` is the state's position in the diagram.
    """

    name: str
    clip: Clip | None = None
    loop: bool = True
    manners: tuple[Reaction, ...] = ()
    event: str = ""
    place: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", self.name.strip())
        object.__setattr__(self, "event", self.event.strip())
        if not self.name:
            raise ValueError("A state needs a name.")
        if not all(math.isfinite(number) for number in self.place):
            raise ValueError(f"'{self.name}': the position in the diagram must be two finite numbers.")
        PLACE_RANGE.check(self.place)


@dataclass(frozen=True)
class Transition:
    """Transition from the state named ``source`` to the state named ``target``, made when all ``conditions`` hold.

    The blend takes ``blend`` seconds; 0 lets the blend take as long as the difference of the poses needs.
    """

    source: str
    target: str
    conditions: tuple[Condition, ...]
    blend: float = 0.0

    def __post_init__(self) -> None:
        where = f"'{self.source}' to '{self.target}'"
        if not self.conditions:
            raise ValueError(f"{where}: a transition needs a condition. Add one first.")
        if not (math.isfinite(self.blend) and 0.0 <= self.blend <= LONGEST_BLEND_SECONDS):
            raise ValueError(
                f"{where}: the blend time must be 0 to {LONGEST_BLEND_SECONDS:g} seconds, not {self.blend}."
            )


@dataclass(frozen=True)
class Role:
    """Performer in the cast of a behaviour, and the id of its partner; an empty id for no partner."""

    performer_id: str
    partner_id: str = ""

    def __post_init__(self) -> None:
        if self.performer_id == self.partner_id:
            raise ValueError("A character cannot be its own partner. Choose another character.")


@dataclass(frozen=True)
class Behaviour:
    """State machine: states with unique names, transitions in the order in which they are tried, and the cast that
    plays it.

    Raises ValueError for a duplicate state name, a transition from or to a missing state, a missing start state, and a
    performer with two roles.
    """

    name: str
    states: tuple[State, ...]
    transitions: tuple[Transition, ...] = ()
    start: str = ""
    cast: tuple[Role, ...] = ()

    def __post_init__(self) -> None:
        if not self.states:
            raise ValueError(f"'{self.name}': a behaviour needs at least one state.")
        names = [state.name for state in self.states]
        object.__setattr__(self, "start", self.start or names[0])
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"'{self.name}': two states are called '{name}'. Rename one of them.")
        if self.start not in names:
            raise ValueError(
                f"'{self.name}': the start state '{self.start}' does not exist. Choose another start state."
            )
        for each in self.transitions:
            for end in (each.source, each.target):
                if end not in names:
                    raise ValueError(
                        f"'{self.name}': the transition from '{each.source}' to '{each.target}' refers to a missing"
                        f" state, '{end}'."
                    )
        players = [role.performer_id for role in self.cast]
        if len(set(players)) < len(players):
            raise ValueError(f"'{self.name}': a character can use a behaviour only once.")

    def state(self, name: str) -> State | None:
        """State of that name, or None."""
        return next((each for each in self.states if each.name == name), None)

    def role_of(self, performer_id: str) -> Role | None:
        """Role of a performer, or None if it does not play this behaviour."""
        return next((each for each in self.cast if each.performer_id == performer_id), None)

    def transitions_from(self, name: str) -> tuple[Transition, ...]:
        """Transitions from a state, in the order in which they are tried."""
        return tuple(each for each in self.transitions if each.source == name)

    def gaps_from(self, name: str) -> tuple[DistanceMeasure, ...]:
        """Distances that the conditions of the transitions from the state ``name`` need, without repeats."""
        conditions = (each for transition in self.transitions_from(name) for each in transition.conditions)
        return tuple(dict.fromkeys(each.gap for each in conditions if isinstance(each, DistanceCondition)))

    @property
    def references(self) -> tuple[tuple[str, str], ...]:
        """(collection, id) of all referenced entities: motions, performers, props."""
        motions = [("motions", each.clip.motion_id) for each in self.states if each.clip]
        players = [("performers", key) for role in self.cast for key in (role.performer_id, role.partner_id) if key]
        meant = [reference for whom in self._meant for reference in reference_of(whom)]
        return tuple(dict.fromkeys((*motions, *players, *meant)))

    @property
    def _meant(self) -> list[BehaviourTarget]:
        conditions = [each for transition in self.transitions for each in transition.conditions]
        manners = [each.whom for state in self.states for each in state.manners]
        return [*(each.gap.whom for each in conditions if isinstance(each, DistanceCondition)), *manners]


@dataclass(frozen=True)
class BehaviourProgress:
    """Progress of a performer in its behaviour: its state, ``seconds`` spent there, and the transition that
    led there.
    """

    state: str
    seconds: float = 0.0
    through: Transition | None = None


def initial_progress(behaviour: Behaviour) -> BehaviourProgress:
    """Progress of a performer that enters the start state of ``behaviour``."""
    return BehaviourProgress(behaviour.start)


def advanced_progress(behaviour: Behaviour, running: BehaviourProgress, senses: ConditionInput) -> BehaviourProgress:
    """Progress of a performer ``senses.step`` seconds after ``running``.

    The transitions from its state are tried in order. The first one whose conditions all hold leads to the next state,
    at 0 seconds; there is at most one transition a frame. If the state no longer exists, the behaviour restarts.
    """
    if behaviour.state(running.state) is None:
        return initial_progress(behaviour)
    seconds = running.seconds + senses.step
    for each in behaviour.transitions_from(running.state):
        if all(condition.is_met(senses, seconds) for condition in each.conditions):
            return BehaviourProgress(each.target, through=each)
    return replace(running, seconds=seconds)


def without_references(behaviour: Behaviour, collection: str, entity_id: str) -> Behaviour:
    """Behaviour without its references to a removed entity, given by collection and id.

    States lose the clip of a removed motion. Roles, reactions and transitions that refer to a removed performer or prop
    are removed; a performer that loses its partner plays on without one.
    """
    gone = (collection, entity_id)
    states = tuple(
        replace(
            state,
            clip=None if state.clip and ("motions", state.clip.motion_id) == gone else state.clip,
            manners=tuple(each for each in state.manners if gone not in reference_of(each.whom)),
        )
        for state in behaviour.states
    )
    transitions = tuple(
        each
        for each in behaviour.transitions
        if not any(isinstance(one, DistanceCondition) and gone in reference_of(one.gap.whom) for one in each.conditions)
    )
    cast = tuple(
        replace(role, partner_id="") if ("performers", role.partner_id) == gone else role
        for role in behaviour.cast
        if ("performers", role.performer_id) != gone
    )
    return replace(behaviour, states=states, transitions=transitions, cast=cast)
