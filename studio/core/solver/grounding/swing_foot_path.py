"""Paths of swing feet over uneven ground: detours above and around obstacles (METHOD 5).

A foot may be raised, held back or moved ahead along its flight, and pitched. For each flight with an obstacle the least
detour is searched; the smoothest path, that of least second differences, follows it as closely as its acceleration
allows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded
from scipy.ndimage import binary_dilation
from scipy.spatial.transform import Rotation

from studio.core.grounds.ground import Ground
from studio.core.runs import runs_of
from studio.core.solver.grounding.footprints import GROUND_EDGE_HEIGHT

FloatArray = NDArray[np.float64]

SOLE_TOLERANCE, PENETRATION_TOLERANCE = 0.005, 0.001
"""Tolerances in metres between a sole and the ground: first for penetration of a riser or overlap of an edge, and the
height below which a foot comes no nearer than on the level floor; second, penetration that is ignored.
"""
DETOURS = np.array(
    [[0.01 * ahead, 0.0, np.radians(15.0) * pitch] for ahead in range(-15, 16) for pitch in range(-3, 4)]
)
"""(W, 3) detours: metres ahead along the flight, metres up (0, computed for each frame), radians of pitch."""
DETOUR_COSTS = np.array([1.0, 1.0, 0.08])
"""Cost of a detour in metres: per metre ahead, per metre up, per radian of pitch."""
DETOUR_SECONDS = 0.3
"""Seconds of keeping a detour that cost as much as entering it."""
NEAR_CONTACT_SECONDS = 0.12
"""Seconds from a contact within which detours cost more."""
PATH_STIFFNESS = 0.01
"""Seconds over which a path is bent; more where its acceleration would be too great."""
SOFTENING_FACTOR, SOFTENING_ROUNDS, SOFTENING_MARGIN = 1.5, 8, 0.1
"""Factor of each softening of a path, greatest number of softenings, and seconds around a sharp bend that are
softened.
"""
DETOUR_ACCELERATION_FRACTION, GENTLE_ACCELERATION = 0.6, 30.0
"""Greatest acceleration that a detour may add, as a fraction of the foot's own, and the one that it may have anyway, in
m/s2.
"""
RAISING_ROUNDS = 8
"""Greatest number of iterations of raising a path that still penetrates the ground."""
SHORTEST_FLIGHT = 0.05
"""Length in metres of a flight below which it has no direction."""
_SCARCE, _FIRM = 1e-9, 1e9
"""Weights of a path's fit: a small one that keeps the equations solvable, and a great one that fixes a standing
foot.
"""


@dataclass(frozen=True, eq=False)
class Sole:
    """Path of a foot over the ground, with points of its sole."""

    ankles: FloatArray
    """(F, 3) metres."""
    feet: FloatArray
    """(F, 3, 3) in the world."""
    toes: FloatArray
    """(F, 3, 3) in the world."""
    points: FloatArray
    """(F, P, 3) points of the sole from heel to tip, metres."""

    @classmethod
    def of(cls, ankles: FloatArray, feet: FloatArray, toes: FloatArray, measures: FloatArray) -> "Sole":
        """Foot path with the points of a sole of ``measures`` (F or 1, 6) (``kernels.support.sole``)."""
        forward, left, down, height, heel, length = np.broadcast_to(measures, (len(ankles), 6)).T
        zero, fractions = np.zeros(len(ankles)), np.linspace(0.0, 1.0, 4)[:, None]

        def place(rotation_matrices: FloatArray, *offset: FloatArray) -> FloatArray:
            return np.asarray(np.einsum("fij,fj->fi", rotation_matrices, np.column_stack(offset)))[:, None]

        back = ankles[:, None] + place(feet, -heel, zero, -height)
        joint = ankles[:, None] + place(feet, forward, left, down)
        ball, under = (
            joint + place(rotation_matrices, zero, zero, -height - down) for rotation_matrices in (feet, toes)
        )
        tip = joint + place(toes, length, zero, -height - down)
        points = np.concatenate([back + fractions * (ball - back), under + fractions[1:] * (tip - under)], axis=1)
        return cls(ankles, feet, toes, points)


def rounded_ground_height(ground: Ground, positions: FloatArray) -> FloatArray:
    """Ground height (...) in metres at ``positions`` (..., 2 or 3), with every edge rounded within ``SOLE_TOLERANCE``
    metres.
    """
    angles = np.pi / 4.0 * np.arange(8)
    ring = np.concatenate([np.zeros((1, 2)), SOLE_TOLERANCE * np.column_stack([np.cos(angles), np.sin(angles)])])
    return np.asarray(ground.height_at(positions[..., None, :2] + ring).min(axis=-1))


def clear_swing_foot(level: Sole, sole: Sole, states: NDArray[np.int64], ground: Ground, frame_rate: float) -> Sole:
    """Path of the foot ``sole``, projected to the ground, with detours around obstacles while ``states`` (F,) are 0.

    ``level`` is the foot as planned on the level floor.
    """
    flight = _Flight.of(level, sole, states, ground)
    flying = np.flatnonzero(states == 0)
    lacks = np.zeros(len(states))
    lacks[flying] = flight.penetration(flying, np.zeros((len(flying), 3)))
    spans = [span for span in runs_of(states == 0) if lacks[slice(*span)].max() > PENETRATION_TOLERANCE]
    if not spans:
        return sole
    displacements = np.zeros((len(states), 3))
    for first, past in spans:
        if lacks[first:past].max() < GROUND_EDGE_HEIGHT:
            displacements[first:past, 1] = np.maximum(lacks[first:past], 0.0)
            continue
        frames = np.arange(first, past)
        lifts = np.maximum(flight.penetration(frames, DETOURS[None]), 0.0)
        near = steps_to_ground(first, past, len(states)) / frame_rate
        displacements[first:past] = _least_detour(lifts, near, frame_rate, first > 0, past < len(states))
    return flight.moved(_smooth_path(displacements, spans, flight, frame_rate))


@dataclass(frozen=True, eq=False)
class _Flight:
    """Geometry of a foot that is displaced along paths (..., 3): ahead, up, pitch."""

    sole: Sole
    ground: Ground
    states: NDArray[np.int64]
    ahead: FloatArray
    """(F, 2) horizontal unit direction of the flight."""
    heading: FloatArray
    """(F, 2) horizontal unit direction of the foot."""
    arms: FloatArray
    """(F, P, 2) from the ankle to the sole's points: along the heading, and up, metres."""
    least: FloatArray
    """(F, P) required height of each point above the ground, metres."""

    @classmethod
    def of(cls, level: Sole, sole: Sole, states: NDArray[np.int64], ground: Ground) -> "_Flight":
        """Geometry of the foot ``sole``; ``level`` is the foot as planned on the level floor."""
        ahead, heading = np.zeros((len(states), 2)), sole.feet[:, :2, 0]
        for first, past in runs_of(states == 0):
            displacement = sole.ankles[min(past, len(states) - 1), :2] - sole.ankles[max(first - 1, 0), :2]
            length = np.linalg.norm(displacement)
            ahead[first:past] = displacement / length if length > SHORTEST_FLIGHT else 0.0
        heading = heading / np.maximum(np.linalg.norm(heading, axis=1, keepdims=True), 1e-9)
        arms = sole.points - sole.ankles[:, None]
        arms = np.stack([np.einsum("fpk,fk->fp", arms[..., :2], heading), arms[..., 2]], axis=-1)
        return cls(
            sole, ground, states, ahead, heading, arms, np.minimum(level.points[..., 2] - ground.height, SOLE_TOLERANCE)
        )

    def penetration(self, frames: NDArray[np.int64], path: FloatArray) -> FloatArray:
        """Penetration (N, ...) in metres of soles in ``frames`` (N,), displaced by ``path`` (N or 1, ..., 3)."""
        more = (frames, *[None] * (path.ndim - 2))
        c, s = np.cos(path[..., 2])[..., None] - 1.0, np.sin(path[..., 2])[..., None]
        along, up = self.arms[more][..., 0], self.arms[more][..., 1]
        moved = path[..., None, :1] * self.ahead[more][..., None, :]
        moved = moved + (c * along + s * up)[..., None] * self.heading[more][..., None, :]
        heights = self.ground.height_at(self.sole.points[more][..., :2] + moved)
        low = self.sole.points[more][..., 2] + path[..., 1:2] + c * up - s * along
        return np.asarray((heights + self.least[more] - low).max(axis=-1))

    def moved(self, path: FloatArray) -> Sole:
        """Foot displaced along ``path`` (F, 3)."""
        axes = np.column_stack([-self.heading[:, 1], self.heading[:, 0], np.zeros(len(path))])
        rotation_matrices = Rotation.from_rotvec(path[:, 2:] * axes).as_matrix()
        ankles = self.sole.ankles + np.column_stack([path[:, :1] * self.ahead, path[:, 1]])
        return Sole(ankles, rotation_matrices @ self.sole.feet, rotation_matrices @ self.sole.toes, self.sole.points)


