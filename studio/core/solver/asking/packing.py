"""Constraints as the arrays that the solver's kernels take: one row a constraint, one writer a kind."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import (
    CLAVICLES,
    THIGHS,
    TRUNK,
    UPPER_ARMS,
    BodyPoint,
    Chain,
    Constraint,
    limb_bones,
)
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.kernels import records
from studio.core.kernels.tasks import goals
from studio.core.kernels.tasks.task import TASK
from studio.core.rotations import to_matrix
from studio.core.solver.asking.areas import area_row
from studio.core.solver.asking.tracks import Targets

FloatArray = NDArray[np.float64]

_PLACES = {part: place for place, part in enumerate(BodyPart)}
_BLANK = np.zeros(1, dtype=TASK)
"""What is asked where nothing is."""
for _end in ("points", "segments", "limbs"):
    _BLANK[_end] = -1
_BLANK["axes"] = 2
_BLANK.setflags(write=False)
_NO_PLACE, _NO_TURN, _NO_DISTANCE = np.full((1, 3), np.nan), np.zeros((1, 3, 3)), np.zeros(1)


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
    def stacked_targets(self) -> records.Targets:
        """As ``kernels.adapt.solve_frames`` takes them."""
        return records.Targets(_stacked(self.places, 3), _stacked(self.turns, 3, 3), _stacked(self.distances))


def _stacked(targets: Sequence[FloatArray], *shape: int) -> FloatArray:
    """(C, F or 1, ...) of C targets (F or 1, ...)."""
    stacked = np.empty((len(targets), max(map(len, targets), default=1), *shape))
    for c, target in enumerate(targets):
        stacked[c] = target
    return stacked


def in_order(constraints: Sequence[Constraint]) -> list[int]:
    """Indices in order of priority; among equals in an order that does not depend on which was made first."""
    return sorted(range(len(constraints)), key=lambda c: (constraints[c].priority, *_rank_among_equals(constraints[c])))


def _rank_among_equals(constraint: Constraint) -> tuple[object, ...]:
    """Hands before elbows, feet before knees."""
    point = constraint.point
    return -_PLACES[point.part], not point.at_end, constraint.kind, point.offset, constraint.name


def pack(constraints: Sequence[Constraint], layout: BodyLayout, targets: Targets, contacts: int = 0) -> Rows:
    """``constraints``, given in order of priority, as the kernels take them.

    The first ``contacts`` of them stand above all others. Raises TypeError for a kind that the solver does not know.
    """
    count, ranks = len(constraints), _levels(constraints, contacts)
    begun = [
        _BLANK.tobytes() if isinstance(each, BalanceConstraint) else _begun(each.point, each.chain, layout)
        for each in constraints
    ]
    rows = Rows(
        layout,
        targets,
        ranks,
        asked=np.frombuffer(bytearray(b"".join(begun)), dtype=TASK),  # whole: NumPy copies records field by field
        areas=np.zeros((count, 10)),
        places=[_NO_PLACE] * count,
        turns=[_NO_TURN] * count,
        distances=[_NO_DISTANCE] * count,
    )
    rows.asked["rank"], rows.asked["weight"] = ranks, [constraint.weight for constraint in constraints]
    for c, constraint in enumerate(constraints):
        write = _WRITERS.get(type(constraint))
        if write is None:
            raise TypeError(f"'{constraint.name}': the solver has no kind '{constraint.kind}'.")
        write(rows, c, constraint)
    for c, constraint in enumerate(constraints):
        if constraint.chain.free_arms or constraint.chain.free_legs:
            _blend_what_takes_limbs(rows, c, constraint.chain)
    return rows


def _levels(constraints: Sequence[Constraint], contacts: int) -> tuple[int, ...]:
    """The level of each, 0 the highest."""
    priorities = [-1] * contacts + [constraint.priority for constraint in constraints[contacts:]]
    ranks = {priority: rank for rank, priority in enumerate(sorted(set(priorities)))}
    return tuple(ranks[priority] for priority in priorities)


@lru_cache(maxsize=1024)
def _begun(point: BodyPoint, chain: Chain, layout: BodyLayout) -> bytes:
    """A record with nothing but its point and what moves that."""
    record = _BLANK.copy()
    _put_end(record[0], 0, point, chain, layout)
    return record.tobytes()


def _put_end(row: np.void, end: int, point: BodyPoint, chain: Chain, layout: BodyLayout) -> None:
    """One end of a constraint: a point of the body and the freedom of its limb."""
    limb = limb_of(point.part)
    row["points"][end], row["segments"][end] = point_indices(point, layout)
    row["limbs"][end] = limb
    row["offsets"][end] = point.offset
    helped, parts, freedom = _freedoms_of(point.part, chain)
    row["freedoms"][end] = freedom, chain.end_segment
    if limb >= 0:
        row["helped"] |= helped
        row["parts"][end] = parts
        row["stiff"] |= freedom > 0.0 and min(parts) < 1.0


def _blend_what_takes_limbs(rows: Rows, c: int, chain: Chain) -> None:
    """Blend whatever is asked below a balance of a limb that it turns: that is not in the motion's own pose."""
    recruited = [limb for limb, part in enumerate((*UPPER_ARMS, *THIGHS)) if chain.recruited(part) > 0.0]
    below = rows.asked["rank"] > rows.asked["rank"][c]
    rows.asked["blends"] |= below & np.isin(rows.asked["limbs"], recruited).any(axis=1)


