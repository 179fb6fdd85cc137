"""Lines on the stage: motion trails, rings around selected performers, marks of ground contacts."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import ContactPoint, touching_points
from studio.core.constraints.base import BodyPoint
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.project import Project
from studio.document import colours
from studio.document.keyed_fields import all_to_stage, fields_of
from studio.engine.posed_performer import FloatArray, PosedPerformer, rows_at
from studio.viewport.body_points import point_path

TRAIL_SECONDS, TRAIL_RATE = 0.8, 120.0
PATH_RING_RADIUS, PATH_MARK_RADIUS = 0.20, 0.045
"""Radius of the ring of a selected performer in leg lengths, and of the mark of a contact in metres."""
PATH_LIFT_METRES = 0.005
_TURN = np.linspace(0.0, 2 * np.pi, 41)
_CIRCLE = np.stack([np.cos(_TURN), np.sin(_TURN), np.zeros_like(_TURN)], axis=1)
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class TrailKeys:
    """Stage positions (N, 3) on a performer's motion trail at the times of keys, and the trail's colour."""

    points: FloatArray
    colour: str


@dataclass(frozen=True, eq=False)
class StagePath:
    """Line through stage ``points`` (N, 3) with ``opacity`` (N,)."""

    points: FloatArray
    colour: str
    opacity: NDArray[np.float64]


def stage_paths(
    project: Project, posed: Mapping[str, PosedPerformer], trail: BodyPoint | None, smooth: bool = True
) -> list[StagePath]:
    """Motion trails of the point ``trail``, and marks of contacts."""
    return [*trails(project, posed, trail, smooth), *contact_marks(project, posed)]


def trails(
    project: Project, posed: Mapping[str, PosedPerformer], point: BodyPoint | None, smooth: bool = True
) -> list[StagePath]:
    """Path of ``point`` on every performer around this moment, in the performer's colour; a smooth curve if ``smooth``,
    else straight from frame to frame.
    """
    found = []
    for pose in posed.values() if point is not None else ():
        assert point is not None
        motion = pose.over_time
        here, reach = pose.frame - motion.first_frame, round(TRAIL_SECONDS * motion.frame_rate)
        rows = slice(max(here - reach, 0), here + reach + 1)
        path = pose.placement.to_stage(point_path(motion, point, rows))
        frames: FloatArray = np.arange(rows.start, rows.start + len(path), dtype=np.float64)
        if smooth and len(path) > 2:
            path, frames = _smooth(path, frames, pose.motion.frame_rate)
        away = np.abs(frames - here) / (reach + 1)
        found.append(StagePath(path, project.characters[pose.performer.character_id].colour, 1 - away))
    return found


def trail_keys(
    project: Project, posed: Mapping[str, PosedPerformer], point: BodyPoint, constraint_id: str
) -> list[TrailKeys]:
    """Positions on the trails of ``point`` at the keys of a constraint, for every performer with a key within its
    trail.
    """
    fields = fields_of("constraints", constraint_id, project.constraints.get(constraint_id))
    found = []
    for pose in posed.values():
        motion = pose.over_time
        timing = timing_of(project, pose.performer) if pose.performer.clips else None
        times = [all_to_stage(project, pose.clip, field, keyed.times) for field, keyed in fields.items()]
        rows = np.unique(rows_at(motion, timing, np.concatenate([[], *times])))
        here = pose.frame - motion.first_frame
        near = rows[np.abs(rows - here) <= round(TRAIL_SECONDS * motion.frame_rate)]
        if len(near):
            path = point_path(motion, point, slice(near[0], near[-1] + 1))[near - near[0]]
            colour = project.characters[pose.performer.character_id].colour
            found.append(TrailKeys(pose.placement.to_stage(path), colour))
    return found


def selection_rings(
    project: Project, posed: Mapping[str, PosedPerformer], selected: Collection[str]
) -> list[StagePath]:
    """Ring on the ground around each selected performer."""
    chosen = [posed[key] for key in selected if key in posed]
    centres, sizes = [pose.points[0] for pose in chosen], [2 * pose.motion.morphology.leg_length for pose in chosen]
    return _rings(project, centres, PATH_RING_RADIUS * np.array(sizes), colours.STAGE_SELECTED_HANDLE, 0.7)


def prop_paths(project: Project, selected: Collection[str], time: float) -> list[StagePath]:
    """Paths of selected props that are keyed or procedural, around the stage time ``time`` in seconds."""
    chosen = [project.props[key] for key in selected if key in project.props]
    paths = [
        each.position.path(time) for each in chosen if not each.held_at(time) and not isinstance(each.position, tuple)
    ]
    return [StagePath(path, colours.STAGE_SELECTED_HANDLE, np.full(len(path), 0.7)) for path in paths]


def contact_marks(project: Project, posed: Mapping[str, PosedPerformer]) -> list[StagePath]:
    """Small ring on the ground at each current contact of a heel, toe, hand, knee or seat."""
    centres = [
        _touching_point(pose, each.point)
        for pose in posed.values()
        for each in pose.contacts_in(project)
        if each.first <= pose.frame <= each.last and isinstance(each.point, ContactPoint)
    ]
    return _rings(project, centres, np.full(len(centres), PATH_MARK_RADIUS), colours.kind_colour("contact"), 0.9)


def _smooth(path: FloatArray, frames: FloatArray, frame_rate: float) -> tuple[FloatArray, FloatArray]:
    """Path and times interpolated to at least ``TRAIL_RATE`` points per second by a spline."""
    from scipy.interpolate import CubicSpline  # late: it takes longer than a window

    steps = int(np.ceil(TRAIL_RATE / frame_rate))
    finer = np.linspace(frames[0], frames[-1], steps * (len(frames) - 1) + 1)
    return CubicSpline(frames, path)(finer), finer


def _touching_point(pose: PosedPerformer, point: ContactPoint) -> FloatArray:
    touching = touching_points(point, pose.motion.morphology.layout)
    return np.asarray(pose.points[touching].mean(axis=0))


def _rings(
    project: Project, centres: Sequence[FloatArray], radii: FloatArray, colour: str, strength: float
) -> list[StagePath]:
    """Circles on the ground under ``centres``."""
    if not centres:
        return []
    points = np.array(centres)[:, None] * [1.0, 1.0, 0.0] + PATH_LIFT_METRES * _UP + radii[:, None, None] * _CIRCLE
    points[..., 2] += project.ground.height_at(points)
    return [StagePath(ring, colour, np.full(len(_CIRCLE), strength)) for ring in points]
