"""Measures of the actor, from the landmarks of a capture."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactPoint, contact_mask
from studio.core.normalized.landmarks import Landmarks, measured_frames

FloatArray = NDArray[np.float64]

SHORTEST_BONE_METRES = 1e-3
"""Length in metres given to a bone that has none in the capture, so that it keeps a direction."""
USUAL_ANKLE_FRACTION = 0.045
"""Usual height of the ankle joint above the sole, as a fraction of the stature's lower half; used if no contact shows
it.
"""
HEEL_LENGTH_FRACTION = 0.3
"""Distance of the heel behind the ankle, as a fraction of the distance from ankle to ball."""


def measure_actor(
    marks: Landmarks,
    alignments: FloatArray,
    rotations: FloatArray,
    contacts: dict[ContactPoint, list[tuple[int, int]]],
    first_frame: int,
    floor: FloatArray | float,
) -> Morphology:
    """Measures of the actor: medians over the motion of all bones, in canonical axes; sole heights where feet stand.

    ``alignments`` (S, 3, 3) and ``rotations`` (F, S, 3, 3) are canonical; ``floor`` (F, 2) is the height of the ground
    under the ankles in metres.
    """
    layout, points = marks.layout, marks.points
    thorax = layout.spine_count - 1
    moving = measured_frames(len(points), first_frame)

    def vector(segment: int, start: int, end: int) -> FloatArray:
        bones = points[moving, end] - points[moving, start]
        return np.asarray(np.median(np.einsum("fji,fj->fi", rotations[moving, segment], bones), axis=0))

    def length(start: int, end: int) -> float:
        bones = np.linalg.norm(points[moving, end] - points[moving, start], axis=1)
        return max(float(np.median(bones)), SHORTEST_BONE_METRES)

    arms, legs = [layout.collar_point(side) for side in (0, 1)], [layout.hip_point(side) for side in (0, 1)]
    feet = np.array([vector(layout.foot_segment(side), legs[side] + 2, legs[side] + 3) for side in (0, 1)])
    leg = np.array([[length(hip, hip + 1), length(hip + 1, hip + 2)] for hip in legs])
    heights = points[:, [layout.ankle_point(0), layout.ankle_point(1)], 2] - floor
    ankle = _ankle_heights(heights, contacts, float(leg.sum() / 2))
    toe_height = np.maximum(ankle + feet[:, 2], 0.0)
    toes = np.array([vector(layout.toe_segment(side), legs[side] + 3, legs[side] + 4) for side in (0, 1)])
    toes[:, 2] = np.maximum(toes[:, 2], -toe_height)  # tips that a file has not are guessed, but not below the ground
    return Morphology(
        spine=np.array([vector(k, k, k + 1) for k in range(layout.spine_count)]),
        neck=length(layout.neck_base, layout.head_joint),
        head=_head_length(marks, points[moving]),
        collar_base=np.array([vector(thorax, layout.neck_base, collar) for collar in arms]),
        clavicle=np.array([length(collar, collar + 1) for collar in arms]),
        arm=np.array([[length(c + 1, c + 2), length(c + 2, c + 3)] for c in arms]),
        hand=np.array([vector(layout.hand_segment(s), arms[s] + 3, arms[s] + 4) for s in (0, 1)]),
        hip_offset=np.array([vector(0, 0, hip) for hip in legs]),
        leg=leg,
        foot=feet,
        toe=toes,
        ankle_height=ankle,
        toe_height=toe_height,
        heel_length=HEEL_LENGTH_FRACTION * np.linalg.norm(feet[:, :2], axis=1),
        neck_rest=_rest_direction(marks, alignments, layout.neck_base),
        clavicle_rest=np.array([_at_ease(rotations[moving], thorax, layout.clavicle_segment(s)) for s in (0, 1)]),
    )


def _rest_direction(marks: Landmarks, alignments: FloatArray, segment: int) -> FloatArray:
    """Unit z axis (3,) of a segment attached to the thorax, in the thorax's axes, in the reference pose."""
    reference = marks.reference_rotations @ alignments
    return np.asarray(reference[marks.layout.spine_count - 1].T @ reference[segment][:, 2])


def _at_ease(rotations: FloatArray, thorax: int, clavicle: int) -> FloatArray:
    """Mean z axis (3,) of a clavicle in the thorax's axes, over ``rotations`` (F, S, 3, 3).

    In a reference pose the arms are raised or hang: taken from it, the shoulders of other bodies would be raised or
    sunk.
    """
    lies = np.einsum("fji,fj->i", rotations[:, thorax], rotations[:, clavicle, :, 2])
    return np.asarray(lies / max(float(np.linalg.norm(lies)), 1e-9))


def _head_length(marks: Landmarks, points: FloatArray) -> float:
    """Length from the head joint to the crown, at least a typical one, because many captures end at the eyes."""
    layout = marks.layout
    bones = points[:, layout.head_end] - points[:, layout.head_joint]
    trunk = np.linalg.norm(marks.reference[layout.neck_base] - marks.reference[0])
    return max(float(np.median(np.linalg.norm(bones, axis=1))), 0.3 * float(trunk), SHORTEST_BONE_METRES)


def _ankle_heights(
    heights: FloatArray, contacts: dict[ContactPoint, list[tuple[int, int]]], leg_length: float
) -> FloatArray:
    """Median of ``heights`` (F, 2) of each ankle while its heel stands.

    If only one heel stands, its median holds for both; if none does, a typical one.
    """
    standing_at: list[float] = []
    for side, heel in enumerate((ContactPoint.LEFT_HEEL, ContactPoint.RIGHT_HEEL)):
        standing = contact_mask(contacts[heel], len(heights))
        standing_at.append(float(np.median(heights[standing, side])) if standing.any() else np.nan)
    usual = 2.0 * USUAL_ANKLE_FRACTION * leg_length
    known = np.clip(np.array(standing_at), 0.25 * usual, 2.5 * usual)
    both = np.nanmean(known) if np.isfinite(known).any() else usual
    return np.asarray(np.where(np.isfinite(known), known, both))
