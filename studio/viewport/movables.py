"""What a gizmo can move: a constraint's place, a prop. Each knows its axes and tells the document."""

from dataclasses import replace
from typing import Protocol

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.placement import Placement
from studio.core.project import Prop
from studio.document.document import Document
from studio.viewport.camera import FloatArray
from studio.viewport.handle_places import handle_place, is_flat, with_handle_place


class Movable(Protocol):
    """A thing with a place in its own axes."""

    placement: Placement

    @property
    def flat(self) -> bool:
        """Whether it stays on the ground."""

    @property
    def place(self) -> FloatArray:
        """(3,) where it is, in its own space."""

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put it at ``place`` (3,), as a part of a gesture."""


class Target:
    """The place by which a constraint is held, as the performer at ``placement`` on a ``floor`` sees it."""

    def __init__(self, document: Document, constraint_id: str, placement: Placement, floor: float) -> None:
        self._document, self._id, self.placement, self._floor = document, constraint_id, placement, floor

    @property
    def _constraint(self) -> Constraint:
        return self._document.project.constraints[self._id]

    @property
    def flat(self) -> bool:
        """Whether it stays on the ground."""
        return is_flat(self._constraint)

    @property
    def place(self) -> FloatArray:
        """(3,) in the space of the motion."""
        return np.array(handle_place(self._constraint, self._floor))

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put it at ``place``."""
        old = self._constraint
        x, y, z = place.tolist()
        new = with_handle_place(old, (x, y, z))
        self._document.replace("constraints", self._id, new, f"Move target of {old.name}", gesture)


class PlacedProp:
    """A prop on the stage."""

    flat = False

    def __init__(self, document: Document, prop_id: str) -> None:
        self._document, self._id = document, prop_id
        self.placement = Placement()

    @property
    def _prop(self) -> Prop:
        return self._document.project.props[self._id]

    @property
    def place(self) -> FloatArray:
        """(3,) centre on the stage."""
        return np.array(self._prop.position)

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put its centre at ``place``."""
        new = replace(self._prop, position=tuple(place.tolist()))
        self._document.replace("props", self._id, new, f"Move {self._prop.name}", gesture)


def selected_movable(document: Document, placement: Placement, floor: float) -> Movable | None:
    """What the gizmo stands on: the current selection, if it can be moved."""
    collection, entity_id = document.selection.current or ("", "")
    if collection == "props" and entity_id in document.project.props:
        return PlacedProp(document, entity_id)
    constraint = document.project.constraints.get(entity_id) if collection == "constraints" else None
    if constraint is None or handle_place(constraint) is None:
        return None
    return Target(document, entity_id, placement, floor)
