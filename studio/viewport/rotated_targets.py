"""Constraints that a gizmo rotates or resizes: orientations, look-at targets, directions, volumes."""

import math
from dataclasses import replace

import numpy as np

from studio.core.changed_records import with_fields
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.keyed import KeyedNumber, KeyedTurn
from studio.core.rotations import frame_along, from_matrix, rotations_about_z, to_matrix
from studio.document.document import Document
from studio.engine.prop_places import further_heading, is_about_z, wrapped_angle
from studio.engine.target_context import TargetContext
from studio.viewport.body_points import point_path
from studio.viewport.camera import FloatArray
from studio.viewport.movables import MIN_SIDE_METRES, MovableTarget

RESIZABLE_AXES = {
    AreaShape.BOX: (True, True, True),
    AreaShape.TABLE: (True, True, True),
    AreaShape.SPHERE: (True, False, False),
    AreaShape.CYLINDER: (True, False, True),
}
"""Axes along which a volume can be resized, by shape."""


class RotatedTarget(MovableTarget):
    """Target that is rotated about the constrained point."""

    rotates = True

    def __init__(self, document: Document, constraint_id: str, moment: TargetContext, floor: float) -> None:
        super().__init__(document, constraint_id, moment, floor)
        pose = moment.pose
        path = point_path(pose.motion, self._begin.point, slice(pose.row, pose.row + 1))
        self._point = pose.placement.to_stage(path[0])

    @property
    def pivot(self) -> FloatArray:
        """(3,) stage position of the constrained point."""
        return self._point

    def _axes_along(self, direction: Vector) -> FloatArray:
        """(3, 3) axes on the stage, the last one along a ``direction`` (3,) in motion space."""
        return np.asarray(self.placement.rotation @ frame_along(np.array(direction), np.array([1.0, 0.0, 0.0])))

    def _here(self, rotation: FloatArray) -> FloatArray:
        """Stage rotation (3, 3) expressed in the space of the constraint."""
        axes = self.placement.rotation
        return np.asarray(axes.T @ rotation @ axes)

    @property
    def _fixed(self) -> Constraint:
        """Constraint with fixed targets at the playhead, as it was when the gizmo was made."""
        fixed = self._moment.with_targets_fixed(self._begin)
        assert fixed is not None
        return fixed


class RotatedSegment(RotatedTarget):
    """Target rotation of an orientation constraint."""

    moves = False

    @staticmethod
    def is_held(now: Constraint) -> bool:
        """Always True, since no position is needed."""
        return True

    @property
    def place(self) -> FloatArray:
        """(3,) position of the constrained point, motion space."""
        return self.placement.to_motion(self._point)

    @property
    def _target(self) -> FloatArray:
        """(3, 3) target rotation at the playhead, in the space of the constraint."""
        fixed = self._fixed
        assert isinstance(fixed, OrientationConstraint)
        return to_matrix(np.array(fixed.target))

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) current axes of the target."""
        now = self._moment.with_targets_fixed(self._constraint)
        assert isinstance(now, OrientationConstraint)
        return np.asarray(self.placement.rotation @ to_matrix(np.array(now.target)))

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the target."""
        x, y, z, w = from_matrix(self._here(rotation) @ self._target).tolist()
        verb = "Key" if isinstance(getattr(self._begin, "target", None), KeyedTurn) else "Rotate"
        text = f"{verb} target of {self._begin.name}"
        self._put(self._moment.with_target_rotation(self._begin, (x, y, z, w)), text, gesture)


class RotatedDirection(RotatedTarget):
    """Target direction of a segment's axis."""

    moves = False
    is_held = RotatedSegment.is_held
    place = RotatedSegment.place

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes, the last one along the direction."""
        now = self._constraint
        assert isinstance(now, UprightConstraint)
        return self._axes_along(now.direction)

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the direction."""
        assert isinstance(self._begin, UprightConstraint)
        x, y, z = (self._here(rotation) @ np.array(self._begin.direction)).tolist()
        self._put(replace(self._begin, direction=(x, y, z)), f"Rotate direction of {self._begin.name}", gesture)


class RotatedAboutCentre(RotatedTarget):
    """Constraint that is rotated about its centre."""

    @property
    def pivot(self) -> FloatArray:
        """(3,) stage position of the centre."""
        return self.placement.to_stage(self.place)


class RotatedRail(RotatedAboutCentre):
    """Rail, rotated about its centre."""

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes, the last one along the direction."""
        now = self._moment.with_targets_fixed(self._constraint)
        assert isinstance(now, RailConstraint)
        return self._axes_along(now.direction)

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the direction, starting from its value at the playhead."""
        fixed = self._fixed
        assert isinstance(fixed, RailConstraint)
        assert isinstance(self._begin, RailConstraint)
        turn = self._here(rotation)
        now = np.array(fixed.direction)
        x, y, z = (tilt_of(self._moment, self._begin, "direction").T @ turn @ now).tolist()
        self._put(replace(self._begin, direction=(x, y, z)), f"Rotate direction of {self._begin.name}", gesture)


