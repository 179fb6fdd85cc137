"""Two-bone limbs moved by their ends, or rotated about the line from root to end, frame by frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyLayout
from studio.core.kernels.limbs.limb import MAX_EXTENSION
from studio.core.rotations import normalized, shortest_arc

FloatArray = NDArray[np.float64]

STRAIGHT_LIMB_OFFSET = 0.02
"""Distance in metres of elbow or knee from the line root-end up to which a limb counts as straight and bends by its
hinge.
"""


class TwoBoneLimb(NamedTuple):
    """An arm or leg in the arrays of a body."""

    root: int
    """Index of the point of shoulder or hip."""
    segment: int
    """Index of the upper segment."""
    last: int
    """Index of the last point."""

    @staticmethod
    def of(limb: int, layout: BodyLayout) -> "TwoBoneLimb":
        """Limb 0 or 1, the left or right arm, or 2 or 3, the left or right leg."""
        if limb < 2:
            return TwoBoneLimb(
                layout.wrist_point(limb) - 2, layout.upper_arm_segment(limb), layout.wrist_point(limb) + 1
            )
        return TwoBoneLimb(
            layout.hip_point(limb - 2), layout.foot_segment(limb - 2) - 2, layout.ankle_point(limb - 2) + 2
        )

    def move_end(self, goals: FloatArray, bending: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Move wrist or ankle to ``goals`` (F, 3), as far as the limb reaches, in place.

        The limb swings by the shortest arc and bends in its plane; a straight one bends by its hinge, ``bending`` (F,)
        metres aside. Hand or foot keeps its orientation.
        """
        root, arm = self.root, self.segment
        roots, ends = positions[:, root], positions[:, root + 2]
        upper, lower = positions[:, root + 1] - roots, ends - positions[:, root + 1]
        lengths = np.linalg.norm([upper, lower], axis=2)
        line, displacement = normalized(ends - roots), normalized(goals - roots)
        span = np.linalg.norm(goals - roots, axis=1)
        span = np.clip(span, np.abs(lengths[0] - lengths[1]) + 1e-3, MAX_EXTENSION * lengths.sum(axis=0))
        hinge = np.minimum(bending, STRAIGHT_LIMB_OFFSET)[:, None] * np.cross(line, rotations[:, arm, :, 0])
        aim = shortest_arc(line, displacement)
        out = normalized(across(np.einsum("fij,fj->fi", aim, across(upper, line) + hinge), displacement))
        along = (lengths[0] ** 2 - lengths[1] ** 2 + span**2) / (2.0 * span)
        aside = np.sqrt(np.maximum(lengths[0] ** 2 - along**2, 0.0))
        mids = roots + along[:, None] * displacement + aside[:, None] * out
        placed = roots + span[:, None] * displacement
        for segment, old, new in ((arm, upper, mids - roots), (arm + 1, lower, placed - mids)):
            aimed = normalized(np.einsum("fij,fj->fi", aim, old))
            rotations[:, segment] = shortest_arc(aimed, normalized(new)) @ aim @ rotations[:, segment]
        positions[:, root + 3 : self.last + 1] += (placed - ends)[:, None]
        positions[:, root + 1], positions[:, root + 2] = mids, placed

    def turn(self, vectors: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Rotate both bones by rotation vectors (F, 3) along the line from root to end, in place; hand or foot
        stays.
        """
        root, arm = self.root, self.segment
        turned, upper = Rotation.from_rotvec(vectors).as_matrix(), positions[:, root + 1] - positions[:, root]
        positions[:, root + 1] += np.einsum("fij,fj->fi", turned, upper) - upper
        rotations[:, arm : arm + 2] = turned[:, None] @ rotations[:, arm : arm + 2]


def across(displacements: FloatArray, line: FloatArray) -> FloatArray:
    """Component of vectors (F, 3) perpendicular to the unit vectors ``line`` (F, 3)."""
    return np.asarray(displacements - np.sum(displacements * line, axis=1, keepdims=True) * line)
