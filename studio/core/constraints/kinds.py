"""All kinds of constraint, in the order of menus and forms."""

from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint

CONSTRAINT_KINDS: dict[str, type[Constraint]] = {
    each.kind: each
    for each in (
        PositionConstraint,
        OrientationConstraint,
        LookAtConstraint,
        UprightConstraint,
        DistanceConstraint,
        BalanceConstraint,
        AreaConstraint,
        ClearConstraint,
    )
}
