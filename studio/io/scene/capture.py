"""Interpretation of scenes, read by a child process, as captures; scales and mirroring are removed."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.rotations import from_matrix, normalized, sign_continuous, to_matrix
from studio.io.bvh.capture import capture_of
from studio.io.guessing import Scale, unit_of_metres
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture
from studio.io.scene.proper_rotations import proper_rotations
from studio.io.scene.scene_reader import SCENE_ADVICE, Arrays

FloatArray = NDArray[np.float64]

_DIGIT = 1e-6
"""Seconds to which programs round the time of a frame."""
_SMALLEST_SCALE = 1e-9
_TURN = slice(3, 7)
_PARTS = slice(0, 3), _TURN, slice(7, 10)
"""Place, turn and scale among the ten numbers of a joint."""


@dataclass(frozen=True)
class SceneJoints:
    """Motion of joints relative to their rest pose: with all rotations zero the body is in its bind pose."""

    skeleton: Skeleton
    local_rotations: FloatArray
    local_translations: FloatArray
    frame_time: float | None
    stated_unit: Scale
    stated_up_axis: str
    repairs: tuple[str, ...]
    frame_time_digit: float = _DIGIT

    @property
    def frame_count(self) -> int:
        """Number of frames F."""
        return len(self.local_rotations)

    def transforms(self, frames: NDArray[np.int64] | slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (N, J, 4) and translations (N, J, 3) of ``frames`` (N,)."""
        return self.local_rotations[frames], self.local_translations[frames]


def capture_in(arrays: Arrays, path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture in the arrays read from ``path`` by the child process: its longest animation. Raises StudioError."""
    file = scene_joints(arrays, path)
    progress(0.4, f"Reading {path.name}")

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        return capture_of(file, path, options, progress)

    return ReadCapture(interpret(options, progress), interpret=interpret)


def scene_joints(arrays: Arrays, path: Path) -> SceneJoints:
    """Joints and frames in the arrays of the file, in its own units and axes. Raises StudioError."""
    try:
        frames, rest, about = arrays["frames"], arrays["rest"], json.loads(arrays["about"].tobytes())
    except (ValueError, KeyError) as error:
        raise StudioError(f"{path.name} could not be read: {error}. {SCENE_ADVICE}") from error
    repairs = _fill(path.name, frames)
    if not (np.isfinite(frames).all() and np.isfinite(rest).all()):
        raise StudioError(f"{path.name}: its joints lie at places that are not numbers. {SCENE_ADVICE}")
    return _rigid(about, frames, rest, path, repairs)


def _fill(name: str, frames: FloatArray) -> tuple[str, ...]:
    """Interpolate missing values of ``frames`` (F, J, 10) in time, in place; return a sentence with the number of
    frames.

    A position, rotation or scale that is missing in all frames stays missing.
    """
    lacking = np.flatnonzero(~np.isfinite(frames).all(axis=(1, 2)))
    times = np.arange(len(frames))
    for joint in np.flatnonzero(~np.isfinite(frames).all(axis=(0, 2))).tolist():
        for part in _PARTS:
            known = np.isfinite(frames[:, joint, part]).all(axis=1)
            if known.all() or not known.any():
                continue
            course = frames[known, joint, part]
            course = sign_continuous(course) if part is _TURN else course
            for column, values in zip(range(10)[part], course.T, strict=True):
                frames[:, joint, column] = np.interp(times, times[known], values)
    if not len(lacking):
        return ()
    count = "1 frame lacks" if len(lacking) == 1 else f"{len(lacking)} frames lack"
    return (f"{name}, frame {lacking[0]}: {count} numbers; what is missing was filled from the frames around.",)


def _rigid(
    about: dict[str, object], frames: FloatArray, rest: FloatArray, path: Path, repairs: tuple[str, ...]
) -> SceneJoints:
    """Joints with scales applied to the positions, and rotations relative to the rest pose."""
    names, parents = _one_root(list(about["names"]), list(about["parents"]))  # type: ignore[call-overload]
    added = len(names) - frames.shape[1]
    still = np.array([0.0] * 6 + [1.0] * 4)
    frames = np.concatenate([np.broadcast_to(still, (len(frames), added, 10)), frames], axis=1)
    rest = np.concatenate([np.broadcast_to(still, (added, 10)), rest])
    with np.errstate(over="ignore", invalid="ignore"):
        rest_places, rest_turns = _world(parents, rest[None])
        places, turns = _world(parents, frames)
    if not all(np.isfinite(numbers).all() for numbers in (rest_places, rest_turns, places, turns)):
        raise StudioError(f"{path.name}: its joints lie farther away than can be told. {SCENE_ADVICE}")
    turns, mirrored = proper_rotations(names, turns @ np.swapaxes(rest_turns, -1, -2))
    above = np.maximum(parents, 0)
    carrier = np.where((parents < 0)[:, None, None], np.eye(3), turns[:, above])
    offsets = rest_places[0] - np.where((parents < 0)[:, None], 0.0, rest_places[0, above])
    moved = places - np.where((parents < 0)[:, None], 0.0, places[:, above])
    local = from_matrix(np.swapaxes(carrier, -1, -2) @ turns)
    translations = np.einsum("fjba,fjb->fja", carrier, moved)
    skeleton = Skeleton(tuple(names), parents, offsets, np.zeros(len(names), dtype=bool))
    poses = PoseSequence(local, translations)
    rate, metres = float(about["frame_rate"]), float(about["unit_metres"])  # type: ignore[arg-type]
    return SceneJoints(
        skeleton,
        poses.local_rotations,
        poses.local_translations,
        1.0 / rate,
        unit_of_metres(metres),
        str(about["up_axis"]),
        (*repairs, *mirrored),
    )


def _one_root(names: list[str], parents: list[int]) -> tuple[list[str], NDArray[np.int64]]:
    """Unique names, and a joint above all if there are several roots."""
    taken: set[str] = set()
    for index, name in enumerate(names):
        unique, number = name or f"joint{index}", 2
        while unique in taken:
            unique, number = f"{name}_{number}", number + 1
        taken.add(unique)
        names[index] = unique
    if parents.count(-1) == 1:
        return names, np.array(parents)
    world = "World"
    while world in taken:
        world += "_"
    return [world, *names], np.array([-1, *(parent + 1 for parent in parents)])


def _world(parents: NDArray[np.int64], local: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (F, J, 3) and rotations (F, J, 3, 3) of joints with local position, rotation and scale (F, J, 10)."""
    places = np.empty((*local.shape[:2], 3))
    spaces = to_matrix(normalized(local[..., 3:7])) * local[..., None, 7:]
    for joint, parent in enumerate(parents.tolist()):
        if parent < 0:
            places[:, joint] = local[:, joint, :3]
        else:
            places[:, joint] = places[:, parent] + np.einsum("fij,fj->fi", spaces[:, parent], local[:, joint, :3])
            spaces[:, joint] = spaces[:, parent] @ spaces[:, joint]
    lengths = np.linalg.norm(spaces, axis=-2, keepdims=True)
    return places, spaces / np.maximum(lengths, _SMALLEST_SCALE)
