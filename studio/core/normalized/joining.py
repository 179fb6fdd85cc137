"""Alignment of the begin of a motion with the end of another (Kovar et al. 2002, equation 1)."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import FOOT_POINTS, touching_points
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion

FloatArray = NDArray[np.float64]

STANDING_WEIGHT, BODY_WEIGHT, SWINGING_WEIGHT = 20.0, 1.0, 0.05
"""Weights of points in the alignment: feet that stand in both motions, hips and shoulders, feet in the air."""
SAME_FOOTHOLD_DISTANCE = 0.06
"""Distance in leg lengths between two positions of a foot below which it is held at one position through a blend."""

FOOT_STEP_LIMIT = 1.2
"""Longest step in leg lengths: a body that is moved farther jumps there without steps."""


@dataclass(frozen=True)
class PlanarTransform:
    """Transform on the ground: a rotation about Z in radians, followed by an offset in leg lengths."""

    turn: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)

    def after(self, first: "PlanarTransform") -> "PlanarTransform":
        """Composition: this transform applied after ``first``."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        x, y = first.offset
        moved = float(c * x - s * y + self.offset[0]), float(s * x + c * y + self.offset[1])
        return PlanarTransform(self.turn + first.turn, moved)


@dataclass(frozen=True)
class FootStep:
    """Step of the foot of ``side`` (0 left, 1 right) by ``displacement`` in leg lengths."""

    side: int
    displacement: float


@dataclass(frozen=True)
class ClipAlignment:
    """Placement of a new clip on the ground, and the steps of the feet that this needs, in their order."""

    placement: PlanarTransform
    steps: tuple[FootStep, ...] = ()


def clip_alignment(
    first: FloatArray, second: FloatArray, both_stand: NDArray[np.bool_], spine_places: FloatArray, shares: FloatArray
) -> ClipAlignment:
    """Placement that aligns channels ``second`` (F, C) with ``first`` (F, C), frame by frame, and the steps it needs.

    ``both_stand`` (F, 4) masks the points of ``FOOT_POINTS`` that stand in both; ``shares`` (F,) are the weights of the
    frames. Rotation and offset minimise the weighted sum of squared distances between the points of an average body;
    standing feet weigh most. If both feet cannot be aligned, one is, and the other has to step.
    """
    old, new = (_points(channels, spine_places) for channels in (first, second))
    placement = _least_squares(old, new, shares[:, None] * _weights(both_stand))
    misses = [_foot_distance(old, new, placement, both_stand, side) for side in range(2)]
    if max(misses) < SAME_FOOTHOLD_DISTANCE:
        return ClipAlignment(placement)
    alone = [both_stand & (np.arange(4) // 2 == side) for side in range(2)]
    tries = [_least_squares(old, new, shares[:, None] * _weights(each)) for each in alone]
    left = [_foot_distance(old, new, placement, both_stand, 1 - kept) for kept, placement in enumerate(tries)]
    kept = int(left[1] < left[0])  # the foot that leaves the other the shorter way
    return ClipAlignment(tries[kept], (FootStep(1 - kept, left[kept]),))


def alignment_by_steps(
    first: FloatArray,
    second: FloatArray,
    both_stand: NDArray[np.bool_],
    spine_places: FloatArray,
    placement: PlanarTransform,
) -> ClipAlignment:
    """Alignment with a given ``placement``: feet step to it, unless one has to move farther than
    ``FOOT_STEP_LIMIT``.
    """
    old, new = (_points(channels, spine_places) for channels in (first, second))
    ways = [_foot_distance(old, new, placement, both_stand, side) for side in range(2)]
    steps = tuple(FootStep(side, way) for side, way in enumerate(ways) if way >= SAME_FOOTHOLD_DISTANCE)
    return ClipAlignment(placement, steps if max(ways) < FOOT_STEP_LIMIT else ())


def _points(channels: FloatArray, spine_places: FloatArray) -> FloatArray:
    """Horizontal positions (F, 8, 2) of hips, shoulders and ``FOOT_POINTS`` of an average body, in leg lengths."""
    body = average_body()
    layout = body.layout
    points = [layout.hip_point(0), layout.hip_point(1), layout.collar_point(0) + 1, layout.collar_point(1) + 1]
    points += [touching_points(each, layout)[0] for each in FOOT_POINTS]
    positions, _ = realize_motion(NormalizedMotion("", 1.0, channels, spine_places), body)
    return np.asarray(positions[:, points, :2] / body.leg_length)


def _weights(both_stand: NDArray[np.bool_]) -> FloatArray:
    feet = np.where(both_stand, STANDING_WEIGHT, SWINGING_WEIGHT)
    return np.concatenate([np.full((len(feet), 4), BODY_WEIGHT), feet], axis=1)


def _least_squares(old: FloatArray, new: FloatArray, weights: FloatArray) -> PlanarTransform:
    """Transform that aligns ``new`` (F, 8, 2) with ``old`` (F, 8, 2) with the least weighted squared distances.

    The rotation is that of body and feet each about their own middle, so that a body is not turned round a foot.
    """
    dots, crosses = 0.0, 0.0
    for part in (slice(0, 4), slice(4, 8)):
        w = weights[:, part]
        a, b = (each[:, part] - _middle(each[:, part], w) for each in (old, new))
        dots += float((w * (a * b).sum(axis=2)).sum())
        crosses += float((w * (b[..., 0] * a[..., 1] - b[..., 1] * a[..., 0])).sum())
    turn = float(np.arctan2(crosses, dots))
    x, y = _middle(old, weights) - _turned(_middle(new, weights), turn)
    return PlanarTransform(turn, (float(x), float(y)))


def _middle(points: FloatArray, weights: FloatArray) -> FloatArray:
    """Weighted mean, (2,), of points (F, P, 2)."""
    return np.asarray(np.einsum("fp,fpk->k", weights, points) / weights.sum())


def _foot_distance(
    old: FloatArray, new: FloatArray, placed: PlanarTransform, both_stand: NDArray[np.bool_], side: int
) -> float:
    """Median distance in leg lengths between a foot's points in both motions while they stand; 0 if they never do."""
    standing = both_stand & (np.arange(4) // 2 == side)
    aside = np.linalg.norm(_turned(new, placed.turn) + placed.offset - old, axis=2)[:, 4:]
    return float(np.median(aside[standing])) if standing.any() else 0.0


def _turned(positions: FloatArray, turn: float) -> FloatArray:
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(positions @ np.array([[c, s], [-s, c]]))


@cache
def average_body() -> Morphology:
    """Body of average proportions, whose points are used to align motions."""
    both, sides = np.ones(2), np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0]])
    return Morphology(
        spine=np.tile([0.0, 0.0, 0.16], (3, 1)),
        neck=0.10,
        head=0.18,
        collar_base=sides * [0.0, 0.03, -0.03],
        clavicle=0.15 * both,
        arm=np.tile([0.29, 0.26], (2, 1)),
        hand=np.tile([0.0, 0.0, 0.18], (2, 1)),
        hip_offset=sides * [0.0, 0.09, -0.04],
        leg=np.tile([0.43, 0.41], (2, 1)),
        foot=np.tile([0.13, 0.0, -0.06], (2, 1)),
        toe=np.tile([0.07, 0.0, -0.01], (2, 1)),
        ankle_height=0.08 * both,
        toe_height=0.02 * both,
        heel_length=0.05 * both,
    )
