"""Feet in the air over ground that is not level: led over what lies in their way, and round it (METHOD 4).

A foot may be raised, held back or led ahead along its flight, and pitched. Through each flight in which something is in
its way the least such way is searched; the path that bends least follows it, as closely as its acceleration allows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded
from scipy.ndimage import binary_dilation
from scipy.spatial.transform import Rotation

from studio.core.grounds.ground import Ground
from studio.core.runs import runs_of
from studio.core.solver.standing.footprints import EDGE

FloatArray = NDArray[np.float64]

PLAY, TOLERANCE = 0.005, 0.001
"""Metres of play between a sole and what it may not touch: by which it may be inside a riser, or past an edge, and
above the ground below which it comes no nearer than it did on the level floor; and by how much it may.
"""
WAYS = np.array([[0.01 * ahead, 0.0, np.radians(15.0) * pitch] for ahead in range(-15, 16) for pitch in range(-3, 4)])
"""Ways out: metres ahead along the flight, metres up (found for each), radians of pitch."""
WORTH = np.array([1.0, 1.0, 0.08])
"""Metres of way that a metre, or a radian, counts as."""
PACE = 0.3
"""Seconds in which a way out may as well be gone as kept."""
HURRIED = 0.12
"""Seconds from a contact within which it costs ever more to be elsewhere."""
STIFF = 0.01
"""Seconds within which a path bends round what stands in it; longer where that would accelerate it too much."""
SOFTER, SOFTENINGS, AROUND = 1.5, 8, 0.1
"""Times it is made softer, at most how often, and so many seconds around."""
MOST_ACCELERATION, GENTLE = 0.6, 30.0
"""Parts of a foot's greatest own acceleration that being led clear may add, and metres a second squared that it may."""
ROUNDS = 8
"""Times a path is raised where it is still not clear."""
SHORTEST_FLIGHT = 0.05
"""Metres of a flight that has no direction."""
_SCARCE, _FIRM = 1e-9, 1e9
"""Weights: so little that equations stay solvable, and so much that a foot that stands stays."""


@dataclass(frozen=True, eq=False)
class Sole:
    """A foot over the ground: ``ankles`` (F, 3), world rotations ``feet`` and ``toes`` (F, 3, 3), and what of it is
    low: ``points`` (F, P, 3), heel to tip.
    """

    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray
    points: FloatArray

    @classmethod
    def of(cls, ankles: FloatArray, feet: FloatArray, toes: FloatArray, measures: FloatArray) -> "Sole":
        """``measures`` (F or 1, 6) of the foot as ``morphology.sole_rows`` has them."""
        forward, left, down, height, heel, length = np.broadcast_to(measures, (len(ankles), 6)).T
        zero, shares = np.zeros(len(ankles)), np.linspace(0.0, 1.0, 4)[:, None]

        def place(turns: FloatArray, *offset: FloatArray) -> FloatArray:
            return np.asarray(np.einsum("fij,fj->fi", turns, np.column_stack(offset)))[:, None]

        back = ankles[:, None] + place(feet, -heel, zero, -height)
        joint = ankles[:, None] + place(feet, forward, left, down)
        ball, under = (joint + place(turns, zero, zero, -height - down) for turns in (feet, toes))
        tip = joint + place(toes, length, zero, -height - down)
        points = np.concatenate([back + shares * (ball - back), under + shares[1:] * (tip - under)], axis=1)
        return cls(ankles, feet, toes, points)


def worn_height(ground: Ground, places: FloatArray) -> FloatArray:
    """(...) the ground's height at ``places`` (..., 2 or 3) with ``PLAY`` metres of each edge worn away."""
    angles = np.pi / 4.0 * np.arange(8)
    ring = np.concatenate([np.zeros((1, 2)), PLAY * np.column_stack([np.cos(angles), np.sin(angles)])])
    return np.asarray(ground.height_at(places[..., None, :2] + ring).min(axis=-1))


