"""What a gizmo can move: a constraint's target, a prop. Each knows its axes and tells the document."""

from dataclasses import replace
from typing import Protocol

import numpy as np

from studio.core.constraints.position import PositionConstraint
from studio.core.project import Prop
from studio.document.document import Document
from studio.viewport.camera import FloatArray
from studio.viewport.performance import Placement


class Movable(Protocol):
    """A thing with a place in its own axes."""

    placement: Placement

    @property
    def place(self) -> FloatArray:
        """(3,) where it is, in its own space."""

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put it at ``place`` (3,), as a part of a gesture."""


class Target:
    """The target of a position constraint, as the performer at ``placement`` sees it."""

    def __init__(self, document: Document, constraint_id: str, placement: Placement) -> None:
        self._document, self._id, self.placement = document, constraint_id, placement

    @property
    def _constraint(self) -> PositionConstraint:
        constraint = self._document.project.constraints[self._id]
        assert isinstance(constraint, PositionConstraint)
        return constraint

    @property
    def place(self) -> FloatArray:
        """(3,) in the space of the motion."""
        return np.array(self._constraint.target)

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put the target at ``place``."""
        old = self._constraint
        new = replace(old, target=tuple(place.tolist()))
        self._document.replace("constraints", self._id, new, f"Move target of {old.name}", gesture)


class PlacedProp:
    """A prop on the stage."""

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


def selected_movable(document: Document, placement: Placement) -> Movable | None:
    """What the gizmo stands on: the current selection, if it can be moved."""
    collection, entity_id = document.selection.current or ("", "")
    if collection == "props" and entity_id in document.project.props:
        return PlacedProp(document, entity_id)
    constraint = document.project.constraints.get(entity_id) if collection == "constraints" else None
    return Target(document, entity_id, placement) if isinstance(constraint, PositionConstraint) else None
