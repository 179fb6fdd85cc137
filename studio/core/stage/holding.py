"""Hands that hold a prop between them, for any size of prop and body."""

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
from studio.core.curves.activation import EASE_PEAK, ActivationCurve, EaseShape, ease
from studio.core.curves.keyed import Quaternion
from studio.core.mesh.hand_shapes import OPEN_GRIP, grip_round
from studio.core.rotations import from_euler, multiply, to_matrix
from studio.core.stage.prop import Carried, InHand, Prop

FloatArray = NDArray[np.float64]

HOLDING, TURNING = Chain(clavicle=0.5, trunk=0.3, root=0.3), Chain(end_segment=1.0)
WRIST_OFFSET = (0.0, 0.0, -0.08)
"""Metres from the middle of a palm back to the wrist, in a hand's axes."""
THIN_PROP_OFFSET = 0.03
"""Metres from the middle of a thin prop aside to a palm."""
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
) -> tuple[Constraint, ...]:
    """Constraints that keep both palms of a performer on the middle of a prop's sides over a range of seconds of the
    motion. They fade in over ``reaching`` seconds before, and out after. The prop is ``turned`` by quarters about Z
    from the performer's facing direction; ``lower`` is for hands that find the middle taken. Fingers point ahead, and
    are raised and lowered with the arms, because wrists do not bend far enough to point ahead overhead or on the floor.
    The rotation of hands has a lower priority than their position.
    """
    begin, end = seconds
    curve = ActivationCurve(begin - reaching, begin, end, end + HAND_REACH_SECONDS)
    scope, words = Scope(performer_id=performer_id), prop.name.lower()
    facing = from_euler("Z", np.array([-turned * math.pi / 2]))
    across = to_matrix(facing)[:, 1]
    is_thin = float(np.abs(across) @ prop.size) < THIN
    turn: Quaternion = tuple(multiply(facing, np.array(FLAT_HAND)).tolist())
    asked: list[Constraint] = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        hand = BodyPoint(BodyPart(f"{side.lower()}_hand"))
        place = np.zeros(3) if is_thin else sign * across * prop.size / 2
        if is_thin:
            place += sign * (THIN_PROP_OFFSET * across + [0.0, 0.0, min(LEAST_HAND_ROOM, prop.size[2]) / 2])
        if lower:
            place[2] -= min(LOWER, max(prop.size[2] / 2 - PROP_EDGE_MARGIN, 0.0))
        palm = FollowProp(prop_id, turn=turn, share=_vector(2.0 * place / prop.size), along_arms=True)
        on_side = PositionConstraint(
            motion_id, f"{side} hand on {words}", hand, HOLDING, priority, curve,
            target=replace(palm, offset=WRIST_OFFSET), scope=scope,
        )  # fmt: skip
        flat = OrientationConstraint(
            motion_id, f"{side} palm on {words}", hand, TURNING, priority + 1, curve, target=palm, scope=scope
        )
        asked += [on_side, flat]
    return tuple(asked)


def _vector(values: FloatArray) -> Vector:
    x, y, z = values.round(12).tolist()
    return x + 0.0, y + 0.0, z + 0.0
