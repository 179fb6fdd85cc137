"""What a gizmo can move: a constraint's place, a prop, a performer. Each knows its axes and tells the document."""

import math
from dataclasses import replace
from typing import Protocol

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.constraints.keyed import KeyedPlace
from studio.core.constraints.own_place import OwnPlace
from studio.core.placement import Placement
from studio.core.project import Performer, Prop
from studio.document.document import Document
from studio.engine.moments import HELD_BY, Moment
from studio.engine.performance import Posed
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
    def turns(self) -> bool:
        """Whether it can be turned about Z."""

    @property
    def yields(self) -> bool:
        """Whether joints that lie under its handles are taken hold of first."""

    @property
    def place(self) -> FloatArray:
        """(3,) where it is, in its own space."""

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put it at ``place`` (3,), as a part of a gesture."""

    def turn(self, angle: float, gesture: int) -> None:
        """Turn it by ``angle`` radians from how it was when this was made; where it can be."""

    def put_back(self, gesture: int) -> None:
        """Put it as it was when this was made."""


class Target:
    """The place by which a constraint is held, as a performer on a ``floor`` sees it at a moment."""

    turns = yields = False

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

    def turn(self, angle: float, gesture: int) -> None:
        """A place has no turn."""

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

    flat, turns, yields = False, True, False

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

    def turn(self, angle: float, gesture: int) -> None:
        """Turn it about its centre."""
        new = replace(self._begin, heading=wrapped(self._begin.heading + angle))
        self._document.replace("props", self._id, new, f"Turn {self._prop.name}", gesture)

    def put_back(self, gesture: int) -> None:
        """Where it was."""
        self._document.replace("props", self._id, self._begin, f"Move {self._begin.name}", gesture)


class PlacedPerformer:
    """A performer, held at the ground under its root: all that it plays goes along."""

    flat = turns = yields = True

    def __init__(self, document: Document, performer_id: str, pose: Posed, floor: float) -> None:
        self._document, self._id, self._pose = document, performer_id, pose
        self.placement, self._begin = Placement(), document.project.performers[performer_id]
        self._floor = floor

    @property
    def place(self) -> FloatArray:
        """(3,) on the ground of the stage."""
        return np.array([*self._pose.points[0, :2], self._floor])

    def move(self, place: FloatArray, gesture: int) -> None:
        """Stand where its root is over ``place``."""
        x, y = (np.array(self._begin.position) + (place - self.place)[:2]).tolist()
        self._put(replace(self._begin, position=(x, y)), "Move", gesture)

    def turn(self, angle: float, gesture: int) -> None:
        """Turn about where its root is now."""
        pivot, (c, s) = self.place[:2], (math.cos(angle), math.sin(angle))
        x, y = (pivot + np.array([[c, -s], [s, c]]) @ (np.array(self._begin.position) - pivot)).tolist()
        turned = replace(self._begin, position=(x, y), heading=wrapped(self._begin.heading + angle))
        self._put(turned, "Turn", gesture)

    def put_back(self, gesture: int) -> None:
        """Where it was."""
        self._put(self._begin, "Move", gesture)

    def _put(self, performer: Performer, verb: str, gesture: int) -> None:
        self._document.replace("performers", self._id, performer, f"{verb} {performer.name} on the stage", gesture)


def wrapped(angle: float) -> float:
    """The same turn, within half a turn to either side."""
    return math.remainder(angle, 2.0 * math.pi)


def selected_movable(document: Document, moment: Moment | None, floor: float) -> Movable | None:
    """What the gizmo stands on: the current selection, if it can be moved."""
    collection, entity_id = document.selection.current or ("", "")
    if collection == "props" and entity_id in document.project.props:
        return PlacedProp(document, entity_id)
    if collection == "performers":
        return PlacedPerformer(document, entity_id, moment.pose, floor) if moment else None
    constraint = document.project.constraints.get(entity_id) if collection == "constraints" else None
    now = moment.fixed(constraint) if constraint and moment else None
    if moment is None or now is None or handle_place(now) is None:
        return None
    return Target(document, entity_id, moment, floor)


def is_keyed(constraint: Constraint) -> bool:
    """Whether the place by which it is held is keyed, so that a drag sets a key."""
    return isinstance(getattr(constraint, HELD_BY.get(constraint.kind, ""), None), KeyedPlace)
