"""Long axis of a foot, from its heel to the middle of the heads of the first and fifth metatarsals.

All positions are (F, 3) by role, in axes that are fixed in space; NaN in frames in which a marker was not seen.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.roles import SIDE_WORDS
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]

TOE_ROLES = ("toe", "inner_toe", "outer_toe", "big_toe")
"""Roles that show the front of a foot."""
_EDGE = float(np.tan(np.radians(12.0)))
"""Part of the way from the heel to the ball by which the fifth metatarsal, or the first, lies beside the long axis."""
_ANKLE_TO_BALL = 0.72
"""Part of the way from heel to ball that lies before the ankle."""
_TIP_TO_BALL = {"heel": 0.72, "ankle": 0.62}
"""Part of the way to the tip of the big toe at which the ball lies, by the place behind from which the way begins."""
_TIP_INWARD = np.radians(5.0)
"""Angle at the heel by which the tip of the big toe lies inside the long axis."""
_TIP = {"toe": 0.245, "big_toe": 0.23}
"""Parts of a leg from its heel beyond which a marker of that name lies before the ball, on a toe (0.26 to 0.28; on the
ball 0.15 to 0.24)."""
_ANKLE_TO_TIP = 0.85
"""The same limits for the way from the ankle."""
_KNEE_TO_PELVIS = 1.9
"""Length of a leg from the pelvis to the heel, in parts of that from the knee to the heel."""
_SHORTEST, _USUAL = 0.13, 0.17
"""Parts of a leg, from the pelvis to the foot, from heel to ball: where it is no cluster on the foot, and as a rule."""


def feet_axes(tracks: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Toes and heels by role, moved to the long axes of the feet if other markers show these.

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
    inner, outer = (tracks.get(f"{side}_{name}") for name in ("inner_toe", "outer_toe"))
    if inner is not None and outer is not None:
        return 0.5 * (inner + outer)
    named = next((name for name in _TIP if f"{side}_{name}" in tracks), None)
    toe = tracks.get(f"{side}_{named}")
    tip = toe if toe is not None and named and _is_tip(tracks, side, toe, _TIP[named]) else None
    if toe is not None and tip is None:
        return toe
    front = tip if inner is None and outer is None else outer if inner is None else inner
    behind = next((name for name in _TIP_TO_BALL if f"{side}_{name}" in tracks), None)
    if front is None or behind is None:
        return front
    heel = tracks[f"{side}_{behind}"]
    above = next((tracks[f"{side}_{name}"] for name in ("knee", "ankle") if f"{side}_{name}" in tracks), None)
    if above is None or above is heel:
        return front
    angle, part = np.arctan(_EDGE if behind == "heel" else _EDGE / _ANKLE_TO_BALL), 1.0
    if front is tip:
        angle, part = _TIP_INWARD, _TIP_TO_BALL[behind]
    leftward = normalized(np.cross(above - heel, front - heel))
    aside = leftward if (side == "left") == (front is not outer) else -leftward
    across = np.linalg.norm(front - heel, axis=-1, keepdims=True) * aside
    return np.asarray(heel + part * np.cos(angle) * (np.cos(angle) * (front - heel) + np.sin(angle) * across))


def _is_tip(tracks: Mapping[str, FloatArray], side: str, toe: FloatArray, limit: float) -> bool:
    """True if the marker ``toe`` (F, 3) is so far from the heel or the ankle that it lies in front of the ball of the
    foot.
    """
    behind = next((name for name in _TIP_TO_BALL if f"{side}_{name}" in tracks), None)
    above = next(
        (
            (tracks[f"{side}_{name}"], parts)
            for name, parts in (("front_hip", 1.0), ("knee", _KNEE_TO_PELVIS))
            if f"{side}_{name}" in tracks
        ),
        None,
    )
    if behind is None or above is None:
        return False
    heel = tracks[f"{side}_{behind}"]
    leg = above[1] * _longest(np.linalg.norm(heel - above[0], axis=-1))
    limit = limit if behind == "heel" else _ANKLE_TO_TIP * limit
    return 0.0 < limit * leg < _median(np.linalg.norm(toe - heel, axis=-1))


def _longest(lengths: FloatArray) -> float:
    known = lengths[np.isfinite(lengths)]
    return float(np.percentile(known, 95)) if len(known) else 0.0


def _median(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else 0.0
