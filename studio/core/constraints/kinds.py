"""Registry of all kinds of constraint, in the order of menus and forms: built-in ones and those that plug-ins add."""

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
    """Kind of constraint, built in or of a plug-in: its record class, and functions that load its solver task and
    views.

    Functions are used so that nothing is imported before it is needed.
    """

    value: type[Constraint]
    """Frozen dataclass with ``kind``, ``unit`` and ``shown``; fields are plain values, points and targets."""
    task: Callable[[], Any]
    """``() -> SolverKind``: its task in the solver. A function that returns None is for a kind without a task of its
    own.
    """
    make: Callable[[Any], Constraint] | None = None
    """``(here) -> Constraint``: makes one at the picked joint; None if the window adds none."""
    editor: Callable[[], Any] | None = None
    """``() -> type[ConstraintEditor]``: its form; None for the form that all kinds share."""
    figure: Callable[[Any, Any, float], Any] | None = None
    """``(constraint, pose, floor) -> HandleShape``: its drawing; None for the ``sketch`` of the constraint."""
    target: Callable[[], Any] | None = None
    """``() -> type[Target]``: its handle; None for a handle that moves the field named by ``shown.held_by``."""


def _part(module: str, name: str) -> Callable[[], Any]:
    """Function that imports ``module`` of the studio when it is called, and returns its attribute ``name``."""
    return lambda: getattr(import_module(f"studio.{module}"), name)


def _built_in(
    value: type[Constraint], *, solved: bool = True, drawn: bool = False, target: str | None = None
) -> ConstraintKind:
    """Built-in kind, whose modules and classes are found by its name.

    ``solved`` is True if it has a task of its own, ``drawn`` if it has a figure; ``target`` names the class of its
    handle.
    """
    kind = value.kind
    make, figure = _part("viewport.new_constraints", f"new_{kind}"), _part("viewport.handle_figures", f"{kind}_figure")
    return ConstraintKind(
        value,
        _part(f"core.solver.task_assembly.kinds.{kind}", f"{kind.upper()}_KIND") if solved else lambda: None,
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
    """Register a kind and return it. Raises ValueError if its name is taken."""
    name = kind.value.kind
    if CONSTRAINT_KINDS.setdefault(name, kind) != kind:
        raise ValueError(f"there is already a constraint of the kind '{name}'.")
    return kind
