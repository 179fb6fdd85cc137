"""Positions of a body's points for given segment rotations while it stands on the ground."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray, Morphology


def standing_points(morphology: Morphology, rotations: FloatArray) -> FloatArray:
    """Canonical points (K+23, 3) of a body whose segments have the world ``rotations`` (K+18, 3, 3) as it stands.

    The root is over the origin and the lower sole on z = 0.
    """
    layout = morphology.layout
    bones = np.einsum("sij,sj->si", rotations, bone_vectors(morphology))
    points = np.zeros((layout.point_count, 3))
    neck, thorax = layout.neck_base, layout.spine_count - 1
    points[1 : neck + 1] = np.cumsum(bones[: layout.spine_count], axis=0)
    points[neck + 1 : neck + 3] = points[neck] + np.cumsum(bones[neck : neck + 2], axis=0)
    for side in range(2):
        arm, leg = layout.clavicle_segment(side), layout.thigh_segment(side)
        for start, base, first in (
            (layout.collar_point(side), points[neck] + rotations[thorax] @ morphology.collar_base[side], arm),
            (layout.hip_point(side), rotations[0] @ morphology.hip_offset[side], leg),
        ):
            points[start] = base
            points[start + 1 : start + 5] = base + np.cumsum(bones[first : first + 4], axis=0)
    soles = [points[layout.ankle_point(side), 2] - morphology.ankle_height[side] for side in range(2)]
    points[:, 2] -= min(soles)
    return points


def bone_vectors(morphology: Morphology) -> FloatArray:
    """Vectors (K+18, 3) from the proximal to the distal point of each segment, in the segment's axes."""
    layout = morphology.layout
    vectors = np.zeros((layout.segment_count, 3))
    vectors[: layout.spine_count] = morphology.spine
    vectors[layout.segment_of_part(BodyPart.NECK), 2] = morphology.neck
    vectors[layout.segment_of_part(BodyPart.HEAD), 2] = morphology.head
    for side in range(2):
        arm, leg = layout.clavicle_segment(side), layout.thigh_segment(side)
        vectors[arm : arm + 3, 2] = morphology.clavicle[side], *morphology.arm[side]
        vectors[arm + 3] = morphology.hand[side]
        vectors[leg : leg + 2, 2] = morphology.leg[side]
        vectors[leg + 2], vectors[leg + 3] = morphology.foot[side], morphology.toe[side]
    return vectors