def led_clear(level: Sole, sole: Sole, states: NDArray[np.int64], ground: Ground, frame_rate: float) -> Sole:
    """A foot that was planned ``level``, set on the ground, led clear of what is in its way while ``states`` are 0."""
    flight = _Flight.of(level, sole, states, ground)
    flying = np.flatnonzero(states == 0)
    lacks = np.zeros(len(states))
    lacks[flying] = flight.lack(flying, np.zeros((len(flying), 3)))
    spans = [span for span in runs_of(states == 0) if lacks[slice(*span)].max() > TOLERANCE]
    if not spans:
        return sole
    ways = np.zeros((len(states), 3))
    for first, past in spans:
        if lacks[first:past].max() < EDGE:
            ways[first:past, 1] = np.maximum(lacks[first:past], 0.0)
            continue
        frames = np.arange(first, past)
        lifts = np.maximum(flight.lack(frames, WAYS[None]), 0.0)
        near = steps_to_ground(first, past, len(states)) / frame_rate
        ways[first:past] = _least_way(lifts, near, frame_rate, first > 0, past < len(states))
    return flight.moved(_smooth_path(ways, spans, flight, frame_rate))


@dataclass(frozen=True, eq=False)
class _Flight:
    """What moving a foot along a path (..., 3: ahead, up, pitch) does: ``ahead`` and ``heading`` (F, 2) level unit
    vectors, ``arms`` (F, P, 2) from the ankle along the heading and up, ``least`` (F, P) metres wanted above ground.
    """

    sole: Sole
    ground: Ground
    states: NDArray[np.int64]
    ahead: FloatArray
    heading: FloatArray
    arms: FloatArray
    least: FloatArray

    @classmethod
    def of(cls, level: Sole, sole: Sole, states: NDArray[np.int64], ground: Ground) -> "_Flight":
        ahead, heading = np.zeros((len(states), 2)), sole.feet[:, :2, 0]
        for first, past in runs_of(states == 0):
            way = sole.ankles[min(past, len(states) - 1), :2] - sole.ankles[max(first - 1, 0), :2]
            length = np.linalg.norm(way)
            ahead[first:past] = way / length if length > SHORTEST_FLIGHT else 0.0
        heading = heading / np.maximum(np.linalg.norm(heading, axis=1, keepdims=True), 1e-9)
        arms = sole.points - sole.ankles[:, None]
        arms = np.stack([np.einsum("fpk,fk->fp", arms[..., :2], heading), arms[..., 2]], axis=-1)
        return cls(sole, ground, states, ahead, heading, arms, np.minimum(level.points[..., 2] - ground.height, PLAY))

    def lack(self, frames: NDArray[np.int64], path: FloatArray) -> FloatArray:
        """(N, ...) metres by which soles at ``frames`` (N,), moved by ``path`` (N or 1, ..., 3), are still too low."""
        more = (frames, *[None] * (path.ndim - 2))
        c, s = np.cos(path[..., 2])[..., None] - 1.0, np.sin(path[..., 2])[..., None]
        along, up = self.arms[more][..., 0], self.arms[more][..., 1]
        moved = path[..., None, :1] * self.ahead[more][..., None, :]
        moved = moved + (c * along + s * up)[..., None] * self.heading[more][..., None, :]
        heights = self.ground.height_at(self.sole.points[more][..., :2] + moved)
        low = self.sole.points[more][..., 2] + path[..., 1:2] + c * up - s * along
        return np.asarray((heights + self.least[more] - low).max(axis=-1))

    def moved(self, path: FloatArray) -> Sole:
        """The foot led along ``path`` (F, 3)."""
        axes = np.column_stack([-self.heading[:, 1], self.heading[:, 0], np.zeros(len(path))])
        turns = Rotation.from_rotvec(path[:, 2:] * axes).as_matrix()
        ankles = self.sole.ankles + np.column_stack([path[:, :1] * self.ahead, path[:, 1]])
        return Sole(ankles, turns @ self.sole.feet, turns @ self.sole.toes, self.sole.points)


def steps_to_ground(first: int, past: int, count: int) -> NDArray[np.int64]:
    """(past - first,) frames from each of a flight to the nearest contact; the ends of the clip are none."""
    steps = np.arange(1, past - first + 1)
    far = np.full(past - first, past - first)
    return np.minimum(steps if first > 0 else far, steps[::-1] if past < count else far)


