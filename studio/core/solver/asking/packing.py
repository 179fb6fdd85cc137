"""Constraints as the arrays that the solver's kernels take: in order of priority, one row each."""

from collections.abc import Sequence

import numpy as np

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import THIGHS, UPPER_ARMS, Chain, Constraint
from studio.core.kernels.tasks.task import TASK
from studio.core.solver.asking.kinds.known import KINDS
from studio.core.solver.asking.rows import BLANK, NO_DISTANCE, NO_PLACE, NO_TURN, Rows, row_of
from studio.core.solver.asking.tracks import Targets

_PLACES = {part: place for place, part in enumerate(BodyPart)}


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
        BLANK.tobytes() if isinstance(each, BalanceConstraint) else row_of(each.point, each.chain, layout)
        for each in constraints
    ]
    rows = Rows(
        layout,
        targets,
        ranks,
        asked=np.frombuffer(bytearray(b"".join(begun)), dtype=TASK),  # whole: NumPy copies records field by field
        areas=np.zeros((count, 10)),
        places=[NO_PLACE] * count,
        turns=[NO_TURN] * count,
        distances=[NO_DISTANCE] * count,
    )
    rows.asked["level"], rows.asked["weight"] = ranks, [constraint.weight for constraint in constraints]
    for c, constraint in enumerate(constraints):
        kind = KINDS.get(type(constraint))
        if kind is None:
            raise TypeError(f"'{constraint.name}': the solver has no kind '{constraint.kind}'.")
        rows.asked["kind"][c] = kind.code
        kind.put(rows, c, constraint)
    for c, constraint in enumerate(constraints):
        if constraint.chain.free_arms or constraint.chain.free_legs:
            _blend_what_takes_limbs(rows, c, constraint.chain)
    return rows


def _levels(constraints: Sequence[Constraint], contacts: int) -> tuple[int, ...]:
    """The level of each, 0 the highest."""
    priorities = [-1] * contacts + [constraint.priority for constraint in constraints[contacts:]]
    ranks = {priority: rank for rank, priority in enumerate(sorted(set(priorities)))}
    return tuple(ranks[priority] for priority in priorities)


def _blend_what_takes_limbs(rows: Rows, c: int, chain: Chain) -> None:
    """Blend whatever is asked below a balance of a limb that it turns: that is not in the motion's own pose."""
    recruited = [limb for limb, part in enumerate((*UPPER_ARMS, *THIGHS)) if chain.recruited(part) > 0.0]
    below = rows.asked["level"] > rows.asked["level"][c]
    rows.asked["blends"] |= below & np.isin(rows.asked["limbs"], recruited).any(axis=1)
