"""Task records and targets of constraints while they are written."""

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
from studio.core.solver.asking.points import limb_of, limb_weights, point_indices
from studio.core.solver.asking.tracks import Targets

FloatArray = NDArray[np.float64]

BLANK_TASK = np.zeros(1, dtype=TASK)
"""Record of a task without request."""
for _end in ("points", "segments", "limbs"):
    BLANK_TASK[_end] = -1
BLANK_TASK["axes"] = 2
BLANK_TASK.setflags(write=False)
NO_POSITION, NO_ROTATION, NO_DISTANCE = np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1)
"""Targets of a task without target."""


@dataclass(eq=False)
class TaskRecords:
    """Records and targets of C constraints while they are written; see ``kernels.tasks.task``.

    ``levels`` (C,), 0 the highest; ``positions`` C of (F or 1, 3), ``rotations`` of (F or 1, 3, 3) and ``distances`` of
    (F or 1,) are the targets, ``weights`` C of (F or 1,) count among tasks of the same level.
    """

    layout: BodyLayout
    targets: Targets
    levels: tuple[int, ...]
    tasks: NDArray[np.void]
    areas: FloatArray
    positions: list[FloatArray]
    rotations: list[FloatArray]
    distances: list[FloatArray]
    weights: list[FloatArray]

    def set_followed_point(self, c: int, target: object) -> bool:
        """Write the point of its own body that a constraint follows; False for other targets."""
        if not isinstance(target, FollowBody):
            return False
        row = self.tasks[c]
        row["points"][1], row["segments"][1] = point_indices(target.point, self.layout)
        row["limbs"][1] = -1
        row["offsets"][1], row["relative"] = target.point.offset, to_matrix(np.array(target.turn))
        return True

    @property
    def stacked_targets(self) -> records.TargetArrays:
        """Target arrays for ``kernels.solve_clip.solve_frames``."""
        return records.TargetArrays(
            _stacked(self.positions, 3), _stacked(self.rotations, 3, 3), _stacked(self.distances)
        )

    @property
    def stacked_weights(self) -> FloatArray:
        """Weights (C, F or 1)."""
        return _stacked(self.weights)


def _stacked(targets: Sequence[FloatArray], *shape: int) -> FloatArray:
    """Array (C, F or 1, ...) of C targets (F or 1, ...)."""
    stacked = np.empty((len(targets), max(map(len, targets), default=1), *shape))
    for c, target in enumerate(targets):
        stacked[c] = target
    return stacked


@lru_cache(maxsize=1024)
def row_of(point: BodyPoint, chain: Chain, layout: BodyLayout) -> bytes:
    """Record with a point and its limb."""
    record = BLANK_TASK.copy()
    write_end(record[0], 0, point, chain, layout)
    return record.tobytes()


def write_end(row: np.void, end: int, point: BodyPoint, chain: Chain, layout: BodyLayout) -> None:
    """Write one end of a constraint: a point of the body and the weights of its limb."""
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
