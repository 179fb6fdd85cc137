"""Constraints on held props in mirrored clips: a prop that a body holds is reflected together with its hands."""

from dataclasses import replace
from typing import Any

import numpy as np

from studio.core.changed_records import with_fields
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.carried_over import MIRROR_TRANSFORM, is_hinged, mirrored_constraint, reflected_tilt
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.rail import RailConstraint
from studio.core.curves.keyed import KeyedNumber
from studio.core.rotations import multiply
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project

HALF_TURN_ABOUT_Z = np.array([0.0, 0.0, 1.0, 0.0])


def constraint_as_played(project: Project, performer_id: str, clip: Clip, constraint: Constraint) -> Constraint:
    """Constraint as a clip plays it: on the other side if the clip is mirrored. The function is its own inverse."""
    if not clip.mirrored:
        return constraint
    return mirrored_constraint(with_held_props_reflected(project, performer_id, clip, constraint))


def with_held_props_reflected(
    project: Project, performer_id: str, clip: Clip, constraint: Constraint, repeat: int = 0
) -> Constraint:
    """Constraint with its positions on held props reflected, for one repeat of a mirrored clip. Its own inverse.

    The mirror image of a motion changes only quantities of the body itself, so props that the performer holds are
    treated here. If a prop has several holds, the one at the constraint's full activation counts.
    """
    changes: dict[str, Any] = {}
    for name, follow in vars(constraint).items() if clip.mirrored else ():
        if isinstance(follow, FollowProp):
            rate = project.frame_rate_of(clip)
            first = float(clip.stage_seconds(constraint.activation.full, rate))
            time = first + repeat * clip.length(rate) / clip.repeats
            signs = project.props[follow.prop_id].reflection_by(performer_id, time)
            changes |= _reflected(name, follow, constraint, signs) if signs is not None else {}
    return with_fields(constraint, **changes)


def _reflected(name: str, follow: FollowProp, constraint: Constraint, signs: Vector) -> dict[str, Any]:
    """Changed fields of a constraint on a prop whose axes are mirrored with ``signs``, by field name.

    With S the signs, the prop's rotation P becomes M P S in the mirror M. A rotation Q in the prop's axes becomes S Q
    D, where D is the mirror of the segment's axes (``mirrored_motion``), as for offsets in a hand's axes; for an area
    or a rail, which has no segment, S Q S.
    """
    turn = np.array(follow.turn) * [*-np.array(signs), 1.0]
    turned = name != "centre" and (signs[0] < 0.0) is not is_hinged(constraint.point.part)
    if turned:
        turn = multiply(turn, HALF_TURN_ABOUT_Z)
    hand = (-1.0, -1.0, 1.0) if follow.along_arms and turned else (1.0, 1.0, 1.0)
    point = replace(
        follow, offset=_times(hand, _times(signs, follow.offset)), share=_times(signs, follow.share),
        turn=tuple(turn.tolist()),
    )  # fmt: skip
    changes: dict[str, Any] = {name: point}
    match constraint:
        case RailConstraint():
            changes["direction"] = _times(signs, constraint.direction)
        case AreaConstraint():
            changes["heading"] = _opposite(constraint.heading)
            changes["tilt"] = reflected_tilt(constraint.tilt, signs)
            if constraint.shape is AreaShape.HALF_SPACE:
                changes["size"] = _times(signs, _times((1.0, -1.0, 1.0), constraint.size))
    return changes


def _opposite(heading: float | KeyedNumber) -> float | KeyedNumber:
    """Heading with the opposite sign."""
    if not isinstance(heading, KeyedNumber):
        return -heading
    return replace(MIRROR_TRANSFORM.retimed_keys(heading, np.negative), values=tuple(-each for each in heading.values))


def _times(signs: Vector, vector: Vector) -> Vector:
    """Elementwise product of two vectors."""
    x, y, z = (np.array(signs) * vector + 0.0).tolist()
    return x, y, z
