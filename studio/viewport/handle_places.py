"""The place by which a constraint is held and dragged, by its kind."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from studio.core.constraints.base import BodyPoint, Constraint, Vector

Read = Callable[[Any, float], Vector | None]
Write = Callable[[Any, Vector], Constraint]


def handle_place(constraint: Constraint, floor: float = 0.0) -> Vector | None:
    """Where the handle is, metres in the motion's space over a ground ``floor`` high; None: it has no place."""
    read, _ = _PLACES.get(constraint.kind, _NOWHERE)
    return read(constraint, floor)


def with_handle_place(constraint: Constraint, place: Vector) -> Constraint:
    """The constraint with its handle at ``place``; the same where it has none."""
    if handle_place(constraint) is None:
        return constraint
    return _PLACES[constraint.kind][1](constraint, place)


def is_flat(constraint: Constraint) -> bool:
    """Whether the handle stays on the ground."""
    return constraint.kind == "balance"


_NOWHERE: tuple[Read, Write] = (lambda constraint, floor: None, lambda constraint, place: constraint)
_TARGET: tuple[Read, Write] = (
    lambda constraint, floor: constraint.target,
    lambda constraint, place: replace(constraint, target=place),
)
_PLACES: dict[str, tuple[Read, Write]] = {
    "position": _TARGET,
    "look_at": _TARGET,
    "distance": (
        lambda constraint, floor: None if isinstance(constraint.other, BodyPoint) else constraint.other,
        lambda constraint, place: replace(constraint, other=place),
    ),
    "area": (
        lambda constraint, floor: constraint.centre,
        lambda constraint, place: replace(constraint, centre=place),
    ),
    "balance": (
        lambda constraint, floor: None if constraint.place is None else (*constraint.place, floor),
        lambda constraint, place: replace(constraint, place=place[:2]),
    ),
}
