"""Trajectories of targets relative to the unsolved poses of their points."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.solver.task_assembly.task_rows import TaskRecords

FloatArray = NDArray[np.float64]
TargetTrajectory = tuple[FloatArray, float]
"""Displacements (F, n) of a target, and the lever over which they rotate a bone, in the same unit."""

MAX_TARGET_OFFSET_METRES = 0.8
"""Greatest distance of a target from its point in metres, approached softly: beyond it only the direction matters."""


@dataclass(frozen=True, eq=False)
class UnsolvedTask:
    """One task on the unsolved poses of a body."""

    c: int
    """Index of the task in ``rows``."""
    rows: TaskRecords
    positions: FloatArray
    """(F, P, 3) metres."""
    rotations: FloatArray
    """(F, S, 3, 3) in the world."""
    body: Morphology

    @property
    def task_record(self) -> Any:
        """Record ``TASK`` of the task."""
        return self.rows.tasks[self.c]

    @property
    def segment_rotations(self) -> FloatArray:
        """Rotations (F, 3, 3) of the constrained segment."""
        return self.rotations[:, self.task_record["segments"][0]]

    @cached_property
    def point_positions(self) -> FloatArray:
        """Positions (F, 3) of the constrained point, metres."""
        return self._end(0)

    @cached_property
    def target_positions(self) -> FloatArray:
        """Target positions (F or 1, 3), or those of the followed point of the body, metres."""
        return self.rows.positions[self.c] if self.task_record["points"][1] < 0 else self._end(1)

    @property
    def target_rotation(self) -> FloatArray:
        """Target rotations (F or 1, 3, 3), or those of the followed segment of the body."""
        if self.task_record["points"][1] < 0:
            return self.rows.rotations[self.c]
        return np.asarray(self.rotations[:, self.task_record["segments"][1]] @ self.task_record["relative"])

    def _end(self, end: int) -> FloatArray:
        """Positions (F, 3) of end 0 or 1 of the task, metres."""
        point, segment = self.task_record["points"][end], self.task_record["segments"][end]
        return np.asarray(self.positions[:, point] + self.rotations[:, segment] @ self.task_record["offsets"][end])


def trajectory_to(target: FloatArray, begin: FloatArray) -> TargetTrajectory:
    """(displacements (F, 3) in metres from ``begin`` to ``target``, lever ``RADIAN_LENGTH``).

    Displacements are softly bounded by ``MAX_TARGET_OFFSET_METRES``, and zero where the target is NaN.
    """
    displacement = np.where(np.isnan(target), 0.0, target - begin)
    return displacement / np.sqrt(
        1.0 + (np.linalg.norm(displacement, axis=1, keepdims=True) / MAX_TARGET_OFFSET_METRES) ** 2
    ), RADIAN_LENGTH


def point_trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory of a task with a point: displacements from its unsolved point to the target."""
    return trajectory_to(unsolved.target_positions, unsolved.point_positions)
