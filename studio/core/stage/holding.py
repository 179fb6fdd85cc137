"""Hands that hold a prop between them, whatever the size of prop and body."""

from studio.core.body.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.stage.prop import Prop
from studio.core.stage.scope import Scope

HOLDING, TURNING = Chain(clavicle=0.5, trunk=0.3), Chain(end_segment=1.0)
BACK = -0.7
"""Where wrists are on the sides of a prop, in halves of its size: so far back that the palms lie on them."""
THIN, APART, PALM = 0.1, 0.24, (-0.07, 0.03)
"""Metres of breadth below which two hands have no room beside each other, as on a stick: there the left one holds it
above the right one, so far apart, its wrist behind the prop and beside it for the palm to be on it.
"""
REACHING = 0.5
"""Seconds in which hands come to a prop before they pick it up, and leave it once it is put down."""
FLAT = (-0.5, 0.5, -0.5, 0.5)
"""A hand in a prop's axes: fingers ahead, the palm on the side."""


def grips(
    motion_id: str, performer_id: str, prop_id: str, prop: Prop, seconds: tuple[float, float], priority: int
) -> tuple[Constraint, ...]:
    """Both wrists of a performer at the sides of a prop, palms on them, from one second of the motion to the other.

    They come there before and leave after. How the hands are turned comes after where they are.
    """
    begin, end = seconds
    curve = ActivationCurve(begin - REACHING, begin, end, end + REACHING)
    scope, words = Scope(performer_id=performer_id), prop.name.lower()
    asked: list[Constraint] = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        part = side.lower()
        wrist = PositionConstraint(
            motion_id, f"{side} hand on {words}", BodyPoint(BodyPart(f"{part}_forearm"), at_end=True), HOLDING,
            priority, curve, target=_wrist_on(prop_id, prop, sign), scope=scope,
        )  # fmt: skip
        palm = OrientationConstraint(
            motion_id, f"{side} palm on {words}", BodyPoint(BodyPart(f"{part}_hand")), TURNING, priority + 1, curve,
            target=FollowProp(prop_id, turn=FLAT), scope=scope,
        )  # fmt: skip
        asked += [wrist, palm]
    return tuple(asked)


def _wrist_on(prop_id: str, prop: Prop, sign: float) -> FollowProp:
    """Where the left wrist (1) or the right one (-1) holds a prop."""
    _, breadth, height = prop.size
    if breadth >= THIN:
        return FollowProp(prop_id, share=(BACK, sign, 0.0))
    back, beside = PALM
    return FollowProp(prop_id, offset=(back, sign * beside, sign * min(APART, height) / 2))
