"""Writer of BVH: Y up, centimetres by default, with enough digits to lose nothing."""

from collections.abc import Iterator, Sequence
from io import StringIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import to_euler
from studio.io.atomic_write import atomic_replacement
from studio.io.registry import Progress

FloatArray = NDArray[np.float64]

_ORDER = "ZXY"
_WORLD_TO_FILE = [1, 2, 0]
"""Y up: file x is world Y (left), y is Z (up), z is X (forward)."""
_ROWS = 500
"""Rows that are written between two reports of progress."""
_TIES = 9
"""Decimals of a radian beyond which angles are alike."""
_SMALLEST_TRAVEL = 1e-9
"""Metres by which a translation must leave its offset to need position channels."""


def write_bvh(
    path: Path | str,
    skeleton: Skeleton,
    poses: PoseSequence,
    frame_rate: float,
    *,
    unit_scale: float = 100.0,
    position_channels: Sequence[int] | None = None,
    decimals: int | None = None,
    progress: Progress = lambda share, text: None,
) -> None:
    """Write ``poses`` as a BVH file; read back, every joint is within 0.01 mm.

    ``unit_scale`` is file units per metre. ``position_channels`` are the joints that get positions; None for the root
    and every joint whose translation leaves its offset. ``decimals`` rounds the numbers of the motion (file units and
    degrees) for a smaller file; None keeps all that matter. With 4, a body of human size is still within 0.01 mm. The
    file appears whole or not at all, also when ``progress`` raises an exception to cancel. Raises StudioError if it
    cannot be written.
    """
    if position_channels is None:
        ends = np.stack([poses.local_translations.min(axis=0), poses.local_translations.max(axis=0)])
        travel = np.abs(ends - skeleton.offsets).max(axis=(0, 2))
        position_channels = np.flatnonzero(travel > _SMALLEST_TRAVEL).tolist()
    positioned = frozenset({0, *position_channels})
    text = StringIO()
    text.write("HIERARCHY\n")
    text.writelines(_hierarchy(skeleton, positioned, unit_scale))
    text.write(f"MOTION\nFrames: {poses.frame_count}\nFrame Time: {1.0 / frame_rate:.10f}\n")
    with atomic_replacement(Path(path)) as part, open(part, "wb") as file:
        file.write(text.getvalue().encode())
        done = 0
        for rows in _rows(skeleton, poses, positioned, unit_scale):
            progress(done / poses.frame_count, f"Writing {Path(path).name}")
            np.savetxt(file, rows if decimals is None else rows.round(decimals) + 0.0, fmt="%.9g")  # no "-0"
            done += len(rows)


def _hierarchy(skeleton: Skeleton, positioned: frozenset[int], scale: float) -> Iterator[str]:
    offsets = skeleton.offsets[:, _WORLD_TO_FILE] * scale + 0.0  # no "-0"
    open_depths: list[int] = []
    for joint in _depth_first(skeleton):
        depth = skeleton.depths[joint]
        while open_depths and open_depths[-1] >= depth:
            yield _indent(open_depths.pop()) + "}\n"
        open_depths.append(depth)
        yield from _joint(skeleton, joint, _indent(depth), offsets[joint], joint in positioned)
    while open_depths:
        yield _indent(open_depths.pop()) + "}\n"


def _indent(depth: int) -> str:
    """Tabs to the depth of the joint, limited for very deep trees."""
    return "\t" * min(depth, 40)


def _joint(skeleton: Skeleton, joint: int, indent: str, offset: FloatArray, positioned: bool) -> Iterator[str]:
    if skeleton.end_sites[joint]:
        yield f"{indent}End Site\n{indent}{{\n"
    else:
        yield f"{indent}{'JOINT' if joint else 'ROOT'} {skeleton.names[joint]}\n{indent}{{\n"
    yield f"{indent}\tOFFSET {offset[0]:.9g} {offset[1]:.9g} {offset[2]:.9g}\n"
    if not skeleton.end_sites[joint]:
        turns = " ".join(f"{axis}rotation" for axis in _ORDER)
        moves = "6 Xposition Yposition Zposition" if positioned else "3"
        yield f"{indent}\tCHANNELS {moves} {turns}\n"
    elif skeleton.children[joint]:
        raise StudioError(f"'{skeleton.names[joint]}' carries joints and cannot be written as the end of a bone.")


def _depth_first(skeleton: Skeleton) -> Iterator[int]:
    waiting = [0]
    while waiting:
        joint = waiting.pop()
        yield joint
        waiting.extend(reversed(skeleton.children[joint]))


def _rows(skeleton: Skeleton, poses: PoseSequence, positioned: frozenset[int], scale: float) -> Iterator[FloatArray]:
    """Rows (N, C) of successive runs of frames, in file units and degrees, joints in the order of the file."""
    joints = [joint for joint in _depth_first(skeleton) if not skeleton.end_sites[joint]]
    last = np.empty((0, skeleton.joint_count, 3))
    for _, run in poses.runs(_ROWS):
        turned = run.local_rotations[..., [*_WORLD_TO_FILE, 3]]
        angles = _continued(last, to_euler(_ORDER, turned))
        positions = run.local_translations[..., _WORLD_TO_FILE] * scale
        columns = []
        for joint in joints:
            columns += [positions[:, joint]] if joint in positioned else []
            columns.append(np.degrees(angles[:, joint]))
        yield np.concatenate(columns, axis=1) + 0.0  # no "-0"
        last = angles[-1:]


def _continued(last: FloatArray, angles: FloatArray) -> FloatArray:
    """Angles (F, J, 3) with whole turns added so that none jumps, continuing from ``last`` (0 or 1, J, 3).

    A step of half a turn takes the same sign on every machine, however its last digits are rounded.
    """
    rough = np.round(np.concatenate([last, angles]), _TIES)
    turns = np.round((np.unwrap(rough, axis=0) - rough) / (2.0 * np.pi))
    return np.asarray(angles + 2.0 * np.pi * turns[len(last) :])
