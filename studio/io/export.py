"""Motions out to files: adapted ones on a character's own skeleton, captures on theirs."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from studio.core.capture import Capture
from studio.core.character_skeleton import character_poses, character_skeleton
from studio.core.errors import StudioError
from studio.core.pose import PoseSequence
from studio.core.skeleton import Skeleton
from studio.core.solver.request import AdaptedMotion

Writer = Callable[[Path, Skeleton, PoseSequence, float], None]


@dataclass(frozen=True)
class MotionFormat:
    """A kind of file that a motion can be written to; its writer is imported when the first one is written."""

    name: str
    suffixes: tuple[str, ...]
    writer: str
    """``module:function`` taking path, skeleton, poses and frame rate."""

    def write(self, path: Path, skeleton: Skeleton, poses: PoseSequence, frame_rate: float) -> None:
        """The whole file or none of it; raises StudioError."""
        module, function = self.writer.split(":")
        writer: Writer = getattr(import_module(module), function)
        writer(path, skeleton, poses, frame_rate)


MOTION_FORMATS = (MotionFormat("BVH", (".bvh",), "studio.io.bvh_writer:write_bvh"),)


def format_for(path: Path) -> MotionFormat:
    """The format that the file's suffix asks for; StudioError naming those there are."""
    for known in MOTION_FORMATS:
        if path.suffix.lower() in known.suffixes:
            return known
    suffixes = ", ".join(suffix for known in MOTION_FORMATS for suffix in known.suffixes)
    raise StudioError(f"{path.name} says no kind of file that motions can be written to. Let it end with {suffixes}.")


def write_capture(capture: Capture, path: Path) -> MotionFormat:
    """Write a capture with its own joints, poses and frame rate; returns the format that was chosen."""
    chosen = format_for(path)
    chosen.write(path, capture.skeleton, capture.poses, capture.frame_rate)
    return chosen


def export_bvh(adapted: AdaptedMotion, name: str, path: Path) -> None:
    """Write an adapted motion as BVH on the skeleton of its body; ``name`` says in errors whose motion it is.

    Read back, every joint is within 0.01 mm. The file appears whole or not at all.
    """
    try:
        poses = character_poses(adapted)
    except StudioError as error:
        raise StudioError(f"The motion of {name} cannot be exported: {error}") from error
    MOTION_FORMATS[0].write(path, character_skeleton(adapted.morphology), poses, adapted.frame_rate)
