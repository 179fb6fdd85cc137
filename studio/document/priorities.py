"""Edits of the priorities of a motion's constraints."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise

from studio.core.constraints.base import Constraint
from studio.document.document import Document


def ties_of(constraints: Mapping[str, Constraint], order: Sequence[str]) -> list[bool]:
    """True for each constraint that has the priority of the one before it."""
    return [False, *(constraints[above].priority == constraints[below].priority for above, below in pairwise(order))]


def ties_with_moved(constraints: Mapping[str, Constraint], order: Sequence[str], moved: str) -> list[bool]:
    """``ties_of`` after one constraint was moved in the order: between two of equal priority it joins them."""
    place = order.index(moved)
    ties = ties_of(constraints, [key for key in order if key != moved])
    between = 0 < place < len(ties) and ties[place]
    return [*ties[:place], between, *ties[place:]] if len(order) > 1 else [False]


def put_priorities(document: Document, order: Sequence[str], ties: Sequence[bool], text: str) -> None:
    """Give constraints the priorities of an order; one undo step. Raises StudioError for conflicting constraints."""
    with document.group(text):
        for key, priority in zip(order, accumulate(int(not tied) for tied in ties), strict=True):
            constraint = document.project.constraints[key]
            document.replace("constraints", key, replace(constraint, priority=priority - 1), text)


def shift_priority(document: Document, constraint_id: str, step: int) -> None:
    """Move a constraint one place up (-1) or down (1) in the order of its motion."""
    constraint = document.project.constraints[constraint_id]
    constraints = document.project.constraints_of(constraint.motion_id)
    order = list(constraints)
    place = order.index(constraint_id)
    goal = min(max(place + step, 0), len(order) - 1)
    order.insert(goal, order.pop(place))
    if goal != place:
        ties = ties_with_moved(constraints, order, constraint_id)
        name = document.shown_project.constraints[constraint_id].name
        put_priorities(document, order, ties, f"Reorder priority of {name}")
