"""Objects that a gizmo can edit: targets, props, performers. Each has axes, and edits the document."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import Follow
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.core.constraints.target import own_place_of
from studio.core.curves.keyed import KeyedPlace
from studio.core.rotations import to_matrix
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer
from studio.core.stage.prop import InHand, Prop
from studio.document.document import Document
from studio.document.mirrored import mirrored_edit
from studio.document.obstacles import obstacles_of
from studio.engine.posed_performer import PosedPerformer
from studio.engine.prop_places import moved_prop, prop_at, resized_prop, tilt_of, turned_prop, wrapped_angle
from studio.engine.target_context import TargetContext
from studio.viewport.camera import FloatArray
from studio.viewport.handle_places import handle_position, is_flat
from studio.viewport.rotate_gizmo import rotation_about

MIN_SIDE_METRES = 0.001
"""Minimum side in metres of a prop or a volume."""


class Movable:
    """Object that a gizmo moves, rotates or resizes; each kind overrides the methods it supports."""

    placement: Placement
    """Placement on the stage of the space of ``place``."""
    flat = False
    """True if the object stays on the ground."""
    gives_way_to_joints = False
    """True if joints under the gizmo's handles are picked before the handles."""
    moves = True
    rotates = heading_only = False
    """True if the object can be rotated; ``heading_only`` if only about Z."""
    scales = (False, False, False)
    """True for each of the object's axes along which it can be resized."""

    @property
    def place(self) -> FloatArray:
        """(3,) position in the object's own space."""
        raise NotImplementedError

    @property
    def pivot(self) -> FloatArray:
        """(3,) stage position about which the object rotates."""
        return self.placement.to_stage(self.place)

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the object as columns, stage space."""
        return self.parent_axes

    @property
    def parent_axes(self) -> FloatArray:
        """(3, 3) axes of its parent as columns, stage space."""
        return self.placement.rotation

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the object to ``position`` (3,), within the undo step of a gesture."""

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the object by ``rotation`` (3, 3), stage space, from its state at creation."""

    def scale(self, factors: FloatArray, gesture: int) -> None:
        """Resize the object by ``factors`` (3,) along its own axes, from its state at creation."""

    def finish(self, gesture: int) -> None:
        """Complete the edit at the end of the gesture."""

    def restore(self, gesture: int) -> None:
        """Restore the object's state at creation."""
        raise NotImplementedError


class MovableTarget(Movable):
    """Target of a constraint on one performer at one moment, over a ground ``floor`` metres high."""

    def __init__(self, document: Document, constraint_id: str, moment: TargetContext, floor: float) -> None:
        self._document, self._id, self._moment, self._floor = document, constraint_id, moment, floor
        self.placement, self._begin = moment.pose.clip_placement, self._constraint
        self.flat = is_flat(self._begin)

    @staticmethod
    def is_held(now: Constraint) -> bool:
        """True if a constraint with fixed targets has a position that can be moved."""
        return handle_position(now) is not None

    @property
    def _constraint(self) -> Constraint:
        stored = self._document.project.constraints[self._id]
        return self._moment.as_played(stored)

    @property
    def place(self) -> FloatArray:
        """(3,) position in motion space."""
        now = self._moment.with_targets_fixed(self._constraint)
        return np.array(handle_position(now, self._floor) if now else None)

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the target to ``position`` (3,)."""
        old = self._constraint
        x, y, z = position.tolist()
        text = f"{'Key' if has_keyed_target(old) and not self._is_apart else 'Move'} {self._words}"
        self._put(self._moment.with_target_moved(self._begin, (x, y, z)), text, gesture)

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the constrained segment."""
        pose = self._moment.pose
        segment = pose.motion.morphology.layout.segment_of_part(self._begin.point.part)
        return np.asarray(pose.placement.rotation @ pose.motion.rotations[pose.row, segment])

    @property
    def parent_axes(self) -> FloatArray:
        """(3, 3) axes of the followed object, else of motion space."""
        target = getattr(self._begin, self._begin.shown.held_by or "target", None)
        track = self._moment.track(target) if isinstance(target, Follow) else None
        rotation = self.placement.rotation
        return rotation if track is None else np.asarray(rotation @ track.rotations[0])

    @property
    def _words(self) -> str:
        """Name of the dragged object: ``target of Right wrist``, ``centre of Table``; with the performer's name if only
        its own target moves.
        """
        whom = f" for {self._moment.pose.performer.name}" if self._is_apart else ""
        return f"{self._begin.shown.handle} of {self._begin.name}{whom}"

    @property
    def _is_apart(self) -> bool:
        """True if the performer has its own offset from a per-character position."""
        own = own_place_of(getattr(self._begin, self._begin.shown.held_by))
        return own is not None and self._moment.performer_id in dict(own.own)

    def restore(self, gesture: int) -> None:
        """Restore the target, without the key that the drag has set."""
        self._put(self._begin, f"Move {self._begin.name}", gesture)

    def _put(self, seen: Constraint, text: str, gesture: int) -> None:
        stored = self._document.project.constraints[self._id]
        moment, clip = self._moment, self._moment.pose.clip
        mirrors = clip is not None and clip.mirrored
        new = mirrored_edit(moment.project, moment.performer_id, clip, stored, seen) if clip and mirrors else seen
        self._document.replace("constraints", self._id, new, text, gesture)


