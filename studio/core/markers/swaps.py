"""Swaps: exchanges of the labels of two markers during tracking."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import seen_mask

FloatArray = NDArray[np.float64]

_JUMP = 0.025
"""Metres beside where it was heading from which a marker may have been mistaken for another."""
_BETTER = 0.35
"""A swap must leave so little of the jump."""
_LONGEST = 0.5
"""Seconds without sight after which nobody knows where a marker was heading."""


@dataclass(frozen=True)
class Swap:
    """Exchange of the labels of the markers ``first`` and ``second`` from ``frame`` on."""

    first: int
    second: int
    frame: int


def find_swaps(points: FloatArray, indices: tuple[int, ...], frame_rate: float, metres: float) -> list[Swap]:
    """Swaps of two tracks of ``points`` (F, P, 3) that continue smoothly only when exchanged.

    The expected position of a marker extrapolates its last velocity, also through gaps. Swaps are found one after
    another: a pair that changes back is found twice.
    """
    track = metres * points[:, indices]
    swaps: list[Swap] = []
    for frame in _suspects(track):
        expected = _expected(track, frame, frame_rate)
        here = track[frame]
        jumps = np.linalg.norm(here - expected, axis=-1)
        jumped = [int(index) for index in np.flatnonzero(jumps > _JUMP)]
        for one, other in combinations(jumped, 2):
            crossed = np.linalg.norm(here[other] - expected[one]) + np.linalg.norm(here[one] - expected[other])
            if crossed < _BETTER * (jumps[one] + jumps[other]):
                track[frame:, [one, other]] = track[frame:, [other, one]]
                swaps.append(Swap(indices[one], indices[other], frame))
                break
    return swaps


def with_swaps_undone(points: FloatArray, swaps: list[Swap]) -> FloatArray:
    """Points with the swaps undone."""
    mended = points.copy()
    for swap in swaps:
        mended[swap.frame :, [swap.first, swap.second]] = mended[swap.frame :, [swap.second, swap.first]]
    return mended


def _suspects(track: FloatArray) -> list[int]:
    """Frames in which at least two markers are off their expected positions, or return from a gap."""
    seen = seen_mask(track)
    heading = 2.0 * track[1:-1] - track[:-2]
    off = np.linalg.norm(track[2:] - heading, axis=-1) > _JUMP
    back = seen[2:] & ~seen[1:-1]
    return [int(frame) + 2 for frame in np.flatnonzero((off | back).sum(axis=1) >= 2)]


def _expected(track: FloatArray, frame: int, frame_rate: float) -> FloatArray:
    """Expected positions (P, 3) of the markers by their last two seen frames; NaN if these are too long ago."""
    expected = np.full(track.shape[1:], np.nan)
    start = max(0, frame - int(_LONGEST * frame_rate) - 2)
    window = track[start:frame]
    for index in range(track.shape[1]):
        seen = np.flatnonzero(seen_mask(window[:, index]))
        if len(seen) > 1 and seen[-1] - seen[-2] == 1:
            last, step = window[seen[-1], index], window[seen[-1], index] - window[seen[-2], index]
            expected[index] = last + step * (frame - start - seen[-1])
    return expected
