"""Reactions of a performer to its partner, another performer or a prop during a state of its behaviour.

``KeepDistance`` moves the performer over the ground; ``reaction_constraints`` makes constraints of the others.
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
from studio.core.stage.behaviour_target import BehaviourTarget, DistanceMeasure, FollowPartner, resolved_target

HEAD_POINT = BodyPoint(BodyPart.HEAD, (0.0, 0.0, 0.05))
"""Point of the head that keeps away from a fist."""
FIST_POINT = BodyPoint(BodyPart.RIGHT_HAND, (0.0, 0.0, 0.09))
"""Middle of the right fist."""
ARM_POINT = BodyPoint(BodyPart.LEFT_FOREARM, (0.0, 0.0, 0.12))
"""Point on the left forearm that parries a strike."""
ACTIVE_WHOLE_CLIP = ActivationCurve(-1.0, -1.0, 1e5, 1e5)
"""Activation that is full at all times of a clip."""


@dataclass(frozen=True)
class KeepDistance:
    """Reaction: face the target ``whom``, and step to keep the horizontal distance to it at ``distance`` within
    ``room``.

    Both lengths are in metres or, if ``legs``, in leg lengths (the mean of both bodies).
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
        """Measure of the distance that is kept."""
        return DistanceMeasure(self.whom, legs=self.legs)


@dataclass(frozen=True)
class LeanAway:
    """Reaction: bend the trunk to keep ``point`` at least ``metres`` away from a point of ``whom``, as a head from a
    fist.
    """

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
    """Reaction: move ``point`` to a point of the target ``whom``, with ``activation`` over the clip's motion seconds.

    By default the forearm parries the partner's fist.
    """

    kind: ClassVar[str] = "meet"
    whom: BehaviourTarget = FollowPartner(FIST_POINT)
    point: BodyPoint = ARM_POINT
    activation: ActivationCurve = ACTIVE_WHOLE_CLIP
    chain: Chain = Chain()


Reaction = KeepDistance | LeanAway | Meet
LEAN_AWAY_CHAIN = Chain(clavicle=0.0, trunk=1.0)


def reaction_constraints(
    manners: tuple[Reaction, ...], motion_id: str, partner_id: str, name: str
) -> tuple[Constraint, ...]:
    """Constraints, on the motion of a state, for its reactions to targets other than the distance kept.

    ``name`` is the state's and titles the constraints. ``Meet`` has a higher priority than ``LeanAway``. A reaction to
    the partner makes no constraint if ``partner_id`` is empty.
    """
    asked: list[Constraint] = []
    for index, manner in enumerate(manners):
        followed = resolved_target(manner.whom, partner_id)
        title = f"{name} {index + 1}"
        if followed is not None and isinstance(manner, Meet):
            meeting = PositionConstraint(
                motion_id, title, manner.point, manner.chain, 0, manner.activation, target=followed
            )
            asked.append(meeting)
        elif followed is not None and isinstance(manner, LeanAway):
            size = (2.0 * manner.metres,) * 3
            leaning = AreaConstraint(
                motion_id, title, manner.point, LEAN_AWAY_CHAIN, 1, ACTIVE_WHOLE_CLIP,
                shape=AreaShape.SPHERE, centre=followed, size=size,
            )  # fmt: skip
            asked.append(leaning)
    return tuple(asked)
