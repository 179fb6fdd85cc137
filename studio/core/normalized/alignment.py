"""Constant rotations between the joint axes of a capture and the canonical segment axes, one for each segment.

Those of pelvis, trunk, head and feet come from the reference pose. Those of the limbs come from the bones and from the
axis about which elbow and knee bend in the motion, because reference poses often bend the wrong way. In a human zero
pose that is a T-pose the palms face down, whatever the axis of the elbow; a forearm that is twisted there is not
straight.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.normalized.landmarks import Landmarks, measured_frames
from studio.core.rotations import frame_along, normalized, shortest_arc

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

PRIOR_BEND_SINE = np.sin(np.deg2rad(15.0))
"""Sine of the bend with which the anatomical hinge axis counts in every frame."""
ALIGNED_UP = np.array([0.0, 0.0, 1.0])
LEAST_STANDING_FRAMES = 5
"""Least number of frames of ground contact from which the sole of a foot is levelled."""
SOLE_SLOPE_TOLERANCE = np.deg2rad(3.0)
"""Angle in radians by which the bone of a standing foot may be steeper or flatter than that of a flat foot."""
LEAST_STANDING_RATIO = 0.25
"""Least fraction of the standing frames of one foot in which the other one must stand to show the slope of
flat feet.
"""


def find_alignments(marks: Landmarks) -> FloatArray:
    """Rotations A (S, 3, 3) of all segments, such that R_canonical = R_joint A (METHOD 2)."""
    layout, reference = marks.layout, marks.reference
    desired = np.empty((layout.segment_count, 3, 3))
    body = anatomical_frame(reference[layout.hip_point(0)] - reference[layout.hip_point(1)])
    proximal, distal = layout.proximal_points(), layout.distal_points()
    bones = normalized(reference[list(distal)] - reference[list(proximal)])
    left, right = (layout.clavicle_segment(side) for side in (0, 1))
    for segment, usual in ((layout.neck_base, ALIGNED_UP), (left, body[:, 1]), (right, -body[:, 1])):
        if not bones[segment].any():  # a neck or clavicle without length
            bones[segment] = usual
    desired[: layout.spine_count] = body if marks.reference_is_rest else trunk_lean(marks) @ body
    desired[layout.neck_base] = frame_along(bones[layout.neck_base], body[:, 0])
    desired[layout.head_joint] = body
    for limb in range(4):
        side, is_leg = limb % 2, limb >= 2
        upper = layout.thigh_segment(side) if is_leg else layout.upper_arm_segment(side)
        usual = body[:, 1] if is_leg else normalized(np.cross(bones[upper], body[:, 0]))
        hinge = limb_hinge(marks, upper, usual)
        bend = shortest_arc(bones[upper], bones[upper + 1])
        desired[upper] = frame_along(bones[upper], hinge)
        desired[upper + 1] = frame_along(bones[upper + 1], bend @ hinge)
        if is_leg:
            desired[upper + 2] = foot_frame(bones[upper + 2], body)
            desired[upper + 3] = desired[upper + 2]
        else:
            desired[upper - 1] = frame_along(bones[upper - 1], body[:, 0])
            palm = usual if marks.reference_is_rest else hinge
            desired[upper + 2] = frame_along(bones[upper + 1], bend @ palm)
    return np.asarray(np.einsum("sji,sjk->sik", marks.reference_rotations, desired))


def trunk_lean(marks: Landmarks) -> FloatArray:
    """Rotation (3, 3) from the vertical to the line from hips to neck in the reference pose.

    A reference pose taken from the motion is seldom upright: that of a fighter on guard leans. Raises StudioError
    if the neck is between the hips.
    """
    layout, reference = marks.layout, marks.reference
    line = reference[layout.neck_base] - 0.5 * (reference[layout.hip_point(0)] + reference[layout.hip_point(1)])
    if not line.any():
        raise StudioError("The neck is between the hips. Choose another joint in the inspector, under Body map.")
    return shortest_arc(ALIGNED_UP, normalized(line))


def anatomical_frame(leftward: FloatArray) -> FloatArray:
    """Axes (3, 3) as columns, x forward, y left, z up, of an upright body whose left is ``leftward`` (3,).

    Raises StudioError if the body lies on its side.
    """
    y = normalized(leftward - leftward @ ALIGNED_UP * ALIGNED_UP)
    if not y.any():
        raise StudioError(
            "In the reference pose one hip is straight above the other, so the body has no front. Choose "
            "another reference pose, up axis or body map in the inspector."
        )
    return np.stack([np.cross(y, ALIGNED_UP), y, ALIGNED_UP], axis=1)


def foot_frame(bone: FloatArray, body: FloatArray) -> FloatArray:
    """Axes (3, 3) of a foot with a level sole: z up, x horizontally along the foot (forward if the foot
    points down).
    """
    along = bone - bone @ ALIGNED_UP * ALIGNED_UP
    x = body[:, 0] if np.linalg.norm(along) < 0.2 else normalized(along)
    return np.stack([x, np.cross(ALIGNED_UP, x), ALIGNED_UP], axis=1)


def limb_hinge(marks: Landmarks, upper: int, anatomical: FloatArray) -> FloatArray:
    """Axis (3,) about which a limb bends, in the world axes of the reference pose.

    It is the normalised sum over the frames of the cross product of upper and lower bone, in the upper segment's axes,
    weighted by its square, because a limb that hardly bends shows no hinge. Samples keep their natural sign. The
    ``anatomical`` hinge (3,) counts in every frame as if the limb were bent by 15 degrees.
    """
    root = marks.layout.proximal_points()[upper]
    seen = measured_frames(len(marks.points))
    points = marks.points[seen, root : root + 3]
    u, f = normalized(points[:, 1] - points[:, 0]), normalized(points[:, 2] - points[:, 1])
    bend = np.einsum("fji,fj->fi", marks.rotations[seen, upper], np.cross(u, f))
    total = ((bend**2).sum(axis=1)[:, None] * bend).mean(axis=0)
    return normalized(marks.reference_rotations[upper] @ total + PRIOR_BEND_SINE**3 * anatomical)


def align_soles(marks: Landmarks, alignments: FloatArray, standing: BoolArray, frame_rate: float) -> None:
    """Rotate the alignments of feet and toes in place so that soles are level while they stand.

    The reference pose of many files stands on tiptoe or heel. ``standing`` (F, 2) masks the frames in which the left
    and right foot rest flat. At least 5 frames and a tilt below 45 degrees are needed. Medians are taken, because feet
    also stand on their edges; sideways the reference pose counts as a second of standing. If the reference pose is that
    of all frames, feet rotate about their hinge alone. A guard's rear heel, which is raised all the time, is recognised
    by a bone that is steeper than that of the other foot.
    """
    layout = marks.layout
    feet = [layout.foot_segment(side) for side in (0, 1)]
    proximal, distal = layout.proximal_points(), layout.distal_points()
    bones = np.stack([marks.reference[distal[foot]] - marks.reference[proximal[foot]] for foot in feet])
    slopes = np.arctan2(-bones[:, 2], np.linalg.norm(bones[:, :2], axis=1))
    tilts = [
        [_tilts(marks.rotations[standing[:, side], joint, 2] @ alignments[joint]) for joint in (foot, foot + 1)]
        for side, foot in enumerate(feet)
    ]
    standing_slopes = [slope - foot[:, 0] for slope, (foot, _) in zip(slopes, tilts, strict=True)]
    usual = _flat_slope(standing_slopes, None if marks.reference_is_rest else float(slopes.mean()))
    for side, foot in enumerate(feet):
        if len(standing_slopes[side]) < LEAST_STANDING_FRAMES:
            continue
        seconds = len(standing_slopes[side]) / frame_rate
        rolling = seconds / (seconds + 1.0) if marks.reference_is_rest else 0.0
        (_, roll), (toe_pitch, toe_roll) = (np.median(tilt, axis=0) for tilt in tilts[side])
        slope = float(np.median(standing_slopes[side]))
        pitch = slopes[side] - np.clip(slope, usual - SOLE_SLOPE_TOLERANCE, usual + SOLE_SLOPE_TOLERANCE)
        _level(alignments, foot, pitch, rolling * roll)
        _level(alignments, foot + 1, toe_pitch, rolling * toe_roll)


def _tilts(ups: FloatArray) -> FloatArray:
    """Angles (F, 2) in radians, forward and leftward, by which ``ups`` (F, 3) are tilted from Z."""
    return np.arctan2(ups[:, :2], ups[:, 2:])


def _flat_slope(standing: Sequence[FloatArray], neutral: float | None) -> float:
    """Downward slope in radians of the bone of a flat foot.

    ``standing`` has the slopes of each foot in its standing frames. The result is that of the foot with most frames or,
    if a ``neutral`` slope is given, of the foot nearest to it.
    """
    slopes = np.concatenate(standing)
    if neutral is None:
        return float(np.median(slopes)) if len(slopes) else 0.0
    least = max(LEAST_STANDING_FRAMES, LEAST_STANDING_RATIO * max(len(each) for each in standing))
    flat = [float(np.median(each)) for each in standing if len(each) >= least]
    return min(flat, key=lambda slope: abs(slope - neutral), default=neutral)


def _level(alignments: FloatArray, segment: int, pitch: float, roll: float) -> None:
    """Rotate one alignment in place by ``pitch`` and ``roll`` in radians, unless the tilt exceeds 45 degrees."""
    up = normalized(np.array([np.tan(pitch), np.tan(roll), 1.0]))
    if up[2] > np.cos(np.deg2rad(45.0)):
        alignments[segment] = alignments[segment] @ shortest_arc(ALIGNED_UP, up)
