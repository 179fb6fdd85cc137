"""Manners: reactions of a performer to another during a state, and the resulting constraints.

``KeepDistance`` moves the performer over the ground; the others are constraints, made by ``manner_constraints``.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.plausible import PLACE_RANGE
from studio.core.stage.whom import BehaviourTarget, DistanceMeasure, FollowPartner, followed_by

HEAD_POINT = BodyPoint(BodyPart.HEAD, (0.0, 0.0, 0.05))
FIST_POINT = BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.0, 0.09))
ARM_POINT = BodyPoint(BodyPart.LEFT_FOREARM, (0.0, 0.0, 0.12))
WHOLE_CLIP = ActivationCurve(-1.0, -1.0, 1e5, 1e5)
"""All the time that a clip plays, in seconds of its motion."""


@dataclass(frozen=True)
class KeepDistance:
    """Face ``whom``, and step to keep the horizontal distance to it at ``distance``, within the tolerance ``room``.

    Both in metres, or in ``legs``, as a ``DistanceMeasure``.
    """

    kind: ClassVar[str] = "keep_distance"
    whom: BehaviourTarget = FollowPartner()
    distance: float = 1.2
    room: float = 0.1
    legs: bool = False

    def __post_init__(self) -> None:
        if not (math.isfinite(self.distance) and self.distance > 0.0):
            raise ValueError(f"The distance must be greater than zero, not {self.distance}.")
        if not (math.isfinite(self.room) and self.room >= 0.0):
            raise ValueError(f"The tolerance must be 0 or more, not {self.room}.")
        PLACE_RANGE.check((self.distance, self.room))

    @property
    def gap(self) -> DistanceMeasure:
        """Measure of the distance to keep."""
        return DistanceMeasure(self.whom, legs=self.legs)


@dataclass(frozen=True)
class LeanAway:
    """Keep ``point`` at least ``metres`` away from a point of ``whom`` by the trunk: the head from a fist."""

    kind: ClassVar[str] = "lean_away"
    whom: BehaviourTarget = FollowPartner(FIST_POINT)
    point: BodyPoint = HEAD_POINT
    metres: float = 0.3

    def __post_init__(self) -> None:
        if not (math.isfinite(self.metres) and self.metres > 0.0):
            raise ValueError(f"The minimum distance must be greater than 0 metres, not {self.metres}.")
        PLACE_RANGE.check(self.metres)


@dataclass(frozen=True)
class Meet:
    """Move ``point`` to a point of ``whom`` with ``activation`` over seconds of the clip's motion.

    The forearm of a parry meets the fist, a striking fist meets the head.
    """

    kind: ClassVar[str] = "meet"
    whom: BehaviourTarget = FollowPartner(FIST_POINT)
    point: BodyPoint = ARM_POINT
    activation: ActivationCurve = WHOLE_CLIP
    chain: Chain = Chain()


Manner = KeepDistance | LeanAway | Meet
LEANING_CHAIN = Chain(clavicle=0.0, trunk=1.0)


def manner_constraints(
    manners: tuple[Manner, ...], motion_id: str, partner_id: str, name: str
) -> tuple[Constraint, ...]:
    """Constraints on the state's motion that the manners of a state ``name`` make, for a performer with that partner.

    ``Meet`` has a higher priority than ``LeanAway``. Manners that need a partner make none without one (an empty id).
    """
    asked: list[Constraint] = []
    for place, manner in enumerate(manners):
        followed = followed_by(manner.whom, partner_id)
        title = f"{name} {place + 1}"
        if followed is not None and isinstance(manner, Meet):
            meeting = PositionConstraint(
                motion_id, title, manner.point, manner.chain, 0, manner.activation, target=followed
            )
            asked.append(meeting)
        elif followed is not None and isinstance(manner, LeanAway):
            size = (2.0 * manner.metres,) * 3
            leaning = AreaConstraint(
                motion_id, title, manner.point, LEANING_CHAIN, 1, WHOLE_CLIP,
                shape=AreaShape.SPHERE, centre=followed, size=size,
            )  # fmt: skip
            asked.append(leaning)
    return tuple(asked)
