"""Quality of an adapted motion, in metres and in ratios to its source."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import at_frames, sole_rows
from studio.core.captures.contacts import ContactInterval
from studio.core.grounds.ground import Ground
from studio.core.kernels.time.acceleration_peaks import segment_peaks
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.runs import runs_of
from studio.core.solver.grounding.footing import foot_states
from studio.core.solver.grounding.grounded_motion import PEAK_CHUNK_FRAMES
from studio.core.solver.grounding.support_polygon import mass_path, support_margins, support_polygons
from studio.core.solver.grounding.swing_foot_path import Sole, rounded_ground_height
from studio.core.solver.request import AdaptedMotion
from studio.core.threads import do_over_frames

FloatArray = NDArray[np.float64]

LEAST_TURNING_SPEED = 1.0
"""Least peak speed in radians per second of a rotating joint in a ratio; slower ones are raised to it."""
SKATE_HEIGHT_METRES, SKATING_SPEED = 0.005, 0.7
"""Limits of skating: greatest height in metres of a foot above the ground, and greatest speed in leg lengths per second
along it; a faster foot swings.
"""
LIMB_BONES = [
    place for place, part in enumerate(BodyPart) if part.value.endswith(("upper_arm", "forearm", "thigh", "shank"))
]
"""Indices in ``BodyPart`` of the long bones of arms and legs."""


@dataclass(frozen=True)
class ContactQuality:
    """Worst values over all contacts of a motion, in metres."""

    slide: float
    """Greatest distance along the ground of a standing joint from its position at the begin of the contact."""
    rise: float
    """Greatest height of a standing heel, ball, hand, knee or seat above the ground, along its normal."""
    penetration: float
    """Greatest depth below the ground of any contact point."""


def contact_quality(adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground) -> ContactQuality:
    """Slide, float and penetration of the contact points during ``contacts`` (frames counted in the whole motion)."""
    return worst_of(*contact_tracks(adapted, contacts, ground))


def worst_of(slides: FloatArray, heights: FloatArray) -> ContactQuality:
    """Worst values in the ``slides`` and ``heights`` of ``contact_tracks``."""
    if not np.isfinite(slides).any():
        return ContactQuality(0.0, 0.0, 0.0)
    rise, depth = float(np.nanmax(heights)), float(np.nanmax(-heights))
    return ContactQuality(float(np.nanmax(slides)), max(rise, 0.0), max(depth, 0.0))


def centre_of_mass(adapted: AdaptedMotion) -> FloatArray:
    """Centre of mass (F, 3) in metres, in the motion's space (de Leva 1996; METHOD 11)."""
    return mass_path(adapted.positions[:], adapted.morphology)


def mass_margins(adapted: AdaptedMotion, standing: NDArray[np.bool_]) -> FloatArray:
    """Distances (F,) in metres from the centre of mass to the edge of the support polygon; negative outside, NaN in
    flight.

    ``standing`` (9, F) masks the contacts that make the polygon.
    """
    margins = np.empty(adapted.frame_count)

    def measure(run: slice) -> None:
        part = adapted.frames(adapted.first_frame + run.start, adapted.first_frame + run.stop - 1)
        areas = support_polygons(part.positions[:], part.rotations[:], standing[:, run], part.morphology)
        margins[run] = support_margins(areas, centre_of_mass(part)[:, :2])

    do_over_frames(measure, adapted.frame_count)
    return margins


def swing_depths(adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground) -> FloatArray:
    """Depths (2, F) in metres of the lowest part of the sole of a foot in the air below the ground; negative above it.

    NaN while heel or toe stand. A point within 5 mm of a riser or an edge counts as beside it.
    """
    states = foot_states(contacts, adapted.first_frame + adapted.frame_count)[:, adapted.first_frame :]
    return np.where(states == 0, -_sole_heights(adapted, ground).min(axis=2), np.nan)


def body_heights(adapted: AdaptedMotion, ground: Ground) -> FloatArray:
    """Heights (F,) in metres above the ground of the lowest point of the body (``point_heights``)."""
    heights = np.empty(adapted.frame_count)

    def measure(run: slice) -> None:
        part = adapted.frames(adapted.first_frame + run.start, adapted.first_frame + run.stop - 1)
        heights[run] = point_heights(part, ground).min(axis=1)

    do_over_frames(measure, adapted.frame_count)
    return heights


