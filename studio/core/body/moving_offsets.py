"""Joints that move in their parents, in files with position channels on every joint.

Such bones may be drawn where no rotation puts them. Their sideways motion becomes a rotation of the parent, and their
motion along the bone becomes its length, so that no joint changes its position in any frame.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import from_matrix, multiply, normalized, rotate, shortest_arc

FloatArray = NDArray[np.float64]

_STEADY = 0.01
"""Fraction of a bone's length: a joint that moves less than this in its parent counts as fixed."""
_SWING = np.radians(0.5)
"""Radians from its direction at rest by which a bone swings in its parent before it is followed."""
_BONES = ("CLAVICLE", "UPPER_ARM", "FOREARM", "HAND"), ("THIGH", "SHANK", "FOOT", "TOE")


def with_measured_offsets(skeleton: Skeleton, poses: PoseSequence) -> Skeleton:
    """Skeleton with the bone lengths of ``poses`` for bones whose offsets are constant there or zero in the file."""
    seen = np.median(poses.local_translations, axis=0)
    stray = np.abs(poses.local_translations - seen).max(axis=(0, 2))
    lengths, own = np.linalg.norm(seen, axis=1), np.linalg.norm(skeleton.offsets, axis=1)
    other = np.linalg.norm(seen - skeleton.offsets, axis=1) > _STEADY * lengths
    taken = other & ((stray < _STEADY * lengths) | (own < _STEADY * lengths))
    taken[0] = False
    return replace(skeleton, offsets=np.where(taken[:, None], seen, skeleton.offsets)) if taken.any() else skeleton


def with_rigid_bones(skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap) -> tuple[PoseSequence, float]:
    """Poses with the same joint positions, reached by rotations of limbs and neck; and the greatest of these rotations
    in radians.
    """
    local, moves = poses.local_rotations, poses.local_translations
    greatest = 0.0
    for joint, end in _bones(skeleton, body_map):
        own, bones = normalized(skeleton.offsets[end]), normalized(moves[:, end])
        directed = np.linalg.norm(bones, axis=1, keepdims=True) > 0.5  # a bone without length points nowhere
        bones = np.where(directed, bones, own)
        swings = np.arccos(np.clip(bones @ own, -1.0, 1.0))
        if np.linalg.norm(own) < 0.5 or swings.max() < _SWING:
            continue
        if not greatest:
            local, moves = local.copy(), moves.copy()
        greatest = max(greatest, float(swings.max()))
        turn = from_matrix(shortest_arc(own, bones))
        back = turn * [-1.0, -1.0, -1.0, 1.0]
        local[:, joint] = multiply(local[:, joint], turn)
        for child in skeleton.children[joint]:
            local[:, child] = multiply(back, local[:, child])
            moves[:, child] = rotate(back, moves[:, child])
    return (PoseSequence(local, moves), greatest) if greatest else (poses, 0.0)


def _bones(skeleton: Skeleton, body_map: BodyMap) -> list[tuple[int, int]]:
    """Bones of limbs and neck as pairs of joints, parents first."""
    parts = [(BodyPart.NECK, BodyPart.HEAD)]
    for side in ("LEFT", "RIGHT"):
        for names in _BONES:
            parts += [(BodyPart[f"{side}_{part}"], BodyPart[f"{side}_{end}"]) for part, end in pairwise(names)]
    joints = [(body_map.get(part), body_map.get(end)) for part, end in parts]
    found = [(a, b) for a, b in joints if a is not None and b is not None and skeleton.parents[b] == a]
    return sorted(found)
