"""What a gizmo can move: a constraint's place, a prop. Each knows its axes and tells the document."""

from dataclasses import replace
from typing import Protocol

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.constraints.keyed import KeyedPlace
from studio.core.constraints.own_place import OwnPlace
from studio.core.placement import Placement
from studio.core.project import Prop
from studio.document.document import Document
from studio.engine.moments import HELD_BY, Moment
from studio.viewport.camera import FloatArray
from studio.viewport.handle_places import handle_place, is_flat

HANDLES = {"distance": "other end", "area": "centre", "balance": "place"}
"""What the handle of a kind is called; of the others it is the target."""


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

    def put_back(self, gesture: int) -> None:
        """Put it as it was when this was made."""


class Target:
    """The place by which a constraint is held, as a performer on a ``floor`` sees it at a moment."""

    def __init__(self, document: Document, constraint_id: str, moment: Moment, floor: float) -> None:
        self._document, self._id, self._moment, self._floor = document, constraint_id, moment, floor
        self.placement, self._begin = moment.pose.clip_placement, self._constraint

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
        now = self._moment.fixed(self._constraint)
        return np.array(handle_place(now, self._floor) if now else None)

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put it at ``place``."""
        old = self._constraint
        x, y, z = place.tolist()
        text = f"{'Key' if is_keyed(old) else 'Move'} {self._words}"
        self._document.replace("constraints", self._id, self._moment.moved(self._begin, (x, y, z)), text, gesture)

    @property
    def _words(self) -> str:
        """What is dragged: ``target of Right wrist``, ``centre of Table``; of whom, where that one has its own."""
        place, whom = getattr(self._begin, HELD_BY[self._begin.kind]), self._moment.performer_id
        own = isinstance(place, OwnPlace) and whom in dict(place.own)
        what = HANDLES.get(self._begin.kind, "target")
        return f"{what} of {self._begin.name}" + (f" for {self._moment.pose.performer.name}" if own else "")

    def put_back(self, gesture: int) -> None:
        """As it was: without the key that a drag has set."""
        self._document.replace("constraints", self._id, self._begin, f"Move {self._words}", gesture)


class PlacedProp:
    """A prop on the stage."""

    flat = False

    def __init__(self, document: Document, prop_id: str) -> None:
        self._document, self._id = document, prop_id
        self.placement, self._begin = Placement(), self._prop

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

    def put_back(self, gesture: int) -> None:
        """Where it was."""
        self._document.replace("props", self._id, self._begin, f"Move {self._begin.name}", gesture)


def selected_movable(document: Document, moment: Moment | None, floor: float) -> Movable | None:
    """What the gizmo stands on: the current selection, if it can be moved."""
    collection, entity_id = document.selection.current or ("", "")
    if collection == "props" and entity_id in document.project.props:
        return PlacedProp(document, entity_id)
    constraint = document.project.constraints.get(entity_id) if collection == "constraints" else None
    now = moment.fixed(constraint) if constraint and moment else None
    if moment is None or now is None or handle_place(now) is None:
        return None
    return Target(document, entity_id, moment, floor)


def is_keyed(constraint: Constraint) -> bool:
    """Whether the place by which it is held is keyed, so that a drag sets a key."""
    return isinstance(getattr(constraint, HELD_BY.get(constraint.kind, ""), None), KeyedPlace)
