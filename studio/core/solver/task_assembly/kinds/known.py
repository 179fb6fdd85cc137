"""Solver's part of each kind of constraint, found by its registration."""

from studio.core.constraints.base import Constraint
from studio.core.constraints.kinds import BUILT_IN_KINDS, CONSTRAINT_KINDS
from studio.core.solver.task_assembly.kinds.kind import SolverKind

SOLVER_KINDS: list[SolverKind] = [task for kind in BUILT_IN_KINDS if (task := kind.task()) is not None]
"""All kinds of constraint for which the kernels have a task."""
KIND_BY_CODE = {kind.code: kind for kind in SOLVER_KINDS}
"""Kinds by their numbers in the kernels; kinds that share a number share their trajectory."""
ENTERING_KINDS = [kind.code for kind in SOLVER_KINDS if kind.enters]
"""Numbers of the kinds that are active only inside a region."""


def solver_kind_of(constraint: Constraint) -> SolverKind | None:
    """``SolverKind`` of a constraint; None if the kernels have no task for it.

    Raises TypeError for a kind that is not registered.
    """
    registered = CONSTRAINT_KINDS.get(constraint.kind)
    if registered is None:
        raise TypeError(f"'{constraint.name}': the solver has no kind '{constraint.kind}'.")
    kind: SolverKind | None = registered.task()
    return kind
