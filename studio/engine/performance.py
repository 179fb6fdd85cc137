"""What a performer does at a moment of the stage: its clip's frame, its pose, its place."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.placement import Placement
from studio.core.project import Clip, Performer, Project
from studio.core.rest_pose import rest_pose
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]
Results = Callable[[str], AdaptedMotion | None]
"""The newest adapted motion by id, or None while there is none."""


def motion_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Seconds of the clip's motion that play at stage ``time``, held at the clip's ends."""
    return min(max(time - clip.start + clip.first / frame_rate, clip.first / frame_rate), clip.last / frame_rate)


def stage_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Stage time at which second ``time`` of the clip's motion plays."""
    return time + clip.start - clip.first / frame_rate


def row_at(motion: AdaptedMotion, clip: Clip | None, time: float) -> int:
    """Row of ``motion`` shown at stage ``time``: the nearest frame."""
    seconds = time if clip is None else motion_time(clip, motion.frame_rate, time)
    frame = round(seconds * motion.frame_rate) - motion.first_frame
    return min(max(frame, 0), motion.frame_count - 1)


@dataclass(frozen=True, eq=False)
class Posed:
    """A performer at a moment: its motion, which row of it, and where it stands."""

    performer: Performer
    motion: AdaptedMotion
    row: int
    placement: Placement
    resting: bool = False
    """Whether it only stands and waits for its motion."""

    @cached_property
    def points(self) -> FloatArray:
        """(K+23, 3) the canonical points on the stage."""
        return self.placement.to_stage(self.motion.positions[self.row])

    @property
    def seconds(self) -> float:
        """The time of its motion that it shows."""
        return (self.row + self.motion.first_frame) / self.motion.frame_rate

    @property
    def motion_id(self) -> str | None:
        """The motion of its first clip."""
        return self.performer.clips[0].motion_id if self.performer.clips else None


def pose_of(performer: Performer, motion: AdaptedMotion, time: float) -> Posed:
    """``performer`` playing ``motion`` at stage ``time``."""
    clip = performer.clips[0] if performer.clips else None
    return Posed(performer, motion, row_at(motion, clip, time), Placement.of(performer))


def posed_performers(project: Project, result_of: Results, time: float) -> dict[str, Posed]:
    """Every visible performer that has an adapted motion, at stage ``time``."""
    posed = {}
    for performer_id, performer in project.performers.items():
        character = project.characters.get(performer.character_id) if performer.visible else None
        motion = result_of(performer_id) if character is not None else None
        # A result may still be of the body that the performer had before.
        if motion is not None and character is not None and motion.morphology.layout == character.build.layout:
            posed[performer_id] = pose_of(performer, motion, time)
    return posed


def resting_performers(project: Project, posed: Mapping[str, Posed]) -> dict[str, Posed]:
    """Every visible performer that is not in ``posed``, in its rest pose at its place."""
    resting = {}
    for performer_id, performer in project.performers.items():
        character = project.characters.get(performer.character_id) if performer.visible else None
        if character is not None and performer_id not in posed:
            positions, rotations = (part[None] for part in rest_pose(character.morphology))
            motion = AdaptedMotion(character.morphology, 1.0, 0, positions, rotations, np.empty((0, 1)))
            resting[performer_id] = Posed(performer, motion, 0, Placement.of(performer), resting=True)
    return resting
