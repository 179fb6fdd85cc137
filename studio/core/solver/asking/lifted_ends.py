"""Feet and hands that constraints take into the ground rotate out of it about ankle and wrist (METHOD 7).

Ankle and wrist stay, so that targets there are still met. Frames are independent of each other.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import at_frames, sole_rows
from studio.core.compact_array import PoseArray
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.target import follows_of
from studio.core.grounds.ground import Ground
from studio.core.solver.asking.points import limb_of
from studio.core.solver.standing.blends import smooth_penetrations
from studio.core.solver.standing.held_foot import FootPath
from studio.core.solver.standing.stand import GroundedMotion
from studio.core.solver.standing.tipping import heights_of, tipped, tipped_about_ankle

FloatArray = NDArray[np.float64]

END_MARGIN = 0.05
"""Greatest height above the ground, in metres, below which a foot or hand begins to rise; 3/16 of it is kept."""
END_TOLERANCE = 1e-4
"""Depth in metres that is left to a foot or hand which touches the ground before the constraints."""
NEGLIGIBLE_END_RISE = 1e-6
"""Metres up to which a rise is left out: a limb that stays has them by rounding."""
END_ROTATIONS = 2
"""Iterations of the rotation of an end segment: its points rise less as it comes level."""
END_PARTS = tuple(BodyPart(f"{side}_{part}") for side in ("left", "right") for part in ("hand", "foot", "toe"))


def constrained_ends(constraints: Sequence[Constraint], activations: FloatArray) -> FloatArray:
    """Activations (4, F) of constraints, (C, F), on the end segment of each limb itself."""
    asked = np.zeros((4, activations.shape[1]))
    for constraint, activation in zip(constraints, activations, strict=True):
        for part in {constraint.point.part, *_followed_parts(constraint)}.intersection(END_PARTS):
            limb = limb_of(part)
            asked[limb] = np.maximum(asked[limb], activation)
    return asked


def _followed_parts(constraint: Constraint) -> Iterable[BodyPart]:
    return (follow.point.part for follow in follows_of(constraint) if isinstance(follow, FollowBody))


def lift_ends(
    standing: GroundedMotion, window: slice, free: FloatArray, positions: FloatArray, rotations: FloatArray
) -> None:
    """Rotate hands and feet of solved frames of a ``window``, (F, P, 3) and (F, S, 3, 3), in place.

    Each rises, by its weight ``free`` (4, F), where it is lower above the ground than before the constraints, and at
    most until it is level.
    """
    body, ground, layout = standing.morphology, standing.ground, standing.morphology.layout
    before, solved = (standing.positions[window], standing.rotations[window]), (positions, rotations)
    for side in range(2):
        hand, foot = (
            LimbEnd(layout.wrist_point(side), layout.hand_segment(side), 1),
            LimbEnd(layout.ankle_point(side), layout.foot_segment(side), 2),
        )
        heights = hand.tip_heights(ground, positions)
        if is_below_goal(heights):
            rises = _rises(heights, hand.tip_heights(ground, before[0]), free[side])
            if rises.any():
                fingers = positions[:, hand.joint + 1] - positions[:, hand.joint]
                hand.rotate(tipped(fingers, np.minimum(rises, np.maximum(-fingers[:, 2], 0.0))), *solved)
        measures = at_frames(sole_rows(body, side), window)
        heights = heights_of(foot.path(*solved), measures, ground)
        if not is_below_goal(heights):
            continue
        rises = _rises(heights, heights_of(foot.path(*before), measures, ground), free[2 + side])
        goals = heights + rises
        for rotated in range(END_ROTATIONS):
            if rotated:
                heights = heights_of(foot.path(*solved), measures, ground)
                rises = without_negligible_rises(goals - heights)
            if not rises.any():
                break
            foot.rotate(tipped_about_ankle(foot.path(*solved), measures, heights, rises), *solved)


def is_below_goal(heights: FloatArray) -> bool:
    """True if any of the ``heights`` (..., F) is below its goal, for any heights before the constraints."""
    return bool((heights < END_MARGIN).any())


def _rises(heights: FloatArray, before: FloatArray, free: FloatArray) -> FloatArray:
    """Metres (..., F) by which points at ``heights`` rise: to the ground, or to those ``before`` the constraints."""
    least = np.minimum(before, 0.0) - END_TOLERANCE
    return without_negligible_rises(free * smooth_penetrations(heights - least, np.minimum(before - least, END_MARGIN)))


def without_negligible_rises(rises: FloatArray) -> FloatArray:
    """``rises`` (..., F) in metres, zero for those that are negligible."""
    return np.where(rises > NEGLIGIBLE_END_RISE, rises, 0.0)


class LimbEnd(NamedTuple):
    """Hand or foot: the point of its ``joint``, its ``segment``, and the number of its points, which is that of its
    segments.
    """

    joint: int
    segment: int
    part_count: int

    def tip_heights(self, ground: Ground, positions: PoseArray) -> FloatArray:
        """Heights (F,) in metres of its first point above the ground."""
        tips = positions[:, self.joint + 1]
        return np.asarray(tips[:, 2] - ground.height_at(tips))

    def path(self, positions: PoseArray, rotations: PoseArray) -> FootPath:
        """Path of a foot."""
        return FootPath(positions[:, self.joint], rotations[:, self.segment], rotations[:, self.segment + 1])

    def rotate(self, turns: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Rotate it by ``turns`` (F, 3, 3) about its joint, in place."""
        points, segments = (
            slice(at + 1 - of, at + 1 - of + self.part_count) for at, of in ((self.joint, 0), (self.segment, 1))
        )
        offsets = positions[:, points] - positions[:, self.joint, None]
        positions[:, points] += np.einsum("fij,fpj->fpi", turns, offsets) - offsets
        rotations[:, segments] = turns[:, None] @ rotations[:, segments]
