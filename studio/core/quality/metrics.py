"""How good an adapted motion is, in millimetres and in ratios to its source."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import at_frames, sole_rows
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.grounds.ground import Ground
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.carrying import clearance, track_of
from studio.core.solver.standing.footing import foot_states
from studio.core.solver.standing.footprints import planes_under, soles_of
from studio.core.solver.standing.support import mass_path
from studio.core.solver.standing.swing import Sole, worn_height

FloatArray = NDArray[np.float64]

QUIET = 20.0
"""Radians a second squared: a source peak below it counts as this, or a still source would divide by nothing."""


ROLLING = 0.1
"""Parts of its ball's way that the tip of a standing toe goes at most where the foot rolls over it."""
STEEP = 0.5
"""Cosine of the angle from level beyond which a foot stands on its toes alone, wherever its heel would be."""


@dataclass(frozen=True)
class ContactQuality:
    """Worst values over all contacts of a motion, in metres."""

    slide: float
    """Greatest distance along the ground of a standing joint from where its contact began."""
    rise: float
    """Greatest height of a standing heel, ball, hand, knee or seat above the ground, along its normal."""
    penetration: float
    """Greatest depth of any below it."""


def contact_quality(adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground) -> ContactQuality:
    """Slide, float and penetration of what stands during ``contacts`` (frames counted in the whole motion)."""
    return worst_of(*contact_tracks(adapted, contacts, ground))


def worst_of(slides: FloatArray, heights: FloatArray) -> ContactQuality:
    """The worst of ``contact_tracks``."""
    if not np.isfinite(slides).any():
        return ContactQuality(0.0, 0.0, 0.0)
    rise, depth = float(np.nanmax(heights)), float(np.nanmax(-heights))
    return ContactQuality(float(np.nanmax(slides)), max(rise, 0.0), max(depth, 0.0))


