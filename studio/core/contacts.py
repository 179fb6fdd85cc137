"""Foot contacts: when heel and toe stand on the ground."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

FloatArray = NDArray[np.float64]


class FootPoint(StrEnum):
    """What of a foot touches: the heel moves with the ankle, the toe with the toe joint."""

    LEFT_HEEL = "left_heel"
    LEFT_TOE = "left_toe"
    RIGHT_HEEL = "right_heel"
    RIGHT_TOE = "right_toe"

    @property
    def side(self) -> int:
        """0 left, 1 right."""
        return 0 if self.value.startswith("left") else 1

    @property
    def is_heel(self) -> bool:
        return self.value.endswith("heel")


@dataclass(frozen=True)
class ContactInterval:
    """One contact of a motion: ``point`` stands still on the ground from frame ``first`` to ``last``, both included."""

    motion_id: str
    point: FootPoint
    first: int
    last: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", FootPoint(self.point))
        if not 0 <= self.first <= self.last:
            raise ValueError(f"A contact runs from a frame to a later one, not from {self.first} to {self.last}.")


HEIGHT_MARGIN = 0.04
"""Metres above its own usual low that a standing heel or toe may be."""
STILL_SPEED = 0.35
"""Metres a second below which it may be standing."""
SHORTEST = 0.05
"""Seconds: shorter contacts are dropped, shorter gaps closed."""
SMOOTHING = 0.02
"""Seconds, standard deviation of the smoothing before speed is taken."""
DRIFT_WINDOW = 1.0
"""Seconds to each side in which a foot is taken to touch the ground at least once."""
GREATEST_DRIFT = 0.04
"""Metres by which the ground of a capture may rise above its usual low."""
ON_THE_FLOOR = 0.12
"""Metres that one foot's usual low may lie above the other's; higher, and it never stands."""


def detect_contacts(
    ankles: FloatArray, toes: FloatArray, frame_rate: float, first_frame: int = 0
) -> dict[FootPoint, list[tuple[int, int]]]:
    """Frames (first, last) in which each foot point stands, from its height and its speed (METHOD 4).

    ``ankles`` and ``toes`` (F, 2, 3) metres, left and right, Z up; frames before ``first_frame`` are not looked at.
    """
    found: dict[FootPoint, list[tuple[int, int]]] = {}
    for kind, tracks in (("heel", ankles), ("toe", toes)):
        lows = np.percentile(tracks[first_frame:, :, 2], 5, axis=0)
        for side, name in enumerate(("left", "right")):
            track = tracks[first_frame:, side]
            standing = np.zeros(len(track), dtype=bool)
            if len(track) > 1 and lows[side] < lows.min() + ON_THE_FLOOR:
                ground = _drifting_low(track[:, 2], lows[side], round(DRIFT_WINDOW * frame_rate))
                smooth = gaussian_filter1d(track, SMOOTHING * frame_rate, axis=0, mode="nearest")
                speed = np.linalg.norm(np.gradient(smooth, axis=0), axis=1) * frame_rate
                standing = (track[:, 2] < ground + HEIGHT_MARGIN) & (speed < STILL_SPEED)
            spans = _without_flicker(_spans(standing), round(SHORTEST * frame_rate))
            found[FootPoint(f"{name}_{kind}")] = [(a + first_frame, b + first_frame) for a, b in spans]
    return found


def _drifting_low(heights: FloatArray, low: float, reach: int) -> FloatArray:
    """(F,) the low of each moment, within ``reach`` frames of it: captures' floors rise and sink by centimetres."""
    local = minimum_filter1d(heights, 2 * reach + 1, mode="nearest")
    return np.clip(local, low, low + GREATEST_DRIFT)


def contact_mask(spans: Iterable[tuple[int, int]], frame_count: int) -> NDArray[np.bool_]:
    """(F,) true in every frame of the given (first, last) spans."""
    mask = np.zeros(frame_count, dtype=bool)
    for first, last in spans:
        mask[first : last + 1] = True
    return mask


def _spans(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _without_flicker(spans: list[tuple[int, int]], shortest: int) -> list[tuple[int, int]]:
    """Close gaps, then drop contacts, of no more than ``shortest`` frames."""
    joined: list[tuple[int, int]] = []
    for first, last in spans:
        if joined and first - joined[-1][1] - 1 <= shortest:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    return [(first, last) for first, last in joined if last - first + 1 > shortest]