def _position(rows: Rows, c: int, constraint: PositionConstraint) -> None:
    target = constraint.target
    if isinstance(target, FollowBody) and _is_pair(constraint):
        # Nought metres from where the other point comes to be, by moving this one alone.
        rows.asked["kind"][c], rows.asked["shares"][c, 0] = goals.DISTANCE, 1.0
        _put_end(rows.asked[c], 1, target.point, constraint.chain, rows.layout)
        rows.asked["freedoms"][c, 1] = 0.0
        return
    rows.asked["kind"][c] = goals.POSITION
    if not rows.put_followed(c, target):
        rows.asked["blends"][c], rows.places[c] = 1, rows.targets.places(target)


def _is_pair(constraint: Constraint) -> bool:
    """Whether a position follows a point of its own body that another limb, or none, carries.

    Then the kernel itself sees to it that it is where the other point comes to be.
    """
    if not isinstance(constraint, PositionConstraint) or not isinstance(constraint.target, FollowBody):
        return False
    limb = limb_of(constraint.point.part)
    return limb >= 0 and constraint.chain.limb > 0.0 and limb_of(constraint.target.point.part) != limb


def _orientation(rows: Rows, c: int, constraint: OrientationConstraint) -> None:
    rows.asked["kind"][c] = goals.ORIENTATION
    if not rows.put_followed(c, constraint.target):
        rows.turns[c] = rows.targets.turns(constraint.target)


def _look_at(rows: Rows, c: int, constraint: LookAtConstraint) -> None:
    rows.asked["kind"][c] = goals.LOOK_AT
    if not rows.put_followed(c, constraint.target):
        rows.places[c] = rows.targets.places(constraint.target)
    rows.asked["limbs"][c, 0] = -1


def _upright(rows: Rows, c: int, constraint: UprightConstraint) -> None:
    rows.asked["kind"][c], rows.asked["offsets"][c, 1] = goals.UPRIGHT, constraint.axis
    rows.places[c], rows.distances[c] = np.array([constraint.direction]), np.array([constraint.cone])


def _distance(rows: Rows, c: int, constraint: DistanceConstraint) -> None:
    row = rows.asked[c]
    row["kind"], rows.distances[c] = goals.DISTANCE, rows.targets.numbers(constraint.distance)
    if isinstance(constraint.other, BodyPoint):
        _put_end(row, 1, constraint.other, constraint.chain, rows.layout)
        # A leg comes to meet a hand only when it is asked for itself: the own thigh stays where it is.
        if row["limbs"][0] < 2 <= row["limbs"][1]:
            row["freedoms"][1] = 0.0
    else:
        rows.places[c] = rows.targets.places(constraint.other)
    free = np.array([row["limbs"][end] >= 0 and row["freedoms"][end, 0] > 0.0 for end in range(2)], dtype=float)
    row["shares"] = free / max(free.sum(), 1.0)


def _balance(rows: Rows, c: int, constraint: BalanceConstraint) -> None:
    """A place of NaN is the motion's own."""
    rows.asked["kind"][c], rows.asked["axes"][c] = goals.BALANCE, 3 if constraint.vertical else 2
    place = constraint.place
    rows.asked["blends"][c] = not rows.put_followed(c, place)
    if isinstance(place, tuple) and len(place) == 2:
        rows.places[c] = rows.targets.masses()
        rows.places[c][:, :2] = place
    elif place is not None and rows.asked["blends"][c]:
        rows.places[c] = rows.targets.places(place)


def _area(rows: Rows, c: int, constraint: AreaConstraint) -> None:
    rows.asked["kind"][c] = goals.AREA
    if not rows.put_followed(c, constraint.centre):
        rows.places[c] = rows.targets.places(constraint.centre)
    if constraint.shape is AreaShape.HALF_SPACE:
        rows.turns[c] = rows.targets.tilts(constraint.heading, constraint.centre, constraint.size)
    else:
        rows.turns[c] = rows.targets.headings(constraint.heading, constraint.centre)
    row = area_row(constraint)
    if len(row) > rows.areas.shape[1]:
        rows.areas = np.pad(rows.areas, ((0, 0), (0, len(row) - rows.areas.shape[1])))
    rows.areas[c, : len(row)] = row


_WRITERS: dict[type[Constraint], Callable[[Rows, int, Any], None]] = {
    PositionConstraint: _position,
    OrientationConstraint: _orientation,
    LookAtConstraint: _look_at,
    UprightConstraint: _upright,
    DistanceConstraint: _distance,
    BalanceConstraint: _balance,
    AreaConstraint: _area,
}


@lru_cache(maxsize=1024)
def _freedoms_of(part: BodyPart, chain: Chain) -> tuple[bool, tuple[float, ...], float]:
    """Whether a chain helps the limb of a part by what carries it, the weights of its bones, and how free it is."""
    limb = limb_of(part)
    if limb < 0:
        return False, (), chain.limb
    carriers, bones = (*TRUNK, CLAVICLES[limb]) if limb < 2 else TRUNK, limb_bones(part)
    parts = tuple(chain.weight(bone) for bone in bones)
    helped = chain.root > 0.0 or any(chain.weight(carrier) > 0.0 for carrier in carriers)
    return helped, parts, max(parts[:1] if part == bones[0] else parts)


@lru_cache(maxsize=1024)
def point_indices(point: BodyPoint, layout: BodyLayout) -> tuple[int, int]:
    """(index of the point an offset counts from, index of the segment in whose axes it stands)."""
    segment = layout.segment(point.part)
    ends = layout.distal_points() if point.at_end else layout.proximal_points()
    return ends[segment], segment


@cache
def limb_of(part: BodyPart) -> int:
    """0, 1 left and right arm, 2, 3 legs, -1 for what is on no limb."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return 0 if side == "left" else 1
    if bone in ("thigh", "shank", "foot", "toe"):
        return 2 if side == "left" else 3
    return -1
