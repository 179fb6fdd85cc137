"""Trunk pitch for arms whose length differs from the actor's, with fixed hips."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import AnyMorphology
from studio.core.rotations import normalized, shortest_arc

FloatArray = NDArray[np.float64]

MAX_TRUNK_RISE = np.radians(20.0)
"""Greatest change of a trunk's pitch in radians, approached softly."""


def arch_trunk(raises: FloatArray, body: AnyMorphology, positions: FloatArray, rotations: FloatArray) -> None:
    """Bend trunks about their hips, in place, so that the neck base of a level trunk rises by ``raises`` (F,) metres.

    The bend is greatest at the lumbar spine. It is smaller for steep trunks, which would gain less. Head and arms keep
    their world orientation. ``positions`` (F, P, 3), ``rotations`` (F, S, 3, 3).
    """
    neck, joints = body.layout.neck_base, range(1, body.layout.spine_count)
    ahead = positions[:, neck] - positions[:, 0]
    level = np.hypot(ahead[:, 0], ahead[:, 1])
    target = raises * level / np.maximum(np.sum(ahead**2, axis=1), 1e-9)
    pitch = MAX_TRUNK_RISE * np.tanh(target / MAX_TRUNK_RISE)
    if not pitch.any():
        return
    axis = np.column_stack([ahead[:, 1], -ahead[:, 0], 0.0 * level]) / np.maximum(level, 1e-9)[:, None]
    levers = np.linalg.norm([positions[0, neck] - positions[0, joint] for joint in joints], axis=1)
    fractions = levers * np.linalg.norm(ahead[0]) / np.sum(levers**2)
    before, turned = positions.copy(), rotations.copy()
    last = body.layout.hip_point(0)
    for joint, fraction in zip(joints, fractions, strict=True):
        rotation_matrices = Rotation.from_rotvec(axis * (fraction * pitch)[:, None]).as_matrix()
        pivot, back = positions[:, joint, None], np.swapaxes(rotation_matrices, 1, 2)
        positions[:, joint + 1 : last] = pivot + (positions[:, joint + 1 : last] - pivot) @ back
        rotations[:, joint : last - 3] = rotation_matrices[:, None] @ rotations[:, joint : last - 3]
    head = body.layout.head_joint
    rotations[:, head], positions[:, head + 1] = (
        turned[:, head],
        positions[:, head] + _vector_between(before, head, head + 1),
    )
    for side in range(2):
        _aim_arm(side, body, before, turned, positions, rotations)


def _aim_arm(
    side: int,
    body: AnyMorphology,
    before: FloatArray,
    turned: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Aim an arm that has moved with its trunk at its direction ``before`` again, in place; the hand keeps its
    orientation.

    The shortest rotation is used, as for arms in contact.
    """
    wrist, upper = body.layout.wrist_point(side), body.layout.upper_arm_segment(side)
    shoulder, arm, hand = wrist - 2, slice(wrist - 1, wrist + 1), upper + 2
    aims = shortest_arc(
        normalized(_vector_between(positions, shoulder, wrist)), normalized(_vector_between(before, shoulder, wrist))
    )
    bones = positions[:, arm] - positions[:, shoulder, None]
    positions[:, arm] = positions[:, shoulder, None] + bones @ np.swapaxes(aims, 1, 2)
    rotations[:, upper:hand] = aims[:, None] @ rotations[:, upper:hand]
    rotations[:, hand], positions[:, wrist + 1] = (
        turned[:, hand],
        positions[:, wrist] + _vector_between(before, wrist, wrist + 1),
    )


def _vector_between(positions: FloatArray, first: int, last: int) -> FloatArray:
    """Vector (F, 3) from point ``first`` to point ``last`` of ``positions`` (F, P, 3)."""
    return np.asarray(positions[:, last] - positions[:, first])
