"""Target trajectories relative to the unsolved poses of their points."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.solver.asking.task_rows import TaskRecords

FloatArray = NDArray[np.float64]
TargetTrajectory = tuple[FloatArray, float]
"""Displacement (F, n) of the target, and the lever over which it rotates a bone, in the same unit."""

MAX_TARGET_OFFSET = 0.8
"""Saturation of a target's distance in metres: beyond it only the direction matters."""


@dataclass(frozen=True, eq=False)
class UnsolvedTask:
    """Task ``c`` of some records on the unsolved poses (F, P, 3) and (F, S, 3, 3) of a body."""

    c: int
    rows: TaskRecords
    positions: FloatArray
    rotations: FloatArray
    body: Morphology

    @property
    def task_record(self) -> Any:
        """Its record of ``TASK``."""
        return self.rows.tasks[self.c]

    @property
    def segment_rotations(self) -> FloatArray:
        """Rotations (F, 3, 3) of its segment."""
        return self.rotations[:, self.task_record["segments"][0]]

    @cached_property
    def point_positions(self) -> FloatArray:
        """Positions (F, 3) of its point."""
        return self._end(0)

    @cached_property
    def target_positions(self) -> FloatArray:
        """Target positions (F or 1, 3), or the other point of the body."""
        return self.rows.positions[self.c] if self.task_record["points"][1] < 0 else self._end(1)

    @property
    def target_rotation(self) -> FloatArray:
        """Target rotations (F or 1, 3, 3), or those of the followed segment."""
        if self.task_record["points"][1] < 0:
            return self.rows.rotations[self.c]
        return np.asarray(self.rotations[:, self.task_record["segments"][1]] @ self.task_record["relative"])

    def _end(self, end: int) -> FloatArray:
        point, segment = self.task_record["points"][end], self.task_record["segments"][end]
        return np.asarray(self.positions[:, point] + self.rotations[:, segment] @ self.task_record["offsets"][end])


def trajectory_to(target: FloatArray, begin: FloatArray) -> TargetTrajectory:
    """Displacements (F, 3) from ``begin`` to ``target``, and their unit length.

    They are softly bounded by ``MAX_TARGET_OFFSET`` and zero where a target is NaN.
    """
    displacement = np.where(np.isnan(target), 0.0, target - begin)
    return displacement / np.sqrt(
        1.0 + (np.linalg.norm(displacement, axis=1, keepdims=True) / MAX_TARGET_OFFSET) ** 2
    ), RADIAN_LENGTH


def point_trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Trajectory from a task's point to its target."""
    return trajectory_to(unsolved.target_positions, unsolved.point_positions)