def point_heights(adapted: AdaptedMotion, ground: Ground) -> FloatArray:
    """Heights (F, N) in metres of the joints of the body, then of its soles, above the ground along its normal.

    They are negative below the ground, with or without contacts. A point within 5 mm of a riser or an edge counts as
    beside it.
    """
    soles = np.concatenate(_sole_points(adapted), axis=1)
    points = np.concatenate([adapted.positions[:], soles], axis=1)
    return np.asarray((points[..., 2] - rounded_ground_height(ground, points)) * ground.normal_at(points)[..., 2])


def skate_distances(adapted: AdaptedMotion, ground: Ground) -> FloatArray:
    """Distances (2, F) in metres that each foot has moved along the ground since it came near it; 0 in the air.

    Contacts do not matter. The lowest point of the sole is measured, so that a foot may roll.
    """
    count, first = adapted.frame_count, adapted.first_frame
    heights, steps = np.empty((2, count)), np.zeros((2, count))

    def measure(run: slice) -> None:
        part = adapted.frames(first + run.start, first + run.stop)  # one frame more, to which the last step leads
        points, above = _sole_points(part), _sole_heights(part, ground)
        heights[:, run] = above[:, : run.stop - run.start].min(axis=2)
        lowest = above.argmin(axis=2)[:, :-1, None]
        moved = np.linalg.norm(np.diff(points[..., :2], axis=1), axis=3)
        steps[:, run.start + 1 : run.stop + 1] = np.take_along_axis(moved, lowest, axis=2)[..., 0]

    do_over_frames(measure, count)
    slow = steps * adapted.frame_rate < SKATING_SPEED * adapted.morphology.leg_length
    near = (heights < SKATE_HEIGHT_METRES) & slow
    distances = np.zeros(near.shape)
    for foot, step, row in zip(near, steps, distances, strict=True):
        for first, stop in runs_of(foot):
            row[first + 1 : stop] = np.cumsum(step[first + 1 : stop])
    return distances


