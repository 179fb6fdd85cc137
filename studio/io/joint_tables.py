"""Positions and rotations of all joints in all frames, as a table (CSV) and as arrays (NPZ), for other computations.

They are in metres and world axes, Z up; rotations are quaternions x, y, z, w.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world
from studio.core.rotations import from_matrix, sign_continuous
from studio.io.atomic_write import write_pieces
from studio.io.export import Take
from studio.io.registry import Progress
from studio.io.zipped import npy_file, write_zip

FloatArray = NDArray[np.float64]

_AXES = ("x", "y", "z", "qx", "qy", "qz", "qw")
_ROWS = 500
"""Frames that are written between two reports of progress."""
_POSED = 0.2
"""The share of the work after which the joints of all frames have their places."""


def write_csv(path: Path, take: Take, progress: Progress) -> None:
    """Write a row for each frame: its time, seven numbers for each joint (``Hips.x``), and the residual of each
    constraint.

    Residuals are metres or radians, empty where the constraint is inactive. Raises StudioError.
    """
    write_pieces(path, _table(path, take, progress))


def _table(path: Path, take: Take, progress: Progress) -> Iterator[bytes]:
    """Lines of the table in pieces: titles first, then rows."""
    residuals, times = _residuals(take), _times(take)
    titles = ["frame", "time", *(f"{name}.{axis}" for name in take.skeleton.names for axis in _AXES), *residuals]
    yield (",".join(map(_quoted, titles)) + "\n").encode()
    for run, positions, rotations in _world(take):
        progress(run.start / len(times), f"Writing {path.name}")
        columns = np.concatenate([positions, rotations], axis=2).reshape(len(positions), -1)
        rows = np.column_stack([times[run], columns, *(residual[run] for residual in residuals.values())])
        for frame, row in enumerate(rows.tolist(), run.start):
            numbers = ",".join("" if number != number else f"{number:.9g}" for number in row)
            yield f"{frame},{numbers}\n".encode()


def write_npz(path: Path, take: Take, progress: Progress) -> None:
    """Write arrays that ``numpy.load`` returns by name, without pickle. Raises StudioError.

    They are ``times`` (F,), ``joints`` (J,) names, ``parents`` (J,), ``offsets`` (J, 3), ``positions`` (F, J, 3) and
    ``rotations`` (F, J, 4) in the world, ``local_rotations`` (F, J, 4), ``local_translations`` (F, J, 3),
    ``constraints`` (C,) names and their ``residuals`` (C, F), NaN where inactive.
    """
    frames, joints = take.poses.frame_count, take.skeleton.joint_count
    positions, rotations = np.empty((frames, joints, 3)), np.empty((frames, joints, 4))
    for run, places, turns in _world(take):
        positions[run], rotations[run] = places, turns
        progress(_POSED * run.start / frames, f"Writing {path.name}")
    residuals = _residuals(take)
    arrays: dict[str, NDArray[Any]] = {
        "times": _times(take),
        "joints": np.array(take.skeleton.names),
        "parents": take.skeleton.parents,
        "offsets": take.skeleton.offsets,
        "positions": positions,
        "rotations": rotations,
        "local_rotations": take.poses.local_rotations,
        "local_translations": take.poses.local_translations,
        "constraints": np.array(list(residuals), dtype=str),
        "residuals": np.array(list(residuals.values())).reshape(len(residuals), frames),
    }
    members = {f"{name}.npy": npy_file(array) for name, array in arrays.items()}
    write_zip(path, members, 4, lambda share, text: progress(_POSED + (1.0 - _POSED) * share, text))


def _world(take: Take) -> Iterator[tuple[slice, FloatArray, FloatArray]]:
    """World positions (N, J, 3) and rotations (N, J, 4), continuous in sign, of successive runs of frames."""
    last = np.empty((0, take.skeleton.joint_count, 4))
    for run, poses in take.poses.runs(_ROWS):
        positions, matrices = joint_world(take.skeleton, poses)
        rotations = sign_continuous(np.concatenate([last, from_matrix(matrices)]))[len(last) :]
        yield run, positions, rotations
        last = rotations[-1:]


def _times(take: Take) -> FloatArray:
    return np.arange(take.poses.frame_count) / take.frame_rate


def _residuals(take: Take) -> dict[str, FloatArray]:
    """Residuals of each constraint of an adapted motion in every frame, by a unique name."""
    if take.adapted is None or take.request is None:
        return {}
    named: dict[str, FloatArray] = {}
    for constraint, residual in zip(take.request.constraints, take.adapted.residuals, strict=True):
        name, number = f"{constraint.name} ({constraint.unit})", 2
        while name in named:
            name, number = f"{constraint.name} {number} ({constraint.unit})", number + 1
        named[name] = residual
    return named


def _quoted(title: str) -> str:
    return '"' + title.replace('"', '""') + '"' if set(title) & set(',"\n') else title
