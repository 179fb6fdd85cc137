"""Defects that an animator would still clean by hand: an adapted motion compared with its source, joint by joint.

Lengths are compared as if both bodies had legs of 85 cm; angles and ratios need no scale.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval
from studio.core.grounds.ground import Ground
from studio.core.kernels.support.sole import SOLE_STANDS
from studio.core.mesh.volume import usual_volume
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.grounding.footing import foot_states
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.clearance import arm_distances, rest_clearances

FloatArray = NDArray[np.float64]

COMMON_LEG_METRES = 0.85
"""Leg length in metres to which bodies are scaled before lengths are compared."""
STANCE_MARGIN_SECONDS = 0.033
"""Seconds at either end of a stance that are ignored."""
NEAR_WRISTS_METRES = 0.25
"""Distance in metres of wrists that belong together."""
BOB_WINDOW_SECONDS = 1.5
"""Window in seconds whose mean is subtracted from the height of the hips before its ups and downs are compared."""
LEAST_STEP_METRES, LEAST_BOB_METRES = 0.01, 0.001
"""Least values in metres of the source in ratios: of a joint's greatest step, and of the bob of the hips."""


PART_SEGMENTS = {
    "spine": (0, 1), "head": (2, 3), "clavicles": (4, 8), "arms": (5, 6, 9, 10), "hands": (7, 11),
    "legs": (12, 13, 16, 17), "feet": (14, 18), "toes": (15, 19),
}  # fmt: skip
"""Indices, in the segments that ``_segments`` compares, by part of the body."""
_HEAD, _HANDS = 3, PART_SEGMENTS["hands"]
"""Segments whose x axes are directions: that of the face, and the normals of the palms."""
SWING_KNEE_PERCENTILE = 98.0
"""Percentile of the straightness of swinging knees that is reported."""


@dataclass(frozen=True)
class MotionQuality:
    """Quality measures of one adapted motion; NaN where a measure does not apply."""

    below: float
    """Greatest depth of a joint below the ground, beyond that of the source."""
    drop: float
    """Mean lowering of the hips above standing ankles, relative to the source."""
    knee_mean: float
    """Additional bend of stance knees: the mean, and ``knee_most`` the greatest."""
    knee_most: float
    swing_knee: float
    """Straightness of knees beyond that of the source, in the straightest fiftieth of the frames of a foot
    in the air.
    """
    toes: float
    """Greatest bend of toes beyond that of the source while their foot is in the air."""
    bob: float
    """Vertical oscillation of the hips relative to that of the source."""
    posture: float
    """Greatest difference of elevation of trunk, upper arms, forearms, thighs and shanks."""
    face: float
    """Greatest angle between the directions of the faces."""
    palms: float
    """Greatest angle between the normals of the palms."""
    shoulders: float
    """Least distance of the shoulder joints relative to that at rest, minus that of the source."""
    hands: float
    """Mean error of the distance between the wrists while those of the source are near each other."""
    jump: float
    """Greatest ratio of a joint's longest step in one frame to that of the same joint in the source, for bones of equal
    length.
    """
    peaks: Mapping[str, float]
    """Greatest ratio of peak angular accelerations to those of the source, by part (``PART_SEGMENTS``)."""
    inside: float
    """Greatest penetration of an arm into the own body, beyond that of the actor or of the rest pose."""

    @property
    def peak(self) -> float:
        """Greatest ratio of a limb's peak acceleration to that of the same limb in the source."""
        return max(self.peaks.values())


