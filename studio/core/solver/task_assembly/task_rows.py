"""Task records and targets of constraints, while they are packed."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowBody
from studio.core.kernels import records
from studio.core.kernels.tasks.task import TASK
from studio.core.rotations import to_matrix
from studio.core.solver.task_assembly.points import limb_of, limb_weights, point_indices
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]

BLANK_TASK = np.zeros(1, dtype=TASK)
"""Task record before a constraint is written into it."""
for _end in ("points", "segments", "limbs"):
    BLANK_TASK[_end] = -1
BLANK_TASK["axes"] = 2
BLANK_TASK.setflags(write=False)
NO_POSITION, NO_ROTATION, NO_DISTANCE = np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1)
"""Position, rotation and distance target of a task that has none."""


@dataclass(eq=False)
class TaskRecords:
    """Task records and targets of C constraints, while they are packed."""

    layout: BodyLayout
    targets: Targets
    levels: tuple[int, ...]
    """(C,) level of each constraint, 0 the highest."""
    tasks: NDArray[np.void]
    """(C,) records of ``TASK``."""
    areas: FloatArray
    """(C, n) area of each task."""
    positions: list[FloatArray]
    """Target positions (F or 1, 3) of each task."""
    rotations: list[FloatArray]
    """Target rotations (F or 1, 3, 3) of each task."""
    distances: list[FloatArray]
    """Target distances (F or 1,) of each task."""
    weights: list[FloatArray]
    """Weights (F or 1,) of each task among those of its level."""

    def set_followed_point(self, c: int, target: object) -> bool:
        """Write the point of its own body that constraint ``c`` follows; False, and nothing is written, for other
        targets.
        """
        if not isinstance(target, FollowBody):
            return False
        row = self.tasks[c]
        row["points"][1], row["segments"][1] = point_indices(target.point, self.layout)
        row["limbs"][1] = -1
        row["offsets"][1], row["relative"] = target.point.offset, to_matrix(np.array(target.turn))
        return True

    @property
    def stacked_targets(self) -> records.TargetArrays:
        """``TargetArrays`` for the kernels."""
        return records.TargetArrays(
            _stacked(self.positions, 3), _stacked(self.rotations, 3, 3), _stacked(self.distances)
        )

    @property
    def stacked_weights(self) -> FloatArray:
        """Weights (C, F or 1) of all tasks."""
        return _stacked(self.weights)


def _stacked(targets: Sequence[FloatArray], *shape: int) -> FloatArray:
    """Array (C, F or 1, ...) of C targets (F or 1, ...)."""
    stacked = np.empty((len(targets), max(map(len, targets), default=1), *shape))
    for c, target in enumerate(targets):
        stacked[c] = target
    return stacked


@lru_cache(maxsize=1024)
def point_task_record(point: BodyPoint, chain: Chain, layout: BodyLayout) -> bytes:
    """Task record, as bytes, with a point and the weights of its limb."""
    record = BLANK_TASK.copy()
    write_end(record[0], 0, point, chain, layout)
    return record.tobytes()


def write_end(row: np.void, end: int, point: BodyPoint, chain: Chain, layout: BodyLayout) -> None:
    """Write end 0 or 1 of a task: a point of the body, and the weights of its limb in the chain."""
    limb = limb_of(point.part)
    row["points"][end], row["segments"][end] = point_indices(point, layout)
    row["limbs"][end] = limb
    row["offsets"][end] = point.offset
    helped, parts, freedom = limb_weights(point.part, chain)
    row["limb_weights"][end] = freedom, chain.end_segment
    if limb >= 0:
        row["assisted"] |= helped
        row["segment_weights"][end] = parts
        row["stiff"] |= freedom > 0.0 and min(parts) < 1.0
