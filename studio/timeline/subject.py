"""Subject: which motion the timeline shows, on which bodies, and how its frames lie on the stage."""

from dataclasses import dataclass

from studio.core.project import Clip, Motion, Performer, Project
from studio.document.document import Document


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
    def offset(self) -> float:
        """Seconds from a time of the motion to the same moment on the stage."""
        return self.clip.start - self.clip.first / self.frame_rate

    @property
    def last_frame(self) -> int:
        """The motion's last frame."""
        return self.frame_count - 1

    def stage_time(self, frame: float) -> float:
        """Seconds on the stage at which a frame of the motion is played."""
        return frame / self.frame_rate + self.offset

    def motion_frame(self, seconds: float) -> float:
        """The motion's frame played at a time of the stage, not rounded."""
        return (seconds - self.offset) * self.frame_rate


def subject_of(document: Document) -> Subject | None:
    """What there is to show, or None when no performer plays a motion."""
    project = document.project
    performer = project.performers.get(document.active_performer_id or "")
    if performer is None or not performer.clips:
        return None
    clip = performer.clips[0]
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
    ends = [1.0]
    for performer in project.performers.values():
        for clip in performer.clips:
            capture = project.captures[project.motions[clip.motion_id].capture_id]
            ends.append(clip.start + (clip.last - clip.first) / capture.frame_rate)
    return max(ends[1:] or ends)


def _plays(performer: Performer, motion_id: str) -> bool:
    return bool(performer.clips) and performer.clips[0].motion_id == motion_id
