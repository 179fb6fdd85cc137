"""Insertion of a found strike: a clip and a constraint of a performer, as one undo step."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.app.capture_import import ReadMotion, add_motion
from studio.app.strike_target import StrikeTarget
from studio.app.workbench import Workbench
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.stage.project import Project, new_id
from studio.document.edited_project import EditedProject

# Here and below: what searches loads the solver, which takes longer than a window.
if TYPE_CHECKING:
    from studio.library.inserted_strike import StrikeScene
    from studio.library.searching import Result

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StrikeRequest:
    """Request to play a found strike: performer, start time on the stage in seconds, and target.

    ``frozen`` (3,) is a fixed target position on the stage; if it is None, the strike follows the moving target.
    """

    found: "Result"
    performer_id: str
    time: float
    target: StrikeTarget
    frozen: FloatArray | None


def _known_capture(project: Project, capture: Capture) -> str | None:
    """Id of a capture of the project with the same frames as ``capture`` and a motion; None if there is none."""
    performed = {motion.capture_id for motion in project.motions.values()}
    for key, each in project.captures.items():
        same = each.skeleton.names == capture.skeleton.names and each.frame_rate == capture.frame_rate
        if key in performed and same and np.array_equal(each.poses.local_rotations, capture.poses.local_rotations):
            return key
    return None


def put_strike(bench: Workbench, wish: StrikeRequest, source: ReadMotion | str) -> None:
    """Insert a strike as a clip of its performer; ``source`` is the capture just read, or the id of one in the project.

    Raises StudioError, and changes nothing, if the performer or the target is missing.
    """
    from studio.library.inserted_strike import inserted_strike

    document, found, key = bench.document, wish.found, wish.performer_id
    project = document.project
    if key not in project.performers or project.get(wish.target.collection, wish.target.id) is None:
        raise StudioError("The character or the target no longer exists. Search again.")
    text = f"Insert strike at {wish.target.name(project)}"
    with document.group(text):
        known = _known_capture(project, source.capture) if isinstance(source, ReadMotion) else source
        if known is not None:
            capture_id = known
        elif isinstance(source, ReadMotion):
            capture_id = add_motion(document, source, text)
            bench.sources[capture_id] = Path(found.clip.take.path)
        motions = document.project.motions.items()
        motion_id = next(each for each, motion in motions if motion.capture_id == capture_id)
        clip_id = new_id()
        scene = strike_scene(bench, key, wish.time, wish.target, wish.frozen)
        _put(document, inserted_strike(scene, found, motion_id, clip_id, new_id()), key, text)
    document.selection.set(("performers", key), ("clips", clip_id))


def strike_scene(
    bench: Workbench, performer_id: str, time: float, target: StrikeTarget, frozen: FloatArray | None
) -> "StrikeScene":
    """Scene in which a strike is evaluated and inserted: performer, time in seconds, and target position ``frozen``
    (3,) or None for a moving target.
    """
    from studio.library.inserted_strike import StrikeScene

    project = bench.document.project
    captures = {motion.capture_id: key for key, motion in project.motions.items()}
    known = {str(path): captures[key] for key, path in bench.sources.items() if key in captures}
    aim = target.follow if frozen is None else frozen
    results = {key: result for key in project.performers if (result := bench.live.result(key)) is not None}
    return StrikeScene(project, performer_id, time, aim, results, known)


def _put(document: EditedProject, made: Project, performer_id: str, text: str) -> None:
    """Replace a performer by the one in the project ``made``, and add the new constraints and contacts."""
    document.replace("performers", performer_id, made.performers[performer_id], text)
    for collection in ("constraints", "contacts"):
        known = getattr(document.project, collection)
        new = {key: each for key, each in getattr(made, collection).items() if key not in known}
        document.put_all(collection, new, text)
