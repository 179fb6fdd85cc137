"""Behaviours in live play: the inputs of their conditions, and the acts that their states start."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.scope import Scope
from studio.core.curves.retiming import SLOWEST_CLIP_SPEED
from studio.core.solver.adapt import body_point_positions
from studio.core.solver.performers.prop_tracks import Holder, stage_track
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.behaviour import Behaviour, BehaviourProgress, Role, State
from studio.core.stage.behaviour_target import BehaviourTarget, DistanceMeasure, resolved_target
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import ConditionInput
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.core.stage.reactions import reaction_constraints

FloatArray = NDArray[np.float64]

SLOWING_SECONDS = 0.5
"""Seconds in which a performer that holds its current pose comes to rest."""


@dataclass(frozen=True)
class StartedAct:
    """Clip that a state plays on a performer, and the constraints ``asked`` that the state adds; ``steps`` is True if
    it begins with a step.
    """

    clip: Clip
    asked: tuple[Constraint, ...] = ()
    steps: bool = False


@dataclass(frozen=True)
class StageView:
    """Stage as last solved, at ``seconds``, and the current state of each performer's behaviour."""

    project: Project
    results: Mapping[str, AdaptedMotion]
    running: Mapping[str, BehaviourProgress]
    seconds: float

    def place_of(self, whom: BehaviourTarget, role: Role) -> FloatArray | None:
        """Stage position (3,) of the target ``whom`` for a performer in ``role``; None if it is missing."""
        follow = resolved_target(whom, role.partner_id)
        if isinstance(follow, FollowPerformer):
            result = self.results.get(follow.performer_id)
            if result is None:
                return None
            return Placement.of(self.project.performers[follow.performer_id]).to_stage(
                body_point_positions(follow.point, result)[0]
            )
        prop = self.project.props.get(follow.prop_id) if follow else None
        if follow is None or prop is None:
            return None
        hands = {
            key: Holder(self.results[key], [0.0], Placement.of(self.project.performers[key]))
            for key in prop.holders & self.results.keys()
        }
        track = stage_track(prop, [self.seconds], hands)
        offset = np.array(follow.offset) + np.array(follow.share) * np.array(prop.size) / 2
        return np.asarray(track.positions[0] + track.rotations[0] @ offset)

    def unit_of(self, gap: DistanceMeasure, role: Role) -> float:
        """Metres per unit of a distance: 1, or the mean leg length of both performers."""
        if not gap.legs:
            return 1.0
        follow = resolved_target(gap.whom, role.partner_id)
        keys = [role.performer_id, *([follow.performer_id] if isinstance(follow, FollowPerformer) else [])]
        bodies = [self.project.characters[self.project.performers[key].character_id] for key in keys]
        return sum(each.morphology.leg_length for each in bodies) / len(bodies)

    def state_of(self, key: str) -> tuple[State, Role] | None:
        """Current state of a performer's behaviour, and its role; None without a behaviour."""
        behaviour = self.project.behaviours.get(self.project.behaviour_of(key) or "")
        state = behaviour.state(self.running[key].state) if behaviour and key in self.running else None
        role = behaviour.role_of(key) if behaviour else None
        return (state, role) if state and role else None


def started_act(state: State, role: Role, blend: float, playing: Clip, frame: int, frame_rate: float) -> StartedAct:
    """Act of a state for a performer that currently plays ``frame`` of the clip ``playing``; ``blend`` is in
    seconds.
    """
    if state.clip is not None:
        goes_on = replace(playing, start=0.0, first=0, ease=0.0) == replace(state.clip, start=0.0, first=0, ease=0.0)
        first = frame if goes_on and state.clip.first <= frame < state.clip.last else state.clip.first
        clip = replace(state.clip, first=first, joined=True, ease=blend)
    else:  # slower and slower, until the last frame is held
        last = frame + max(round(SLOWEST_CLIP_SPEED * SLOWING_SECONDS * frame_rate), 1)
        clip = replace(
            playing,
            first=frame,
            last=last,
            speed=SLOWEST_CLIP_SPEED,
            repeats=1,
            turn=0.0,
            offset=(0.0, 0.0),
            ease=blend,
        )
    asked = reaction_constraints(state.manners, clip.motion_id, role.partner_id, state.name)
    return StartedAct(clip, tuple(replace(each, scope=Scope(role.performer_id)) for each in asked))


def condition_input(seen: StageView, behaviour: Behaviour, role: Role, heard: ConditionInput) -> ConditionInput:
    """Inputs for the conditions of a performer's state: ``heard`` events and keys, and the distances that the state
    tests, measured in the last solved frame.

    ``heard.gaps`` is ignored; distances to missing performers or props are left out.
    """
    gaps: dict[DistanceMeasure, float] = {}
    for gap in behaviour.gaps_from(seen.running[role.performer_id].state):
        own = seen.place_of(FollowPerformer(role.performer_id, gap.point), role)
        other = seen.place_of(gap.whom, role)
        if own is not None and other is not None:
            metres = float(np.linalg.norm((other - own)[: 2 if gap.flat else 3]))
            gaps[gap] = metres / seen.unit_of(gap, role)
    return replace(heard, gaps=gaps)
