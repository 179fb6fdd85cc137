"""The kinds of constraint that the solver knows: a new one is a file beside this one and a line here."""

from collections.abc import Mapping

from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.solver.asking.kinds.area import AREA
from studio.core.solver.asking.kinds.balance import BALANCE
from studio.core.solver.asking.kinds.distance import DISTANCE
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.kinds.look_at import LOOK_AT
from studio.core.solver.asking.kinds.orientation import ORIENTATION
from studio.core.solver.asking.kinds.position import POSITION
from studio.core.solver.asking.kinds.upright import UPRIGHT

KINDS: Mapping[type[Constraint], Kind] = {
    PositionConstraint: POSITION,
    OrientationConstraint: ORIENTATION,
    LookAtConstraint: LOOK_AT,
    UprightConstraint: UPRIGHT,
    DistanceConstraint: DISTANCE,
    BalanceConstraint: BALANCE,
    AreaConstraint: AREA,
}
BY_CODE = {kind.code: kind for kind in KINDS.values()}
"""The same by what the kernels know each by."""
ENTERING = [kind.code for kind in KINDS.values() if kind.enters]
