"""How sharply targets themselves move and come and go: what joints must turn with to follow them (METHOD (36))."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import Morphology
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.rows import Rows
from studio.core.solver.standing.support import mass_path

FloatArray = NDArray[np.float64]

FARTHEST = 0.8
"""Metres that a target brings its point at most: what is farther off is no more than a direction."""
NEAR = 0.1
"""Seconds around a frame within which what a target brings may show in the joints."""


def brought(
    rows: Rows,
    first: int,
    activations: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    body: Morphology,
    rate: float,
) -> FloatArray:
    """(2, C, F) radians a second squared that targets, from row ``first`` on, bring by their ways and by their edges.

    (a + v^2 / l) / l over l metres, v and a of what each asks beside where the unsolved poses have what it is for; and
    what a radian has by its activation (C, F), with which joints come and go.
    """
    brings = np.zeros((2, *activations.shape))
    for c in (first + np.flatnonzero((activations[first:] > 0.0).any(axis=1))).tolist():
        path, lever = _path(c, rows, positions, rotations, body)
        edges = np.abs(np.diff(activations[c], 2)) * rate**2
        sharp = np.stack([_sharp(path, lever, rate), np.pad(edges, 1, mode="edge")])
        acts = maximum_filter1d(activations[c] > 0.0, 3)
        brings[:, c] = maximum_filter1d(np.where(acts, sharp, 0.0), 2 * round(NEAR * rate) + 1, mode="nearest")
    return brings


def _sharp(path: FloatArray, lever: float, rate: float) -> FloatArray:
    """(F,) radians a second squared that turn a bone with a lever along a path (F, n)."""
    speed = np.linalg.norm(np.gradient(path, axis=0), axis=1) * rate
    push = np.linalg.norm(np.diff(path, 2, axis=0), axis=1) * rate**2
    return np.asarray((np.pad(push, 1, mode="edge") + speed**2 / lever) / lever)


def _path(
    c: int, rows: Rows, positions: FloatArray, rotations: FloatArray, body: Morphology
) -> tuple[FloatArray, float]:
    """What one constraint asks (F, n), and the lever over which it turns a bone."""
    row, count = rows.asked[c], len(positions)
    target = np.broadcast_to(rows.places[c], (count, 3))
    (point, other), (segment, axes) = row["points"], row["segments"]
    place = positions[:, point] + rotations[:, segment] @ row["offsets"][0]
    followed = positions[:, other] + rotations[:, axes] @ row["offsets"][1]
    if row["kind"] == goals.ORIENTATION:
        turns = np.broadcast_to(rows.turns[c], (count, 3, 3)) if other < 0 else rotations[:, axes] @ row["relative"]
        errors = turns @ np.swapaxes(rotations[:, segment], 1, 2)
        return np.asarray(Rotation.from_matrix(errors).as_rotvec()), 1.0
    if row["kind"] == goals.LOOK_AT:
        way = (target if other < 0 else followed) - place
        way = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
        return way - rotations[:, segment, :, 0], 1.0
    if row["kind"] == goals.UPRIGHT:
        axes = rotations[:, segment] @ row["offsets"][1]
        lean = np.arccos(np.clip(np.sum(axes * target, axis=1, keepdims=True), -1.0, 1.0))
        return (target - axes) * np.maximum(lean - rows.distances[c][:, None], 0.0) / np.maximum(lean, 1e-9), 1.0
    if row["kind"] == goals.DISTANCE:
        now = np.linalg.norm(place - (target if other < 0 else followed), axis=1, keepdims=True)
        return rows.distances[c][:, None] - now, goals.TURN_ARM
    begin = mass_path(positions, body) if row["kind"] == goals.BALANCE else place
    way = (followed if other >= 0 else np.where(np.isnan(target), begin, target)) - begin
    return way / np.sqrt(1.0 + (np.linalg.norm(way, axis=1, keepdims=True) / FARTHEST) ** 2), goals.TURN_ARM