def _sole_points(adapted: AdaptedMotion) -> FloatArray:
    """Low points (2, F, P, 3) of both soles, heel to tip."""
    body, points = adapted.body, []
    frames = np.arange(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    for side in range(2):
        foot, ankle = body.layout.foot_segment(side), adapted.positions[:, body.layout.ankle_point(side)]
        turns, measures = adapted.rotations[:, foot : foot + 2], at_frames(sole_rows(body, side), frames)
        points.append(Sole.of(ankle, turns[:, 0], turns[:, 1], measures).points)
    return np.array(points)


def _sole_heights(adapted: AdaptedMotion, ground: Ground) -> FloatArray:
    """Heights (2, F, P) in metres of ``_sole_points`` above the ground."""
    points = _sole_points(adapted)
    return np.asarray(points[..., 2] - rounded_ground_height(ground, points))


def foot_heights(adapted: AdaptedMotion, ground: Ground) -> FloatArray:
    """Heights (2, F) in metres of the lowest point of each sole above the ground, negative below it."""
    return np.asarray(_sole_heights(adapted, ground).min(axis=2))


def knee_speeds(adapted: AdaptedMotion) -> FloatArray:
    """Angular speeds (2, F) in rad/s of the left and right knee; a popping knee has a peak."""
    if adapted.frame_count < 2:
        return np.zeros((2, adapted.frame_count))
    return np.array([np.abs(np.gradient(flexion)) for flexion in knee_flexions(adapted)]) * adapted.frame_rate


def knee_flexions(adapted: AdaptedMotion) -> FloatArray:
    """Angles (2, F) in radians by which the left and right knee are bent; 0 for a straight leg."""
    return _flexions(adapted, [adapted.morphology.layout.hip_point(side) for side in range(2)])


def elbow_flexions(adapted: AdaptedMotion) -> FloatArray:
    """Angles (2, F) in radians by which the left and right elbow are bent; 0 for a straight arm."""
    return _flexions(adapted, [adapted.morphology.layout.collar_point(side) + 1 for side in range(2)])


def _flexions(adapted: AdaptedMotion, roots: Sequence[int]) -> FloatArray:
    """Angles (R, F) in radians between the two long bones of limbs, whose three joints begin at ``roots``."""
    flexions = []
    for root in roots:
        upper, lower = (adapted.positions[:, root + step + 1] - adapted.positions[:, root + step] for step in range(2))
        across = np.linalg.norm(np.cross(upper, lower), axis=1)
        flexions.append(np.arctan2(across, np.sum(upper * lower, axis=1)))
    return np.array(flexions)


def angular_acceleration(rotations: FloatArray, frame_rate: float) -> FloatArray:
    """Magnitude (F - 2, ...) in rad/s^2 of the angular acceleration of rotations (F, ..., 3, 3)."""
    turns = np.swapaxes(rotations[:-1], -1, -2) @ rotations[1:]
    velocity = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec().reshape(turns.shape[:-1])
    return np.asarray(np.linalg.norm(np.diff(velocity, axis=0), axis=-1) * frame_rate**2)


@dataclass(frozen=True, eq=False)
class MotionPeaks:
    """Greatest speeds and accelerations of a motion, which a report compares with those of its source."""

    frame_count: int
    turning: FloatArray
    """Angular speed in rad/s and angular acceleration in rad/s^2 (P, 2) of each ``BodyPart``."""
    knees: FloatArray
    """Angular speeds (2,) of the knees in rad/s."""

    @staticmethod
    def of(motion: AdaptedMotion) -> "MotionPeaks":
        """Peaks of all frames."""
        return MotionPeaks(motion.frame_count, turning_peaks(motion), knee_speeds(motion).max(axis=1))

    @staticmethod
    def of_source(source: AdaptedMotion, adapted: AdaptedMotion) -> "MotionPeaks":
        """Peaks of ``source`` in the frames of ``adapted``."""
        first = adapted.first_frame
        return MotionPeaks.of(source.frames(first, first + adapted.frame_count - 1))

    def acceleration_ratio(self, source: "MotionPeaks") -> float:
        """Greatest ratio of a limb segment's peak angular acceleration to that of the same segment in the source.

        About 1 is as smooth as the capture; a popping knee or elbow shows as 5 and more. 1 for fewer than three frames.
        """
        if self.frame_count < 3:
            return 1.0
        ours, theirs = (each.turning[LIMB_BONES, 1] for each in (self, source))
        return float((ours / np.maximum(theirs, QUIET_PEAK)).max())

    def speed_ratio(self, source: "MotionPeaks") -> float:
        """Greatest ratio of any segment's peak angular speed to that of the same segment in the source.

        It is 1 for a single frame.
        """
        if self.frame_count < 2:
            return 1.0
        ours, theirs = (np.maximum(each.turning[:, 0], LEAST_TURNING_SPEED) for each in (self, source))
        return float((ours / theirs).max())

    def knee_speed_ratio(self, source: "MotionPeaks") -> float:
        """Greater ratio, of both knees, of the peak speed to that of the same knee in the source; high for a popping
        knee.
        """
        return float(
            (np.maximum(self.knees, LEAST_TURNING_SPEED) / np.maximum(source.knees, LEAST_TURNING_SPEED)).max()
        )


def acceleration_ratio(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Ratio ``MotionPeaks.acceleration_ratio`` of a motion to the same frames of its source."""
    return MotionPeaks.of(adapted).acceleration_ratio(MotionPeaks.of_source(source, adapted))


def turning_peaks(motion: AdaptedMotion) -> FloatArray:
    """Peaks (P, 2) of angular speed (rad/s) and acceleration (rad/s^2) of each ``BodyPart``."""
    layout = motion.morphology.layout
    parents, peaks = np.full(layout.segment_count, -1), np.empty((layout.segment_count, 2))
    greatest = np.zeros_like(peaks)
    for first in range(0, max(motion.frame_count - 2, 1), PEAK_CHUNK_FRAMES):  # all rotations of a long take are large
        run = np.ascontiguousarray(motion.rotations[first : first + PEAK_CHUNK_FRAMES + 2])
        segment_peaks(parents, run, motion.frame_rate, peaks)
        greatest = np.maximum(greatest, peaks)
    return greatest[[layout.segment_of_part(part) for part in BodyPart]]
