"""Pose correction of a picked joint by the gizmo: rotated (E), or moved by two-bone or spine IK (W), on a correction
layer.
"""

from collections.abc import Mapping

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import limb_bones
from studio.core.kernels import channel_columns as channel
from studio.core.rotations import from_matrix, to_rotation_vector
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.correction import NO_OFFSET, Correction, PoseOffsets
from studio.document.correction_edits import correction_at, set_pose
from studio.document.document import Document
from studio.engine.correction_range import with_fitted_fades
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.body_points import BodyJoint
from studio.viewport.camera import FloatArray
from studio.viewport.movables import Movable
from studio.viewport.new_constraints import turned_part

HIPS = (BodyPart.PELVIS,)


class CorrectedJoint(Movable):
    """Picked joint at the playhead; rotating and moving it edits a correction layer."""

    rotates = True

    def __init__(self, document: Document, performer_id: str, pose: PosedPerformer, joint: BodyJoint) -> None:
        self._document, self._performer_id, self._pose, self._joint = document, performer_id, pose, joint
        self.placement = pose.placement
        self._part = turned_part(joint.point)
        self._time = document.playhead.time
        self._id = correction_at(document, performer_id, self._time)
        self._before = document.project.corrections.get(self._id or "")
        self._selected = document.selection.items
        self._keyed: Correction | None = None
        limb = limb_bones(self._part)
        self._upper = limb[0] if limb and self._part not in limb else None
        self._is_hips = joint.point.part is BodyPart.PELVIS
        self._is_head = self._part in (BodyPart.HEAD, BodyPart.NECK) and joint.point.at_end
        self.moves = self._upper is not None or self._is_hips or self._is_head

    @property
    def words(self) -> str:
        """Name of the joint or body part: ``left elbow``."""
        return self._joint.name

    @property
    def place(self) -> FloatArray:
        """(3,) position in motion space: the end of the limb for a hand or foot, else the joint."""
        layout = self._pose.motion.morphology.layout
        index = self._joint.index
        if self._upper is not None:
            index = layout.proximal_points()[layout.segment_of_part(self._upper) + 2]
        return np.asarray(self._pose.motion.positions[self._pose.row, index])

    @property
    def pivot(self) -> FloatArray:
        """(3,) stage position about which the segment rotates."""
        layout = self._pose.motion.morphology.layout
        return np.asarray(self._pose.points[layout.proximal_points()[layout.segment_of_part(self._part)]])

    @property
    def own_axes(self) -> FloatArray:
        """(3, 3) axes of the segment as columns, stage space."""
        return self._axes(self._segment)

    @property
    def parent_axes(self) -> FloatArray:
        """(3, 3) axes of the parent segment as columns, stage space; of motion space without a parent."""
        parent = self._pose.motion.morphology.layout.parent_segments()[self._segment]
        return self._axes(parent) if parent >= 0 else self.placement.rotation

    @property
    def _segment(self) -> int:
        return self._pose.motion.morphology.layout.segment_of_part(self._part)

    def _axes(self, segment: int) -> FloatArray:
        return np.asarray(self.placement.rotation @ self._pose.motion.rotations[self._pose.row, segment])

    def rotate(self, rotation: FloatArray, gesture: int) -> None:
        """Rotate the segment by ``rotation`` (3, 3), stage space, from its displayed pose."""
        own = self.own_axes
        self._set({self._part: to_rotation_vector(from_matrix(own.T @ rotation @ own))}, None, gesture)

    def move(self, position: FloatArray, gesture: int) -> None:
        """Move the joint to ``position`` (3,): a limb bends, trunk and neck lean, or the hips move."""
        from studio.core.solver.posing import head_turns, limb_turns  # here: it loads kernels

        motion, row = self._pose.motion, self._pose.row
        posed = motion.morphology.layout, motion.positions[row], motion.rotations[row]
        if self._is_hips:
            self._set({}, position - self.place, gesture)
        elif self._upper is not None:
            self._set(limb_turns(*posed, self._upper, position), None, gesture)
        else:
            further = position - self.place
            self._set(head_turns(*posed, posed[1][posed[0].head_joint] + further), None, gesture)

    def finish(self, gesture: int) -> None:
        """Fit the fades of the correction to its pose."""
        document, key, keyed = self._document, self._id or "", self._keyed
        if keyed is not None and document.project.corrections.get(key) is keyed:  # else another project was opened
            timing = timing_of(document.project, self._pose.performer)
            fitted = with_fitted_fades(keyed, self._before, timing, self._pose.over_time, self._time)
            document.replace("corrections", key, fitted, f"Correct {self.words}", gesture)

    def restore(self, gesture: int) -> None:
        """Restore the correction; one that was new is removed."""
        document = self._document
        with document.group(f"Correct {self.words}", gesture):
            if self._id is not None and self._id in document.project.corrections:
                if self._before is None:
                    document.remove("corrections", self._id, "Correct pose")
                else:
                    document.replace("corrections", self._id, self._before, "Correct pose")
        document.selection.set(*(item for item in self._selected if document.project.get(*item) is not None))

    def _set(self, turns: Mapping[BodyPart, FloatArray], displacement: FloatArray | None, gesture: int) -> None:
        """Key rotations (3, 3) of parts, and a displacement (3,) of the hips in metres, relative to the displayed
        pose.
        """
        from studio.core.solver.posing import composed_rotations  # here: it loads kernels

        before, weight = self._offsets
        now = composed_rotations(turns, {part: weight * np.array(before.turn(part)) for part in turns})
        keyed = {part: _vector(turn / weight) for part, turn in now.items()}
        hips = None
        if displacement is not None:
            hips = _vector((weight * np.array(before.hips) + self._along_body(displacement)) / weight)
        text = f"Correct {self.words}"
        self._id = set_pose(self._document, self._performer_id, self._time, keyed, hips, gesture, text)
        self._keyed = self._document.project.corrections[self._id]

    @property
    def _offsets(self) -> tuple[PoseOffsets, float]:
        """Offsets of a key at the playhead that would leave the pose unchanged, and the weight of the correction
        there.
        """
        if self._before is None:
            return PoseOffsets(), 1.0
        return self._before.pose_at(self._time), self._before.weight

    def _along_body(self, displacement: FloatArray) -> FloatArray:
        """Displacement (3,) in leg lengths along the body's heading, from one in motion space in metres."""
        motion = self._pose.motion
        channels = motion.composite.motion.channels if motion.composite else None
        yaw = 0.0 if channels is None else float(channels[min(self._pose.frame, len(channels) - 1), channel.YAW])
        c, s = np.cos(yaw), np.sin(yaw)
        x, y, z = displacement
        return np.array([c * x + s * y, -s * x + c * y, z]) / motion.body.leg_length


def _vector(numbers: FloatArray) -> tuple[float, float, float]:
    x, y, z = (round(float(number), 6) for number in numbers)
    return (x, y, z) if (x, y, z) != NO_OFFSET else NO_OFFSET
