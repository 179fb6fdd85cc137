"""How constraints on a limb yield to its contacts, which stand above all, and take it over as these let go.

A place is led there from where the limb stands, so that it is met on its way: blended, as what comes and goes is, it
would be missed by as much as lower constraints move the body. All else comes and goes with the contact.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.rotations import normalized
from studio.core.solver.asking.points import limb_of, point_indices
from studio.core.solver.standing.stand import Standing

FloatArray = NDArray[np.float64]


def limb_shares(constraints: Sequence[Constraint], standing: Standing, window: slice = slice(None)) -> FloatArray:
    """(C, F) how free of its contacts the limb is that each constraint is about, 1 where that is none."""
    freedoms = standing.limb_freedoms[:, window]
    shares = np.ones((len(constraints), freedoms.shape[1]))
    for row, constraint in zip(shares, constraints, strict=True):
        limb = limb_of(constraint.point.part)
        if limb >= 0:
            row[:] = freedoms[limb]
    return shares


def constraint_activations(constraints: Sequence[Constraint], standing: Standing) -> FloatArray:
    """(C, F) in [0, 1], 0 where a contact stands above."""
    motion, activations = standing.motion, limb_shares(constraints, standing)
    for row, constraint in zip(activations, constraints, strict=True):
        if is_led(constraint):
            row[:] = row > 0.0
        if not constraint.activation.is_whole(0.0, motion.duration):
            row *= constraint.activation.at(motion.times)
    return activations


def is_led(constraint: Constraint) -> bool:
    """Whether it is a place, which is led to its target."""
    return isinstance(constraint, PositionConstraint) and not isinstance(constraint.target, FollowBody)


def led_place(
    constraint: Constraint, target: FloatArray, share: FloatArray, standing: Standing, window: slice
) -> FloatArray:
    """(F or 1, 3) metres: ``target`` (F or 1, 3), but where the limb is free by a ``share`` (F,) on the way there.

    The way goes round the root of the limb, evenly in angle and in length: straight, it would fold the limb.
    """
    limb, layout = limb_of(constraint.point.part), standing.morphology.layout
    if limb < 0 or (share == 1.0).all():
        return target
    origin, segment = point_indices(constraint.point, layout)
    positions, rotations = standing.positions[window], standing.rotations[window]
    root = positions[:, layout.collar(limb) + 1 if limb < 2 else layout.hip(limb - 2)]
    stands = positions[:, origin] + rotations[:, segment] @ np.array(constraint.point.offset) - root
    way = target - root
    begins, ends = (np.linalg.norm(each, axis=1, keepdims=True) for each in (stands, way))
    led = root + (begins + share[:, None] * (ends - begins)) * _arc(normalized(stands), normalized(way), share[:, None])
    return np.where(share[:, None] < 1.0, led, target)


def _arc(first: FloatArray, last: FloatArray, share: FloatArray) -> FloatArray:
    """(F, 3) unit vectors that are a ``share`` (F, 1) of the way from some to others on great circles."""
    sine = np.linalg.norm(np.cross(first, last), axis=1, keepdims=True)
    angle, turns = np.arctan2(sine, (first * last).sum(axis=1, keepdims=True)), sine > 1e-9
    divisor = np.where(turns, sine, 1.0)
    begins = np.where(turns, np.sin((1.0 - share) * angle) / divisor, 1.0 - share)
    ends = np.where(turns, np.sin(share * angle) / divisor, share)
    return np.asarray(begins * first + ends * last)
