"""Texts that describe conditions of transitions, and clips and reactions of states."""

import math

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowPerformer
from studio.core.stage.behaviour import State
from studio.core.stage.behaviour_target import BehaviourTarget, FollowPartner
from studio.core.stage.conditions import (
    Condition,
    DistanceCondition,
    EventCondition,
    KeyCondition,
    TimeCondition,
)
from studio.core.stage.project import Project
from studio.core.stage.reactions import ARM_POINT, FIST_POINT, HEAD_POINT, KeepDistance, LeanAway, Reaction
from studio.document.length_units import length_text
from studio.engine.point_names import POINT_NAMES, point_words

LEFT_FIST = BodyPoint(BodyPart.LEFT_HAND, FIST_POINT.offset)
RIGHT_FOREARM = BodyPoint(BodyPart.RIGHT_FOREARM, ARM_POINT.offset)
FIGHT_POINT_NAMES = {
    HEAD_POINT: "head",
    FIST_POINT: "right fist",
    LEFT_FIST: "left fist",
    RIGHT_FOREARM: "right forearm",
    ARM_POINT: "left forearm",
}
"""Names of points that are used in fights and are no joints."""
_UPRIGHT = (BodyPart.PELVIS, BodyPart.ABDOMEN, BodyPart.THORAX, BodyPart.NECK, BodyPart.HEAD)
_WAYS = (("behind", "ahead of"), ("right of", "left of"), ("below", "above"))


def point_name(point: BodyPoint) -> str:
    """Name of a body point, for example ``right fist``, ``left wrist`` or ``a point 0.90 m above the pelvis``."""
    return FIGHT_POINT_NAMES.get(point) or (_offset_words(point) if any(point.offset) else point_words(point))


def _offset_words(point: BodyPoint) -> str:
    """Distance of a body point from its joint as text; for points on the trunk with the direction."""
    axis = max(range(3), key=lambda place: abs(point.offset[place]))
    way = _WAYS[axis][point.offset[axis] > 0.0] if point.part in _UPRIGHT else "off"
    return f"a point {length_text(math.hypot(*point.offset), 'm', 2)} {way} the {point_words(point)}"


def point_choices() -> list[tuple[BodyPoint, str]]:
    """All named body points with their labels, those used in fights first."""
    joints = {BodyPoint(part, at_end=at_end): name for (part, at_end), name in POINT_NAMES.items()}
    return [(point, name.capitalize()) for point, name in {**FIGHT_POINT_NAMES, **joints}.items()]


def target_name(whom: BehaviourTarget, project: Project) -> str:
    """Name of a target: the partner, a performer or a prop."""
    match whom:
        case FollowPartner():
            return "partner"
        case FollowPerformer():
            performer = project.performers.get(whom.performer_id)
            return performer.name if performer else "?"
    prop = project.props.get(whom.prop_id)
    return prop.name if prop else "?"


def condition_words(condition: Condition, project: Project) -> str:
    """Condition of a transition as text."""
    match condition:
        case DistanceCondition():
            gap = condition.gap
            where = target_name(gap.whom, project)
            if not gap.flat and isinstance(gap.whom, FollowPartner | FollowPerformer):
                where = f"{where}'s {point_name(gap.whom.point)}"
            return f"{where} {'<' if condition.closer else '>'} {condition.distance:.2f} {gap.unit}"
        case TimeCondition():
            return f"after {condition.seconds:.2f} s"
        case EventCondition():
            return f"on {condition.event}"
        case KeyCondition():
            return f"key press {condition.key}"
    return "clip ends"


def manner_words(manner: Reaction, project: Project) -> str:
    """Reaction of a state as text, for the box of the state."""
    whom = target_name(manner.whom, project)
    match manner:
        case KeepDistance():
            return f"keeps {manner.distance:.2f} {manner.gap.unit} from {whom}"
        case LeanAway():
            return f"leans {length_text(manner.metres, 'm', 2)} away from {_point_of(manner.whom)}"
    return f"{point_name(manner.point)} meets {_point_of(manner.whom)}"


def _point_of(whom: BehaviourTarget) -> str:
    return point_name(whom.point) if isinstance(whom, FollowPartner | FollowPerformer) else "prop"


def clip_words(state: State, project: Project) -> str:
    """Name of the clip that a state plays, or the text for a state that holds its pose."""
    if state.clip is None:
        return "holds its pose"
    motion = project.motions.get(state.clip.motion_id)
    return f"{motion.name if motion else '?'} · {'loops' if state.loop else 'once'}"
