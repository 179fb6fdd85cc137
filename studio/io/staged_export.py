"""What a performer of a stage plays, as a file: its row of clips on its character."""

import re

from studio.core.body.carried_joints import carried_joints
from studio.core.captures.capture import Capture
from studio.core.normalized.normalize import normalize
from studio.core.project import Project
from studio.core.solver.performers.performing import Performance
from studio.core.solver.performers.rows import is_plain
from studio.io.export import Take, take_of_adapted


def file_name(project: Project, performer_id: str, suffix: str = ".bvh") -> str:
    """``front_kick tall man.bvh``: the motion, of several the first, and who performs it."""
    performer = project.performers[performer_id]
    motion = project.motions[performer.clips[0].motion_id]
    return safe_name(f"{motion.name} {performer.name.lower()}{suffix}")


def safe_name(name: str) -> str:
    """A name that every system allows."""
    return re.sub(r'[\\/:*?"<>|]', "_", name)


def take_of_performer(project: Project, performer_id: str, performance: Performance, *, along: bool = False) -> Take:
    """What one performer plays on its character; ``along`` has it carry the other joints of its only capture."""
    performer = project.performers[performer_id]
    character = project.characters[performer.character_id]
    clips = performer.clips
    capture = project.captures[project.motions[clips[0].motion_id].capture_id]
    alone = len(clips) == 1 and is_plain(clips[0])
    carried = (capture, normalize(capture)[1]) if along and alone and other_joints(capture) else None
    return take_of_adapted(performer.name, performance.played, character, performance.request, carried)


def other_joints(capture: Capture) -> tuple[str, ...]:
    """The capture's joints that a character can carry along."""
    if capture.body_map is None:
        return ()
    skeleton = capture.skeleton
    carried = carried_joints(skeleton, capture.body_map)
    return tuple(skeleton.names[joint] for joint in carried if not skeleton.end_sites[joint])
