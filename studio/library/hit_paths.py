"""Path of a clip's hit point while the clip can hit (P09 section 3.3.1)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.body.morphology import Morphology
from studio.core.solver.task_assembly.points import point_indices
from studio.library.clip_labels import ClipLabel, HitSegment, Limb, hit_point

FloatArray = NDArray[np.float64]

HIT_REACH_FRACTION = 0.85
"""Fraction of the limb's reach at the hit; the clip can hit in frames with at least this reach."""
HIT_SEARCH_SECONDS = 0.15
"""Maximum seconds before and after the hit in which the limb can hit."""


@dataclass(frozen=True, eq=False)
class HitPath:
    """Path of the hit point in the frames ``first`` to ``last``, both included, in which the clip can hit.

    ``places`` (T, 3) are in metres, in the space of the motion on the actor's body.
    """

    first: int
    last: int
    places: FloatArray

    @property
    def box(self) -> FloatArray:
        """Bounding box (2, 3) of the path: its lowest and its highest corner."""
        return np.asarray([self.places.min(axis=0), self.places.max(axis=0)])


def hit_path(positions: FloatArray, rotations: FloatArray, body: Morphology, rate: float, label: ClipLabel) -> HitPath:
    """Path of the hit point of the clip ``label``, for a motion on its actor's body with ``rate`` frames per second.

    ``positions`` (F, K+23, 3) and ``rotations`` (F, K+18, 3, 3) are those of the posed body.
    """
    places = hit_point_positions(positions, rotations, body, label.limb, label.segment)
    root = positions[:, limb_root(body.layout, label.limb)]
    reach = np.linalg.norm((places - root)[:, :2], axis=1)
    most = int(np.ceil(HIT_SEARCH_SECONDS * rate))
    able = reach >= HIT_REACH_FRACTION * reach[label.hit]
    first = last = label.hit
    while first - 1 > max(label.first, label.hit - most) and able[first - 1]:
        first -= 1
    while last + 1 < min(label.last, label.hit + most) and able[last + 1]:
        last += 1
    return HitPath(first, last, places[first : last + 1])


def hit_point_positions(
    positions: FloatArray, rotations: FloatArray, body: Morphology, limb: Limb, segment: HitSegment
) -> FloatArray:
    """Positions (F, 3) of a hit point on a body, in metres."""
    point = hit_point(limb, segment, body)
    origin, carrier = point_indices(point, body.layout)
    return np.asarray(positions[:, origin] + rotations[:, carrier] @ np.array(point.offset))


def limb_root(layout: BodyLayout, limb: Limb) -> int:
    """Index of the canonical point about which a limb swings: shoulder or hip."""
    return layout.collar_point(limb.side) + 1 if limb.is_arm else layout.hip_point(limb.side)


def limb_size(body: Morphology, limb: Limb) -> float:
    """Length in metres along the bones from the root of a limb to its end: size(Limb) of P09 equation 1."""
    side = limb.side
    if limb.is_arm:
        hand = 0.5 * float(np.linalg.norm(body.hand[side]))
        return body.spine_length + float(body.clavicle[side] + body.arm[side].sum()) + hand
    hip, foot = (float(np.linalg.norm(each[side])) for each in (body.hip_offset, body.foot))
    return hip + float(body.leg[side].sum()) + foot