def steps_to_ground(first: int, past: int, count: int) -> NDArray[np.int64]:
    """Distance (past - first,) in frames from each frame of a flight to the nearest contact; the ends of a clip are
    none.
    """
    steps = np.arange(1, past - first + 1)
    far = np.full(past - first, past - first)
    return np.minimum(steps if first > 0 else far, steps[::-1] if past < count else far)


def _least_detour(
    lifts: FloatArray, near: FloatArray, frame_rate: float, from_ground: bool, to_ground: bool
) -> FloatArray:
    """Least detour (N, 3) through one flight of N frames.

    It minimises the sum of squared detours and squared speeds, by dynamic programming (Bellman 1957). ``lifts`` (N, W)
    are the metres by which each of ``DETOURS`` has to be raised in each frame, ``near`` (N,) the seconds to the nearest
    contact.
    """
    count, flat = len(lifts), DETOURS * DETOUR_COSTS
    lengths = np.sum(flat**2, axis=1) + lifts**2
    costs = lengths * (1.0 + (NEAR_CONTACT_SECONDS / near[:, None]) ** 4) / (frame_rate * DETOUR_SECONDS) ** 2
    between = np.sum((flat[:, None] - flat) ** 2, axis=2)
    total, came = costs[0] + from_ground * lengths[0], np.zeros(lifts.shape, dtype=np.int64)
    whole, displacements = np.empty(between.shape), np.arange(len(flat))
    for row in range(1, count):
        np.subtract(lifts[row][:, None], lifts[row - 1], out=whole)
        np.multiply(whole, whole, out=whole)
        whole += between
        whole += total
        came[row] = whole.argmin(axis=1)
        total = whole[displacements, came[row]] + costs[row]
    best, chosen = int((total + to_ground * lengths[-1]).argmin()), np.zeros((count, 3))
    for row in range(count - 1, -1, -1):
        chosen[row] = DETOURS[best]
        chosen[row, 1] = lifts[row, best]
        best = came[row, best]
    return chosen


