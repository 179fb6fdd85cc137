"""Followed targets: a point of the same body, of another performer, a prop, a joint of the capture.

Each is a place and a rotation fixed to the thing. A position, the outside of a distance or the centre of an area takes
the place; an orientation takes the rotation, an area's heading its turn about Z.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from studio.core.constraints.base import BodyPoint, Vector, finite_vector
from studio.core.curves.keyed import Quaternion, unit_quaternion
from studio.core.curves.tangents import SPARSE

UNTURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class FollowBody:
    """``point`` of the same body, where the adapted motion has it; ``turn`` counts in the axes of its segment."""

    kind: ClassVar[str] = "follow_body"
    point: BodyPoint
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class FollowPerformer:
    """``point`` of another performer; for that performer itself it is a point of the same body.

    With ``awaits`` the target is the position at full activation, before and after it too: a parry meets the blow
    instead of chasing it.
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
    """Point fixed to a prop, in its axes: ``offset`` metres from its centre plus ``share`` of its half size.

    ``share`` (0, 1, 0) is the middle of its left side, whatever its size. With ``along_arms`` the followed rotation is
    that of a hand whose fingers are raised and lowered with the arms, as wrists bend only so far, and ``offset`` is in
    the hand's axes.
    """

    kind: ClassVar[str] = "follow_prop"
    prop_id: str
    offset: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = UNTURNED
    share: Vector = (0.0, 0.0, 0.0)
    along_arms: bool = field(default=False, metadata=SPARSE)

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from a prop"))
        object.__setattr__(self, "share", finite_vector(self.share, "The attachment point on a prop"))
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


@dataclass(frozen=True)
class FollowTracked:
    """A joint of the capture itself, as it was recorded; ``offset`` in metres and ``turn`` in the joint's axes."""

    kind: ClassVar[str] = "follow_tracked"
    joint: str
    offset: Vector = (0.0, 0.0, 0.0)
    turn: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        object.__setattr__(self, "offset", finite_vector(self.offset, "An offset from a joint"))
        object.__setattr__(self, "turn", unit_quaternion(self.turn))


Follow = FollowBody | FollowPerformer | FollowProp | FollowTracked
FOLLOWS = (FollowBody, FollowPerformer, FollowProp, FollowTracked)
