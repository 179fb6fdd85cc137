"""Followed targets: a point of the same body, of another performer, of a prop, or a joint of the capture.

Each has a position and a rotation fixed to the object. A position, the outside of a distance and the centre of a volume
use the position; an orientation uses the rotation, and the heading of a volume its rotation about Z.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from studio.core.constraints.base import BodyPoint, Vector, finite_vector
from studio.core.curves.keyed import Quaternion, unit_quaternion
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT

UNTURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class FollowBody:
    """Target: ``point`` of the same adapted body; ``turn`` is a rotation in the axes of its segment."""

    kind: ClassVar[str] = "follow_body"
    point: BodyPoint
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class FollowPerformer:
    """Target: ``point`` of another performer, or of the same body if that is the performer itself.

    With ``awaits`` the target is the position at full activation, at all times: a parry meets the blow instead of
    chasing it.
    """

    kind: ClassVar[str] = "follow_performer"
    performer_id: str
    point: BodyPoint
    turn: Quaternion = UNTURNED
    awaits: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class FollowProp:
    """Target: point fixed to a prop, at ``offset`` metres plus ``share`` times its half size from its centre, in its
    axes.

    ``share`` (0, 1, 0) is the middle of its left side, whatever its size. With ``along_arms`` the followed rotation is
    that of a hand whose fingers are raised and lowered with the arms, because wrists bend only so far, and ``offset``
    is in the hand's axes.
    """

    kind: ClassVar[str] = "follow_prop"
    prop_id: str
    offset: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = UNTURNED
    share: Vector = (0.0, 0.0, 0.0)
    along_arms: bool = field(default=False, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from a prop"))
        object.__setattr__(self, "share", finite_vector(self.share, "The attachment point on a prop"))
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class FollowTracked:
    """Target: a joint of the capture itself, as it was recorded; ``offset`` in metres and ``turn`` are in the joint's
    axes.
    """

    kind: ClassVar[str] = "follow_tracked"
    joint: str
    offset: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from a joint"))
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


Follow = FollowBody | FollowPerformer | FollowProp | FollowTracked
FOLLOWS = (FollowBody, FollowPerformer, FollowProp, FollowTracked)
