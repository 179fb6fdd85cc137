"""Figures drawn for constraints by kind: lines to the target, wireframes, discs."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from studio.core.changed_records import with_fields
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.core.constraints.parallel import PARALLEL_AXIS_METRES, ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.constraints.target import own_place_of
from studio.core.curves.keyed import KeyedPlace
from studio.core.rotations import to_matrix
from studio.core.stage.placement import Placement
from studio.engine.posed_performer import PosedPerformer
from studio.engine.residual_measures import measure_of
from studio.viewport.body_points import point_path
from studio.viewport.camera import FloatArray
from studio.viewport.solid_figures import capsule_lines, mesh_lines

REACHED_METRES = 0.003
"""Residual in metres below which a point is drawn as on its target."""
DISC_RADIUS, BALANCE_RING_RADIUS = 0.05, 0.08
"""Radii in metres of the disc under a centre of mass, and of the ring at its target."""
AXIS_LENGTH_METRES = 0.13
"""Length in metres of each of the three axes by which a rotation is drawn."""
PLANE_PATCH_METRES = 1.2
"""Side in metres of the square drawn for an endless plane."""
_TURN = np.linspace(0.0, 2 * np.pi, 49)
_CIRCLE = np.stack([np.cos(_TURN), np.sin(_TURN), np.zeros_like(_TURN)], axis=1)
_SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]])


@dataclass(frozen=True, eq=False)
class HandleShape:
    """Figure of a constraint: lines (N, 3) and filled faces in motion space; ``link`` (2, 3) is the line from the
    current state to the target.
    """

    lines: tuple[FloatArray, ...] = ()
    faces: tuple[FloatArray, ...] = ()
    link: FloatArray | None = None
    link_always: bool = False
    """True if the link is drawn even if the target is reached; without a link, the lines show the residual."""
    missed: bool = False
    only_chosen: bool = False
    """True if the figure is drawn only while the constraint is selected, because it would hide the body."""

    def placed(self, placement: Placement) -> "HandleShape":
        """Figure moved to a placement on the stage."""
        lines, faces = (tuple(placement.to_stage(each) for each in parts) for parts in (self.lines, self.faces))
        link = None if self.link is None else placement.to_stage(self.link)
        return replace(self, lines=lines, faces=faces, link=link)


def figure_of(constraint: Constraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Figure of ``constraint`` on a posed performer, over a ground ``floor`` metres high."""
    draw = CONSTRAINT_KINDS[constraint.kind].figure
    if draw is None:
        return HandleShape(lines=constraint.sketch(_point(pose, constraint.point), _turn(pose, constraint.point)))
    figure: HandleShape = draw(constraint, pose, floor)
    return figure


def figure_with_goal(
    constraint: Constraint, goal: tuple[float, ...], has_weight: bool, pose: PosedPerformer, floor: float
) -> HandleShape:
    """Figure of a constraint whose target is blended with others to ``goal``: a link to the goal and, while the
    constraint has a weight, a thin line from the goal to its own target, or the own axes of an orientation.
    """
    residual = figure_of(with_fields(constraint, target=goal), pose, floor)
    if constraint.kind == "orientation":
        return replace(figure_of(constraint, pose, floor), missed=residual.missed)
    own = getattr(constraint, "target")  # noqa: B009 - positions and orientations alone share goals
    return replace(residual, lines=(np.array([goal, own]),) if has_weight else ())


def with_outline(figure: HandleShape, outline: FloatArray | None, floor: float) -> HandleShape:
    """Figure with the outline (N, 2) of the support polygon added."""
    if outline is None:
        return figure
    closed = np.column_stack([np.concatenate([outline, outline[:1]]), np.full(len(outline) + 1, floor)])
    return replace(figure, lines=(*figure.lines, closed))


def with_path(figure: HandleShape, target: object, time: float, position: FloatArray, leg_length: float) -> HandleShape:
    """Figure with the path of a keyed or procedural ``target`` around a ``time`` of its motion, in seconds.

    A per-character path passes through ``position``, the target's position at that time.
    """
    if not isinstance(target, KeyedPlace | KeyedOwnPlace | ProceduralPlace):
        return figure
    path = target.path(time)
    if own_place_of(target) is not None:
        path = position + (leg_length if isinstance(target, KeyedOwnPlace) else 1.0) * (path - target.at([time]))
    return replace(figure, lines=(*figure.lines, path))


