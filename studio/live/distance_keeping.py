"""Distance keeping in live play: time, length and rotation of a performer's steps."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.follow import FollowPerformer
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.compose import Composite
from studio.core.stage.behaviour import Role, State
from studio.core.stage.behaviour_target import PELVIS_POINT, resolved_target
from studio.core.stage.placement import Placement
from studio.core.stage.reactions import KeepDistance
from studio.live.live_behaviour import StageView, StartedAct

FloatArray = NDArray[np.float64]

DISTANCE_STEP_SECONDS = 0.6
"""Seconds that a step of both feet takes."""
KEEPING_STEP_METRES, KEEPING_TURN = 0.4, 0.7
"""Maximum displacement (m) and rotation (radians) of one step."""
KEEPING_FACING_TOLERANCE = 0.25
"""Error of facing in radians that is accepted without a step."""
SETTLING_SECONDS = 0.3
"""Seconds after the start of an act, and after a step, during which a performer does not step."""


def distance_step(seen: StageView, key: str, act: StartedAct, composite: Composite, frame: int) -> StartedAct | None:
    """Act of a step that corrects a performer's distance and facing; None if it needs none, or may not step yet.

    The performer plays ``frame`` of ``composite``, which belongs to ``act``.
    """
    found = seen.state_of(key)
    kept = _kept(found[0]) if found else None
    if (
        found is None
        or kept is None
        or seen.seconds < act.clip.start + SETTLING_SECONDS + DISTANCE_STEP_SECONDS * act.steps
    ):
        return None
    role, project = found[1], seen.project
    whom, own = seen.place_of(kept.whom, role), seen.place_of(FollowPerformer(key, PELVIS_POINT), role)
    if whom is None or own is None:
        return None
    placement = Placement.of(project.performers[key])
    away = (whom - own)[:2]
    apart = max(float(np.linalg.norm(away)), 1e-9)
    looks = float(composite.motion.channels[frame, channel.YAW]) + placement.heading - _stance(act, composite, frame)
    turn = (math.atan2(away[1], away[0]) - looks + math.pi) % (2.0 * math.pi) - math.pi
    unit = seen.unit_of(kept.gap, role)
    wrong = apart - unit * kept.distance
    if abs(turn) <= KEEPING_FACING_TOLERANCE and abs(wrong) <= unit * kept.room:
        return None
    wrong *= 0.5 if _comes_too(seen, key, kept, role) else 1.0
    leg = project.characters[project.performers[key].character_id].morphology.leg_length
    way = float(np.clip(wrong, -KEEPING_STEP_METRES, KEEPING_STEP_METRES)) * away / (apart * leg)
    x, y, _ = (placement.rotation.T @ [*way, 0.0]).tolist()
    turned = float(np.clip(turn, -KEEPING_TURN, KEEPING_TURN))
    return replace(act, clip=replace(act.clip, turn=turned, offset=(x, y), ease=DISTANCE_STEP_SECONDS), steps=True)


def _kept(state: State) -> KeepDistance | None:
    return next((each for each in state.manners if isinstance(each, KeepDistance)), None)


def _stance(act: StartedAct, composite: Composite, frame: int) -> float:
    """Median yaw (rad) of the pelvis in a clip relative to the facing direction: fighters stand half sideways."""
    yaws = composite.piece_at(frame).piece.motion.channels[act.clip.first : act.clip.last + 1, channel.YAW]
    return float(np.median(yaws)) * (-1.0 if act.clip.mirrored else 1.0)


def _comes_too(seen: StageView, key: str, kept: KeepDistance, role: Role) -> bool:
    """True if the performer from which this one keeps its distance does the same; then each takes half of the step."""
    whom = resolved_target(kept.whom, role.partner_id)
    found = seen.state_of(whom.performer_id) if isinstance(whom, FollowPerformer) else None
    other = _kept(found[0]) if found else None
    back = resolved_target(other.whom, found[1].partner_id) if found and other else None
    return isinstance(back, FollowPerformer) and back.performer_id == key
