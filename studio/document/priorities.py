"""Edits of the priorities of a motion's constraints."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise

from studio.core.constraints.base import Constraint
from studio.document.document import Document


def shared_priorities(constraints: Mapping[str, Constraint], order: Sequence[str]) -> list[bool]:
    """True for each constraint of the ``order`` that has the same priority as the one before it."""
    return [False, *(constraints[above].priority == constraints[below].priority for above, below in pairwise(order))]


def shared_priorities_after_move(
    constraints: Mapping[str, Constraint], order: Sequence[str], moved: Collection[str]
) -> list[bool]:
    """``shared_priorities`` of the ``order`` to which the ``moved`` constraints were moved.

    Between two others of equal priority they get that priority too; among themselves they share one only if they did
    before.
    """
    others = [key for key in order if key not in moved]
    shared = {below for below, tied in zip(others, shared_priorities(constraints, others), strict=True) if tied}
    below = dict[str, str | None]()
    following: str | None = None
    for key in reversed(order):
        below[key] = following = following if key in moved else key
    return [False] + [
        constraints[one].priority == constraints[two].priority
        if (one in moved) == (two in moved)
        else below[two] in shared
        for one, two in pairwise(order)
    ]


def put_priorities(document: Document, order: Sequence[str], ties: Sequence[bool], text: str) -> None:
    """Give constraints the priorities of an ``order`` in one undo step; a True in ``ties`` shares the priority of the
    one before. Raises StudioError for conflicting constraints.
    """
    with document.group(text):
        for key, priority in zip(order, accumulate(int(not tied) for tied in ties), strict=True):
            constraint = document.project.constraints[key]
            document.replace("constraints", key, replace(constraint, priority=priority - 1), text)


def shift_priorities(document: Document, constraint_ids: Collection[str], step: int) -> bool:
    """Move constraints together up (``step`` -1) or down (1) by one in the order of their motion, in one undo step.

    Returns False if none of them can move.
    """
    project, orders = document.project, list[list[str]]()
    for motion_id in dict.fromkeys(project.constraints[key].motion_id for key in constraint_ids):
        before = list(project.constraints_of(motion_id))
        after = before if step < 0 else before[::-1]
        for index in range(1, len(after)):
            if after[index] in constraint_ids and after[index - 1] not in constraint_ids:
                after = [*after[: index - 1], after[index], after[index - 1], *after[index + 1 :]]
        order = after if step < 0 else after[::-1]
        if order != before:
            orders.append(order)
    names = [document.shown_project.constraints[key].name for key in constraint_ids]
    text = f"Reorder priority of {names[0] if len(names) == 1 else f'{len(names)} constraints'}"
    with document.group(text):
        for order in orders:
            put_priorities(
                document, order, shared_priorities_after_move(project.constraints, order, constraint_ids), text
            )
    return bool(orders)