def position_figure(constraint: PositionConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Link from the point to its target."""
    link = np.stack([_point(pose, constraint.point), np.array(constraint.target)])
    return HandleShape(link=link, missed=_length(link) > REACHED_METRES)


def look_at_figure(constraint: LookAtConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Link from the eyes to the target, always drawn."""
    link = np.stack([_point(pose, constraint.point), np.array(constraint.target)])
    gaze, way = _turn(pose, constraint.point)[:, 0], link[1] - link[0]
    angle = float(np.arctan2(np.linalg.norm(np.cross(gaze, way)), gaze @ way))
    return HandleShape(link=link, link_always=True, missed=angle > measure_of(constraint).held_below)


def distance_figure(constraint: DistanceConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Link between both ends."""
    other = constraint.other
    end = _point(pose, other) if isinstance(other, BodyPoint) else np.array(other)
    link = np.stack([_point(pose, constraint.point), end])
    distance = float(np.array(constraint.distance))
    return HandleShape(link=link, link_always=True, missed=abs(_length(link) - distance) > REACHED_METRES)


def orientation_figure(constraint: OrientationConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Three axes of the target rotation, at the origin of the segment."""
    begin = _point(pose, constraint.point)
    asked, is_so = to_matrix(np.array(constraint.target)), _turn(pose, constraint.point)
    lines = tuple(np.stack([begin, begin + AXIS_LENGTH_METRES * axis]) for axis in asked.T)
    cosine = np.clip((np.trace(asked.T @ is_so) - 1.0) / 2.0, -1.0, 1.0)
    return HandleShape(lines=lines, missed=float(np.arccos(cosine)) > measure_of(constraint).held_below)


def parallel_figure(constraint: ParallelConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Both axes, each at its segment."""
    turn, other = _turn(pose, constraint.point), _turn(pose, constraint.other)
    lines = (
        *constraint.sketch(_point(pose, constraint.point), turn),
        _point(pose, constraint.other)
        + PARALLEL_AXIS_METRES * np.stack([np.zeros(3), other @ np.array(constraint.other_axis)]),
    )
    lean = float(constraint.lean(turn[None], other[None])[0])
    return HandleShape(lines=lines, missed=lean > measure_of(constraint).held_below)


def balance_figure(constraint: BalanceConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Disc under the centre of mass, and its target."""
    x, y, _ = _mass(pose)
    below = np.array([x, y, floor])
    disc = below + DISC_RADIUS * _CIRCLE
    if not isinstance(constraint.place, tuple):
        return HandleShape(lines=(disc, below + BALANCE_RING_RADIUS * _CIRCLE), faces=(disc,))
    asked = np.array([*constraint.place[:2], floor])
    link = np.stack([below, asked])
    return HandleShape(
        (disc, asked + BALANCE_RING_RADIUS * _CIRCLE), (disc,), link, missed=_length(link) > REACHED_METRES
    )


def clear_figure(constraint: ClearConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Capsules of the body that the arms avoid."""
    lines = tuple(pose.points_in_clip(each) for each in capsule_lines(pose.motion, pose.row))
    return HandleShape(lines=lines, only_chosen=True)


def area_figure(constraint: AreaConstraint, pose: PosedPerformer, floor: float) -> HandleShape:
    """Lines and faces of the volume, and a link to the nearest allowed position."""
    if constraint.mesh is not None and constraint.shape is AreaShape.MESH:
        lines, faces = mesh_lines(constraint.mesh)
    else:
        lines, faces = _SHAPES[constraint.shape](np.array(constraint.size))
    turn, centre = _rotation(constraint), np.array(constraint.centre)
    link = np.stack([_point(pose, constraint.point), _allowed(constraint, _point(pose, constraint.point))])
    return HandleShape(
        tuple(line @ turn.T + centre for line in lines),
        tuple(face @ turn.T + centre for face in faces),
        link,
        missed=_length(link) > REACHED_METRES,
    )


LinesAndFaces = tuple[list[FloatArray], list[FloatArray]]


def _half_space(size: FloatArray) -> LinesAndFaces:
    """Square piece of the plane, and its normal."""
    normal = size / np.linalg.norm(size)
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    square = _SQUARE @ np.stack([first, np.cross(normal, first), normal]) * PLANE_PATCH_METRES / 2
    return [square, np.stack([np.zeros(3), 0.25 * normal])], [square]


def _box(size: FloatArray) -> LinesAndFaces:
    bottom, top = (_SQUARE * [1.0, 1.0, 0.0] + [0.0, 0.0, z] for z in (-1.0, 1.0))
    upright = [np.stack([bottom[k], top[k]]) for k in range(4)]
    return [line * size / 2 for line in (bottom, top, *upright)], []


def _table(size: FloatArray) -> LinesAndFaces:
    """Box with an emphasised top."""
    lines, _ = _box(size)
    return lines, [lines[1]]


def _sphere(size: FloatArray) -> LinesAndFaces:
    return [size[0] / 2 * np.roll(_CIRCLE, shift, axis=1) for shift in range(3)], []


def _cylinder(size: FloatArray) -> LinesAndFaces:
    bottom, top = (_CIRCLE * size[0] / 2 + [0.0, 0.0, z * size[2] / 2] for z in (-1, 1))
    return [bottom, top, *(np.stack([bottom[k], top[k]]) for k in (0, 12, 24, 36))], []


_SHAPES: dict[AreaShape, Callable[[FloatArray], LinesAndFaces]] = {
    AreaShape.HALF_SPACE: _half_space,
    AreaShape.BOX: _box,
    AreaShape.TABLE: _table,
    AreaShape.SPHERE: _sphere,
    AreaShape.CYLINDER: _cylinder,
}


def _point(pose: PosedPerformer, point: BodyPoint) -> FloatArray:
    return pose.points_in_clip(point_path(pose.motion, point, slice(pose.row, pose.row + 1))[0])


def _turn(pose: PosedPerformer, point: BodyPoint) -> FloatArray:
    return pose.rotation_in_clip(point.part)


def _allowed(constraint: AreaConstraint, position: FloatArray) -> FloatArray:
    from studio.core.solver.task_assembly.area_rows import (
        nearest_allowed_position,
    )  # not before a result is there: it loads kernels

    return nearest_allowed_position(constraint, position)


def _rotation(constraint: AreaConstraint) -> FloatArray:
    from studio.core.solver.task_assembly.area_rows import fixed_rotation  # as above

    return fixed_rotation(constraint)


def _mass(pose: PosedPerformer) -> FloatArray:
    from studio.core.quality.metrics import centre_of_mass  # as above

    row = slice(pose.row, pose.row + 1)
    centre: FloatArray = centre_of_mass(replace(pose.motion, positions=pose.motion.positions[row]))[0]
    return pose.points_in_clip(centre)


def _length(link: FloatArray) -> float:
    return float(np.linalg.norm(link[1] - link[0]))
