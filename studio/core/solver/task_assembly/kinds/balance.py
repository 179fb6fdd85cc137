"""Balance tasks: the centre of mass over a target."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import BalanceConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.grounding.support_polygon import mass_path
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.posed_points import target_positions
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask, trajectory_to
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: BalanceConstraint) -> None:
    """Write record ``c`` of a balance constraint: its target, NaN where the motion's own centre of mass is kept."""
    rows.tasks["axes"][c] = 3 if constraint.vertical else 2
    place = constraint.place
    rows.tasks["blends"][c] = not rows.set_followed_point(c, place)
    if isinstance(place, tuple) and len(place) == 2:
        rows.positions[c] = rows.targets.masses()
        rows.positions[c][:, :2] = place
    elif place is not None and rows.tasks["blends"][c]:
        rows.positions[c] = rows.targets.positions(place)


def residual(constraint: BalanceConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Distance (F,) in metres from the centre of mass to its target; horizontal unless its height counts."""
    target = np.array(targets.masses())
    if isinstance(constraint.place, tuple) and len(constraint.place) == 2:
        target[:, :2] = constraint.place
    elif constraint.place is not None:
        target = target_positions(constraint.place, targets, adapted)
    axes = 3 if constraint.vertical else 2
    away = mass_path(adapted.positions[:], adapted.morphology) - target
    return np.asarray(np.linalg.norm(away[:, :axes], axis=1))


def trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory from the unsolved centre of mass."""
    return trajectory_to(unsolved.target_positions, mass_path(unsolved.positions, unsolved.body))


BALANCE_KIND = SolverKind(goals.BALANCE_TASK, write_task, trajectory, residual)