def contact_tracks(
    adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """Slides and heights above the ground (9, F) in metres, NaN where a point does not stand.

    A row each of ``ContactPoint``; a slide is how far a heel, or what of a toe stands, has moved since its contact
    began.
    """
    slides, heights = np.full((2, len(ContactPoint), adapted.frame_count), np.nan)
    for contact in contacts:
        if not isinstance(contact.point, ContactPoint):
            continue
        first = max(contact.first - adapted.first_frame, 0)
        stop = min(contact.last + 1 - adapted.first_frame, adapted.frame_count)
        if stop > first:
            row, span = tuple(ContactPoint).index(contact.point), slice(first, stop)
            slides[row, span], heights[row, span] = _standing(adapted, contact.point, span, ground)
    return slides, heights


def centre_of_mass(adapted: AdaptedMotion) -> FloatArray:
    """(F, 3) metres, in the motion's space: where the body's centre of mass is (de Leva 1996; METHOD 7)."""
    return mass_path(adapted.positions[:], adapted.morphology)


def _standing(
    adapted: AdaptedMotion, point: ContactPoint, span: slice, ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """How far (F,) what stands has moved along the ground in one contact, and its heights (F,) above it."""
    if point.is_foot:
        return _standing_foot(adapted, point, span, ground)
    body = adapted.body
    joint = track_of(point, body, adapted.positions[span])
    under = joint[len(joint) // 2, :2]
    normal = ground.normal_at(under)
    heights = (joint - [*under, ground.height_at(under)]) @ normal - clearance(body, point)
    return _slide(joint, normal), heights


def _slide(joint: FloatArray, normal: FloatArray) -> FloatArray:
    """(F,) distances of a track (F, 3) from its begin, along the plane of ``normal``."""
    way = joint - joint[0]
    return np.asarray(np.linalg.norm(way - (way @ normal)[:, None] * normal, axis=1))


def _stood_on(ball: FloatArray, tip: FloatArray, normal: FloatArray) -> FloatArray:
    """(F, 3) how a toe goes along the plane of ``normal``: as its ball, or as the tip over which it rolls."""
    steps = np.diff([ball, tip], axis=1)
    steps -= (steps @ normal)[..., None] * normal
    sizes = np.linalg.norm(steps, axis=2)
    rolls = sizes[1] < ROLLING * sizes[0]
    return np.concatenate([ball[:1], ball[0] + np.cumsum(np.where(rolls[:, None], steps[1], steps[0]), axis=0)])


def _standing_foot(
    adapted: AdaptedMotion, point: ContactPoint, span: slice, ground: Ground
) -> tuple[FloatArray, FloatArray]:
    """The same of a heel, or the lower one of ball and tip of the toes.

    Where the foot lies over an edge the ground is the plane of what it stands on.
    """
    layout, side = adapted.morphology.layout, point.side
    frames = adapted.first_frame + np.arange(span.start, span.stop)
    measures = at_frames(sole_rows(adapted.body, side), frames)
    foot = adapted.rotations[span, layout.spine_count + 12 + 4 * side]
    ankle, toe = adapted.positions[span, layout.ankle(side)], adapted.positions[span, layout.toe(side)]
    middle = np.array([len(foot) // 2])
    soles = soles_of(ankle[middle], foot[middle], at_frames(measures, middle))
    planes = planes_under(ground, soles)
    steep = not point.is_heel and foot[middle[0], 2, 2] < STEEP
    normal = ground.normal_at(toe[middle[0]]) if steep else planes.normals[0]
    if point.is_heel:
        below = np.column_stack([-measures[:, 4], 0.0 * measures[:, 4], -measures[:, 3]])
        sole = ankle + np.einsum("fij,fj->fi", foot, np.broadcast_to(below, ankle.shape))
    else:
        sole = toe - (measures[:, 3] + measures[:, 2])[:, None] * normal
    if planes.overhangs.any():
        heights = (sole - [*soles[0, 1], planes.heights[0]]) @ normal
    else:
        heights = (sole[:, 2] - ground.height_at(sole)) * normal[2]
    if point.is_heel:
        return _slide(sole, normal), heights
    turns = adapted.rotations[span, layout.spine_count + 12 + 4 * side :][:, :2]
    tip = Sole.of(ankle, turns[:, 0], turns[:, 1], measures).points[:, -1]
    tips = (tip[:, 2] - worn_height(ground, tip)) * normal[2]
    return _slide(_stood_on(toe, tip, normal), normal), np.minimum(heights, tips)


def swing_depths(adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground) -> FloatArray:
    """(2, F) metres by which a foot in the air is below the ground with some part of its sole; negative above it.

    NaN where heel or toe stand. Within 5 mm of a riser or an edge counts as beside it.
    """
    body, count = adapted.body, adapted.first_frame + adapted.frame_count
    frames, depths = np.arange(adapted.first_frame, count), np.empty((2, adapted.frame_count))
    states = foot_states(contacts, count)[:, adapted.first_frame :]
    for side in range(2):
        foot, ankle = body.layout.spine_count + 12 + 4 * side, adapted.positions[:, body.layout.ankle(side)]
        turns, measures = adapted.rotations[:, foot : foot + 2], at_frames(sole_rows(body, side), frames)
        points = Sole.of(ankle, turns[:, 0], turns[:, 1], measures).points
        depths[side] = (worn_height(ground, points) - points[..., 2]).max(axis=1)
    return np.where(states == 0, depths, np.nan)


def knee_speeds(adapted: AdaptedMotion) -> FloatArray:
    """(2, F) rad/s: how fast the left and right knee bend or stretch; a popping knee is a narrow peak."""
    layout = adapted.morphology.layout
    if adapted.frame_count < 2:
        return np.zeros((2, adapted.frame_count))
    speeds = []
    for side in range(2):
        hip, knee, ankle = (adapted.positions[:, layout.hip(side) + step] for step in range(3))
        thigh, shank = knee - hip, ankle - knee
        bend = np.arctan2(np.linalg.norm(np.cross(thigh, shank), axis=1), np.sum(thigh * shank, axis=1))
        speeds.append(np.abs(np.gradient(bend)) * adapted.frame_rate)
    return np.array(speeds)


def angular_acceleration(rotations: FloatArray, frame_rate: float) -> FloatArray:
    """Magnitude (F - 2, ...) in rad/s^2 of the angular acceleration of rotations (F, ..., 3, 3)."""
    turns = np.swapaxes(rotations[:-1], -1, -2) @ rotations[1:]
    velocity = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec().reshape(turns.shape[:-1])
    return np.asarray(np.linalg.norm(np.diff(velocity, axis=0), axis=-1) * frame_rate**2)


def acceleration_ratio(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Worst peak angular acceleration of an upper or lower arm or leg, beside the same segment's peak in the source.

    About 1 is as smooth as the capture; a popping knee or elbow shows as 5 and more. 1 for fewer than three frames.
    """
    if adapted.frame_count < 3:
        return 1.0
    ours, first = limb_accelerations(adapted), adapted.first_frame
    theirs = source_accelerations(source)[first : first + len(ours)]
    return float((ours.max(axis=0) / np.maximum(theirs.max(axis=0), QUIET)).max())


def limb_accelerations(motion: AdaptedMotion) -> FloatArray:
    """(F - 2, 8) rad/s^2: how sharply upper and lower arms and legs turn in the world."""
    segments = [motion.morphology.layout.spine_count + bone for bone in (3, 4, 7, 8, 10, 11, 14, 15)]
    return angular_acceleration(motion.rotations[:, segments], motion.frame_rate)


@lru_cache(maxsize=4)
def source_accelerations(source: AdaptedMotion) -> FloatArray:
    """``limb_accelerations`` of a source: the same for all characters."""
    return limb_accelerations(source)
