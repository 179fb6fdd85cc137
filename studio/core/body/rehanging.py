"""Joints hung from others than in their file: rigs for inverse kinematics keep the feet under the root."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import from_matrix

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Rehanging:
    """The new order of joints: ``order`` (J,) counts in the old one, ``parents`` (J,) in the new one."""

    order: IntArray
    parents: IntArray


def rehang(parents: IntArray, moved: Mapping[int, int]) -> Rehanging:
    """The order in which every parent stands before its children when joints hang from others: ``moved`` joint: parent.

    A joint moves only to one that it does not carry.
    """
    above = [moved.get(joint, parent) for joint, parent in enumerate(parents.tolist())]

    def depth(joint: int) -> int:
        return 0 if above[joint] < 0 else 1 + depth(above[joint])

    order = np.array(sorted(range(len(above)), key=lambda joint: (depth(joint), joint)))
    place = {int(old): new for new, old in enumerate(order)}
    return Rehanging(order, np.array([place.get(above[old], -1) for old in order.tolist()]))


def rehung(skeleton: Skeleton, poses: PoseSequence, new: Rehanging) -> tuple[Skeleton, PoseSequence]:
    """The same motion on a skeleton whose joints hang as ``new`` says; its zero pose is the same too."""
    still = PoseSequence(np.tile([0.0, 0.0, 0.0, 1.0], (1, skeleton.joint_count, 1)), skeleton.offsets[None])
    offsets = _local(*joint_world(skeleton, still), new)[1][0]
    names = tuple(skeleton.names[old] for old in new.order)
    turns, moves = _local(*joint_world(skeleton, poses), new)
    return Skeleton(names, new.parents, offsets, skeleton.end_sites[new.order]), PoseSequence(from_matrix(turns), moves)


def _local(positions: FloatArray, turns: FloatArray, new: Rehanging) -> tuple[FloatArray, FloatArray]:
    """Rotations (F, J, 3, 3) and translations (F, J, 3) from the parents of ``new``, of joints in the world."""
    positions, turns = positions[:, new.order], turns[:, new.order]
    below = new.parents >= 0
    carriers = np.swapaxes(turns[:, new.parents[below]], -1, -2)
    local, moves = turns.copy(), positions.copy()
    local[:, below] = carriers @ turns[:, below]
    apart = positions[:, below] - positions[:, new.parents[below]]
    moves[:, below] = np.einsum("fjab,fjb->fja", carriers, apart)
    return local, moves
