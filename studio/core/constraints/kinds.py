"""All kinds of constraint, in the order of menus and forms: those of the studio, and those that plug-ins add."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
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


@dataclass(frozen=True)
class ConstraintKind:
    """Kind of constraint, built in or of a plug-in: its value, and a part for each view of it.

    All parts but the value are functions, so that nothing is loaded before it is needed.
    """

    value: type[Constraint]
    """Frozen dataclass with ``kind``, ``unit`` and ``shown``; fields are plain values, points and targets."""
    task: Callable[[], Any]
    """``() -> SolverKind``: what the solver does for it, by one of its own tasks; None where it does it without one."""
    make: Callable[[Any], Constraint] | None = None
    """``(here) -> Constraint``: a new one at the picked joint; without it the window adds none."""
    editor: Callable[[], Any] | None = None
    """``() -> type[ConstraintEditor]``: its form; without it, the form that all kinds share."""
    figure: Callable[[Any, Any, float], Any] | None = None
    """``(constraint, pose, floor) -> HandleShape``: its drawing; without it, the value's ``sketch``."""
    target: Callable[[], Any] | None = None
    """``() -> type[Target]``: its handle; without it, one that moves the value named by ``shown.held_by``."""


def _part(module: str, name: str) -> Callable[[], Any]:
    """Function that returns ``name`` of a module of the studio, which is imported when it is called."""
    return lambda: getattr(import_module(f"studio.{module}"), name)


def _built_in(
    value: type[Constraint], *, solved: bool = True, drawn: bool = False, target: str | None = None
) -> ConstraintKind:
    """Built-in kind, whose parts bear its name: ``solved`` by a task, ``drawn`` by a figure of its own, moved by the
    class ``target``.
    """
    kind = value.kind
    make, figure = _part("viewport.new_constraints", f"new_{kind}"), _part("viewport.handle_figures", f"{kind}_figure")
    return ConstraintKind(
        value,
        _part(f"core.solver.asking.kinds.{kind}", f"{kind.upper()}_KIND") if solved else lambda: None,
        lambda here: make()(here),
        _part(f"panels.constraint_editors.{kind}", value.__name__.replace("Constraint", "Editor")),
        (lambda constraint, pose, floor: figure()(constraint, pose, floor)) if drawn else None,
        _part("viewport.rotated_targets", target) if target else None,
    )


BUILT_IN_KINDS = (
    _built_in(PositionConstraint, drawn=True),
    _built_in(OrientationConstraint, drawn=True, target="RotatedSegment"),
    _built_in(LookAtConstraint, drawn=True, target="RotatedLookAt"),
    _built_in(UprightConstraint, target="RotatedDirection"),
    _built_in(ParallelConstraint, drawn=True),
    _built_in(DistanceConstraint, drawn=True),
    _built_in(BalanceConstraint, drawn=True),
    _built_in(AreaConstraint, drawn=True, target="RotatedArea"),
    _built_in(RailConstraint, target="RotatedRail"),
    _built_in(ClearConstraint, solved=False, drawn=True),
)
CONSTRAINT_KINDS: dict[str, ConstraintKind] = {each.value.kind: each for each in BUILT_IN_KINDS}
"""All kinds by name."""


def add_kind(kind: ConstraintKind) -> ConstraintKind:
    """Register a kind; raises ValueError if the name is taken."""
    name = kind.value.kind
    if CONSTRAINT_KINDS.setdefault(name, kind) != kind:
        raise ValueError(f"there is already a constraint of the kind '{name}'.")
    return kind
