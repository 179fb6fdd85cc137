"""All kinds of constraint, in the order of menus and forms, and those that plug-ins add."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.upright import UprightConstraint

CONSTRAINT_KINDS: dict[str, type[Constraint]] = {
    each.kind: each
    for each in (
        PositionConstraint,
        OrientationConstraint,
        LookAtConstraint,
        UprightConstraint,
        ParallelConstraint,
        DistanceConstraint,
        BalanceConstraint,
        AreaConstraint,
        RailConstraint,
        ClearConstraint,
    )
}


@dataclass(frozen=True)
class ConstraintKind:
    """A kind of constraint that a plug-in adds: its value, and a part for each view of it.

    All parts but the value are functions, so that nothing is loaded before it is needed.
    """

    value: type[Constraint]
    """Frozen dataclass with ``kind``, ``unit`` and ``shown``; fields are plain values, points and targets."""
    task: Callable[[], Any]
    """``() -> SolverKind``: what the solver does for it, by one of its own tasks."""
    make: Callable[[Any], Constraint] | None = None
    """``(here) -> Constraint``: a new one at the picked joint; without it the window adds none."""
    editor: Callable[[], Any] | None = None
    """``() -> type[ConstraintEditor]``: its form; without it, the form that all kinds share."""
    figure: Callable[[Any, Any, float], Any] | None = None
    """``(constraint, pose, floor) -> HandleShape``: its drawing; without it, the value's ``sketch``."""
    target: Callable[[], Any] | None = None
    """``() -> type[Target]``: its handle; without it, one that moves the value named by ``shown.held_by``."""


ADDED_KINDS: dict[str, ConstraintKind] = {}
"""Registrations of plug-ins by kind."""


def is_made(kind: str) -> bool:
    """True if the window can add a constraint of a kind."""
    return kind not in ADDED_KINDS or ADDED_KINDS[kind].make is not None


def add_kind(kind: ConstraintKind) -> ConstraintKind:
    """Register a kind; raises ValueError where there is another one of that name."""
    name = kind.value.kind
    if name in CONSTRAINT_KINDS and ADDED_KINDS.get(name) != kind:
        raise ValueError(f"there is already a constraint of the kind '{name}'.")
    CONSTRAINT_KINDS[name], ADDED_KINDS[name] = kind.value, kind
    return kind
