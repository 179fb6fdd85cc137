"""What the active body does at the playhead: where a new place of a constraint begins."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from studio.core.constraints.base import BodyPoint, Vector
from studio.panels.editor import Editor

if TYPE_CHECKING:
    from studio.core.solver.request import AdaptedMotion


def place_now(editor: Editor, point: BodyPoint) -> Vector | None:
    """Where a point of the body is, metres in the motion's space; None while nobody performs."""
    from studio.core.solver.adapt import place_of  # not before a result is there: it loads kernels

    pose = _pose(editor)
    return None if pose is None else _vector(place_of(point, pose)[0])


def mass_now(editor: Editor) -> Vector | None:
    """Where the body's centre of mass is, as ``place_now``."""
    from studio.core.metrics import centre_of_mass  # as above

    pose = _pose(editor)
    return None if pose is None else _vector(centre_of_mass(pose)[0])


def _pose(editor: Editor) -> "AdaptedMotion | None":
    """The one frame of the active performer that is on show."""
    document = editor.document
    performer_id = document.active_performer_id
    motion = editor.live.result(performer_id) if performer_id else None
    if performer_id is None or motion is None or not document.project.performers[performer_id].clips:
        return None
    clip = document.project.performers[performer_id].clips[0]
    frame = round((document.playhead.time - clip.start) * motion.frame_rate) + clip.first
    row = int(np.clip(frame, clip.first, clip.last)) - motion.first_frame
    row = min(max(row, 0), motion.frame_count - 1)
    return replace(motion, positions=motion.positions[row : row + 1], rotations=motion.rotations[row : row + 1])


def _vector(place: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in place)
    return x, y, z
