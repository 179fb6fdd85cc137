"""The long axis of a foot: from its heel to the middle of the heads of the first and fifth metatarsals.

All positions are (F, 3) by role, in axes that are fixed in space; NaN where a marker was not seen.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.roles import SIDE_WORDS
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]

TOES = ("toe", "inner_toe", "outer_toe")
"""Places that show the front of a foot."""
_EDGE = float(np.tan(np.radians(12.0)))
"""Part of the way from the heel to the ball by which the fifth metatarsal, or the first, lies beside the long axis."""
_ANKLE_TO_BALL = 0.72
"""Part of the way from heel to ball that lies before the ankle."""
_SHORTEST, _USUAL = 0.13, 0.17
"""Parts of a leg, from the pelvis to the foot, from heel to ball: where it is no cluster on the foot, and as a rule."""


def feet_axes(tracks: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Toes and heels by role, moved to the long axes of the feet where other markers show these.

    Two markers that are too near each other to be heel and toe only give the direction: they are moved apart along it.
    """
    found: dict[str, FloatArray] = {}
    for side in SIDE_WORDS:
        toe = _toe(tracks, side)
        if toe is None:
            continue
        found[f"{side}_toe"] = toe
        heel, hip = (tracks.get(f"{side}_{name}") for name in ("heel", "front_hip"))
        if heel is None or hip is None:
            continue
        length = _longest(np.linalg.norm(heel - hip, axis=-1))
        apart = _median(np.linalg.norm(toe - heel, axis=-1))
        if 0.0 < apart < _SHORTEST * length:
            middle, along = 0.5 * (toe + heel), 0.5 * _USUAL * length * normalized(toe - heel)
            found |= {f"{side}_toe": middle + along, f"{side}_heel": middle - along}
    return found


def _toe(tracks: Mapping[str, FloatArray], side: str) -> FloatArray | None:
    toe, inner, outer = (tracks.get(f"{side}_{name}") for name in TOES)
    if inner is not None and outer is not None:
        return 0.5 * (inner + outer)
    if toe is not None:
        return toe
    edge = outer if inner is None else inner
    behind = next((tracks[f"{side}_{name}"] for name in ("heel", "ankle") if f"{side}_{name}" in tracks), None)
    if edge is None or behind is None:
        return edge
    above = next((tracks[f"{side}_{name}"] for name in ("knee", "ankle") if f"{side}_{name}" in tracks), None)
    if above is None or above is behind:
        return edge
    angle = np.arctan(_EDGE if f"{side}_heel" in tracks else _EDGE / _ANKLE_TO_BALL)
    leftward = normalized(np.cross(above - behind, edge - behind))
    inward = leftward if (side == "right") == (inner is None) else -leftward
    across = np.linalg.norm(edge - behind, axis=-1, keepdims=True) * inward
    return np.asarray(behind + np.cos(angle) * (np.cos(angle) * (edge - behind) + np.sin(angle) * across))


def _longest(lengths: FloatArray) -> float:
    known = lengths[np.isfinite(lengths)]
    return float(np.percentile(known, 95)) if len(known) else 0.0


def _median(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else 0.0
