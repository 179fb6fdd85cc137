"""Constraints on a limb yield to its ground contacts, and take over as the contacts are released.

A position target starts at the contact's position and moves to its own, so the point is on a target at every frame.
Blending the solutions instead would make the residual depend on constraints of lower priority. All other kinds fade in
and out with the contact.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.rotations import normalized
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.task_assembly.points import limb_of, point_indices

FloatArray = NDArray[np.float64]


def contact_release(
    constraints: Sequence[Constraint], standing: GroundedMotion, window: slice = slice(None)
) -> FloatArray:
    """Release fraction (C, F) of the limb of each constraint from its contacts, 0 in contact; 1 without limb."""
    freedoms = standing.limb_freedoms[:, window]
    fractions = np.ones((len(constraints), freedoms.shape[1]))
    for row, constraint in zip(fractions, constraints, strict=True):
        limb = limb_of(constraint.point.part)
        if limb >= 0:
            row[:] = freedoms[limb]
    return fractions


def constraint_activations(constraints: Sequence[Constraint], standing: GroundedMotion) -> FloatArray:
    """Activations (C, F) in [0, 1] of the constraints, 0 while their limb is in contact."""
    motion, activations = standing.motion, contact_release(constraints, standing)
    for row, constraint in zip(activations, constraints, strict=True):
        if is_ramped(constraint):
            row[:] = row > 0.0
        if not constraint.activation.is_whole(0.0, motion.duration):
            row *= constraint.activation.at(motion.times)
    return activations


def is_ramped(constraint: Constraint) -> bool:
    """True for a constraint whose target moves away from a contact as that is released: a position constraint."""
    return isinstance(constraint, PositionConstraint) and not isinstance(constraint.target, FollowBody)


def ramped_target(
    constraint: Constraint, target: FloatArray, fraction: FloatArray, standing: GroundedMotion, window: slice
) -> FloatArray:
    """Target positions (F or 1, 3) in metres, moved from the contact to ``target`` by the release ``fraction`` (F,).

    The path goes round the root of the limb, linear in angle and in length: a straight path would fold the limb. It
    stays as high above the ground as the contact, or sinks evenly to a lower target.
    """
    limb, layout = limb_of(constraint.point.part), standing.morphology.layout
    if limb < 0 or (fraction == 1.0).all():
        return target
    origin, segment = point_indices(constraint.point, layout)
    positions, rotations = standing.positions[window], standing.rotations[window]
    root = positions[:, layout.collar_point(limb) + 1 if limb < 2 else layout.hip_point(limb - 2)]
    stands = positions[:, origin] + rotations[:, segment] @ np.array(constraint.point.offset) - root
    displacement = target - root
    begins, ends = (np.linalg.norm(each, axis=1, keepdims=True) for each in (stands, displacement))
    led = root + (begins + fraction[:, None] * (ends - begins)) * _arc(
        normalized(stands), normalized(displacement), fraction[:, None]
    )
    first, last = (each[:, 2] - standing.ground.height_at(each) for each in (root + stands, root + displacement))
    least = standing.ground.height_at(led) + first + fraction * np.minimum(last - first, 0.0)
    led[:, 2] = np.maximum(led[:, 2], least)
    return np.where(fraction[:, None] < 1.0, led, target)


def _arc(first: FloatArray, last: FloatArray, fraction: FloatArray) -> FloatArray:
    """Unit vectors (F, 3) at ``fraction`` (F, 1) of the great circles from ``first`` to ``last``."""
    sine = np.linalg.norm(np.cross(first, last), axis=1, keepdims=True)
    angle, rotation_matrices = np.arctan2(sine, (first * last).sum(axis=1, keepdims=True)), sine > 1e-9
    divisor = np.where(rotation_matrices, sine, 1.0)
    begins = np.where(rotation_matrices, np.sin((1.0 - fraction) * angle) / divisor, 1.0 - fraction)
    ends = np.where(rotation_matrices, np.sin(fraction * angle) / divisor, fraction)
    return np.asarray(begins * first + ends * last)
