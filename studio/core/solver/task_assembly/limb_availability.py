"""Availability of arms and legs as redundant limbs of a balance, and their limits (METHOD 11)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, at_frames, sole_rows
from studio.core.captures.contacts import ContactInterval, contact_mask
from studio.core.compact_array import PoseArray
from studio.core.grounds.ground import Ground
from studio.core.solver.grounding.contact_blending import release_weight
from studio.core.solver.task_assembly.chains import HIP_LIMIT, point_masses

FloatArray = NDArray[np.float64]


def limb_availability(
    limbs: NDArray[np.int64],
    levels: NDArray[np.int64],
    activations: FloatArray,
    contacts: Sequence[ContactInterval],
    frame_rate: float,
) -> FloatArray:
    """Availability (L, 4, F) of each limb to each level, 0 to 1.

    It is 0 in contact or with an active task of that level or above, and rises to 1 soon after and before. ``limbs``
    (C, 2) are the limbs of each constraint's points, ``levels`` (C,), ``activations`` (C, F). The least activation
    counts fully, so that a limb is back in the motion's own pose when its task begins.
    """
    taken = np.zeros((int(levels.max(initial=-1)) + 1, 4, activations.shape[1]), dtype=np.bool_)
    for limb in range(4):
        spans = [(each.first, each.last) for each in contacts if each.point.limb == limb]
        taken[:, limb] = contact_mask(spans, activations.shape[1])
        for c in np.flatnonzero((limbs == limb).any(axis=1)):
            taken[levels[c] :, limb] |= activations[c] > 0.0
    return np.array([[release_weight(each, frame_rate) for each in level] for level in taken])


def leg_limit_fractions(
    body: AnyMorphology, ground: Ground, positions: PoseArray, window: slice = slice(None)
) -> FloatArray:
    """Fraction (2, F) of its joint limit by which each leg may rotate about its hip without entering the ground.

    A point c metres above the ground and h beside the hip may rotate by c / h. The result is the smooth minimum of the
    limit and these angles of ankle, ball and tip. ``positions`` are those of all frames (P, 3), F is the number of
    frames of ``window``.
    """
    found, positions = [], positions[window]
    for side in range(2):
        hip, soles = body.layout.hip_point(side), at_frames(sole_rows(body, side), window)
        points = positions[:, hip + 2 : hip + 5]
        soles_above = np.stack([soles[:, 3], np.maximum(soles[:, 3] + soles[:, 2], 0.0), np.zeros(len(soles))], axis=1)
        above = np.maximum(points[..., 2] - ground.height_at(points) - soles_above, 1e-9)
        beside = np.linalg.norm(points[..., :2] - positions[:, hip : hip + 1, :2], axis=-1)
        found.append((1.0 + ((HIP_LIMIT * beside / above) ** 4).sum(axis=1)) ** -0.25)
    return np.array(found)


def arm_limit_fractions(body: AnyMorphology, positions: PoseArray, window: slice = slice(None)) -> FloatArray:
    """Fraction (2, F) of its joint limit by which each arm may rotate about its shoulder: the squared sine of its mass'
    elevation.

    A level arm helps whether it rotates up or down, and would change sides between two frames. ``positions`` are those
    of all frames (P, 3), F is the number of frames of ``window``.
    """
    found, positions, masses = [], positions[window], point_masses(body.layout)
    for side in range(2):
        shoulder = body.layout.collar_point(side) + 1
        arm = slice(shoulder, shoulder + 4)
        lever = np.einsum("p,fpi->fi", masses[arm], positions[:, arm] - positions[:, shoulder : shoulder + 1])
        found.append(lever[:, 2] ** 2 / np.maximum((lever**2).sum(axis=1), 1e-12))
    return np.array(found)
