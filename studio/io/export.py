"""Motions out to files: adapted ones on a character's own skeleton, captures on theirs."""

from dataclasses import dataclass
from pathlib import Path

from studio.core.capture import Capture
from studio.core.character import Character
from studio.core.character_skeleton import character_poses, character_skeleton
from studio.core.errors import StudioError
from studio.core.normalized.actor import Actor
from studio.core.normalized.realize import own_poses
from studio.core.pose import PoseSequence
from studio.core.skeleton import Skeleton
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.registry import Format, Progress, known_formats


@dataclass(frozen=True, eq=False)
class Take:
    """A motion on its way out: joints and poses for every format, and what more is known for those that hold it."""

    name: str
    skeleton: Skeleton
    poses: PoseSequence
    frame_rate: float
    capture: Capture | None = None
    """What is written as it was recorded."""
    character: Character | None = None
    """Who performs ``adapted``, with the skin; ``skeleton`` is then its ``character_skeleton``."""
    adapted: AdaptedMotion | None = None
    request: AdaptRequest | None = None
    """What ``adapted`` answers: the normalised motion, contacts, constraints."""


def take_of_capture(capture: Capture) -> Take:
    """A capture with its own joints, poses and frame rate."""
    return Take(capture.name, capture.skeleton, capture.poses, capture.frame_rate, capture=capture)


def take_of_adapted(
    name: str, adapted: AdaptedMotion, character: Character | None = None, request: AdaptRequest | None = None
) -> Take:
    """An adapted motion on the skeleton of its body; ``name`` says in errors whose motion it is."""
    try:
        poses = character_poses(adapted)
    except StudioError as error:
        raise StudioError(f"The motion of {name} cannot be exported: {error}") from error
    skeleton = character_skeleton(adapted.morphology)
    return Take(name, skeleton, poses, adapted.frame_rate, character=character, adapted=adapted, request=request)


def take_of_actor(adapted: AdaptedMotion, actor: Actor, request: AdaptRequest | None = None) -> Take:
    """A motion adapted to the actor of its own capture, on the capture's joints: fingers, eyes, props and all others
    that play no part of the body move as they were captured.
    """
    name = request.motion.name if request else "the actor"
    try:
        poses = own_poses(actor, adapted.positions, adapted.rotations, adapted.first_frame)
    except StudioError as error:
        raise StudioError(f"The motion of {name} cannot be exported: {error}") from error
    return Take(name, actor.skeleton, poses, adapted.frame_rate, adapted=adapted, request=request)


def format_for(path: Path, job: str = "motion_writer") -> Format:
    """The format that the file's suffix asks for; StudioError naming those there are."""
    known = known_formats()
    for each in known.that_can(job):
        if path.suffix.lower() in each.suffixes:
            return each
    what = job.removesuffix("_writer")
    suffixes = ", ".join(known.suffixes(job))
    raise StudioError(f"{path.name} says no kind of file that a {what} can be written to. Let it end with {suffixes}.")


def write_take(take: Take, path: Path, progress: Progress = lambda share, text: None) -> Format:
    """Write a take in the format that the suffix of ``path`` asks for, which is returned. Raises StudioError."""
    chosen = format_for(path)
    chosen.write_motion(path, take, progress)
    return chosen


def write_capture(capture: Capture, path: Path) -> Format:
    """``write_take`` of a capture as it is."""
    return write_take(take_of_capture(capture), path)