def _least_way(
    lifts: FloatArray, near: FloatArray, frame_rate: float, from_ground: bool, to_ground: bool
) -> FloatArray:
    """(N, 3) the least way through one flight, of ``WAYS`` with the ``lifts`` (N, W) that each needs at each frame,
    ``near`` (N,) seconds from the ground.

    Least is the sum of squared ways and of squared speeds, by dynamic programming (Bellman 1957).
    """
    count, flat = len(lifts), WAYS * WORTH
    lengths = np.sum(flat**2, axis=1) + lifts**2
    costs = lengths * (1.0 + (HURRIED / near[:, None]) ** 4) / (frame_rate * PACE) ** 2
    between = np.sum((flat[:, None] - flat) ** 2, axis=2)
    total, came = costs[0] + from_ground * lengths[0], np.zeros(lifts.shape, dtype=np.int64)
    whole, ways = np.empty(between.shape), np.arange(len(flat))
    for row in range(1, count):
        np.subtract(lifts[row][:, None], lifts[row - 1], out=whole)
        np.multiply(whole, whole, out=whole)
        whole += between
        whole += total
        came[row] = whole.argmin(axis=1)
        total = whole[ways, came[row]] + costs[row]
    best, chosen = int((total + to_ground * lengths[-1]).argmin()), np.zeros((count, 3))
    for row in range(count - 1, -1, -1):
        chosen[row] = WAYS[best]
        chosen[row, 1] = lifts[row, best]
        best = came[row, best]
    return chosen


def _smooth_path(ways: FloatArray, spans: list[tuple[int, int]], flight: _Flight, frame_rate: float) -> FloatArray:
    """(F, 3) along ``ways`` (F, 3) through the ``spans`` of frames, softer where that would jolt the foot.

    What is led along may be softer than what is raised: the latter comes after, and clears what the former leaves.
    """
    stiff = np.full((len(ways), 2), STIFF)  # led along and turned; raised
    own = float(np.linalg.norm(np.diff(flight.sole.ankles, 2, axis=0), axis=1).max(initial=0.0))
    most = max(MOST_ACCELERATION * own, GENTLE / frame_rate**2)
    for _ in range(SOFTENINGS):
        path = _bent_path(ways, spans, flight, 1.0 / (stiff * frame_rate) ** 4)
        bent = np.abs(np.diff(path[:, :2], 2, axis=0))
        jerky = np.pad(bent > most, ((1, 1), (0, 0)))
        if not jerky.any():
            break
        for column in range(2):
            stiff[binary_dilation(jerky[:, column], iterations=round(AROUND * frame_rate) + 1), column] *= SOFTER
    return path


def _bent_path(ways: FloatArray, spans: list[tuple[int, int]], flight: _Flight, weights: FloatArray) -> FloatArray:
    """(F, 3) the path that bends least through ``ways``, by ``weights`` (F, 2), raised until it is clear."""
    still = np.where(flight.states == 0, 0.0, _FIRM)
    held = still.copy()
    for first, past in spans:
        held[first:past] = weights[first:past, 0]
    path = _bent_least(ways, held)
    path[flight.states != 0] = 0.0
    path[:, 1] = 0.0
    frames = np.concatenate([np.arange(*span) for span in spans])
    raised = np.zeros((len(ways), 1))
    for _ in range(ROUNDS):
        lack = flight.lack(frames, path[frames])
        low = frames[lack > TOLERANCE]
        if not len(low):
            break
        raised[low, 0] = path[low, 1] + lack[lack > TOLERANCE]
        still[low] = weights[low, 1]
        path[:, 1] = np.where(flight.states == 0, _bent_least(raised, still)[:, 0], 0.0)
    return path


def _bent_least(wanted: FloatArray, weights: FloatArray) -> FloatArray:
    """(F, N) the paths of least second differences, as near to ``wanted`` (F, N) as ``weights`` (F,) say."""
    count = len(weights)
    bands = np.zeros((3, count))
    bands[2] = weights + _SCARCE
    if count > 2:
        for place, share in enumerate((1.0, 4.0, 1.0)):
            bands[2, place : count - 2 + place] += share
        bands[1, 1:-1] -= 2.0
        bands[1, 2:] -= 2.0
        bands[0, 2:] += 1.0
    return np.asarray(solveh_banded(bands, weights[:, None] * wanted))
