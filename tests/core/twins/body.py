"""Moving a part of a body, by walking the tree instead of counting ranges."""

import numpy as np

from studio.core.body.canonical import BodyLayout


def carried_by(layout: BodyLayout, segment: int) -> set[int]:
    """``segment`` and every segment that hangs on it."""
    carried = {segment}
    for other, parent in enumerate(layout.parent_segments()):
        if parent in carried:
            carried.add(other)
    return carried


def carried_points(layout: BodyLayout, segment: int) -> set[int]:
    """The points that move when ``segment`` turns about its origin."""
    segments = carried_by(layout, segment)
    points = {layout.distal_points()[each] for each in segments}
    thorax = layout.spine_count - 1
    if thorax in segments:
        points |= {layout.collar_point(0), layout.collar_point(1)}
    if segment == 0:
        points |= {layout.hip_point(0), layout.hip_point(1)}
    return points


def turn_part(
    layout: BodyLayout,
    turn: np.ndarray,
    segment: int,
    positions: np.ndarray,
    rotations: np.ndarray,
    pivot: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions and rotations after ``segment`` has turned about ``pivot``, its own origin unless given."""
    moved, turned = positions.copy(), rotations.copy()
    origin = positions[layout.proximal_points()[segment]] if pivot is None else pivot
    for point in carried_points(layout, segment):
        moved[point] = origin + turn @ (positions[point] - origin)
    for other in carried_by(layout, segment):
        turned[other] = turn @ rotations[other]
    return moved, turned


def bone_lengths(layout: BodyLayout, positions: np.ndarray) -> np.ndarray:
    """Length of every segment, and of what ties collars and hips to the trunk."""
    ends = positions[..., list(layout.distal_points()), :] - positions[..., list(layout.proximal_points()), :]
    ties = [
        positions[..., point, :] - positions[..., carrier, :]
        for point, carrier in (
            *((layout.collar_point(side), layout.neck_base) for side in (0, 1)),
            *((layout.hip_point(side), 0) for side in (0, 1)),
        )
    ]
    return np.linalg.norm(np.concatenate([ends, np.stack(ties, axis=-2)], axis=-2), axis=-1)
