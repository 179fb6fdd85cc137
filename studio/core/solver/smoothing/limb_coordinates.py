"""Coordinates of limb joints whose averages are rotations again, within the joints' limits (METHOD (37)).

For joints with limits they are swing-twist angles (``kernels.limits.swing_twist_coordinates``), in which the limits are
convex, so that the path from one side of a shoulder to the other leads through its front. For joints without limits
they are quaternions. Both are relative to the unsolved rotations.
"""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.kernels.limits.swing_twist_coordinates import (
    clamp_limb_angles,
    write_limb_angles,
    write_limb_rotations,
    write_rotations_from_angles,
)
from studio.core.rotations import from_matrix, sign_continuous, to_matrix

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LIMB_SEGMENTS = np.array([[3, 4, 5, 5], [7, 8, 9, 9], [10, 11, 12, 13], [14, 15, 16, 17]])
"""(4, 4) segments of arms and legs, counted after those of the spine: a hand stands in for the missing toe of an
arm.
"""
ALL_LIMBS = np.ones(4, dtype=np.int64)
"""Selection of all limbs."""


class LimbCoordinates:
    """Converts rotations of the 16 limb joints to coordinates relative to their unsolved rotations, and back, in F
    frames.
    """

    def __init__(
        self, layout: BodyLayout, unsolved: FloatArray, limits: NDArray[np.void], limbs: IntArray = ALL_LIMBS
    ) -> None:
        """Prepare for ``unsolved`` rotations (F, S, 3, 3); ``limits`` (4,) are records ``LIMB_LIMITS``, or none.

        Joints of limbs that are 0 in ``limbs`` (4,) stay unchanged.
        """
        self._limbs, self._limits = limbs, limits
        self._segments = (layout.spine_count + LIMB_SEGMENTS).ravel()
        self._carriers = np.array(layout.parent_segments())[self._segments]
        self._unsolved = self.joint_rotations(unsolved)
        self._own = self._angles(self._unsolved)

    @property
    def unsolved_coordinates(self) -> FloatArray:
        """Coordinates (F, 16, n) of the unsolved rotations."""
        return self.coordinates(self._unsolved)

    def joint_rotations(self, rotations: FloatArray) -> FloatArray:
        """Rotations (F, 16, 3, 3) of the limb joints in their parents, from world rotations (F, S, 3, 3)."""
        rotation_matrices = np.empty((len(rotations), 16, 3, 3))
        write_limb_rotations(self._carriers, self._segments, rotations, rotation_matrices)
        return rotation_matrices

    def coordinates(self, rotation_matrices: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """Coordinates (F, 16, n) of joint rotations (F, 16, 3, 3); signs of quaternions follow the coordinates
        ``beside``.
        """
        if len(self._limits):
            return self._angles(rotation_matrices) - self._own
        quaternions, joints = np.zeros((*rotation_matrices.shape[:2], 4)), np.flatnonzero(np.repeat(self._limbs, 4))
        quaternions[..., 3] = 1.0
        quaternions[:, joints] = from_matrix(
            np.swapaxes(self._unsolved[:, joints], 2, 3) @ rotation_matrices[:, joints]
        )
        if beside is None:
            return sign_continuous(quaternions)
        return np.where((quaternions * beside).sum(axis=-1, keepdims=True) < 0.0, -quaternions, quaternions)

    def rotations(self, values: FloatArray) -> FloatArray:
        """Joint rotations (F, 16, 3, 3) of coordinates ``values`` (F, 16, n)."""
        if not len(self._limits):
            length = np.linalg.norm(values, axis=-1, keepdims=True)
            return np.ascontiguousarray(self._unsolved @ to_matrix(values / length))
        rotation_matrices = self._unsolved.copy()
        write_rotations_from_angles(self._limbs, self._own + values, self._limits, rotation_matrices)
        return rotation_matrices

    def clamped_to_limits(self, values: FloatArray) -> FloatArray:
        """Coordinates clamped to the joint limits, or to the motion's own angles where those are beyond."""
        if not len(self._limits):
            return np.asarray(values / np.linalg.norm(values, axis=-1, keepdims=True))
        angles = self._own + values
        clamp_limb_angles(self._limbs, self._own, self._limits, angles)
        return angles - self._own

    def _angles(self, rotation_matrices: FloatArray) -> FloatArray:
        """Swing-twist angles (F, 16, 3) in radians, centred on the limits; zero without limits."""
        angles = np.zeros(rotation_matrices.shape[:-1])
        if len(self._limits):
            write_limb_angles(self._limbs, rotation_matrices, self._limits, angles)
        return angles