def _smooth_path(
    displacements: FloatArray, spans: list[tuple[int, int]], flight: _Flight, frame_rate: float
) -> FloatArray:
    """Smooth path (F, 3) near the detours in the ``spans`` of frames, softer where its acceleration is too great.

    The horizontal part may be softer than the vertical one, which clears the remaining penetration afterwards.
    """
    stiff = np.full((len(displacements), 2), PATH_STIFFNESS)  # led along and turned; raised
    own = float(np.linalg.norm(np.diff(flight.sole.ankles, 2, axis=0), axis=1).max(initial=0.0))
    most = max(DETOUR_ACCELERATION_FRACTION * own, GENTLE_ACCELERATION / frame_rate**2)
    for _ in range(SOFTENING_ROUNDS):
        path = _bent_path(displacements, spans, flight, 1.0 / (stiff * frame_rate) ** 4)
        bent = np.abs(np.diff(path[:, :2], 2, axis=0))
        jerky = np.pad(bent > most, ((1, 1), (0, 0)))
        if not jerky.any():
            break
        for column in range(2):
            stiff[binary_dilation(jerky[:, column], iterations=round(SOFTENING_MARGIN * frame_rate) + 1), column] *= (
                SOFTENING_FACTOR
            )
    return path


def _bent_path(
    displacements: FloatArray, spans: list[tuple[int, int]], flight: _Flight, weights: FloatArray
) -> FloatArray:
    """Path (F, 3) of least second differences near the detours, by ``weights`` (F, 2), raised until it is clear of the
    ground.
    """
    still = np.where(flight.states == 0, 0.0, _FIRM)
    held = still.copy()
    for first, past in spans:
        held[first:past] = weights[first:past, 0]
    path = _bent_least(displacements, held)
    path[flight.states != 0] = 0.0
    path[:, 1] = 0.0
    frames = np.concatenate([np.arange(*span) for span in spans])
    raised = np.zeros((len(displacements), 1))
    for _ in range(RAISING_ROUNDS):
        penetration = flight.penetration(frames, path[frames])
        low = frames[penetration > PENETRATION_TOLERANCE]
        if not len(low):
            break
        raised[low, 0] = path[low, 1] + penetration[penetration > PENETRATION_TOLERANCE]
        still[low] = weights[low, 1]
        path[:, 1] = np.where(flight.states == 0, _bent_least(raised, still)[:, 0], 0.0)
    return path


def _bent_least(target: FloatArray, weights: FloatArray) -> FloatArray:
    """Paths (F, N) that minimise squared second differences, and squared distances from ``target`` (F, N) by
    ``weights`` (F,).
    """
    count = len(weights)
    bands = np.zeros((3, count))
    bands[2] = weights + _SCARCE
    if count > 2:
        for index, fraction in enumerate((1.0, 4.0, 1.0)):
            bands[2, index : count - 2 + index] += fraction
        bands[1, 1:-1] -= 2.0
        bands[1, 2:] -= 2.0
        bands[0, 2:] += 1.0
    return np.asarray(solveh_banded(bands, weights[:, None] * target))
