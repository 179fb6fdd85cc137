"""Table of the kinds of constraint: a new one is a file beside this one and a line here, or that of a plug-in."""

from collections.abc import Mapping

from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.kinds import ADDED_KINDS
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.solver.asking.kinds.area import AREA_KIND
from studio.core.solver.asking.kinds.balance import BALANCE_KIND
from studio.core.solver.asking.kinds.distance import DISTANCE_KIND
from studio.core.solver.asking.kinds.kind import SolverKind
from studio.core.solver.asking.kinds.look_at import LOOK_AT_KIND
from studio.core.solver.asking.kinds.orientation import ORIENTATION_KIND
from studio.core.solver.asking.kinds.parallel import PARALLEL_KIND
from studio.core.solver.asking.kinds.position import POSITION_KIND
from studio.core.solver.asking.kinds.rail import RAIL_KIND
from studio.core.solver.asking.kinds.upright import UPRIGHT_KIND

SOLVER_KINDS: Mapping[type[Constraint], SolverKind] = {
    PositionConstraint: POSITION_KIND,
    OrientationConstraint: ORIENTATION_KIND,
    LookAtConstraint: LOOK_AT_KIND,
    UprightConstraint: UPRIGHT_KIND,
    DistanceConstraint: DISTANCE_KIND,
    BalanceConstraint: BALANCE_KIND,
    AreaConstraint: AREA_KIND,
    RailConstraint: RAIL_KIND,
    ParallelConstraint: PARALLEL_KIND,
}
KIND_BY_CODE = {kind.code: kind for kind in SOLVER_KINDS.values()}
"""Kinds by their numbers in the kernels; those that share a number share their trajectory."""
ENTERING_KINDS = [kind.code for kind in SOLVER_KINDS.values() if kind.enters]


def solver_kind_of(constraint: Constraint) -> SolverKind | None:
    """The solver's part of a constraint's kind, one of a plug-in too; None where the kernels have no task for it."""
    added = ADDED_KINDS.get(constraint.kind)
    return added.task() if added is not None else SOLVER_KINDS.get(type(constraint))