def motion_quality(
    adapted: AdaptedMotion,
    source: AdaptedMotion,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    first_frame: int = 0,
) -> MotionQuality:
    """Quality of a whole adapted motion relative to its ``source`` on the actor's own body."""
    states = foot_states(contacts, adapted.frame_count)
    flat = _steady(states == SOLE_STANDS, adapted.frame_rate)[:, first_frame:]
    swings = states[:, first_frame:] == 0
    adapted, source = _from(first_frame, adapted), _from(first_frame, source)
    knees = [_knee(adapted, side)[flat[side]] - _knee(source, side)[flat[side]] for side in range(2)]
    above = [[_hips(m)[flat[s], 2] - _scaled(m)[flat[s], _ankle(m, s), 2] for m in (source, adapted)] for s in (0, 1)]
    straighter = np.concatenate([(_knee(source, s) - _knee(adapted, s))[swings[s]] for s in range(2)])
    folded = np.concatenate([(_toe_fold(adapted, s) - _toe_fold(source, s))[swings[s]] for s in range(2)])
    bend, drop = np.concatenate(knees), np.concatenate([of_source - own for of_source, own in above])
    stands = len(bend) > 0
    heights = (
        _scaled(adapted)[..., 2]
        - ground.height_at(adapted.positions) * COMMON_LEG_METRES / adapted.morphology.leg_length
    )
    peaks = np.array([_peak(adapted, s) / max(_peak(source, t), QUIET_PEAK) for s, t in _segments(adapted, source)])
    return MotionQuality(
        below=max(0.0, -float(heights.min()) - max(0.0, -float(_scaled(source)[..., 2].min()))),
        drop=float(drop.mean()) if stands else np.nan,
        knee_mean=float(bend.mean()) if stands else np.nan,
        knee_most=float(bend.max()) if stands else np.nan,
        swing_knee=float(np.percentile(straighter, SWING_KNEE_PERCENTILE)) if len(straighter) else np.nan,
        toes=float(folded.max()) if len(folded) else np.nan,
        bob=_bob(adapted) / max(_bob(source), LEAST_BOB_METRES),
        posture=float(np.abs(limb_elevations(adapted) - limb_elevations(source)).max()),
        face=float(_x_axes_apart(adapted, source, _HEAD).max()),
        palms=max(float(_x_axes_apart(adapted, source, hand).max()) for hand in _HANDS),
        shoulders=_least_shoulders(adapted) - _least_shoulders(source),
        hands=_hands(adapted, source),
        jump=_jump(adapted, source),
        peaks={part: float(peaks[list(segments)].max()) for part, segments in PART_SEGMENTS.items()},
        inside=_inside(adapted, source),
    )


def _from(first_frame: int, motion: AdaptedMotion) -> AdaptedMotion:
    return replace(motion, positions=motion.positions[first_frame:], rotations=motion.rotations[first_frame:])


def _steady(standing: NDArray[np.bool_], frame_rate: float) -> NDArray[np.bool_]:
    """Contact mask (2, F) without the first and last moments of each stance."""
    edge = max(1, round(STANCE_MARGIN_SECONDS * frame_rate))
    inner = standing.copy()
    for step in range(1, edge + 1):
        inner[:, step:] &= standing[:, :-step]
        inner[:, :-step] &= standing[:, step:]
    return inner


def _scaled(motion: AdaptedMotion) -> FloatArray:
    return np.asarray(motion.positions[:] * (COMMON_LEG_METRES / motion.morphology.leg_length))


def _ankle(motion: AdaptedMotion, side: int) -> int:
    return motion.morphology.layout.ankle_point(side)


def _hips(motion: AdaptedMotion) -> FloatArray:
    layout = motion.morphology.layout
    return np.asarray(_scaled(motion)[:, [layout.hip_point(0), layout.hip_point(1)]].mean(axis=1))


def _knee(motion: AdaptedMotion, side: int) -> FloatArray:
    """Bend (F,) of a knee in radians, 0 for a straight leg."""
    hip = motion.morphology.layout.hip_point(side)
    thigh, shank = (np.diff(motion.positions[:, hip + k : hip + k + 2], axis=1)[:, 0] for k in (0, 1))
    return vector_angles(thigh, shank)