class RotatedLookAt(RotatedTarget):
    """Look-at target, which orbits the eyes when rotated."""

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Move the target on a circle around the eyes."""
        fixed, eyes = self._fixed, self.placement.to_motion(self._point)
        assert isinstance(fixed, LookAtConstraint)
        assert isinstance(fixed.target, tuple)
        self.move(eyes + self._here(rotation) @ (np.array(fixed.target) - eyes), gesture)


class RotatedArea(RotatedAboutCentre):
    """Volume: all shapes but a sphere rotate, and most can be resized."""

    def __init__(self, document: Document, constraint_id: str, moment: TargetContext, floor: float) -> None:
        super().__init__(document, constraint_id, moment, floor)
        area = self._area
        self.rotates = area.shape is not AreaShape.SPHERE
        self.scales = RESIZABLE_AXES.get(area.shape, (False, False, False))

    @property
    def _area(self) -> AreaConstraint:
        assert isinstance(self._begin, AreaConstraint)
        return self._begin

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the volume; the last one is the normal of a half-space."""
        now = self._moment.with_targets_fixed(self._constraint)
        assert isinstance(now, AreaConstraint)
        if now.shape is AreaShape.HALF_SPACE:
            return self._axes_along(now.size)
        return np.asarray(self.placement.rotation @ _area_rotation(now))

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the volume about its centre: about Z by its heading, so that a keyed heading may exceed a full turn,
        else by its tilt.
        """
        area = self._area
        text = f"Rotate {area.name}"
        if area.shape is AreaShape.HALF_SPACE:
            tilt = tilt_of(self._moment, area, "size")
            x, y, z = (tilt.T @ self._here(rotation) @ tilt @ np.array(area.size)).tolist()
            self._put(replace(area, size=(x, y, z)), text, gesture)
            return
        fixed, seconds = self._fixed, self._moment.pose.seconds
        assert isinstance(fixed, AreaConstraint)
        now = _area_rotation(fixed)
        headed = now @ _tilt_at(area, seconds).T
        if is_about_z(rotation) and is_about_z(headed):
            angle = math.atan2(rotation[1, 0], rotation[0, 0])
            self._put(replace(area, heading=further_heading(area.heading, angle, seconds)), text, gesture)
            return
        tilt = headed.T @ self._here(rotation) @ now
        x, y, z, w = from_matrix(tilt).tolist()
        if isinstance(area.tilt, KeyedTurn):
            self._put(replace(area, tilt=area.tilt.with_key(seconds, (x, y, z, w))), text, gesture)
        elif isinstance(area.heading, KeyedNumber):
            self._put(replace(area, tilt=KeyedTurn((seconds,), ((x, y, z, w),))), text, gesture)
        else:  # what it turns about Z goes into the heading
            about_z = math.atan2(tilt[1, 0], tilt[0, 0])
            x, y, z, w = from_matrix(rotations_about_z(-about_z) @ tilt).tolist()
            heading = wrapped_angle(area.heading + about_z)
            self._put(replace(area, heading=heading, tilt=(x, y, z, w)), text, gesture)

    def scale(self, factors: FloatArray, gesture: int) -> None:
        """Resize the volume about its centre."""
        x, y, z = np.maximum(np.array(self._area.size) * factors, MIN_SIDE_METRES).tolist()
        self._put(replace(self._area, size=(x, y, z)), f"Resize {self._area.name}", gesture)


def _area_rotation(fixed: AreaConstraint) -> FloatArray:
    from studio.core.solver.task_assembly.area_rows import (
        fixed_rotation,
    )  # not before a result is there: it loads kernels

    return fixed_rotation(fixed)


def _tilt_at(area: AreaConstraint, seconds: float) -> FloatArray:
    """(3, 3) tilt of a volume at ``seconds`` of its motion."""
    if isinstance(area.tilt, KeyedTurn):
        return np.asarray(area.tilt.at([seconds])[0])
    return to_matrix(np.array(area.tilt))


def tilt_of(moment: TargetContext, constraint: Constraint, name: str) -> FloatArray:
    """(3, 3) rotation from the stored direction in the field ``name`` of a constraint to the direction at the
    playhead.
    """
    columns = []
    for axis in np.eye(3).tolist():
        fixed = moment.with_targets_fixed(with_fields(constraint, **{name: tuple(axis)}))
        assert fixed is not None
        columns.append(np.array(getattr(fixed, name)))
    return np.stack(columns, axis=1)


def target_of_kind(constraint: Constraint) -> type[MovableTarget]:
    """Class of the movable target of a constraint, by its kind; a kind without its own can only be moved."""
    target = CONSTRAINT_KINDS[constraint.kind].target
    kind: type[MovableTarget] = target() if target else MovableTarget
    return kind
