"""A trunk step by brute force: levers are measured by turning joints a little and looking."""

import numpy as np

from studio.core.canonical import BodyLayout
from studio.core.kernels.trunk import CLAVICLE_WEIGHT, ROOT_WEIGHT
from tests.core.twins.body import carried_by, turn_part
from tests.core.twins.rotation import from_vector

LITTLE = 1e-6


def joints(layout: BodyLayout) -> list[int]:
    """Segments that a trunk step turns: vertebrae above the pelvis, clavicles, neck, head."""
    spine = layout.spine_count
    return [*range(1, spine), spine + 2, spine + 6, spine, spine + 1]


def weight(layout: BodyLayout, segment: int, chain: np.ndarray) -> float:
    """How freely a joint moves for a constraint with weights limb, end segment, clavicle, trunk, root."""
    limb, end, clavicle, trunk, _ = chain
    if segment < layout.spine_count:
        return trunk
    if segment == layout.neck_base:
        return max(limb, clavicle)
    return max(limb, end) if segment == layout.head_joint else CLAVICLE_WEIGHT * clavicle


def lever(
    layout: BodyLayout, segment: int, point: int, direction: np.ndarray, positions: np.ndarray, rotations: np.ndarray
) -> np.ndarray:
    """(3,) how far ``point`` goes along ``direction`` for a small turn of ``segment`` about each world axis."""
    moved = [
        turn_part(layout, from_vector(LITTLE * axis), segment, positions, rotations)[0][point] for axis in np.eye(3)
    ]
    return np.array([(each - positions[point]) @ direction / LITTLE for each in moved])


def coupling(
    layout: BodyLayout, points: tuple[int, int], directions: np.ndarray, chain: np.ndarray,
    positions: np.ndarray, rotations: np.ndarray,
) -> float:  # fmt: skip
    """How far the first point moves for a unit of the second's: sum of weighted products of their levers."""
    total = ROOT_WEIGHT * chain[4] * (directions[0] @ directions[1])
    for segment in joints(layout):
        levers = [lever(layout, segment, p, d, positions, rotations) for p, d in zip(points, directions, strict=True)]
        total += weight(layout, segment, chain) * (levers[0] @ levers[1])
    return float(total)


def carries(layout: BodyLayout, segment: int, carrier: int) -> bool:
    """Whether what is fixed to the segment ``carrier`` moves when ``segment`` turns about its origin."""
    return carrier in carried_by(layout, segment)
