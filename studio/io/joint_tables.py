"""Where every joint is at every frame, as a table (CSV) and as arrays (NPZ), for other programs to compute with.

Metres and world axes, Z up; rotations as quaternions x, y, z, w.
"""

from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.kinematics import joint_world
from studio.core.rotations import from_matrix, sign_continuous
from studio.io.export import Take
from studio.io.registry import Progress
from studio.io.replacing import write_whole
from studio.io.zipped import npy, write_zip

FloatArray = NDArray[np.float64]

_AXES = ("x", "y", "z", "qx", "qy", "qz", "qw")
_ROWS = 500
"""Rows of a table that are written between two reports of progress."""


def write_csv(path: Path, take: Take, progress: Progress) -> None:
    """A row a frame: its time, seven numbers a joint (``Hips.x``), and by how much each constraint is missed.

    Residuals are metres or radians, empty where the constraint is not active. Raises StudioError.
    """
    positions, rotations = _world(take)
    residuals = _residuals(take)
    titles = ["frame", "time", *(f"{name}.{axis}" for name in take.skeleton.names for axis in _AXES), *residuals]
    columns = np.concatenate([positions, rotations], axis=2).reshape(len(positions), -1)
    rows = np.column_stack([_times(take), columns, *residuals.values()])
    text = StringIO()
    text.write(",".join(map(_quoted, titles)) + "\n")
    for frame, row in enumerate(rows.tolist()):
        if frame % _ROWS == 0:
            progress(frame / len(rows), f"Writing {path.name}")
        text.write(f"{frame}," + ",".join("" if number != number else f"{number:.9g}" for number in row) + "\n")
    write_whole(path, text.getvalue().encode())


def write_npz(path: Path, take: Take, progress: Progress) -> None:
    """Arrays that ``numpy.load`` gives by name; no pickle. Raises StudioError.

    ``times`` (F,), ``joints`` (J,) names, ``parents`` (J,), ``offsets`` (J, 3), ``positions`` (F, J, 3) and
    ``rotations`` (F, J, 4) in the world, ``local_rotations`` (F, J, 4), ``local_translations`` (F, J, 3),
    ``constraints`` (C,) names and ``residuals`` (C, F) by how much each is missed, NaN where it is not active.
    """
    progress(0.0, f"Writing {path.name}")
    positions, rotations = _world(take)
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
        "residuals": np.array(list(residuals.values())).reshape(len(residuals), len(positions)),
    }
    write_zip(path, {f"{name}.npy": npy(array) for name, array in arrays.items()}, 4, progress)


def _world(take: Take) -> tuple[FloatArray, FloatArray]:
    positions, matrices = joint_world(take.skeleton, take.poses)
    return positions, sign_continuous(from_matrix(matrices))


def _times(take: Take) -> FloatArray:
    return np.arange(take.poses.frame_count) / take.frame_rate


def _residuals(take: Take) -> dict[str, FloatArray]:
    """By a name of its own, what each constraint of an adapted motion is missed by at every frame."""
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
