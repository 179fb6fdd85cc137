"""Gaps: frames in which a marker was not seen; short ones are filled by its own path, long ones by its neighbours."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import seen_mask
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

_NEIGHBOURS = 6
"""Frames on each side that a spline goes through."""
_DONORS = 4
"""Markers at most that carry another one through its gap."""
_WITHIN = 64
"""Frames on each side among which they are looked for."""
_LOOKED_AT = 400
"""Frames that tell how stiff two markers hang together."""
_SKIN = 0.001
"""Metres by which even markers on one bone move against each other."""
_STIFF = 0.02
"""Metres by which the distance to a donor may vary (standard deviation): skin moves, joints move more."""


@dataclass(frozen=True)
class Gap:
    """Gap of the marker with the index ``place``, from frame ``first`` to ``last``, both included."""

    place: int
    first: int
    last: int

    @property
    def frames(self) -> int:
        """Number of frames."""
        return self.last - self.first + 1


def find_gaps(points: FloatArray, indices: tuple[int, ...]) -> Iterator[Gap]:
    """Gaps of the ``points`` (F, P, 3) at ``indices``, including those at the beginning and the end.

    Points that are never seen have none.
    """
    for place in indices:
        unseen = ~seen_mask(points[:, place])
        if unseen.all():
            continue
        for first, end in runs_of(unseen):
            yield Gap(place, first, end - 1)


def spline_through(points: FloatArray, gap: Gap) -> FloatArray | None:
    """Positions (n, 3) in a gap on a cubic spline through the nearest frames on both sides.

    None if fewer than two frames are seen on one side of it.
    """
    from scipy.interpolate import CubicSpline  # slow to import, and most files have no markers

    start = max(0, gap.first - _WITHIN)
    seen = start + np.flatnonzero(seen_mask(points[start : gap.last + 1 + _WITHIN, gap.place]))
    before, after = seen[seen < gap.first][-_NEIGHBOURS:], seen[seen > gap.last][:_NEIGHBOURS]
    if len(before) < 2 or len(after) < 2:
        return None
    known = np.concatenate([before, after])
    return np.asarray(CubicSpline(known, points[known, gap.place])(np.arange(gap.first, gap.last + 1)))


@dataclass(frozen=True)
class Stiffness:
    """Mean and standard deviation (P, P) of the distance between each pair of points, in metres; NaN on the
    diagonal.
    """

    mean: FloatArray
    spread: FloatArray


def stiffness(points: FloatArray, indices: tuple[int, ...], metres: float) -> Stiffness:
    """Distances of pairs of points over sampled frames in which both are seen; ``metres`` is the length of a unit."""
    frames = np.unique(np.linspace(0, len(points) - 1, _LOOKED_AT).astype(int))
    mean, spread = (np.full((points.shape[1], points.shape[1]), np.nan) for _ in range(2))
    there = metres * points[frames][:, list(indices)]
    for at, place in enumerate(indices):
        distances = np.linalg.norm(there - there[:, at, None], axis=-1)
        known = np.isfinite(distances)
        count = np.maximum(known.sum(axis=0), 1)
        middle = np.where(known, distances, 0.0).sum(axis=0) / count
        mean[place, list(indices)] = np.where(known.any(axis=0), middle, np.nan)
        spread[place, list(indices)] = np.sqrt(np.where(known, (distances - middle) ** 2, 0.0).sum(axis=0) / count)
        mean[place, place] = np.nan
    return Stiffness(mean, spread)


def pattern_through(points: FloatArray, gap: Gap, known: Stiffness) -> FloatArray | None:
    """Positions (n, 3) in a gap by the motion of the most rigid neighbours; None without three of them.

    The rigid motion (Kabsch 1976) of the neighbours, weighted by their rigidity, is applied from the last frame before
    the gap and from the first one after it. Both results are blended by nearness, so that the path is continuous on
    both sides.
    """
    donors = _donors(points, gap, known)
    if len(donors) < 3:
        return None
    frames = np.arange(gap.first, gap.last + 1)
    anchors = [frame for frame in (gap.first - 1, gap.last + 1) if 0 <= frame < len(points)]
    moving = points[gap.first : gap.last + 1, donors]
    trust = (known.spread[gap.place, donors] + _SKIN) ** -2.0
    trust /= trust.sum()
    carried = [_carried(points[anchor, donors], points[anchor, gap.place], moving, trust) for anchor in anchors]
    if len(carried) == 1:
        return carried[0]
    share = ((frames - gap.first + 1) / (gap.frames + 1))[:, None]
    return np.asarray((1.0 - share) * carried[0] + share * carried[1])


def _donors(points: FloatArray, gap: Gap, known: Stiffness) -> list[int]:
    """Markers that are seen throughout the gap and beside it, and keep their distance to its marker best."""
    mean, spread = known.mean[gap.place], known.spread[gap.place]
    stiff = np.flatnonzero((mean > 0.01) & (spread < _STIFF))
    around = points[max(gap.first - 1, 0) : gap.last + 2, stiff]
    stiff = stiff[seen_mask(around).all(axis=0)]
    order = np.argsort(spread[stiff] + 0.02 * mean[stiff])  # of two that are as stiff the nearer one
    return _spread_out(points[gap.first - 1 if gap.first else gap.last + 1], stiff[order].tolist())


def _spread_out(positions: FloatArray, stiff: list[int]) -> list[int]:
    """First few markers of ``stiff`` that are not on one line: three on a line do not define a rotation about it."""
    chosen = stiff[:2]
    for donor in stiff[2:]:
        legs = positions[[*chosen[1:], donor]] - positions[chosen[0]]
        singular = np.linalg.svd(legs, compute_uv=False)
        if singular[1] > 0.15 * singular[0]:
            chosen.append(donor)
        if len(chosen) == _DONORS:
            break
    return chosen


def _carried(source: FloatArray, marker: FloatArray, targets: FloatArray, trust: FloatArray) -> FloatArray:
    """Positions of ``marker`` (3,) if ``source`` (n, 3) moves rigidly to each of ``targets`` (F, n, 3).

    ``trust`` (n,) are weights with sum 1.
    """
    middle, middles = trust @ source, np.einsum("n,fni->fi", trust, targets)
    covariance = np.einsum("n,ni,fnj->fij", trust, source - middle, targets - middles[:, None])
    u, _, v = np.linalg.svd(covariance)
    turn = np.ones((len(targets), 3))
    turn[:, 2] = np.sign(np.linalg.det(u) * np.linalg.det(v))
    rotation = np.einsum("fji,fj,fkj->fik", v, turn, u)
    return np.asarray(middles + rotation @ (marker - middle))