def vector_angles(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles (F,) in radians between vectors (F, 3)."""
    sine = np.linalg.norm(np.cross(first, second), axis=1)
    return np.asarray(np.arctan2(sine, np.einsum("fk,fk->f", first, second)))


def _toe_fold(motion: AdaptedMotion, side: int) -> FloatArray:
    """Bend (F,) of the toes in radians, 0 in line with the foot."""
    foot = motion.morphology.layout.foot_segment(side)
    return vector_angles(motion.rotations[:, foot, :, 0], motion.rotations[:, foot + 1, :, 0])


def _x_axes_apart(adapted: AdaptedMotion, source: AdaptedMotion, number: int) -> FloatArray:
    """Angles (F,) in radians between the x axes of both motions, for the segments at index ``number`` of
    ``_segments``.
    """
    own, theirs = _segments(adapted, source)[number]
    return vector_angles(adapted.rotations[:, own, :, 0], source.rotations[:, theirs, :, 0])


def _bob(motion: AdaptedMotion) -> float:
    height = _hips(motion)[:, 2]
    return float(
        np.std(height - uniform_filter1d(height, max(3, round(BOB_WINDOW_SECONDS * motion.frame_rate)), mode="mirror"))
    )


def limb_elevations(motion: AdaptedMotion) -> FloatArray:
    """Elevations (F, 9) in radians of the trunk and of both bones of left arm, right arm, left leg and right leg."""
    layout = motion.morphology.layout
    roots = [layout.collar_point(0) + 1, layout.collar_point(1) + 1, layout.hip_point(0), layout.hip_point(1)]
    bones = [(0, layout.neck_base), *((root + k, root + k + 1) for root in roots for k in (0, 1))]
    ways = [motion.positions[:, b] - motion.positions[:, a] for a, b in bones]
    return np.stack([np.arctan2(way[:, 2], np.linalg.norm(way[:, :2], axis=1)) for way in ways], axis=1)


def _least_shoulders(motion: AdaptedMotion) -> float:
    body, layout = motion.morphology, motion.morphology.layout
    left, right = (motion.positions[:, layout.collar_point(side) + 1] for side in (0, 1))
    rest = body.collar_base + body.clavicle[:, None] * body.clavicle_rest
    return float(np.linalg.norm(left - right, axis=1).min() / np.linalg.norm(rest[0] - rest[1]))


def _hands(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Mean error of the distance between the hands; any distance from the source's own to that scaled by the arms is
    right.
    """
    own, theirs = (
        np.linalg.norm(
            m.positions[:, m.morphology.layout.wrist_point(0)] - m.positions[:, m.morphology.layout.wrist_point(1)],
            axis=1,
        )
        for m in (adapted, source)
    )
    near = theirs * COMMON_LEG_METRES / source.morphology.leg_length < NEAR_WRISTS_METRES
    if not near.any():
        return np.nan
    scaled = theirs[near] * adapted.morphology.arm.sum() / source.morphology.arm.sum()
    least, most = np.minimum(scaled, theirs[near]), np.maximum(scaled, theirs[near])
    return float((np.maximum(least - own[near], 0.0) + np.maximum(own[near] - most, 0.0)).mean())


def _jump(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Greatest ratio of the step of a joint to its step in the source.

    Joints are measured from the middle of the hips along the chain of bones, scaled to the source's.
    """
    reaches = _reaches(source.morphology) * (COMMON_LEG_METRES / source.morphology.leg_length)
    mine, theirs = (_steps(motion, reaches) for motion in (adapted, source))
    return float((mine / np.maximum(theirs, LEAST_STEP_METRES)).max())


def _steps(motion: AdaptedMotion, reaches: FloatArray) -> FloatArray:
    """Greatest steps (21,) in metres in one frame: of the hips vertically, and of the points of the limbs."""
    hips, limbs = _hips(motion)[:, None], motion.positions[:, -20:]
    middle = hips * (motion.morphology.leg_length / COMMON_LEG_METRES)
    up = hips * [0.0, 0.0, 1.0]
    places = np.concatenate([up, up + (limbs - middle) * (reaches / _reaches(motion.morphology))[:, None]], axis=1)
    return np.asarray(np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=0, initial=0.0))


def _reaches(body: Morphology) -> FloatArray:
    """Lengths (20,) in metres along the bones from the middle of the hips to each point of both arms, then of both
    legs.
    """
    middle, (collars, hips) = body.hip_offset.mean(axis=0), (body.collar_base, body.hip_offset)
    trunk = float(np.linalg.norm(middle)) + body.spine_length
    bases = trunk + np.linalg.norm(collars, axis=1), np.linalg.norm(hips - middle, axis=1)
    ends = np.linalg.norm(body.hand, axis=1), np.linalg.norm(body.foot, axis=1), np.linalg.norm(body.toe, axis=1)
    arms = np.column_stack([bases[0], body.clavicle, body.arm, ends[0]])
    legs = np.column_stack([bases[1], body.leg, *ends[1:]])
    return np.concatenate([arms, legs]).cumsum(axis=1).ravel()


def _inside(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Greatest self-penetration of the body beyond that at rest, where sleeves, skirts and thick arms may overlap."""
    body, volume = adapted.morphology, adapted.volume or usual_volume(adapted.morphology)
    allowed = np.minimum(rest_clearances(body, volume), min(0.0, float(arm_distances(source).min())))
    return max(0.0, float((allowed - arm_distances(adapted)).max()))


def _segments(adapted: AdaptedMotion, source: AdaptedMotion) -> list[tuple[int, int]]:
    """Pairs of corresponding segments of both bodies: pelvis, thorax and all segments beyond them."""
    own, theirs = adapted.morphology.layout.spine_count, source.morphology.layout.spine_count
    return [(0, 0), *((own + k, theirs + k) for k in range(-1, 18))]


def _peak(motion: AdaptedMotion, segment: int) -> float:
    if motion.frame_count < 3:
        return QUIET_PEAK
    return float(angular_acceleration(motion.rotations[:, segment], motion.frame_rate).max())
