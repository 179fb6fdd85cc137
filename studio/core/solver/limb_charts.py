"""Turns of the limbs' joints as numbers whose means are turns again, and within the joints' limits (METHOD (37)).

A joint with limits is charted by these: shoulders, hips, wrists and ankles by swing and twist about the middle of their
range, elbows and knees by bend, slant and turn (METHOD (25) to (28)). What limits allow is convex there, and so the
way from one side of a shoulder to the other leads through the front of it. Free joints are charted by quaternions.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from studio.core.canonical import BodyLayout
from studio.core.rotations import from_matrix, sign_continuous, to_matrix

FloatArray = NDArray[np.float64]

BONES = np.array([[3, 4, 5, 5], [7, 8, 9, 9], [10, 11, 12, 13], [14, 15, 16, 17]])
"""Segments of arms and legs beside the spine's, four a limb: a hand stands for the toe that an arm has not."""


class LimbCharts:
    """Charts of the 16 joints of limbs, about the unsolved turns of F frames."""

    def __init__(
        self, layout: BodyLayout, unsolved: FloatArray, limits: NDArray[np.void], limbs: Sequence[int] = range(4)
    ) -> None:
        """``unsolved`` rotations (F, S, 3, 3); ``limits`` (4,) of ``kernels.joint_limits``, or none.

        Of others than ``limbs`` nothing changes.
        """
        self._limbs, self._joints = limbs, [4 * limb + joint for limb in limbs for joint in range(4)]
        self._segments = (layout.spine_count + BONES).ravel()
        self._carriers = np.array(layout.parent_segments())[self._segments]
        self._limits = limits
        self._unsolved = self.turns_of(unsolved)
        self._own = self._angles(self._unsolved) if len(limits) else np.empty(0)

    def turns_of(self, rotations: FloatArray) -> FloatArray:
        """(F, 16, 3, 3) turns of poses' joints."""
        return np.asarray(np.swapaxes(rotations[:, self._carriers], 2, 3) @ rotations[:, self._segments])

    def values(self, turns: FloatArray, beside: FloatArray | None = None) -> FloatArray:
        """(F, 16, n) what ``turns`` (F, 16, 3, 3) have beside the unsolved ones, with signs as those ``beside``."""
        if len(self._limits):
            return self._angles(turns) - self._own
        quaternions = np.zeros((*turns.shape[:2], 4))
        quaternions[..., 3] = 1.0
        before = np.swapaxes(self._unsolved[:, self._joints], 2, 3)
        quaternions[:, self._joints] = from_matrix(before @ turns[:, self._joints])
        if beside is None:
            return sign_continuous(quaternions)
        return np.where((quaternions * beside).sum(axis=-1, keepdims=True) < 0.0, -quaternions, quaternions)

    def turns(self, values: FloatArray) -> FloatArray:
        """``values`` backwards, as far as limits allow."""
        if not len(self._limits):
            length = np.linalg.norm(values, axis=-1, keepdims=True)
            return np.ascontiguousarray(self._unsolved @ to_matrix(values / length))
        own = self._own.reshape(-1, 4, 4, 3)
        angles, turns = own + values.reshape(own.shape), self._unsolved.reshape(*own.shape, 3).copy()
        for limb in self._limbs:
            for joint in range(4):
                turns[:, limb, joint] = _turns(angles[:, limb, joint], own[:, limb, joint], joint, self._limits[limb])
        return turns.reshape(-1, 16, 3, 3)

    def _angles(self, turns: FloatArray) -> FloatArray:
        """(F, 16, 3) radians beside the middles of limits."""
        turns = turns.reshape(-1, 4, 4, 3, 3)
        angles = np.zeros(turns.shape[:-1])
        for limb in self._limbs:
            for joint in range(4):
                angles[:, limb, joint] = _angles(turns[:, limb, joint], joint, self._limits[limb])
        return angles.reshape(-1, 16, 3)


def _angles(turns: FloatArray, joint: int, row: NDArray[np.void]) -> FloatArray:
    """(F, 3) swing and twist, or bend, slant and turn, of one joint of a limb; of toes a rotation vector."""
    if joint == 3:
        return np.asarray(Rotation.from_matrix(turns).as_rotvec())
    if joint == 1:
        bend, turn = np.arctan2(-turns[:, 1, 2], turns[:, 2, 2]), np.arctan2(-turns[:, 0, 1], turns[:, 0, 0])
        slant = np.arcsin(np.clip(turns[:, 0, 2], -1.0, 1.0))
        angles = np.stack([bend, slant, turn], axis=1) - _middles(row)
        angles[:, ::2] = _half_turns_off(angles[:, ::2])
        return angles
    turns = row["axes"][joint // 2].T @ turns
    across = np.hypot(turns[:, 0, 2], turns[:, 1, 2])
    scale = np.arctan2(across, turns[:, 2, 2]) / np.maximum(across, 1e-9)
    angles = np.stack([-scale * turns[:, 1, 2], scale * turns[:, 0, 2], 0.0 * scale], axis=1)
    rest = np.swapaxes(_turned(angles), 1, 2) @ turns
    angles[:, 2] = _half_turns_off(np.arctan2(rest[:, 1, 0], rest[:, 0, 0]) - row["twists"][joint // 2, 0])
    return angles


def _turns(angles: FloatArray, own: FloatArray, joint: int, row: NDArray[np.void]) -> FloatArray:
    """``_angles`` backwards, no further than limits go or the motion's ``own``."""
    if joint == 3:
        return _turned(angles)
    x, y, z = np.eye(3)
    if joint == 1:
        half = [0.5 * (row["bends"][1] - row["bends"][0]), row["aslant"], row["turns"][1]]
        bend, slant, turn = (_within(angles, own, half) + _middles(row))[..., None].swapaxes(0, 1)
        return _turned(bend * x) @ _turned(slant * y) @ _turned(turn * z)
    radii, (middle, half) = row["radii"][joint // 2], row["twists"][joint // 2]
    part, own_part = _part_of_swing(angles, radii), _part_of_swing(own, radii)
    swing = angles * [1.0, 1.0, 0.0] * (np.maximum(1.0, own_part) / np.maximum(part, 1e-9)).clip(max=1.0)[:, None]
    twist = _within(angles[:, 2:], own[:, 2:], half) + middle
    return np.asarray(row["axes"][joint // 2] @ _turned(swing) @ _turned(twist * z))


def _middles(row: NDArray[np.void]) -> FloatArray:
    """Bend, slant and turn of elbow or knee at the middle of their ranges."""
    return np.array([row["bends"].mean(), 0.0, row["turns"][0]])


def _part_of_swing(angles: FloatArray, radii: FloatArray) -> FloatArray:
    """(F,) which part of its limit each swing is: METHOD (26)."""
    across = radii[np.where(angles[:, :2] >= 0.0, [0, 2], [1, 3])]
    return np.asarray(np.linalg.norm(angles[:, :2] / across, axis=1))


def _within(angles: FloatArray, own: FloatArray, half: ArrayLike) -> FloatArray:
    """``angles`` no further from nought than ``half`` a range, or than the motion's ``own``."""
    most = np.maximum(half, np.abs(own))
    return np.asarray(np.clip(angles, -most, most))


def _half_turns_off(angles: FloatArray) -> FloatArray:
    """Angles between -pi and pi."""
    return np.asarray(angles - 2.0 * np.pi * np.floor(angles / (2.0 * np.pi) + 0.5))


def _turned(vectors: FloatArray) -> FloatArray:
    """(F, 3, 3) turns of rotation vectors (F, 3)."""
    return np.asarray(Rotation.from_rotvec(vectors).as_matrix())
