"""Targets of constraints: fixed (plain numbers), keyed, procedural, per character, or following an object."""

from dataclasses import replace

from studio.core.constraints.base import Constraint, Vector, finite_vector
from studio.core.constraints.follow import FOLLOWS, Follow, FollowBody
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.curves.keyed import KeyedPlace, KeyedTurn, Keys, Quaternion, unit_quaternion

Place = Vector | KeyedPlace | KeyedOwnPlace | ProceduralPlace | OwnPlace | Follow
"""Position in motion space in metres, before the performer's placement on the stage."""
Turn = Quaternion | KeyedTurn | Follow
"""Rotation in motion space."""


def checked_place(place: object, constraint: Constraint, what: str) -> Place:
    """``place`` as a valid position. Raises ValueError, which names the constraint and ``what``."""
    if isinstance(place, KeyedPlace | KeyedOwnPlace | ProceduralPlace | OwnPlace | Follow):
        if isinstance(place, FollowBody) and place.point == constraint.point:
            raise ValueError(f"'{constraint.name}': a point cannot follow itself. Choose another point.")
        return place
    return finite_vector(place, f"'{constraint.name}': {what}")


def checked_turn(turn: object, constraint: Constraint) -> Turn:
    """``turn`` as a valid rotation. Raises ValueError, which names the constraint."""
    if isinstance(turn, KeyedTurn | Follow):
        if isinstance(turn, FollowBody) and turn.point.part == constraint.point.part:
            raise ValueError(f"'{constraint.name}': a segment cannot follow itself. Choose another segment.")
        return turn
    try:
        return unit_quaternion(turn)  # type: ignore[arg-type]
    except ValueError as error:
        raise ValueError(f"'{constraint.name}': the target is not a rotation: {error}") from error


def follows_of(constraint: Constraint) -> list[Follow]:
    """All followed targets of a constraint."""
    return [value for value in vars(constraint).values() if isinstance(value, FOLLOWS)]


def own_places_of(constraint: Constraint) -> list[OwnPlace]:
    """All per-character positions of a constraint, with those that are origins of keyed or procedural positions."""
    return [own for value in vars(constraint).values() if (own := own_place_of(value)) is not None]


def own_place_of(target: object) -> OwnPlace | None:
    """Per-character position that is the target or its origin; None for a target shared by all characters."""
    own = target if isinstance(target, OwnPlace) else getattr(target, "origin", None)
    return own if isinstance(own, OwnPlace) else None


def with_own_place(target: Place, own: OwnPlace) -> Place:
    """``target`` with its per-character position or origin replaced by ``own``."""
    return replace(target, origin=own) if isinstance(target, KeyedOwnPlace | ProceduralPlace) else own


def key_times(constraint: Constraint) -> tuple[float, ...]:
    """Times in seconds of all keys of a constraint, ascending."""
    keyed = (value for value in vars(constraint).values() if isinstance(value, Keys))
    return tuple(sorted({time for value in keyed for time in value.times}))


def is_moving(constraint: Constraint) -> bool:
    """True if the target of a constraint differs between frames."""
    own_height = getattr(constraint, "vertical", False)
    return own_height or any(hasattr(value, "kind") for value in vars(constraint).values())
