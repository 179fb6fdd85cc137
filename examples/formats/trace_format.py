"""A file format added to the studio: one text line a frame, ``time x y z``, of where the root is.

An installed package makes it known in its pyproject.toml, and every dialog and verb has it:

    [project.entry-points."morpho_studio.formats"]
    trace = "trace_format:FORMAT"
"""

from pathlib import Path

import numpy as np

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.rotations import IDENTITY_QUATERNION
from studio.io.atomic_write import write_atomically
from studio.io.export import Take
from studio.io.importing import ImportOptions
from studio.io.registry import Format, Progress, ReadCapture

HEAD = "trace 1\n"
FORMAT = Format(
    "Trace", (".trace",), f"{__name__}:sniff", capture_reader=f"{__name__}:read", motion_writer=f"{__name__}:write"
)


def sniff(head: bytes) -> bool:
    """True if a file that begins with ``head`` is a trace."""
    return head.startswith(HEAD.encode())


def read(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """A skeleton of one joint that goes where the trace says, in metres."""
    progress(0.0, f"Reading {path.name}")
    try:
        rows = np.loadtxt(path, skiprows=1, ndmin=2)
        times, places = rows[:, 0], rows[:, 1:4].reshape(-1, 1, 3)
        rate = options.frame_rate or round(1.0 / float(np.diff(times).mean()), 3)
    except (ValueError, IndexError, ZeroDivisionError) as error:
        raise StudioError(f"{path.name} is no trace of 'time x y z': {error}. Export it again.") from error
    skeleton = Skeleton(("Root",), np.array([-1]), np.zeros((1, 3)), np.array([False]))
    poses = PoseSequence(np.tile(IDENTITY_QUATERNION, (len(rows), 1, 1)), places)
    guess = Guess("unit", "m", "A trace does not say its unit.", Confidence.LIKELY)
    still = np.tile(IDENTITY_QUATERNION, (1, 1))
    capture = Capture(path.stem, path.name, skeleton, poses, rate, None, still, 0.0, "m", "Z", 0, (guess,), ())
    return ReadCapture(capture)


def write(path: Path, take: Take, progress: Progress) -> None:
    """Write the places of the root of ``take``."""
    progress(0.0, f"Writing {path.name}")
    places = take.poses.local_translations[:, 0]
    lines = (f"{frame / take.frame_rate:.6f} {x} {y} {z}\n" for frame, (x, y, z) in enumerate(places))
    write_atomically(path, (HEAD + "".join(lines)).encode())
