"""Swing-twist coordinates of limb joints: their means are rotations again, within the joints' limits (METHOD (37)).

A joint with limits has its angles about the middles of the limits (``kernels.limits.swing_twist_coordinates``). The
limits are convex there, so that the path from one side of a shoulder to the other leads through its front. Joints
without limits have quaternions.
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

BONES = np.array([[3, 4, 5, 5], [7, 8, 9, 9], [10, 11, 12, 13], [14, 15, 16, 17]])
"""Segments of arms and legs beside the spine's, four a limb: a hand stands for the toe that an arm has not."""
ALL = np.ones(4, dtype=np.int64)


class LimbCharts:
    """Charts of the 16 joints of limbs, about the unsolved turns of F frames."""

    def __init__(
        self, layout: BodyLayout, unsolved: FloatArray, limits: NDArray[np.void], limbs: IntArray = ALL
    ) -> None:
        """``unsolved`` rotations (F, S, 3, 3); ``limits`` (4,) of ``kernels.limits.limb_joint_limits``, or none.

        Of others than ``limbs`` (4,) nothing changes.
        """
        self._limbs, self._limits = limbs, limits
        self._segments = (layout.spine_count + BONES).ravel()
        self._carriers = np.array(layout.parent_segments())[self._segments]
        self._unsolved = self.turns_of(unsolved)
        self._own = self._angles(self._unsolved)

    @property
    def unturned(self) -> FloatArray:
        """(F, 16, n) ``values`` of the unsolved turns."""
        return self.values(self._unsolved)

    def turns_of(self, rotations: FloatArray) -> FloatArray:
        """(F, 16, 3, 3) turns of poses' joints."""
        turns = np.empty((len(rotations), 16, 3, 3))
        write_limb_rotations(self._carriers, self._segments, rotations, turns)
        return turns

    def values(self, turns: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """(F, 16, n) what ``turns`` (F, 16, 3, 3) have beside the unsolved ones, with signs as those ``beside``."""
        if len(self._limits):
            return self._angles(turns) - self._own
        quaternions, joints = np.zeros((*turns.shape[:2], 4)), np.flatnonzero(np.repeat(self._limbs, 4))
        quaternions[..., 3] = 1.0
        quaternions[:, joints] = from_matrix(np.swapaxes(self._unsolved[:, joints], 2, 3) @ turns[:, joints])
        if beside is None:
            return sign_continuous(quaternions)
        return np.where((quaternions * beside).sum(axis=-1, keepdims=True) < 0.0, -quaternions, quaternions)

    def turns(self, values: FloatArray) -> FloatArray:
        """``values`` backwards."""
        if not len(self._limits):
            length = np.linalg.norm(values, axis=-1, keepdims=True)
            return np.ascontiguousarray(self._unsolved @ to_matrix(values / length))
        turns = self._unsolved.copy()
        write_rotations_from_angles(self._limbs, self._own + values, self._limits, turns)
        return turns

    def within(self, values: FloatArray) -> FloatArray:
        """``values`` as far as limits, or the motion itself, let them be."""
        if not len(self._limits):
            return np.asarray(values / np.linalg.norm(values, axis=-1, keepdims=True))
        angles = self._own + values
        clamp_limb_angles(self._limbs, self._own, self._limits, angles)
        return angles - self._own

    def _angles(self, turns: FloatArray) -> FloatArray:
        """(F, 16, 3) radians beside the middles of limits, nought where there are none."""
        angles = np.zeros(turns.shape[:-1])
        if len(self._limits):
            write_limb_angles(self._limbs, turns, self._limits, angles)
        return angles
