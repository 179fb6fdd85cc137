"""What a body stands on: the outline of its standing soles, hands, knees and seat, and where the mass is to be over it.

An outline is its support function h (N,) for N directions n over the ground: it holds the points p with n . p <= h for
all of them. So outlines are averaged over time (Minkowski), shrunk and measured by simple arithmetic.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint, contact_mask, touching_points
from studio.core.single import PoseArray
from studio.core.solver.asking.chains import point_masses

FloatArray = NDArray[np.float64]

DIRECTIONS = 48
SMOOTHING = 0.3
"""Seconds before and after over which an outline is averaged, so that it changes smoothly with every step."""
EASING = 0.15
"""Seconds before and after over which the way to an outline is averaged: the mass does not bounce off its edge."""
BALL, REAR, TIP = 0.19, 0.13, 0.10
"""Radii of a sole at ball, heel and tip, as parts of its length (breadth of an adult's foot 0.38 of its length)."""
RADII = {"hand": 0.05, "knee": 0.05, "seat": 0.1}
"""Of palm and fingers, knee and half a seat, as parts of the leg's length."""
_ANGLES = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
_NORMALS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
_SIDEWAYS = np.stack([-np.sin(_ANGLES), np.cos(_ANGLES)], axis=1)
_COSINE, _SINE = np.cos(_ANGLES[1]), np.sin(_ANGLES[1])


def mass_path(positions: FloatArray, body: Morphology) -> FloatArray:
    """(F, 3) metres: where the centre of mass of posed bodies (F, P, 3) is (de Leva 1996; METHOD 7)."""
    return np.asarray(point_masses(body.layout) @ positions)


def standing_points(contacts: Sequence[ContactInterval], frame_count: int) -> NDArray[np.bool_]:
    """(9, F) where each ``ContactPoint`` stands."""
    spans = [[(each.first, each.last) for each in contacts if each.point is point] for point in ContactPoint]
    return np.array([contact_mask(each, frame_count) for each in spans])


def outlines(
    positions: FloatArray, rotations: FloatArray, standing: NDArray[np.bool_], body: Morphology, margin: float = 0.0
) -> FloatArray:
    """(F, N) the outline of what stands, ``margin`` metres shrunk; NaN where nothing does.

    ``positions`` (F, P, 3), ``rotations`` (F, S, 3, 3), ``standing`` (9, F) as of ``standing_points``. It shrinks to
    the middle line of a sole at most.
    """
    found = np.full((len(positions), DIRECTIONS), -np.inf)
    for point, stands in zip(ContactPoint, standing, strict=True):
        if stands.any():
            for centres, radius in _circles(point, positions, rotations, stands, body):
                reach = centres @ _NORMALS.T + max(radius - margin, 0.0)
                found[stands] = np.maximum(found[stands], reach)
    return np.where(np.isfinite(found), found, np.nan)


def smoothed(areas: FloatArray, frame_rate: float) -> tuple[FloatArray, FloatArray]:
    """Outlines (F, N) averaged over time, and (F,) in [0, 1] how much there is to stand on around each frame."""
    stands = np.isfinite(areas[:, :1]).astype(np.float64)
    weight = _around(stands, SMOOTHING, frame_rate)
    mean = _around(np.nan_to_num(areas), SMOOTHING, frame_rate) / np.where(weight > 0.0, weight, np.nan)
    return mean, weight[:, 0] / _around(np.ones((len(areas), 1)), SMOOTHING, frame_rate)[:, 0]


def support_path(
    positions: PoseArray,
    rotations: PoseArray,
    standing: NDArray[np.bool_],
    body: Morphology,
    frame_rate: float,
    margin: float,
    window: slice,
) -> FloatArray:
    """(F, 3) where the centre of mass of a standing motion is to be in the frames of ``window``: over its support.

    It is led to the nearest place of the smoothed outline, smoothly where it meets its edge; in flight it is the
    motion's own.
    """
    first, stop, _ = window.indices(len(positions))
    reach = _half(SMOOTHING, frame_rate) + _half(EASING, frame_rate)
    wide = slice(max(first - reach, 0), min(stop + reach, len(positions)))
    areas, presence = smoothed(outlines(positions[wide], rotations[wide], standing[:, wide], body, margin), frame_rate)
    masses = mass_path(positions[wide], body)
    way = presence[:, None] * np.nan_to_num(nearest_within(areas, masses[:, :2]) - masses[:, :2])
    masses[:, :2] += _around(way, EASING, frame_rate) / _around(np.ones((len(way), 1)), EASING, frame_rate)
    return masses[first - wide.start : stop - wide.start]


def _half(seconds: float, frame_rate: float) -> int:
    """Frames to either side over which something is averaged."""
    return max(1, round(seconds * frame_rate))


def _around(values: FloatArray, seconds: float, frame_rate: float) -> FloatArray:
    """(F, N) sums of ``values`` (F, N) under a Hann window of ``seconds`` to either side."""
    half = _half(seconds, frame_rate)
    window = np.hanning(2 * half + 3)[1:-1]
    return np.stack([np.convolve(np.pad(column, half), window, mode="valid") for column in values.T], axis=1)


def corners(areas: FloatArray) -> FloatArray:
    """(F, N, 2) the corners of outlines (F, N), anticlockwise."""
    ahead = np.roll(areas, -1, axis=1)
    return np.asarray(areas[..., None] * _NORMALS + ((ahead - areas * _COSINE) / _SINE)[..., None] * _SIDEWAYS)


def nearest_within(areas: FloatArray, points: FloatArray) -> FloatArray:
    """(F, 2) the places of outlines (F, N) that are nearest to ``points`` (F, 2)."""
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
    """(F,) metres from ``points`` (F, 2) to the edge of outlines (F, N): negative outside, NaN where nothing stands."""
    beyond = _beyond(areas, points)
    distance = np.linalg.norm(points - nearest_within(areas, points), axis=1)
    return np.where(beyond > 0.0, -distance, -beyond)


def _beyond(areas: FloatArray, points: FloatArray) -> FloatArray:
    """(F,) metres beyond the line that is passed furthest; negative inside, NaN for no outline."""
    return np.asarray(np.max(points @ _NORMALS.T - areas, axis=1))


def _circles(
    point: ContactPoint, positions: FloatArray, rotations: FloatArray, stands: NDArray[np.bool_], body: Morphology
) -> list[tuple[FloatArray, float]]:
    """What lies on the ground at a contact point where it ``stands`` (F,), as circles: centres (n, 2) and a radius."""
    if point.is_foot:
        rear, ball, tip = _sole(positions, rotations, stands, body, point.side)
        return [rear] if point.is_heel else [ball, tip]
    radius = body.leg_length * RADII[point.member]
    joints = touching_points(point, body.layout)
    if point.member == "hand":
        joints = [joints[0], joints[0] + 1]
    return [(positions[stands, joint, :2], radius) for joint in joints]


def _sole(
    positions: FloatArray, rotations: FloatArray, stands: NDArray[np.bool_], body: Morphology, side: int
) -> list[tuple[FloatArray, float]]:
    """Circles in which a sole lies where it ``stands`` (F,), at heel, ball and tip."""
    layout = body.layout
    ankle, ball, tip = (positions[stands, layout.ankle(side) + step] for step in range(3))
    foot = rotations[stands, layout.spine_count + 12 + 4 * side]
    rear = ankle + foot @ np.array([-body.heel_length[side], 0.0, -body.ankle_height[side]])
    line = ball[:, :2] - rear[:, :2]
    ahead = line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    length = float(body.heel_length[side] + np.hypot(*body.foot[side, :2]) + np.hypot(*body.toe[side, :2]))
    at_rear, at_tip = REAR * length, TIP * length
    return [
        (rear[:, :2] + at_rear * ahead, at_rear),
        (ball[:, :2], BALL * length),
        (tip[:, :2] - at_tip * ahead, at_tip),
    ]
