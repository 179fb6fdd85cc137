"""Constraints packed for the solver's kernels: one task record each, in order of priority."""

from collections.abc import Sequence

import numpy as np

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import THIGHS, UPPER_ARMS, Chain, Constraint
from studio.core.kernels.tasks.area_shapes import AREA_NUMBERS
from studio.core.kernels.tasks.task import TASK
from studio.core.solver.task_assembly.kinds.known import solver_kind_of
from studio.core.solver.task_assembly.task_rows import (
    BLANK_TASK,
    NO_DISTANCE,
    NO_POSITION,
    NO_ROTATION,
    TaskRecords,
    point_task_record,
)
from studio.core.solver.task_assembly.tracks import Targets

_PLACES = {part: place for place, part in enumerate(BodyPart)}


def priority_order(constraints: Sequence[Constraint]) -> list[int]:
    """Indices of ``constraints`` in order of priority; the order among equals does not depend on their creation."""
    return sorted(
        range(len(constraints)), key=lambda c: (constraints[c].priority, *_order_among_equals(constraints[c]))
    )


def _order_among_equals(constraint: Constraint) -> tuple[object, ...]:
    """Sort key of constraints with the same priority: hands before elbows, feet before knees."""
    point = constraint.point
    return -_PLACES[point.part], not point.at_end, constraint.kind, point.offset, constraint.name


def pack_tasks(
    constraints: Sequence[Constraint], layout: BodyLayout, targets: Targets, contacts: int = 0
) -> TaskRecords:
    """Task records of ``constraints``, given in order of priority.

    The first ``contacts`` of them have higher levels than all others. Raises TypeError for an unknown kind.
    """
    count, levels = len(constraints), levels_by_priority(constraints, contacts)
    begun = [
        BLANK_TASK.tobytes()
        if isinstance(each, BalanceConstraint)
        else point_task_record(each.point, each.chain, layout)
        for each in constraints
    ]
    rows = TaskRecords(
        layout,
        targets,
        levels,
        tasks=np.frombuffer(bytearray(b"".join(begun)), dtype=TASK),  # whole: NumPy copies records field by field
        areas=np.zeros((count, AREA_NUMBERS)),
        positions=[NO_POSITION] * count,
        rotations=[NO_ROTATION] * count,
        distances=[NO_DISTANCE] * count,
        weights=[constraint.weights_at(targets.times) for constraint in constraints],
    )
    rows.tasks["level"] = levels
    for c, constraint in enumerate(constraints):
        kind = solver_kind_of(constraint)
        if kind is None:
            raise TypeError(f"'{constraint.name}': the solver has no kind '{constraint.kind}'.")
        rows.tasks["kind"][c] = kind.code
        kind.write_task(rows, c, constraint)
    for c, constraint in enumerate(constraints):
        if constraint.chain.free_arms or constraint.chain.free_legs:
            _blend_tasks_on_redundant_limbs(rows, c, constraint.chain)
    return rows


def levels_by_priority(constraints: Sequence[Constraint], contacts: int) -> tuple[int, ...]:
    """Level of each constraint, 0 the highest: contacts first, then one level for each priority, in order."""
    priorities = [-1] * contacts + [constraint.priority for constraint in constraints[contacts:]]
    levels = {priority: rank for rank, priority in enumerate(sorted(set(priorities)))}
    return tuple(levels[priority] for priority in priorities)


def _blend_tasks_on_redundant_limbs(rows: TaskRecords, c: int, chain: Chain) -> None:
    """Blend the transitions of tasks on limbs that a balance ``c`` above them rotates.

    Their unsolved pose is not the motion's own pose.
    """
    recruited = [limb for limb, part in enumerate((*UPPER_ARMS, *THIGHS)) if chain.recruited(part) > 0.0]
    below = rows.tasks["level"] > rows.tasks["level"][c]
    rows.tasks["blends"] |= below & np.isin(rows.tasks["limbs"], recruited).any(axis=1)
