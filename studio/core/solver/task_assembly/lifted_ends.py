"""Feet and hands that constraints take into the ground are rotated out of it about ankle and wrist (METHOD 7).

Ankle and wrist stay, so that their targets are still met. Frames are independent of each other.
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
from studio.core.solver.grounding.contact_blending import smooth_penetrations
from studio.core.solver.grounding.foot_tipping import ankle_tip_rotations, heights_of, tip_rotations
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.grounding.held_foot import FootPath
from studio.core.solver.task_assembly.points import limb_of

FloatArray = NDArray[np.float64]

END_MARGIN_METRES = 0.05
"""Height above the ground in metres below which a foot or hand begins to rise; at ground height it is raised by 3/16 of
this.
"""
END_TOLERANCE = 1e-4
"""Penetration in metres that is left to a foot or hand which touches the ground before the constraints."""
NEGLIGIBLE_END_RISE = 1e-6
"""Rise in metres that is ignored: rounding alone causes it in a limb that stays."""
END_ROTATIONS = 2
"""Iterations of the rotation of a foot: its points rise less as it becomes level."""
END_PARTS = tuple(BodyPart(f"{side}_{part}") for side in ("left", "right") for part in ("hand", "foot", "toe"))
"""Hands, feet and toes."""


def constrained_ends(constraints: Sequence[Constraint], activations: FloatArray) -> FloatArray:
    """Activations (4, F) of those ``constraints`` that constrain the hand or foot of each limb itself.

    ``activations`` (C, F) are those of the constraints.
    """
    asked = np.zeros((4, activations.shape[1]))
    for constraint, activation in zip(constraints, activations, strict=True):
        for part in {constraint.point.part, *_followed_parts(constraint)}.intersection(END_PARTS):
            limb = limb_of(part)
            asked[limb] = np.maximum(asked[limb], activation)
    return asked


def _followed_parts(constraint: Constraint) -> Iterable[BodyPart]:
    """Parts of the own body that a constraint follows."""
    return (follow.point.part for follow in follows_of(constraint) if isinstance(follow, FollowBody))


def lift_ends(
    standing: GroundedMotion, window: slice, free: FloatArray, positions: FloatArray, rotations: FloatArray
) -> None:
    """Rotate hands and feet of solved frames of a ``window``, (F, P, 3) and (F, S, 3, 3), out of the ground, in place.

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
                hand.rotate(tip_rotations(fingers, np.minimum(rises, np.maximum(-fingers[:, 2], 0.0))), *solved)
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
            foot.rotate(ankle_tip_rotations(foot.path(*solved), measures, heights, rises), *solved)


def is_below_goal(heights: FloatArray) -> bool:
    """True if any of the ``heights`` (..., F) in metres is so low that the point may have to rise."""
    return bool((heights < END_MARGIN_METRES).any())


def _rises(heights: FloatArray, before: FloatArray, free: FloatArray) -> FloatArray:
    """Rises (..., F) in metres of points at ``heights``: to the ground, or to their heights ``before`` the
    constraints.
    """
    least = np.minimum(before, 0.0) - END_TOLERANCE
    return without_negligible_rises(
        free * smooth_penetrations(heights - least, np.minimum(before - least, END_MARGIN_METRES))
    )


def without_negligible_rises(rises: FloatArray) -> FloatArray:
    """``rises`` (..., F) in metres, zero for those that are negligible."""
    return np.where(rises > NEGLIGIBLE_END_RISE, rises, 0.0)


class LimbEnd(NamedTuple):
    """Hand, or foot and toe, in the arrays of a body."""

    joint: int
    """Index of the point of wrist or ankle."""
    segment: int
    """Index of the segment of hand or foot."""
    part_count: int
    """Number of segments, and of points beyond the joint."""

    def tip_heights(self, ground: Ground, positions: PoseArray) -> FloatArray:
        """Heights (F,) in metres above the ground of the first point beyond the joint."""
        tips = positions[:, self.joint + 1]
        return np.asarray(tips[:, 2] - ground.height_at(tips))

    def path(self, positions: PoseArray, rotations: PoseArray) -> FootPath:
        """Path of the foot in posed frames."""
        return FootPath(positions[:, self.joint], rotations[:, self.segment], rotations[:, self.segment + 1])

    def rotate(self, turns: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Rotate hand or foot about its joint by ``turns`` (F, 3, 3), in place."""
        points, segments = (
            slice(at + 1 - of, at + 1 - of + self.part_count) for at, of in ((self.joint, 0), (self.segment, 1))
        )
        offsets = positions[:, points] - positions[:, self.joint, None]
        positions[:, points] += np.einsum("fij,fpj->fpi", turns, offsets) - offsets
        rotations[:, segments] = turns[:, None] @ rotations[:, segments]
