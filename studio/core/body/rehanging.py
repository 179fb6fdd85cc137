"""Reparented joints: rigs for inverse kinematics keep the feet below the root, and they must hang from the shanks."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_APART = 0.1
"""Fraction of a shank's length: a foot nearer than this to the shank's end still counts as attached (stretchy legs)."""


@dataclass(frozen=True)
class JointOrder:
    """New order of joints: ``order`` (J,) has the old index of each joint, ``parents`` (J,) new indices."""

    order: IntArray
    parents: IntArray


def reparented_order(parents: IntArray, moved: Mapping[int, int]) -> JointOrder:
    """Order of the joints with every parent before its children, after ``moved`` (joint: new parent) is applied.

    The new parent of a joint must not be one of its descendants.
    """
    above = [moved.get(joint, parent) for joint, parent in enumerate(parents.tolist())]

    def depth(joint: int) -> int:
        return 0 if above[joint] < 0 else 1 + depth(above[joint])

    order = np.array(sorted(range(len(above)), key=lambda joint: (depth(joint), joint)))
    place = {int(old): new for new, old in enumerate(order)}
    return JointOrder(order, np.array([place.get(above[old], -1) for old in order.tolist()]))


def with_body_over_feet(skeleton: Skeleton, poses: PoseSequence, feet: Mapping[int, int]) -> tuple[PoseSequence, float]:
    """Motion with the body moved over its feet, and its greatest distance from them before.

    ``feet`` maps each foot, which is no descendant of the body, to its shank. Some files move the feet through the
    world and leave the body behind, or fixed. The rotations of the legs give the position at which the ends of both
    shanks meet the feet. Raises StudioError if there is none.
    """
    positions, turns = joint_world(skeleton, poses)
    if all(_hangs_in_poses(positions[:, foot] - positions[:, shank], turns[:, shank]) for foot, shank in feet.items()):
        return poses, 0.0
    still = joint_world(skeleton, rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))))[0][0]
    gaps = np.stack(
        [
            positions[:, foot] - positions[:, shank] - turns[:, shank] @ (still[foot] - still[shank])
            for foot, shank in feet.items()
        ]
    )
    near = _APART * min(float(np.linalg.norm(still[foot] - still[shank])) for foot, shank in feet.items())
    farthest = float(np.linalg.norm(gaps, axis=2).max())
    if farthest <= near:
        return poses, 0.0
    above = skeleton.path(0, skeleton.common_ancestor(*feet.values()))
    body = next((joint for joint in above if not any(skeleton.path(joint, foot) for foot in feet)), None)
    if body is None or np.linalg.norm(gaps - gaps.mean(axis=0), axis=2).max() > near:
        foot, shank = next(iter(feet.items()))
        raise StudioError(
            f"'{skeleton.names[foot]}' is parented to the root and drifts from '{skeleton.names[shank]}'."
            " Bake the legs, or parent the feet to the shanks, and export it again."
        )
    carrier = turns[:, skeleton.parents[body]]
    moves = np.array(poses.local_translations)
    moves[:, body] += np.einsum("fji,fj->fi", carrier, gaps.mean(axis=0))
    return PoseSequence(poses.local_rotations, moves), farthest


def _hangs_in_poses(bones: FloatArray, turns: FloatArray) -> bool:
    """True if ``bones`` (F, 3), from shank to foot in the world, rotate with the shank, whose rotations are ``turns``
    (F, 3, 3), wherever the zero pose has the foot.
    """
    near = _APART * float(np.median(np.linalg.norm(bones, axis=1)))
    within = np.einsum("fji,fj->fi", turns, bones)
    away, moved = (np.linalg.norm(each - np.median(each, axis=0), axis=1).max() for each in (within, bones))
    return bool(away <= near < moved)


def reparented_motion(skeleton: Skeleton, poses: PoseSequence, new: JointOrder) -> tuple[Skeleton, PoseSequence]:
    """Skeleton with the parents of ``new``, and the same motion on it; the zero pose keeps its positions too."""
    still = PoseSequence(np.tile([0.0, 0.0, 0.0, 1.0], (1, skeleton.joint_count, 1)), skeleton.offsets[None])
    offsets = _local(*joint_world(skeleton, still), new)[1][0]
    names = tuple(skeleton.names[old] for old in new.order)
    turns, moves = _local(*joint_world(skeleton, poses), new)
    return Skeleton(names, new.parents, offsets, skeleton.end_sites[new.order]), PoseSequence(from_matrix(turns), moves)


def _local(positions: FloatArray, turns: FloatArray, new: JointOrder) -> tuple[FloatArray, FloatArray]:
    """Rotations (F, J, 3, 3) and translations (F, J, 3) relative to the parents of ``new``, from world ones."""
    positions, turns = positions[:, new.order], turns[:, new.order]
    below = new.parents >= 0
    carriers = np.swapaxes(turns[:, new.parents[below]], -1, -2)
    local, moves = turns.copy(), positions.copy()
    local[:, below] = carriers @ turns[:, below]
    apart = positions[:, below] - positions[:, new.parents[below]]
    moves[:, below] = np.einsum("fjab,fjb->fja", carriers, apart)
    return local, moves
