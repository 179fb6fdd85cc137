"""Hands that hold a prop between them, for any size of prop and body."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Constraint, Vector
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import EASE_PEAK, ActivationCurve, EaseShape, ease
from studio.core.curves.keyed import Quaternion
from studio.core.mesh.hand_shapes import OPEN_GRIP, grip_round
from studio.core.rotations import from_euler, multiply, to_matrix
from studio.core.stage.prop import Carried, InHand, Prop

FloatArray = NDArray[np.float64]

HOLDING, TURNING = Chain(clavicle=0.5, trunk=0.3, root=0.3), Chain(end_segment=1.0)
PALM_OFFSET, THIN_PROP_OFFSET = -0.08, 0.03
"""Metres from a side of a prop back to the wrist whose palm is on its middle, and from a thin one aside to a wrist."""
THIN, LEAST_HAND_ROOM = 0.1, 0.24
"""Metres of breadth below which two hands have no room beside each other, as on a stick: there the left one holds it
above the right one, so far apart.
"""
LOWER, PROP_EDGE_MARGIN = 0.1, 0.03
"""Metres by which a receiver's hands are below the giver's, and that they keep from the prop's lower edge."""
HAND_REACH_SECONDS, REACH_SPEED = 0.5, 1.3
"""Seconds, at least, in which hands come to a prop before they pick it up, and leave it once it is put down; and their
highest speed then, metres a second.
"""
CLOSING = 0.2
"""Seconds in which hands change from one grip to another."""
FLAT_HAND = (-0.5, 0.5, -0.5, 0.5)
"""A hand in a prop's axes: fingers ahead, the palm on the side."""


def reaching_time(distance: float) -> float:
    """Seconds in which hands reach a prop that is ``distance`` metres from them."""
    return max(HAND_REACH_SECONDS, EASE_PEAK * distance / REACH_SPEED)


def grip_on(prop: Prop, hold: InHand | Carried) -> float | None:
    """Grip of the hands that hold a prop, from -1 (open) to 1 (fists); None if no hand holds it."""
    if isinstance(hold, InHand):
        return grip_round(min(prop.size)) if hold.point.part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND) else None
    breadth = min(prop.size[:2])
    return grip_round(breadth) if breadth < THIN else OPEN_GRIP


def grips_on_props(props: Iterable[Prop], performer_id: str, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weights (N,) from 0 to 1 of a performer's hold of a prop at ``times`` (N,) of the stage, and the grips (N,) for
    it.
    """
    weights, grips = np.zeros(len(times)), np.zeros(len(times))
    for prop in props:
        for hold in prop.holds:
            grip = grip_on(prop, hold) if hold.performer_id == performer_id else None
            if grip is None:
                continue
            since = np.inf if hold.begin is None else times - hold.begin
            left = np.inf if hold.end is None else hold.end - times
            weight = ease(1.0 + np.minimum(since, left) / CLOSING, EaseShape.QUINTIC)
            grips = np.where(weight > weights, grip, grips)
            weights = np.maximum(weights, weight)
    return weights, grips


def grip_constraints(
    motion_id: str,
    performer_id: str,
    prop_id: str,
    prop: Prop,
    seconds: tuple[float, float],
    priority: int,
    *,
    turned: int = 0,
    lower: bool = False,
    reaching: float = HAND_REACH_SECONDS,
    elevation: float = 0.0,
) -> tuple[Constraint, ...]:
    """Constraints that keep both wrists of a performer at the sides of a prop, palms on their middle, over a range of
    seconds of the motion. They fade in over ``reaching`` seconds before, and out after. The prop is ``turned`` by
    quarters about Z from the performer's facing direction; ``lower`` is for hands that find the middle taken.
    Fingers point ahead, raised by ``elevation`` radians like the arms for a prop overhead, because wrists do not
    bend far enough to point ahead. The rotation of hands has a lower priority than their position.
    """
    begin, end = seconds
    curve = ActivationCurve(begin - reaching, begin, end, end + HAND_REACH_SECONDS)
    scope, words = Scope(performer_id=performer_id), prop.name.lower()
    facing = from_euler("Z", np.array([-turned * math.pi / 2]))
    fingers = multiply(facing, from_euler("Y", np.array([-elevation])))
    palm: Quaternion = tuple(multiply(fingers, np.array(FLAT_HAND)).tolist())
    asked: list[Constraint] = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        part = side.lower()
        on_side = PositionConstraint(
            motion_id, f"{side} hand on {words}", BodyPoint(BodyPart(f"{part}_forearm"), at_end=True), HOLDING,
            priority, curve, target=_wrist_on(prop_id, prop, sign, fingers, lower), scope=scope,
        )  # fmt: skip
        flat = OrientationConstraint(
            motion_id, f"{side} palm on {words}", BodyPoint(BodyPart(f"{part}_hand")), TURNING, priority + 1, curve,
            target=FollowProp(prop_id, turn=palm), scope=scope,
        )  # fmt: skip
        asked += [on_side, flat]
    return tuple(asked)


def _wrist_on(prop_id: str, prop: Prop, sign: float, fingers: FloatArray, lower: bool) -> FollowProp:
    """Position of the left wrist (1) or the right one (-1) on a prop, for hands whose fingers point along x and whose
    palms face y after the rotation ``fingers`` (4,) in its axes.
    """
    axes = to_matrix(fingers)
    breadth, height = float(np.abs(axes[:, 1]) @ prop.size), prop.size[2]
    share, offset = np.zeros(3), PALM_OFFSET * axes[:, 0]
    if breadth >= THIN:
        share = sign * axes[:, 1]
    else:
        offset = offset + sign * (
            THIN_PROP_OFFSET * axes[:, 1] + np.array([0.0, 0.0, min(LEAST_HAND_ROOM, height) / 2])
        )
    if lower:
        offset[2] -= min(LOWER, max(height / 2 - PROP_EDGE_MARGIN, 0.0))
    return FollowProp(prop_id, offset=_vector(offset), share=_vector(share))


def _vector(values: FloatArray) -> Vector:
    x, y, z = values.round(12).tolist()
    return x + 0.0, y + 0.0, z + 0.0
