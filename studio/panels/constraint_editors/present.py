"""Pose of the active performer at the playhead, from which new targets are made."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Constraint, Vector
from studio.engine.posed_performer import posed_performers
from studio.engine.target_context import TargetContext
from studio.panels.editor import Editor


def current_context(editor: Editor[Constraint]) -> TargetContext | None:
    """Poses of all performers at the playhead, from the view of the active one; None without performers."""
    document = editor.document
    posed = posed_performers(document.project, editor.live.result, document.playhead.time)
    pose = posed.get(document.active_performer_id or "")
    return None if pose is None else TargetContext(document.project, posed, pose)


def current_position(editor: Editor[Constraint], point: BodyPoint) -> Vector | None:
    """Position in metres of a body point at the playhead, in clip space; None without performers."""
    from studio.core.solver.adapt import body_point_positions  # not before a result is there: it loads kernels

    moment = current_context(editor)
    return None if moment is None else _vector(body_point_positions(point, moment.pose.motion)[moment.pose.row])


def current_centre_of_mass(editor: Editor[Constraint]) -> Vector | None:
    """Position in metres of the body's centre of mass at the playhead, in clip space; None without performers."""
    from studio.core.quality.metrics import centre_of_mass  # as above

    moment = current_context(editor)
    return None if moment is None else _vector(centre_of_mass(moment.pose.motion)[moment.pose.row])


def current_rotation(editor: Editor[Constraint], part: BodyPart) -> np.ndarray | None:
    """Rotation matrix (3, 3) of a segment at the playhead, in clip space; None without performers."""
    moment = current_context(editor)
    if moment is None:
        return None
    motion = moment.pose.motion
    return np.asarray(motion.rotations[moment.pose.row, motion.morphology.layout.segment_of_part(part)])


def _vector(position: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in position)
    return x, y, z
