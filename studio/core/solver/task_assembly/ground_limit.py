"""Position targets below the ground: they are raised to it, because the ground comes before every constraint.

A point may be as low as in the unconstrained motion, or as low as its foot allows.
"""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.body.morphology import AnyMorphology, at_frames, sole_rows
from studio.core.constraints.base import Constraint
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.task_assembly.points import limb_of, point_indices

FloatArray = NDArray[np.float64]


def target_above_ground(
    constraint: Constraint, target: FloatArray, standing: GroundedMotion, window: slice
) -> FloatArray:
    """Target positions (F or 1, 3) in metres, raised to the least height of their point; ``target`` itself if none is
    too low.
    """
    ground, body = standing.ground, standing.morphology
    origin, segment = point_indices(constraint.point, body.layout)
    floor, lowest = ground.height_at(target), least_height(constraint, body, window)
    if (target[:, 2] >= floor + lowest).all():
        return target
    before = standing.positions[window, origin] + standing.rotations[window, segment] @ np.array(
        constraint.point.offset
    )
    least = floor + np.minimum(before[:, 2] - ground.height_at(before), lowest)
    return np.column_stack([np.broadcast_to(target[:, :2], (len(least), 2)), np.maximum(target[:, 2], least)])


def least_height(constraint: Constraint, body: AnyMorphology, window: slice) -> FloatArray:
    """Least height (F or 1,) in metres of a constrained point above the ground; an ankle or ball is above a level
    sole.
    """
    limb, layout = limb_of(constraint.point.part), body.layout
    origin = point_indices(constraint.point, layout)[0]
    if limb < 2 or any(constraint.point.offset):
        return np.zeros(1)
    return np.maximum(_height_over_sole(origin, limb - 2, layout, at_frames(sole_rows(body, limb - 2), window)), 0.0)


def _height_over_sole(point: int, side: int, layout: BodyLayout, measures: FloatArray) -> FloatArray:
    """Height (F or 1,) in metres of the ankle or the ball above a level sole, 0 for other points."""
    ankle = layout.ankle_point(side)
    if point == ankle:
        return np.asarray(measures[:, 3])
    return np.asarray(measures[:, 2] + measures[:, 3]) if point == ankle + 1 else np.zeros(1)


def ground_planes(standing: GroundedMotion, window: slice) -> FloatArray:
    """Planes z = a + b x + c y (4, F or 1, 3) of the ground under the unconstrained end of each limb, metres."""
    ground, layout = standing.ground, standing.morphology.layout
    if ground.is_level:
        return np.broadcast_to(np.array([ground.height, 0.0, 0.0]), (4, 1, 3)).copy()
    ends = [layout.wrist_point(0), layout.wrist_point(1), layout.ankle_point(0), layout.ankle_point(1)]
    places = np.swapaxes(standing.positions[window][:, ends, :2], 0, 1)
    slopes = ground.slope_at(places)
    levels = ground.height_at(places) - (slopes * places).sum(axis=-1)
    return np.ascontiguousarray(np.concatenate([levels[..., None], slopes], axis=-1))