class PlacedProp(Movable):
    """Prop at the playhead: a drag moves it, sets a key, or changes its offset in the holder's hands."""

    rotates = True
    scales = (True, True, True)

    def __init__(self, document: Document, prop_id: str, posed: Mapping[str, PosedPerformer]) -> None:
        self._document, self._id = document, prop_id
        self.placement, self._begin = Placement(), document.project.props[prop_id]
        self._pose = prop_at(document.project, posed, prop_id, document.playhead.time)
        self._obstacles = obstacles_of(document.project, prop_id)

    @property
    def place(self) -> FloatArray:
        """(3,) centre on the stage."""
        return self._pose.place

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the centre to ``position`` (3,)."""
        verb = (
            "Key" if isinstance(self._begin.position, KeyedPlace) and self._begin.lies_at(self._pose.time) else "Move"
        )
        self._put(moved_prop(self._pose, position), verb, gesture)

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the prop."""
        return self._pose.axes

    @property
    def parent_axes(self) -> FloatArray:
        """(3, 3) axes of the holder's segment or chest, else of the stage."""
        hold = None if self._begin.lies_at(self._pose.time) else self._begin.held_at(self._pose.time)
        if hold is None:
            return np.eye(3)
        axes = self._pose.axes @ (to_matrix(np.array(hold.turn)) if isinstance(hold, InHand) else tilt_of(self._pose)).T
        return axes if isinstance(hold, InHand) else axes @ rotation_about(axes[:, 2], -hold.heading)

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the prop about its centre."""
        self._put(turned_prop(self._pose, rotation), "Rotate", gesture)

    def scale(self, factors: FloatArray, gesture: int) -> None:
        """Resize the prop, and the constraints that make it an obstacle."""
        x, y, z = np.maximum(np.array(self._begin.size) * factors, MIN_SIDE_METRES).tolist()
        obstacles = {key: replace(each, size=(x, y, z)) for key, each in self._obstacles.items()}
        resized = resized_prop(self._pose, (x, y, z), self._document.project.ground)
        self._put(resized, "Resize", gesture, obstacles)

    def restore(self, gesture: int) -> None:
        """Restore the prop."""
        self._put(self._begin, "Move", gesture, self._obstacles)

    def _put(
        self, prop: Prop, verb: str, gesture: int, obstacles: Mapping[str, AreaConstraint] = MappingProxyType({})
    ) -> None:
        text = f"{verb} {prop.name}"
        with self._document.group(text, gesture):
            self._document.replace("props", self._id, prop, text)
            for key, each in obstacles.items():
                self._document.replace("constraints", key, each, text)


class PlacedPerformer(Movable):
    """Performer, grabbed at the ground under its root; all its clips move along."""

    flat = gives_way_to_joints = rotates = heading_only = True

    def __init__(self, document: Document, performer_id: str, pose: PosedPerformer, floor: float) -> None:
        self._document, self._id, self._pose = document, performer_id, pose
        self.placement, self._begin = Placement(), document.project.performers[performer_id]
        self._floor = floor

    @property
    def place(self) -> FloatArray:
        """(3,) position on the ground of the stage."""
        return np.array([*self._pose.points[0, :2], self._floor])

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the performer so that its root is above ``position`` (3,)."""
        x, y = (np.array(self._begin.position) + (position - self.place)[:2]).tolist()
        self._put(replace(self._begin, position=(x, y)), "Move", gesture)

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the performer's heading."""
        return Placement.of(self._begin).rotation

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the performer about its current root, by the part of the rotation about Z."""
        pivot, angle = self.place[:2], math.atan2(rotation[1, 0], rotation[0, 0])
        x, y = (pivot + rotation[:2, :2] @ (np.array(self._begin.position) - pivot)).tolist()
        turned = replace(self._begin, position=(x, y), heading=wrapped_angle(self._begin.heading + angle))
        self._put(turned, "Rotate", gesture)

    def restore(self, gesture: int) -> None:
        """Restore the placement."""
        self._put(self._begin, "Move", gesture)

    def _put(self, performer: Performer, verb: str, gesture: int) -> None:
        self._document.replace("performers", self._id, performer, f"{verb} {performer.name} on the stage", gesture)


class SelectedTogether(Movable):
    """Several selected objects of one kind: the gizmo is that of the last one, and the others move along."""

    def __init__(self, document: Document, words: str, lead: Movable, others: Sequence[Movable]) -> None:
        self._document, self._words, self._lead, self._all = document, words, lead, (lead, *others)
        self._begins = [each.placement.to_stage(each.place) for each in self._all]
        self.placement, self.flat, self.gives_way_to_joints = lead.placement, lead.flat, lead.gives_way_to_joints
        self.moves, self.rotates, self.heading_only, self.scales = (
            lead.moves, lead.rotates, lead.heading_only, lead.scales,
        )  # fmt: skip

    @property
    def place(self) -> FloatArray:
        """(3,) position of the last object in its own space."""
        return self._lead.place

    @property
    def pivot(self) -> FloatArray:
        """(3,) stage position about which the last object rotates; each object has its own."""
        return self._lead.pivot

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the last object."""
        return self._lead.own_axes

    @property
    def parent_axes(self) -> FloatArray:
        """(3, 3) axes of the last object's parent."""
        return self._lead.parent_axes

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the last object to ``position`` (3,), and the others by the same displacement."""
        moved = self.placement.to_stage(position) - self._begins[0]
        with self._document.group(f"Move {self._words}", gesture):
            for each, begin in zip(self._all, self._begins, strict=True):
                each.move(each.placement.to_motion(begin + moved), gesture)

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate each object about its own pivot."""
        with self._document.group(f"Rotate {self._words}", gesture):
            for each in self._all:
                each.rotate(rotation, gesture)

    def scale(self, factors: FloatArray, gesture: int) -> None:
        """Resize each object along its own axes."""
        with self._document.group(f"Resize {self._words}", gesture):
            for each in self._all:
                each.scale(factors, gesture)

    def restore(self, gesture: int) -> None:
        """Restore all objects."""
        with self._document.group(f"Move {self._words}", gesture):
            for each in self._all:
                each.restore(gesture)


def has_keyed_target(constraint: Constraint) -> bool:
    """True if the handle's position is keyed, so that a drag sets a key."""
    return isinstance(getattr(constraint, constraint.shown.held_by, None), KeyedPlace | KeyedOwnPlace)
