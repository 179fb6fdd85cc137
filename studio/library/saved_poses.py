"""Saved poses: one JSON file for each, in a folder of the user's library, which a person can read and edit."""

import math
from dataclasses import dataclass
from pathlib import Path

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import Vector
from studio.core.errors import StudioError
from studio.core.names import free_name, safe_name
from studio.core.stage.local_pose import LocalPose
from studio.io.json_text import read_json, write_json

POSE_SUFFIX = ".json"
POSE_NAME_KEY, HIPS_HEIGHT_KEY, POSE_ROTATIONS_KEY = "name", "hips height (leg lengths)", "rotation vectors (degrees)"
"""Keys in the JSON file of a pose."""


@dataclass(frozen=True)
class SavedPose:
    """Named pose, and the path of its file."""

    path: Path
    name: str
    pose: LocalPose


def read_pose(path: Path) -> SavedPose:
    """Pose in the file ``path``. Raises StudioError with the reason if it cannot be read."""
    record = read_json(path)
    try:
        if not isinstance(record, dict):
            raise ValueError("It is no record.")
        rotations = {BodyPart(part): _radians(angles) for part, angles in record[POSE_ROTATIONS_KEY].items()}
        return SavedPose(path, str(record[POSE_NAME_KEY]), LocalPose(rotations, float(record[HIPS_HEIGHT_KEY])))
    except KeyError as error:
        reason = f"It has no {error}."
    except (TypeError, ValueError, AttributeError, OverflowError) as error:
        reason = f"{str(error).rstrip('.')}."
    raise StudioError(f"{path} is not a pose. {reason} Correct it there, or delete the file and save the pose again.")


def read_poses(folder: Path) -> tuple[list[SavedPose], list[str]]:
    """Poses in ``folder`` sorted by name, and an error message for each file that holds no pose."""
    found, problems = [], []
    for path in sorted(folder.glob(f"*{POSE_SUFFIX}")):
        try:
            found.append(read_pose(path))
        except StudioError as error:
            problems.append(str(error))
    return sorted(found, key=lambda each: each.name.lower()), problems


def write_pose(folder: Path, name: str, pose: LocalPose) -> SavedPose:
    """Write a pose to a new file of ``folder``, and return it. Raises StudioError if it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudioError(
            f"The folder '{folder}' cannot be created: {error.strerror}. Check its permissions."
        ) from error
    taken = {path.stem for path in folder.glob(f"*{POSE_SUFFIX}")}
    path = folder / f"{free_name(safe_name(name).lower(), taken)}{POSE_SUFFIX}"
    rotations = {part.value: [round(math.degrees(angle), 4) for angle in pose.rotations[part]] for part in BodyPart}
    write_json(path, {POSE_NAME_KEY: name, HIPS_HEIGHT_KEY: round(pose.hips_height, 4), POSE_ROTATIONS_KEY: rotations})
    return SavedPose(path, name, pose)


def _radians(degrees: list[float]) -> Vector:
    if len(degrees) != 3:
        raise ValueError(f"A rotation is three numbers, got {degrees}.")
    x, y, z = map(math.radians, degrees)
    return x, y, z


def rename_pose(saved: SavedPose, name: str) -> SavedPose:
    """Save a pose under another name in place of the old one, and return it. Raises StudioError if it cannot be
    written.
    """
    renamed = write_pose(saved.path.parent, name, saved.pose)
    delete_pose(saved)
    return renamed


def delete_pose(saved: SavedPose) -> None:
    """Delete the file of a pose. Raises StudioError if it cannot be deleted."""
    try:
        saved.path.unlink(missing_ok=True)
    except OSError as error:
        raise StudioError(
            f"'{saved.path}' could not be deleted: {error.strerror}. Delete it in the file manager."
        ) from error
