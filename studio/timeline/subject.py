"""Motion shown by the timeline, the performers that play it, and the mapping of its frames to the stage."""

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
class BodyOnTimeline:
    """Visible performer of the active motion, with its name and colour."""

    performer_id: str
    name: str
    colour: str


@dataclass(frozen=True)
class ActiveMotion:
    """Motion of the active performer's clip; constraints and contacts count in its own time."""

    performer_id: str
    clip: Clip
    motion: Motion
    frame_rate: float
    frame_count: int
    bodies: tuple[BodyOnTimeline, ...]

    @property
    def motion_id(self) -> str:
        """Id of the motion."""
        return self.clip.motion_id

    @property
    def last_frame(self) -> int:
        """Last frame of the motion."""
        return self.frame_count - 1

    def to_stage(self, seconds: Seconds) -> Seconds:
        """Stage times in seconds at which times of the motion, a number or an array, first play."""
        if not isinstance(self.clip.speed, KeyedNumber):  # thousands of times a picture
            return self.clip.start + (seconds - self.clip.first / self.frame_rate) / self.clip.speed
        return self._like(seconds, self.clip.stage_seconds(seconds, self.frame_rate))

    def to_motion(self, seconds: Seconds) -> Seconds:
        """Times of the motion in seconds at stage times, extrapolated beyond the ends of the clip."""
        if not isinstance(self.clip.speed, KeyedNumber):
            return (seconds - self.clip.start) * self.clip.speed + self.clip.first / self.frame_rate
        return self._like(seconds, self.clip.motion_seconds(seconds, self.frame_rate))

    @staticmethod
    def _like(asked: Seconds, found: NDArray[np.float64]) -> Seconds:
        return found if isinstance(asked, np.ndarray) else float(found)

    def stage_time(self, frame: float) -> float:
        """Stage time in seconds at which a frame of the motion first plays."""
        return float(self.to_stage(frame / self.frame_rate))

    def motion_frame(self, seconds: float) -> float:
        """Frame of the motion at a stage time in seconds, as a fractional number."""
        return float(self.to_motion(seconds) * self.frame_rate)

    @property
    def repeat_seconds(self) -> float:
        """Duration on the stage of one loop of the clip, in seconds."""
        return self.clip.length(self.frame_rate) / self.clip.repeats

    def looped_frame(self, seconds: float) -> float:
        """Frame of the motion that plays at a stage time in seconds, loops included, as a fractional number."""
        return self.motion_frame(seconds - self.clip.repeat_at(seconds, self.frame_rate) * self.repeat_seconds)


def subject_of(document: Document) -> ActiveMotion | None:
    """Motion that the timeline shows; None if no performer plays one."""
    project = document.project
    performer = project.performers.get(document.active_performer_id or "")
    if performer is None or not performer.clips:
        return None
    clip = document.active_clip or performer.clips[0]
    motion = project.motions[clip.motion_id]
    capture = project.captures[motion.capture_id]
    return ActiveMotion(
        performer_id=document.active_performer_id or "",
        clip=clip,
        motion=motion,
        frame_rate=capture.frame_rate,
        frame_count=capture.poses.frame_count,
        bodies=tuple(
            BodyOnTimeline(key, each.name, project.characters[each.character_id].colour)
            for key, each in project.performers.items()
            if each.visible and _plays(each, clip.motion_id)
        ),
    )


def stage_extent(project: Project) -> float:
    """End in seconds of the last clip on the stage; 1 without clips."""
    ends = [timing_of(project, performer).end for performer in project.performers.values() if performer.clips]
    return max(ends, default=1.0)


def play_different_rows(project: Project) -> bool:
    """True if visible performers play different clips, so that each needs a clip track."""
    return len({(each.clips, each.layers) for each in project.performers.values() if each.visible}) > 1


def _plays(performer: Performer, motion_id: str) -> bool:
    return any(clip.motion_id == motion_id for clip in performer.clips)
