"""Subject: which motion the timeline shows, on which bodies, and how its frames lie on the stage."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from studio.core.curves.keyed import KeyedNumber
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project
from studio.document.document import Document

Seconds = TypeVar("Seconds", float, NDArray[np.float64])


@dataclass(frozen=True)
class Body:
    """A visible performer of the motion, as it is told apart everywhere: by name and colour."""

    performer_id: str
    name: str
    colour: str


@dataclass(frozen=True)
class Subject:
    """The motion of the active performer's clip; constraints and contacts count from its own beginning."""

    performer_id: str
    clip: Clip
    motion: Motion
    frame_rate: float
    frame_count: int
    bodies: tuple[Body, ...]

    @property
    def motion_id(self) -> str:
        """The motion shown."""
        return self.clip.motion_id

    @property
    def last_frame(self) -> int:
        """The motion's last frame."""
        return self.frame_count - 1

    def to_stage(self, seconds: Seconds) -> Seconds:
        """Seconds on the stage at which seconds of the motion, one number or many, are played first."""
        if not isinstance(self.clip.speed, KeyedNumber):  # thousands of times a picture
            return self.clip.start + (seconds - self.clip.first / self.frame_rate) / self.clip.speed
        return self._like(seconds, self.clip.stage_seconds(seconds, self.frame_rate))

    def to_motion(self, seconds: Seconds) -> Seconds:
        """Seconds of the motion that are played at times of the stage, before and after the clip too."""
        if not isinstance(self.clip.speed, KeyedNumber):
            return (seconds - self.clip.start) * self.clip.speed + self.clip.first / self.frame_rate
        return self._like(seconds, self.clip.motion_seconds(seconds, self.frame_rate))

    @staticmethod
    def _like(asked: Seconds, found: NDArray[np.float64]) -> Seconds:
        return found if isinstance(asked, np.ndarray) else float(found)

    def stage_time(self, frame: float) -> float:
        """Seconds on the stage at which a frame of the motion is played."""
        return float(self.to_stage(frame / self.frame_rate))

    def motion_frame(self, seconds: float) -> float:
        """The motion's frame played at a time of the stage, not rounded."""
        return float(self.to_motion(seconds) * self.frame_rate)


def subject_of(document: Document) -> Subject | None:
    """Content of the rows; None when no performer plays a motion."""
    project = document.project
    performer = project.performers.get(document.active_performer_id or "")
    if performer is None or not performer.clips:
        return None
    clip = document.active_clip or performer.clips[0]
    motion = project.motions[clip.motion_id]
    capture = project.captures[motion.capture_id]
    return Subject(
        performer_id=document.active_performer_id or "",
        clip=clip,
        motion=motion,
        frame_rate=capture.frame_rate,
        frame_count=capture.poses.frame_count,
        bodies=tuple(
            Body(key, each.name, project.characters[each.character_id].colour)
            for key, each in project.performers.items()
            if each.visible and _plays(each, clip.motion_id)
        ),
    )


def stage_extent(project: Project) -> float:
    """Seconds at which the last clip on the stage ends; 1 where there is none."""
    ends = [timing_of(project, performer).end for performer in project.performers.values() if performer.clips]
    return max(ends, default=1.0)


def play_apart(project: Project) -> bool:
    """True if visible performers play different clips, so that one row cannot stand for all."""
    return len({(each.clips, each.layers) for each in project.performers.values() if each.visible}) > 1


def _plays(performer: Performer, motion_id: str) -> bool:
    return any(clip.motion_id == motion_id for clip in performer.clips)
