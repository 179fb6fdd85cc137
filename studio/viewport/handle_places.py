"""Position of the handle by which a constraint is dragged, by kind."""

from studio.core.constraints.base import Constraint, Vector


def handle_position(constraint: Constraint, floor: float = 0.0) -> Vector | None:
    """Position (3,) of a constraint's handle in motion space, metres, over a ground ``floor`` metres high; None if it
    has no handle.

    The constraint's targets must be fixed (``TargetContext.with_targets_fixed``).
    """
    place = getattr(constraint, constraint.shown.held_by, None)
    if not isinstance(place, tuple):
        return None
    return (place[0], place[1], floor) if is_flat(constraint) else (place[0], place[1], place[2])


def is_flat(constraint: Constraint) -> bool:
    """True if the handle stays on the ground."""
    place = getattr(constraint, "place", None)
    lies = isinstance(place, tuple) and len(place) == 2
    return constraint.kind == "balance" and (lies or not getattr(constraint, "vertical", False))
