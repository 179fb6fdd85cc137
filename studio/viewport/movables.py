"""What a gizmo can move: a constraint's place, a prop, a performer. Each knows its axes and tells the document."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np

from studio.core.constraints.base import Constraint
from studio.core.constraints.carried_over import mirrored_constraint
from studio.core.constraints.keyed import KeyedPlace
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.core.constraints.target import own_place_of
from studio.core.project import Performer
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.document.mirrored import mirrored_change
from studio.engine.moments import TargetContext
from studio.engine.performance import Posed
from studio.engine.props import moved_prop, prop_at, turned_prop, wrapped
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.gizmo import Gizmo
from studio.viewport.handle_places import handle_place, is_flat
from studio.viewport.handles import floor_under


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

    def __init__(self, document: Document, constraint_id: str, moment: TargetContext, floor: float) -> None:
        self._document, self._id, self._moment, self._floor = document, constraint_id, moment, floor
        self.placement, self._begin = moment.pose.clip_placement, self._constraint

    @property
    def _constraint(self) -> Constraint:
        stored = self._document.project.constraints[self._id]
        return mirrored_constraint(stored) if self._moment.pose.mirrored else stored

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
        text = f"{'Key' if is_keyed(old) and not self._is_apart else 'Move'} {self._words}"
        self._put(self._moment.moved(self._begin, (x, y, z)), text, gesture)

    def turn(self, angle: float, gesture: int) -> None:
        """A place has no turn."""

    @property
    def _words(self) -> str:
        """What is dragged: ``target of Right wrist``, ``centre of Table``; of whom, where that one has its own."""
        whom = f" for {self._moment.pose.performer.name}" if self._is_apart else ""
        return f"{self._begin.shown.handle} of {self._begin.name}{whom}"

    @property
    def _is_apart(self) -> bool:
        """True if the performer has an offset of its own from the per-character position."""
        own = own_place_of(getattr(self._begin, self._begin.shown.held_by))
        return own is not None and self._moment.performer_id in dict(own.own)

    def put_back(self, gesture: int) -> None:
        """As it was: without the key that a drag has set."""
        self._put(self._begin, f"Move {self._words}", gesture)

    def _put(self, seen: Constraint, text: str, gesture: int) -> None:
        stored = self._document.project.constraints[self._id]
        new = mirrored_change(stored, seen) if self._moment.pose.mirrored else seen
        self._document.replace("constraints", self._id, new, text, gesture)


class PlacedProp:
    """A prop where it is now: a drag moves it, sets a key, or gives it another place in the hands that hold it."""

    flat = yields = False
    turns = True

    def __init__(self, document: Document, prop_id: str, posed: Mapping[str, Posed]) -> None:
        self._document, self._id = document, prop_id
        self.placement, self._begin = Placement(), document.project.props[prop_id]
        self._pose = prop_at(document.project, posed, prop_id, document.playhead.time)

    @property
    def place(self) -> FloatArray:
        """(3,) centre on the stage."""
        return self._pose.place

    def move(self, place: FloatArray, gesture: int) -> None:
        """Put its centre at ``place``."""
        verb = (
            "Key" if isinstance(self._begin.position, KeyedPlace) and self._begin.lies_at(self._pose.time) else "Move"
        )
        self._put(moved_prop(self._pose, place), verb, gesture)

    def turn(self, angle: float, gesture: int) -> None:
        """Turn it about its centre."""
        self._put(turned_prop(self._pose, angle), "Turn", gesture)

    def put_back(self, gesture: int) -> None:
        """Where it was."""
        self._put(self._begin, "Move", gesture)

    def _put(self, prop: Prop, verb: str, gesture: int) -> None:
        self._document.replace("props", self._id, prop, f"{verb} {prop.name}", gesture)


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


def selected_movable(document: Document, posed: Mapping[str, Posed], *, picking: bool = False) -> Movable | None:
    """What the gizmo stands on: the current selection, if it can be moved.

    A body is not while a joint of it is picked, beside which its handle would lie.
    """
    project, pose = document.project, posed.get(document.active_performer_id or "")
    collection, entity_id = document.selection.current or ("", "")
    if collection == "props" and entity_id in project.props:
        return PlacedProp(document, entity_id, posed)
    if pose is None:
        return None
    floor = floor_under(project, pose)
    if collection == "performers":
        return (
            None
            if picking or entity_id not in project.performers
            else PlacedPerformer(document, entity_id, pose, floor)
        )
    moment = TargetContext(project, posed, pose)
    constraint = project.constraints.get(entity_id) if collection == "constraints" else None
    if constraint is not None and pose.mirrored:
        constraint = mirrored_constraint(constraint)
    now = moment.fixed(constraint) if constraint else None
    if now is None or handle_place(now) is None:
        return None
    return Target(document, entity_id, moment, floor)


def gizmo_on(movable: Movable, camera: OrbitCamera, size: tuple[float, float], pixels: float) -> Gizmo:
    """The gizmo by which a thing is moved, with arrows of so many ``pixels``."""
    origin, axes = movable.placement.to_stage(movable.place), movable.placement.rotation.T
    return Gizmo(origin, axes, camera, size, pixels, movable.flat, movable.turns)


def is_keyed(constraint: Constraint) -> bool:
    """Whether the place by which it is held is keyed, so that a drag sets a key."""
    return isinstance(getattr(constraint, constraint.shown.held_by, None), KeyedPlace | KeyedOwnPlace)
