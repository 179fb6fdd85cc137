"""Constraints as the arrays that the solver's kernels take: one row a constraint, one writer a kind."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.canonical import BodyLayout, BodyPart
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels import goals
from studio.core.rotations import to_matrix
from studio.core.solver.areas import area_row
from studio.core.solver.chains import FreeJoints

FloatArray = NDArray[np.float64]


@dataclass(eq=False)
class Rows:
    """The arrays of C constraints while they are being written; ``kernels.constraints`` says what each holds."""

    layout: BodyLayout
    kinds: NDArray[np.int64]
    ranks: NDArray[np.int64]
    ends: NDArray[np.int64]
    offsets: FloatArray
    freedoms: FloatArray
    places: FloatArray
    turns: FloatArray
    distances: FloatArray
    shares: FloatArray
    areas: FloatArray

    def put_end(self, c: int, end: int, point: BodyPoint, constraint: Constraint) -> None:
        """One end of a constraint: a point of the body and the freedom of its limb."""
        limb = limb_of(point.part)
        self.ends[c, end] = *point_indices(point, self.layout), limb
        self.offsets[c, end] = point.offset
        self.freedoms[c, end] = constraint.chain.limb, constraint.chain.end_segment


def pack(
    constraints: Sequence[Constraint], joints: FreeJoints, layout: BodyLayout
) -> tuple[tuple[NDArray[Any], ...], tuple[FloatArray, ...]]:
    """``asked`` and ``wishes`` of the kernels. Raises TypeError for a kind that the solver does not know."""
    count = len(constraints)
    levels = sorted({constraint.priority for constraint in constraints})
    rows = Rows(
        layout,
        kinds=np.empty(count, dtype=np.int64),
        ranks=np.array([levels.index(constraint.priority) for constraint in constraints]),
        ends=np.full((count, 2, 3), -1, dtype=np.int64),
        offsets=np.zeros((count, 2, 3)),
        freedoms=np.zeros((count, 2, 2)),
        places=np.full((count, 1, 3), np.nan),
        turns=np.zeros((count, 1, 3, 3)),
        distances=np.zeros((count, 1)),
        shares=np.zeros((count, 2)),
        areas=np.zeros((count, 10)),
    )
    for c, constraint in enumerate(constraints):
        write = _WRITERS.get(type(constraint))
        if write is None:
            raise TypeError(f"'{constraint.name}': the solver has no kind '{constraint.kind}'.")
        write(rows, c, constraint)
    asked = (rows.kinds, rows.ranks, rows.ends, rows.offsets, joints.mobilities, rows.freedoms)
    wishes = (rows.places, rows.turns, rows.distances, rows.shares)
    return (*asked, np.ones(count), joints.joints, rows.areas), wishes


def _position(rows: Rows, c: int, constraint: PositionConstraint) -> None:
    rows.kinds[c], rows.places[c, 0] = goals.POSITION, constraint.target
    rows.put_end(c, 0, constraint.point, constraint)


def _orientation(rows: Rows, c: int, constraint: OrientationConstraint) -> None:
    rows.kinds[c], rows.turns[c, 0] = goals.ORIENTATION, to_matrix(np.array(constraint.target))
    rows.put_end(c, 0, constraint.point, constraint)


def _look_at(rows: Rows, c: int, constraint: LookAtConstraint) -> None:
    rows.kinds[c], rows.places[c, 0] = goals.LOOK_AT, constraint.target
    rows.put_end(c, 0, constraint.point, constraint)
    rows.ends[c, 0, 2] = -1


def _distance(rows: Rows, c: int, constraint: DistanceConstraint) -> None:
    rows.kinds[c], rows.distances[c, 0] = goals.DISTANCE, constraint.distance
    rows.put_end(c, 0, constraint.point, constraint)
    if isinstance(constraint.other, BodyPoint):
        rows.put_end(c, 1, constraint.other, constraint)
        # A leg comes to meet a hand only when it is asked for itself: the own thigh stays where it is.
        if rows.ends[c, 0, 2] < 2 <= rows.ends[c, 1, 2]:
            rows.freedoms[c, 1] = 0.0
    else:
        rows.places[c, 0] = constraint.other
    free = np.array([rows.ends[c, end, 2] >= 0 and rows.freedoms[c, end, 0] > 0.0 for end in range(2)], dtype=float)
    rows.shares[c] = free / max(free.sum(), 1.0)


def _balance(rows: Rows, c: int, constraint: BalanceConstraint) -> None:
    rows.kinds[c] = goals.BALANCE
    if constraint.place is not None:
        rows.places[c, 0] = *constraint.place, 0.0


def _area(rows: Rows, c: int, constraint: AreaConstraint) -> None:
    rows.kinds[c] = goals.AREA
    rows.put_end(c, 0, constraint.point, constraint)
    rows.areas[c] = area_row(constraint)


_WRITERS: dict[type[Constraint], Callable[[Rows, int, Any], None]] = {
    PositionConstraint: _position,
    OrientationConstraint: _orientation,
    LookAtConstraint: _look_at,
    DistanceConstraint: _distance,
    BalanceConstraint: _balance,
    AreaConstraint: _area,
}


def point_indices(point: BodyPoint, layout: BodyLayout) -> tuple[int, int]:
    """(index of the point an offset counts from, index of the segment in whose axes it stands)."""
    segment = layout.segment(point.part)
    ends = layout.distal_points() if point.at_end else layout.proximal_points()
    return ends[segment], segment


def limb_of(part: BodyPart) -> int:
    """0, 1 left and right arm, 2, 3 legs, -1 for what is on no limb."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return 0 if side == "left" else 1
    if bone in ("thigh", "shank", "foot", "toe"):
        return 2 if side == "left" else 3
    return -1
