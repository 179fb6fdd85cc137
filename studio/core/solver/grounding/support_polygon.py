"""Support polygon: the outline of standing soles, hands, knees and seat, and the path of the centre of mass over it.

An outline is represented by its support function h (N,) for N horizontal directions n: the points p with n . p <= h for
all of them. Averaging (Minkowski), shrinking and measuring outlines are then simple arithmetic.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint, contact_mask, touching_points
from studio.core.compact_array import PoseArray
from studio.core.solver.task_assembly.chains import point_masses

FloatArray = NDArray[np.float64]

OUTLINE_DIRECTIONS = 48
"""Number N of horizontal directions of a support function."""
OUTLINE_SMOOTHING_SECONDS = 0.3
"""Seconds on either side over which an outline is averaged, so that it changes smoothly with every step."""
MASS_PATH_SMOOTHING_SECONDS = 0.15
"""Seconds on either side over which displacements of the mass into an outline are averaged, so that it does not bounce
off the edge.
"""
BALL_RADIUS, HEEL_RADIUS, TIP_RADIUS = 0.19, 0.13, 0.10
"""Radii of a sole at ball, heel and tip, in lengths of the sole (an adult's foot is 0.38 of its length wide)."""
CONTACT_RADII = {"hand": 0.05, "knee": 0.05, "seat": 0.1}
"""Radii of a hand with its fingers, of a knee, and of half a seat, in leg lengths."""
_ANGLES = np.arange(OUTLINE_DIRECTIONS) * (2.0 * np.pi / OUTLINE_DIRECTIONS)
_NORMALS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
_SIDEWAYS = np.stack([-np.sin(_ANGLES), np.cos(_ANGLES)], axis=1)
_COSINE, _SINE = np.cos(_ANGLES[1]), np.sin(_ANGLES[1])


def mass_path(positions: FloatArray, body: Morphology) -> FloatArray:
    """Centre of mass (F, 3) in metres of posed bodies with ``positions`` (F, P, 3) (de Leva 1996; METHOD 11)."""
    return np.asarray(point_masses(body.layout) @ positions)


def standing_mask(contacts: Sequence[ContactInterval], frame_count: int) -> NDArray[np.bool_]:
    """(9, F) True where each ``ContactPoint`` is in contact."""
    spans = [[(each.first, each.last) for each in contacts if each.point is point] for point in ContactPoint]
    return np.array([contact_mask(each, frame_count) for each in spans])


def support_polygons(
    positions: FloatArray, rotations: FloatArray, standing: NDArray[np.bool_], body: Morphology, margin: float = 0.0
) -> FloatArray:
    """Support functions (F, N) in metres of the contacts' outline, shrunk by ``margin`` metres; NaN without contacts.

    ``positions`` (F, P, 3), ``rotations`` (F, S, 3, 3), ``standing`` (9, F) the result of ``standing_mask``. An outline
    shrinks to the middle line of a sole at most.
    """
    found = np.full((len(positions), OUTLINE_DIRECTIONS), -np.inf)
    for point, stands in zip(ContactPoint, standing, strict=True):
        if stands.any():
            for centres, radius in _circles(point, positions, rotations, stands, body):
                reach = centres @ _NORMALS.T + max(radius - margin, 0.0)
                found[stands] = np.maximum(found[stands], reach)
    return np.where(np.isfinite(found), found, np.nan)


def averaged_polygons(areas: FloatArray, frame_rate: float) -> tuple[FloatArray, FloatArray]:
    """Support functions (F, N) averaged over time, and the fraction (F,) of the averaging window that is in contact."""
    stands = np.isfinite(areas[:, :1]).astype(np.float64)
    weight = _around(stands, OUTLINE_SMOOTHING_SECONDS, frame_rate)
    mean = _around(np.nan_to_num(areas), OUTLINE_SMOOTHING_SECONDS, frame_rate) / np.where(weight > 0.0, weight, np.nan)
    return mean, weight[:, 0] / _around(np.ones((len(areas), 1)), OUTLINE_SMOOTHING_SECONDS, frame_rate)[:, 0]


def support_path(
    positions: PoseArray,
    rotations: PoseArray,
    standing: NDArray[np.bool_],
    body: Morphology,
    frame_rate: float,
    margin: float,
    window: slice,
) -> FloatArray:
    """Path (F, 3) of the centre of mass that stays over the support of a grounded motion, in the frames of ``window``.

    It is the point of the smoothed outline nearest to the motion's own centre of mass, smoothed at the edge; in flight
    it is the motion's own.
    """
    first, stop, _ = window.indices(len(positions))
    reach = _half(OUTLINE_SMOOTHING_SECONDS, frame_rate) + _half(MASS_PATH_SMOOTHING_SECONDS, frame_rate)
    wide = slice(max(first - reach, 0), min(stop + reach, len(positions)))
    lines = support_polygons(positions[wide], rotations[wide], standing[:, wide], body, margin)
    areas, presence = averaged_polygons(lines, frame_rate)
    masses = mass_path(positions[wide], body)
    displacement = presence[:, None] * np.nan_to_num(nearest_within(areas, masses[:, :2]) - masses[:, :2])
    masses[:, :2] += _around(displacement, MASS_PATH_SMOOTHING_SECONDS, frame_rate) / _around(
        np.ones((len(displacement), 1)), MASS_PATH_SMOOTHING_SECONDS, frame_rate
    )
    return masses[first - wide.start : stop - wide.start]


def _half(seconds: float, frame_rate: float) -> int:
    """Number of frames in ``seconds``, on either side of an average."""
    return max(1, round(seconds * frame_rate))


def _around(values: FloatArray, seconds: float, frame_rate: float) -> FloatArray:
    """Sums (F, N) of ``values`` (F, N), weighted by a Hann window of ``seconds`` on either side."""
    half = _half(seconds, frame_rate)
    window = np.hanning(2 * half + 3)[1:-1]
    return np.stack([np.convolve(np.pad(column, half), window, mode="valid") for column in values.T], axis=1)


def corners(areas: FloatArray) -> FloatArray:
    """Corners (F, N, 2) of outlines with support functions (F, N), anticlockwise, metres."""
    ahead = np.roll(areas, -1, axis=1)
    return np.asarray(areas[..., None] * _NORMALS + ((ahead - areas * _COSINE) / _SINE)[..., None] * _SIDEWAYS)


def nearest_within(areas: FloatArray, points: FloatArray) -> FloatArray:
    """Positions (F, 2) nearest to ``points`` (F, 2) within outlines with support functions (F, N)."""
    outside = _beyond(areas, points) > 0.0
    found, ends, own = points.copy(), corners(areas[outside]), points[outside][:, None]
    begins = np.roll(ends, 1, axis=1)
    edges, away = ends - begins, own - begins
    along = np.sum(away * edges, axis=2) / np.maximum(np.sum(edges * edges, axis=2), 1e-12)
    places = begins + np.clip(along, 0.0, 1.0)[..., None] * edges
    nearest = np.argmin(np.linalg.norm(own - places, axis=2), axis=1)
    found[outside] = places[np.arange(len(places)), nearest]
    return found


def support_margins(areas: FloatArray, points: FloatArray) -> FloatArray:
    """Distance (F,) in metres of ``points`` (F, 2) from the edge of outlines: negative outside, NaN without
    contacts.
    """
    beyond = _beyond(areas, points)
    distance = np.linalg.norm(points - nearest_within(areas, points), axis=1)
    return np.where(beyond > 0.0, -distance, -beyond)


def _beyond(areas: FloatArray, points: FloatArray) -> FloatArray:
    """Greatest distance (F,) in metres of points beyond a line of their outline; negative inside, NaN for no
    outline.
    """
    return np.asarray(np.max(points @ _NORMALS.T - areas, axis=1))


def _circles(
    point: ContactPoint, positions: FloatArray, rotations: FloatArray, stands: NDArray[np.bool_], body: Morphology
) -> list[tuple[FloatArray, float]]:
    """(centres (n, 2), radius) of each circle that covers a contact point in the n frames in which it ``stands``
    (F,).
    """
    if point.is_foot:
        rear, ball, tip = _sole(positions, rotations, stands, body, point.side)
        return [rear] if point.is_heel else [ball, tip]
    radius = body.leg_length * CONTACT_RADII[point.member]
    joints = touching_points(point, body.layout)
    if point.member == "hand":
        joints = [joints[0], joints[0] + 1]
    return [(positions[stands, joint, :2], radius) for joint in joints]


def _sole(
    positions: FloatArray, rotations: FloatArray, stands: NDArray[np.bool_], body: Morphology, side: int
) -> list[tuple[FloatArray, float]]:
    """(centres (n, 2), radius) of circles at heel, ball and tip of a sole in the n frames in which it ``stands``
    (F,).
    """
    layout = body.layout
    ankle, ball, tip = (positions[stands, layout.ankle_point(side) + step] for step in range(3))
    foot = rotations[stands, layout.foot_segment(side)]
    rear = ankle + foot @ np.array([-body.heel_length[side], 0.0, -body.ankle_height[side]])
    line = ball[:, :2] - rear[:, :2]
    ahead = line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    length = float(body.heel_length[side] + np.hypot(*body.foot[side, :2]) + np.hypot(*body.toe[side, :2]))
    at_rear, at_tip = HEEL_RADIUS * length, TIP_RADIUS * length
    return [
        (rear[:, :2] + at_rear * ahead, at_rear),
        (ball[:, :2], BALL_RADIUS * length),
        (tip[:, :2] - at_tip * ahead, at_tip),
    ]
