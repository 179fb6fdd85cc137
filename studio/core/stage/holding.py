"""Constraints for hands that hold a prop, for any size of prop and body."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Constraint, Vector
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import QUINTIC_PEAK_SLOPE, ActivationCurve, EaseShape, ease
from studio.core.curves.keyed import Quaternion
from studio.core.mesh.hand_shapes import OPEN_GRIP, grip_round
from studio.core.rotations import from_euler, multiply, to_matrix
from studio.core.stage.prop import Carried, InHand, Prop

FloatArray = NDArray[np.float64]

HOLD_CHAIN, HAND_TURN_CHAIN = Chain(clavicle=0.5, trunk=0.3, root=0.3), Chain(end_segment=1.0)
"""Segments that move a hand onto a prop, and segments that rotate the hand there."""
WRIST_OFFSET = (0.0, 0.0, -0.08)
"""Offset in metres from the middle of the palm to the wrist, in the axes of the hand."""
THIN_PROP_OFFSET = 0.03
"""Distance in metres from the axis of a thin prop to the middle of the palm."""
THIN_PROP_BREADTH, STACKED_HANDS_BREADTH = 0.1, 0.24
"""In metres: breadth below which a prop is held like a stick, the left hand above the right; and the most that the two
hands are then apart.
"""
RECEIVER_HANDS_DROP, PROP_EDGE_MARGIN = 0.1, 0.03
"""Metres by which a receiver's hands are below the giver's, and the least distance of hands from the prop's lower edge.
"""
HAND_REACH_SECONDS, REACH_SPEED = 0.5, 1.3
"""Least time in seconds in which hands reach a prop before they pick it up, and withdraw after they put it down; and
their highest speed then, in metres per second.
"""
GRIP_CHANGE_SECONDS = 0.2
"""Time in seconds in which hands change from one grip to another."""
FLAT_HAND_ROTATION = (-0.5, 0.5, -0.5, 0.5)
"""Quaternion of a hand in the axes of a prop: fingers ahead, the palm on the side."""


def reaching_time(distance: float) -> float:
    """Time in seconds in which hands reach a prop at ``distance`` metres from them."""
    return max(HAND_REACH_SECONDS, QUINTIC_PEAK_SLOPE * distance / REACH_SPEED)


def grip_on(prop: Prop, hold: InHand | Carried) -> float | None:
    """Grip of the hands that hold a prop, from -1 (open) to 1 (fists); None if no hand holds it."""
    if isinstance(hold, InHand):
        return grip_round(min(prop.size)) if hold.point.part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND) else None
    breadth = min(prop.size[:2])
    return grip_round(breadth) if breadth < THIN_PROP_BREADTH else OPEN_GRIP


def grips_on_props(props: Iterable[Prop], performer_id: str, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weights (N,) from 0 to 1 of a performer's hold on props at stage ``times`` (N,), and the grips (N,) of the hands.

    A grip is from -1 (open) to 1 (fists).
    """
    weights, grips = np.zeros(len(times)), np.zeros(len(times))
    for prop in props:
        for hold in prop.holds:
            grip = grip_on(prop, hold) if hold.performer_id == performer_id else None
            if grip is None:
                continue
            since = np.inf if hold.begin is None else times - hold.begin
            left = np.inf if hold.end is None else hold.end - times
            weight = ease(1.0 + np.minimum(since, left) / GRIP_CHANGE_SECONDS, EaseShape.QUINTIC)
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
) -> tuple[Constraint, ...]:
    """Constraints that keep both palms of a performer on the middle of a prop's sides over a range of motion seconds.

    They fade in over ``reaching`` seconds before the range and fade out after it. ``turned`` is the number of quarter
    turns about Z of the prop from the performer's facing direction; ``lower`` places the hands lower, for a prop whose
    middle another performer holds. Fingers point ahead, and are raised and lowered with the arms, because wrists do not
    bend far enough to point ahead overhead or on the floor. The rotation of the hands has a lower priority than their
    position.
    """
    begin, end = seconds
    curve = ActivationCurve(begin - reaching, begin, end, end + HAND_REACH_SECONDS)
    scope, words = Scope(performer_id=performer_id), prop.name.lower()
    facing = from_euler("Z", np.array([-turned * math.pi / 2]))
    across = to_matrix(facing)[:, 1]
    is_thin = float(np.abs(across) @ prop.size) < THIN_PROP_BREADTH
    turn: Quaternion = tuple(multiply(facing, np.array(FLAT_HAND_ROTATION)).tolist())
    asked: list[Constraint] = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        hand = BodyPoint(BodyPart(f"{side.lower()}_hand"))
        place = np.zeros(3) if is_thin else sign * across * prop.size / 2
        if is_thin:
            place += sign * (THIN_PROP_OFFSET * across + [0.0, 0.0, min(STACKED_HANDS_BREADTH, prop.size[2]) / 2])
        if lower:
            place[2] -= min(RECEIVER_HANDS_DROP, max(prop.size[2] / 2 - PROP_EDGE_MARGIN, 0.0))
        palm = FollowProp(prop_id, turn=turn, share=_vector(2.0 * place / prop.size), along_arms=True)
        on_side = PositionConstraint(
            motion_id, f"{side} hand on {words}", hand, HOLD_CHAIN, priority, curve,
            target=replace(palm, offset=WRIST_OFFSET), scope=scope,
        )  # fmt: skip
        flat = OrientationConstraint(
            motion_id, f"{side} palm on {words}", hand, HAND_TURN_CHAIN, priority + 1, curve, target=palm, scope=scope
        )
        asked += [on_side, flat]
    return tuple(asked)


def _vector(values: FloatArray) -> Vector:
    x, y, z = values.round(12).tolist()
    return x + 0.0, y + 0.0, z + 0.0
