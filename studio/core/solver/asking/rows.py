"""The arrays of constraints while they are being written: one record of ``TASK`` each, and where things are to be."""

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
from studio.core.solver.asking.points import freedoms_of, limb_of, point_indices
from studio.core.solver.asking.tracks import Targets

FloatArray = NDArray[np.float64]

BLANK = np.zeros(1, dtype=TASK)
"""What is asked where nothing is."""
for _end in ("points", "segments", "limbs"):
    BLANK[_end] = -1
BLANK["axes"] = 2
BLANK.setflags(write=False)
NO_PLACE, NO_TURN, NO_DISTANCE = np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1)


@dataclass(eq=False)
class Rows:
    """The arrays of C constraints while they are being written; ``kernels.tasks.task`` says what each record holds.

    ``ranks`` (C,) are their levels, 0 the highest; ``places`` C of (F or 1, 3), ``turns`` of (F or 1, 3, 3) and
    ``distances`` of (F or 1,) where things are to be.
    """

    layout: BodyLayout
    targets: Targets
    ranks: tuple[int, ...]
    asked: NDArray[np.void]
    areas: FloatArray
    places: list[FloatArray]
    turns: list[FloatArray]
    distances: list[FloatArray]

    def put_followed(self, c: int, target: object) -> bool:
        """What a constraint follows on its own body; False where that is no such thing."""
        if not isinstance(target, FollowBody):
            return False
        row = self.asked[c]
        row["points"][1], row["segments"][1] = point_indices(target.point, self.layout)
        row["limbs"][1] = -1
        row["offsets"][1], row["relative"] = target.point.offset, to_matrix(np.array(target.turn))
        return True

    @property
    def stacked_targets(self) -> records.TargetArrays:
        """As ``kernels.solve_clip.solve_frames`` takes them."""
        return records.TargetArrays(_stacked(self.places, 3), _stacked(self.turns, 3, 3), _stacked(self.distances))


def _stacked(targets: Sequence[FloatArray], *shape: int) -> FloatArray:
    """(C, F or 1, ...) of C targets (F or 1, ...)."""
    stacked = np.empty((len(targets), max(map(len, targets), default=1), *shape))
    for c, target in enumerate(targets):
        stacked[c] = target
    return stacked


@lru_cache(maxsize=1024)
def row_of(point: BodyPoint, chain: Chain, layout: BodyLayout) -> bytes:
    """A record with nothing but its point and what moves that."""
    record = BLANK.copy()
    put_end(record[0], 0, point, chain, layout)
    return record.tobytes()


def put_end(row: np.void, end: int, point: BodyPoint, chain: Chain, layout: BodyLayout) -> None:
    """One end of a constraint: a point of the body and the freedom of its limb."""
    limb = limb_of(point.part)
    row["points"][end], row["segments"][end] = point_indices(point, layout)
    row["limbs"][end] = limb
    row["offsets"][end] = point.offset
    helped, parts, freedom = freedoms_of(point.part, chain)
    row["limb_weights"][end] = freedom, chain.end_segment
    if limb >= 0:
        row["assisted"] |= helped
        row["segment_weights"][end] = parts
        row["stiff"] |= freedom > 0.0 and min(parts) < 1.0
