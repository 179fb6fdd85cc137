"""Footprints: feet planned on a level floor, each projected to uneven ground by one rigid displacement (METHOD 5).

The ground is sampled once for a footprint, at its heel, ball and tip, never under a moving foot. The planned contact is
moved as one rigid piece to the plane found there, so that a foot that stands on the level floor stands on the slope as
well; the displacement is interpolated between contacts.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import at_frames
from studio.core.captures.contacts import spans_of
from studio.core.grounds.ground import Ground
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS
from studio.core.solver.grounding.contact_blending import smoothstep_array

FloatArray = NDArray[np.float64]

GROUND_EDGE_HEIGHT = 0.03
"""Deviation in metres of the ground under a sole from the plane of its slope, beyond which the ground has an edge
there.
"""
STEEPEST_SOLE_SLOPE = np.radians(35.0)
"""Greatest slope in radians that a sole takes."""
TOE_BEND_RANGE = np.radians([-20.0, 40.0])
"""Greatest bend of toes, down and up, in radians, to follow the ground beyond the ball; steeper ground is ignored."""
LONGEST_FLIGHT_SECONDS = 1.0
"""Seconds without contact from which on a foot follows the ground below it."""
WAYPOINT_SECONDS = 0.5 * LONGEST_FLIGHT_SECONDS
"""Seconds between samples of the ground below a foot in a long flight."""
SHORTEST_RAMP_SECONDS = 0.25
"""Seconds before the first and after the last contact up to which a foot does not follow the ground."""
EARLY_RISE_FRACTION, LATE_SINK_FRACTION = 0.2, 0.12
"""Greatest fraction of a flight by which a foot rises early, or sinks late."""
LEAST_CLIMB_SECONDS = 0.36
"""Least seconds of a rise or descent; flights that are hardly longer neither rise early nor sink late."""
_SETTLING = 4
"""Iterations of a sole along the plane under it."""


@dataclass(frozen=True, eq=False)
class SolePlanes:
    """Planes of the ground under N soles."""

    heights: FloatArray
    """(N,) heights at the balls, metres."""
    normals: FloatArray
    """(N, 3) unit normals."""
    overhangs: NDArray[np.bool_]
    """(N, 2) True if heel or ball is beyond an edge."""
    bends: FloatArray
    """(N,) upward bends of the toes, radians."""


@dataclass(frozen=True, eq=False)
class Footprints:
    """The N contacts of one foot in time, with their displacement to the ground."""

    first: NDArray[np.int64]
    """(N,) first frame."""
    last: NDArray[np.int64]
    """(N,) last frame, included."""
    pivots: FloatArray
    """(N, 3) balls on the level floor, metres."""
    moves: FloatArray
    """(N, 3) displacements of the balls to the ground, metres."""
    tilts: FloatArray
    """(N, 3) rotation vectors about the balls, radians."""
    bends: FloatArray
    """(N,) upward bends of the toes, radians."""
    hanging: NDArray[np.bool_]
    """(N,) True for a heel over a drop."""


@dataclass(frozen=True, eq=False)
class FootOnTerrain:
    """One foot on uneven ground, in F frames."""

    ankles: FloatArray
    """(F, 3) metres."""
    feet: FloatArray
    """(F, 3, 3) in the world."""
    toes: FloatArray
    """(F, 3, 3) in the world."""
    heights: FloatArray
    """(F,) interpolated heights of its footprints above the level floor, metres."""


def planes_under(ground: Ground, soles: FloatArray) -> SolePlanes:
    """Planes of the ground under ``soles`` (N, 3, 2), the horizontal positions of heel, ball and tip.

    They pass through the ground at heel and ball, and are tilted across as the ground is. A sole over an edge takes the
    plane at its highest point.
    """
    heights, normals = ground.height_at(soles), ground.normal_at(soles)
    line = soles[:, 1] - soles[:, 0]
    length = np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    along = line / length
    slopes = -normals[..., :2] / normals[..., 2:]
    expected = np.einsum("npk,nk->n", slopes[:, :2] / 2, line)
    tip_expected = np.einsum("nk,nk->n", slopes[:, 1:].mean(axis=1), soles[:, 2] - soles[:, 1])
    edge = (np.abs(heights[:, 1] - heights[:, 0] - expected) > GROUND_EDGE_HEIGHT) | (
        heights[:, 2] - heights[:, 1] - tip_expected > GROUND_EDGE_HEIGHT
    )
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    rise = (heights[:, 1] - heights[:, 0]) / length[:, 0]
    lean = np.einsum("npk,nk->n", slopes[:, :2] / 2, across)
    slope = rise[:, None] * along + lean[:, None] * across
    highest, rows = heights.argmax(axis=1), np.arange(len(soles))
    slope = np.where(edge[:, None], slopes[rows, highest], slope)
    steep = np.linalg.norm(slope, axis=1, keepdims=True) / np.tan(STEEPEST_SOLE_SLOPE)
    slope = slope / np.maximum(steep, 1.0)
    level = np.where(edge | (steep[:, 0] > 1.0), highest, 1)
    at_ball = heights[rows, level] + np.einsum("nk,nk->n", slope, soles[:, 1] - soles[rows, level])
    at_heel = at_ball - np.einsum("nk,nk->n", slope, line)
    overhangs = np.stack([at_heel - heights[:, 0], at_ball - heights[:, 1]], axis=1) > GROUND_EDGE_HEIGHT
    normal = np.column_stack([-slope, np.ones(len(slope))])
    to_tip = soles[:, 2] - soles[:, 1]
    gap = heights[:, 2] - at_ball - np.einsum("nk,nk->n", slope, to_tip)
    bends = np.arctan2(gap, np.maximum(np.linalg.norm(to_tip, axis=1), 1e-9))
    bends = np.where(edge | (bends < TOE_BEND_RANGE[0]) | (bends > TOE_BEND_RANGE[1]), 0.0, bends)
    return SolePlanes(at_ball, normal / np.linalg.norm(normal, axis=1, keepdims=True), overhangs, bends)


def tilts_of(normals: FloatArray) -> FloatArray:
    """Rotation vectors (N, 3) of the shortest rotations from the vertical to ``normals`` (N, 3)."""
    axis = np.stack([-normals[:, 1], normals[:, 0], np.zeros(len(normals))], axis=1)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arctan2(sine, normals[:, 2:])
    return np.asarray(axis * angle / np.maximum(sine, 1e-12))


def find_footprints(
    states: NDArray[np.int64], ankles: FloatArray, feet: FloatArray, measures: FloatArray, ground: Ground
) -> Footprints:
    """Footprints of a foot planned on the level floor, with their displacement to the ground.

    ``states`` (F,), ``ankles`` (F, 3), ``feet`` (F, 3, 3); ``measures`` (F or 1, 6) of the foot
    (``kernels.support.sole``).
    """
    first, last, middle, of_episode = np.array(_spans(states), dtype=np.int64).reshape(-1, 4).T
    soles = soles_of(ankles[middle], feet[middle], at_frames(measures, middle))
    nudges = ground.foothold_offsets(soles)[of_episode]
    level = np.column_stack([soles[:, 1], np.full(len(soles), ground.height)])
    placed = soles + nudges[:, None]
    for _ in range(_SETTLING):
        planes = planes_under(ground, placed)
        reach = np.linalg.norm(soles - soles[:, 1:2], axis=2) * [-1.0, 0.0, 1.0]
        turned = Rotation.from_rotvec(tilts_of(planes.normals)).as_matrix()
        lines = np.column_stack([soles[:, 1] - soles[:, 0], np.zeros(len(soles))])
        lines /= np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-9)
        sloping = np.einsum("nij,nj->ni", turned, lines)[:, None, :2]
        placed = placed[:, 1:2] + reach[..., None] * sloping
    moves = np.column_stack([nudges, planes.heights - ground.height])
    return Footprints(first, last, level, moves, tilts_of(planes.normals), planes.bends, planes.overhangs[:, 0])


def project_to_terrain(
    footprints: Footprints, ankles: FloatArray, feet: FloatArray, toes: FloatArray, ground: Ground, frame_rate: float
) -> FootOnTerrain:
    """Foot planned on the level floor, projected to the ground with its footprints.

    ``ankles`` (F, 3), ``feet`` and ``toes`` (F, 3, 3) are those planned.
    """
    prints = _with_waypoints(footprints, ankles, ground, frame_rate)
    count = len(ankles)
    pivots, tilts = (_interpolated(prints, values, count) for values in (prints.pivots, prints.tilts))
    moves = _interpolated(prints, prints.moves, count, frame_rate)
    rotation_matrices = Rotation.from_rotvec(tilts).as_matrix()
    bent = (
        toes @ Rotation.from_rotvec(_interpolated(prints, prints.bends[:, None] * [0.0, -1.0, 0.0], count)).as_matrix()
    )
    return FootOnTerrain(
        pivots + moves + np.einsum("fij,fj->fi", rotation_matrices, ankles - pivots),
        rotation_matrices @ feet,
        rotation_matrices @ bent,
        moves[:, 2],
    )


def _spans(states: NDArray[np.int64]) -> list[tuple[int, int, int, int]]:
    """(first, last, typical frame, index of the first footprint of its contact) of each footprint of a foot.

    A contact is one footprint, or several if its heel rises and comes down again while the toe stands.
    """
    found: list[tuple[int, int, int, int]] = []
    for begin, end in spans_of(states != 0):
        heels = [(begin + a, begin + b) for a, b in spans_of((states[begin : end + 1] & HEEL_STANDS) != 0)]
        leader = len(found)
        for index, (first, last) in enumerate(heels or [(begin, end)]):
            flat = [(first + a, first + b) for a, b in spans_of(states[first : last + 1] == SOLE_STANDS)]
            longest = max(flat or [(first, last)], key=lambda run: run[1] - run[0])
            found.append(
                (
                    begin if index == 0 else first,
                    end if index == max(len(heels), 1) - 1 else last,
                    (longest[0] + longest[1]) // 2,
                    leader,
                )
            )
    return found


def soles_of(ankles: FloatArray, feet: FloatArray, measures: FloatArray) -> FloatArray:
    """Horizontal positions (N, 3, 2) of heel, ball and tip of feet that are laid flat about their balls.

    ``measures`` (N or 1, 6) of the foot (``kernels.support.sole``).
    """
    ahead = feet[:, :2, 0] / np.maximum(np.linalg.norm(feet[:, :2, 0], axis=1, keepdims=True), 1e-9)
    to_ball = np.broadcast_to(measures[:, :3], ankles.shape)
    ball = ankles[:, :2] + np.einsum("fij,fj->fi", feet, to_ball)[:, :2]
    heel = ball - (measures[:, :1] + measures[:, 4:5]) * ahead
    tip = ball + measures[:, 5:] * ahead
    return np.stack([heel, ball, tip], axis=1)


def _with_waypoints(prints: Footprints, ankles: FloatArray, ground: Ground, frame_rate: float) -> Footprints:
    """Footprints with additional ones in long flights, in which a foot follows the ground below it."""
    count = len(ankles)
    borders = np.column_stack([np.append(-1, prints.last), np.append(prints.first, count)])
    frames: list[int] = []
    for before, after in borders.tolist():
        at_end = before < 0 or after >= count
        gap = (after - before) / frame_rate
        if gap > (SHORTEST_RAMP_SECONDS if at_end else LONGEST_FLIGHT_SECONDS) or not len(prints.first):
            pieces = max(round(gap / WAYPOINT_SECONDS), 1)
            inner = np.linspace(max(before, 0), min(after, count - 1), pieces + 1).astype(int)
            keep_first, keep_last = before < 0, after >= count
            frames += inner[0 if keep_first else 1 : None if keep_last else -1].tolist()
    if not frames:
        return prints
    extra = np.array(sorted(set(frames)), dtype=np.int64)
    level = np.column_stack([ankles[extra, :2], np.full(len(extra), ground.height)])
    moves = np.zeros((len(extra), 3))
    moves[:, 2] = ground.height_at(level) - ground.height
    order = np.argsort(np.concatenate([prints.first, extra]), kind="stable")

    first, last = np.append(prints.first, extra)[order], np.append(prints.last, extra)[order]
    pivots, all_moves, tilts = (
        np.concatenate(both)[order]
        for both in (
            (prints.pivots, level),
            (prints.moves, moves),
            (prints.tilts, tilts_of(ground.normal_at(level))),
        )
    )
    bends = np.append(prints.bends, np.zeros(len(extra)))[order]
    hanging = np.append(prints.hanging, np.zeros(len(extra), dtype=np.bool_))[order]
    return Footprints(first, last, pivots, all_moves, tilts, bends, hanging)


def _interpolated(prints: Footprints, values: FloatArray, count: int, frame_rate: float = math.inf) -> FloatArray:
    """Values (F, 3) of footprints over time: ``values`` (N, 3) during each footprint, interpolated between them.

    With a frame rate, rises come early in a flight, and descents late, as feet pass over edges.
    """
    frames = np.arange(count)
    following = np.minimum(np.searchsorted(prints.last, frames), len(prints.last) - 1)
    before = np.where(frames < prints.first[following], np.maximum(following - 1, 0), following)
    gap = np.maximum(prints.first[following] - prints.last[before], 1)
    fraction = np.clip((frames - prints.last[before]) / gap, 0.0, 1.0)
    change = values[following] - values[before]
    eased = values[before] + smoothstep_array(fraction)[:, None] * change
    if frame_rate < math.inf:
        most = np.where(change[:, 2] > 0.0, EARLY_RISE_FRACTION, LATE_SINK_FRACTION)
        haste = np.clip(1.0 - LEAST_CLIMB_SECONDS * frame_rate / gap, 0.0, most)
        rising = np.where(change[:, 2] > 0.0, fraction, fraction - haste) / (1.0 - haste)
        eased[:, 2] = values[before][:, 2] + smoothstep_array(np.clip(rising, 0.0, 1.0)) * change[:, 2]
    return np.asarray(eased)
