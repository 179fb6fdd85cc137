"""Adaptation of the legs to the ground: ankle targets, foot rotations, and root lowering (METHOD 5)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, leg_rows, sole_rows
from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, ContactPoint, spans_of
from studio.core.compact_array import PoseArray
from studio.core.grounds.ground import Ground
from studio.core.kernels.channel_columns import LIMB_SLACK
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.limbs.limb import SOFT_IK_THRESHOLD, SOLE_SOFT_IK_THRESHOLD
from studio.core.kernels.limits.root_reach_limit import HALF_FREE_REACH
from studio.core.kernels.records import LegTargets
from studio.core.kernels.support.foot_plan import FootPlan, plan_foot
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.heel_roll import find_roll_pitches, roll_feet
from studio.core.kernels.support.leg_lengths import keep_leg_lengths
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS
from studio.core.kernels.support.swing_foot_clearance import raise_swing_foot
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.grounding.contact_blending import (
    DISPLACEMENT_RETURN_SECONDS,
    RELEASE_SECONDS,
    ROOT_AVERAGE_SECONDS,
    hann_average,
    release_weight,
    smooth_drops,
)
from studio.core.solver.grounding.footprints import find_footprints, project_to_terrain
from studio.core.solver.grounding.pelvis_tilt import tilt_pelvis_to_feet
from studio.core.solver.grounding.swing_foot_path import Sole, clear_swing_foot
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]

FOLDED_LEG, FOLD_MARGIN, FOLD_CORNER = 0.3, 0.12, 0.03
"""Least distance of a folded leg's ankle below its hip, tolerance of that distance, and rounding of its corner, all in
leg lengths. The distance decreases with the horizontal distance from the hip, to zero at a leg's length.
"""
FOLLOW_SMOOTHING_SECONDS = ROOT_AVERAGE_SECONDS / 5.0
"""Standard deviation in seconds of the smoothing of the root's displacement with its feet."""
ROLL_SMOOTHING_SECONDS = 0.012
"""Standard deviation in seconds of the smoothing of a rolling foot's pitch."""
CLIMB_SMOOTHING_SECONDS = 0.09
"""Standard deviation in seconds of the smoothing with which the root follows the heights of footprints."""


@dataclass(frozen=True, eq=False)
class Footing:
    """Leg targets of one body on the ground, in all frames."""

    states: NDArray[np.int64]
    """(2, F) states of both feet: bits ``HEEL_STANDS`` and ``TOE_STANDS``."""
    soft_thresholds: FloatArray
    """(2, F) soft-IK thresholds: the fraction of its length up to which each leg extends freely."""
    runs: FloatArray
    """(2, F) additional extension, in leg lengths, that the root may cause as a foot is released; inf for a free
    foot.
    """
    ankles: FloatArray
    """(2, F, 3 or 7) ankle targets, metres, with knee targets in the last columns (``kernels.limbs.legs``)."""
    feet: PoseArray
    """(2, F, 3, 3) in the world."""
    toes: PoseArray
    """(2, F, 3, 3) in the world."""
    drops: FloatArray
    """(F,) root lowering, metres."""

    @property
    def root_reaches(self) -> FloatArray:
        """Greatest extension (2, F) of each leg that the root may cause, in leg lengths; inf for a free foot.

        A standing foot keeps the root within the leg's soft-IK threshold; near the end of the contact the extension
        grows smoothly.
        """
        return self.soft_thresholds + self.runs

    def legs(self, motion: NormalizedMotion, window: slice = slice(None)) -> LegTargets:
        """``LegTargets`` of the frames of ``window``, as contiguous arrays for the kernels."""
        stance = self.soft_thresholds, self.ankles, self.feet, self.toes
        return LegTargets(motion.channels[window], *(np.ascontiguousarray(each[:, window]) for each in stance))


def foot_states(contacts: Sequence[ContactInterval], frame_count: int) -> NDArray[np.int64]:
    """States (2, F) of both feet in contact intervals: bits ``HEEL_STANDS`` and ``TOE_STANDS``."""
    toes, heels = np.zeros((2, 2, frame_count), dtype=np.int64)
    for contact in contacts:
        point = contact.point
        if isinstance(point, ContactPoint) and point.is_foot:
            bit, bits = (HEEL_STANDS, heels) if point.is_heel else (TOE_STANDS, toes)
            bits[point.side, contact.first : contact.last + 1] = bit
    return np.asarray(toes | heels)


def foot_contacts(states: NDArray[np.int64]) -> tuple[ContactInterval, ...]:
    """Contact intervals of feet with ``states`` (2, F): the inverse of ``foot_states``."""
    return tuple(
        ContactInterval("", point, first, last)
        for point in FOOT_POINTS
        for first, last in spans_of(states[point.side] & (HEEL_STANDS if point.is_heel else TOE_STANDS) != 0)
    )


def find_footing(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    positions: FloatArray,
    rotations: FloatArray,
    carried: FloatArray | None = None,
    upright: tuple[FloatArray, FloatArray] | None = None,
) -> Footing:
    """Plan the feet of a whole clip from its retargeted pose, which has been translated to the ground's own height.

    The body follows its feet and, on uneven ground, the low-passed mean height of the footprints (h1 of METHOD 5):
    ``positions`` are moved in place, and ``drops`` include the heights. With hands, knees or seat in contact, it
    follows by the fraction ``carried`` (F,) of its weight on the feet, and a shortage of reach is left to settling
    (10): lower hips do not help the leg of a plank. Feet are planned from the ``upright`` positions and rotations if
    the body is tilted with the ground.
    """
    states = foot_states(contacts, motion.frame_count)
    pose = (positions, rotations) if upright is None else upright
    count = motion.frame_count
    ankles, feet, toes = np.empty((2, count, 3)), np.empty((2, count, 3, 3)), np.empty((2, count, 3, 3))
    plans = [FootPlan(ankles[side], feet[side], toes[side]) for side in range(2)]
    soft_thresholds = leg_soft_thresholds(motion, states, ground.is_level)
    runs = reach_relaxation(leg_freedoms(states, motion.frame_rate))
    standing = [
        _Foot(side, morphology, ground, motion.frame_rate, states[side], sole_rows(morphology, side))
        for side in range(2)
    ]
    for foot, plan in zip(standing, plans, strict=True):
        foot.plan(*pose, plan)
    if ground.is_level:
        off = ankles - positions[:, [morphology.layout.ankle_point(side) for side in range(2)]].transpose(1, 0, 2)
        dips = np.zeros_like(off)
        if carried is None:  # hands, knees and seat that stand leave the pelvis no room
            dips = tilt_pelvis_to_feet(off, states, morphology, motion.frame_rate, positions, rotations)
        goes = root_follow(off - dips, states, motion.frame_rate, positions, morphology)
        goes *= 1.0 if carried is None else carried[:, None]
        positions += goes[:, None]
        for side, planted in enumerate(states != 0):
            free = release_weight(planted, motion.frame_rate, DISPLACEMENT_RETURN_SECONDS)[:, None]
            ankles[side] += free * (goes + dips[side] - off[side])
        for foot, soft_threshold, plan in zip(standing, soft_thresholds, plans, strict=True):
            foot.roll(soft_threshold, positions, plan)
        drops = np.zeros(count)
        if carried is None and np.count_nonzero(states):
            drops = _drops(motion, morphology, rotations, ankles - positions[:, 0], soft_thresholds, states)
            drops = smooth_drops(drops, motion.frame_rate)
        return Footing(states, soft_thresholds, runs, ankles, feet, toes, drops)
    draped = [foot.project_to_terrain(*pose, plan) for foot, plan in zip(standing, plans, strict=True)]
    return _draped_footing(motion, morphology, positions, rotations, states, draped, carried)


def _draped_footing(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    positions: FloatArray,
    rotations: FloatArray,
    states: NDArray[np.int64],
    draped: "Sequence[_ProjectedFoot]",
    carried: FloatArray | None,
) -> Footing:
    """Footing on uneven ground, from feet that have been projected to it."""
    feet_fraction = np.ones(motion.frame_count) if carried is None else carried
    ankles, feet, toes = _stacked([each.foot for each in draped])
    climb = np.mean([each.heights for each in draped], axis=0)
    climb = feet_fraction * bell_average(climb, CLIMB_SMOOTHING_SECONDS * motion.frame_rate)
    soft_thresholds = leg_soft_thresholds(motion, states, False)  # draping has put down heels that would hang
    runs = reach_relaxation(leg_freedoms(states, motion.frame_rate))
    relative = ankles - positions[:, 0]
    relative[..., 2] -= climb
    on_level = np.array([each.level_ankles for each in draped]) - positions[:, 0]
    drops, all_feet, level = (
        _drops(motion, morphology, rotations, places, soft_thresholds, stands)
        for places, stands in (
            (relative, states),
            (relative, np.full_like(states, SOLE_STANDS)),
            (on_level, np.full_like(states, SOLE_STANDS)),
        )
    )
    # A foot in the air that reaches far down, as on the way down a flight of steps, brings the root down early.
    early = all_feet - np.maximum(level, 0.0)
    drops = np.maximum(drops, early) if carried is None else feet_fraction * early
    drops = smooth_drops(drops, motion.frame_rate) - climb
    _keep_below_hips(ankles, drops, states, motion.frame_rate, morphology, positions)
    return Footing(states, soft_thresholds, runs, ankles, feet, toes, drops)


def _keep_below_hips(
    ankles: FloatArray,
    drops: FloatArray,
    states: NDArray[np.int64],
    frame_rate: float,
    morphology: AnyMorphology,
    positions: FloatArray,
) -> None:
    """Keep ankles (2, F, 3) of swing feet below their hips by at least the length of a folded leg, in place.

    Long strides over steps would raise them higher, and the leg would swing wildly.
    """
    for side in range(2):
        hips = positions[:, morphology.layout.hip_point(side)]
        bones = leg_rows(morphology, side)
        legs = bones.sum(axis=1)
        folded = np.maximum(FOLDED_LEG * legs, np.abs(bones[:, 0] - bones[:, 1]) + 0.5 * FOLDED_LEG * legs)
        own = positions[:, morphology.layout.ankle_point(side), 2] - hips[:, 2]
        aside = np.linalg.norm(ankles[side, :, :2] - hips[:, :2], axis=1) / legs
        least = -folded * (1.0 - np.minimum(aside, 1.0) ** 2) ** 2
        over = own - least
        highest = least + 0.5 * (over + np.hypot(over, FOLD_CORNER * legs))  # the higher one, without a corner
        beyond = ankles[side, :, 2] - (hips[:, 2] - drops) - highest
        softened = FOLD_MARGIN * legs * -np.expm1(-np.maximum(beyond, 0.0) / (FOLD_MARGIN * legs))
        ankles[side, :, 2] -= release_weight(states[side] != 0, frame_rate) * (np.maximum(beyond, 0.0) - softened)


def _drops(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    rotations: FloatArray,
    ankles: FloatArray,
    soft_thresholds: FloatArray,
    states: NDArray[np.int64],
) -> FloatArray:
    """Root lowering (F,) in metres with which standing legs reach their ``ankles`` (2, F, 3), given relative to the
    root.
    """
    drops = np.empty(motion.frame_count)
    required_root_lowering(motion.channels, morphology.rows, rotations, ankles, soft_thresholds, states, drops)
    return drops


@dataclass(frozen=True, eq=False)
class _ProjectedFoot:
    """One foot projected to uneven ground."""

    foot: FootPlan
    level_ankles: FloatArray
    """(F, 3) ankles as planned on the level floor."""
    heights: FloatArray
    """(F,) heights of its footprints, metres."""


def _stacked(plans: Sequence[FootPlan]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Ankles (2, F, 3), feet and toes (2, F, 3, 3) of the plans of both feet."""
    ankles, feet, toes = (np.array(part) for part in zip(*plans, strict=True))
    return ankles, feet, toes


@dataclass(frozen=True, eq=False)
class _Foot:
    """One foot of a body over its ground."""

    side: int
    body: AnyMorphology
    ground: Ground
    frame_rate: float
    states: NDArray[np.int64]
    """(F,) bits ``HEEL_STANDS`` and ``TOE_STANDS``."""
    soles: FloatArray
    """(F or 1, 6) measures of the foot (``kernels.support.sole``)."""

    def plan(self, positions: FloatArray, rotations: FloatArray, plan: FootPlan) -> None:
        """Write the ``plan`` of the foot on the level floor at the ground's own height, before it rolls."""
        ankle, foot = (
            self.body.layout.ankle_point(self.side),
            self.body.layout.foot_segment(self.side),
        )
        plan.ankles[:], plan.feet[:], plan.toes[:] = positions[:, ankle], rotations[:, foot], rotations[:, foot + 1]
        balls, reach = np.ascontiguousarray(positions[:, ankle + 1, 2]), RELEASE_SECONDS * self.frame_rate
        plan_foot(self.states, self.soles, self.ground.height, self.ground.is_level, reach, balls, plan)
        if not self.ground.is_level:
            self._keep_above(plan)

    def roll(self, soft_thresholds: FloatArray, positions: FloatArray, plan: FootPlan) -> None:
        """Roll the foot of a ``plan`` on the level floor, in place, until its leg reaches it, and keep it above the
        floor.
        """
        bones = leg_rows(self.body, self.side)
        # Contiguous, which a single frame is by itself: kernels are compiled for one layout.
        hips = np.ascontiguousarray(positions[:, self.body.layout.hip_point(self.side)])
        reaches = soft_thresholds * bones.sum(axis=1)
        pitches = np.empty((len(hips), 2))
        find_roll_pitches(self.soles, self.states, hips, reaches, plan.ankles, plan.feet, pitches)
        pitches = bell_average(pitches, ROLL_SMOOTHING_SECONDS * self.frame_rate)
        roll_feet(self.soles, self.states, pitches, RELEASE_SECONDS * self.frame_rate, plan.ankles, plan.feet)
        self._keep_above(plan)

    def _keep_above(self, plan: FootPlan) -> None:
        """Keep the swing foot of a ``plan`` above the level floor, in place."""
        raise_swing_foot(self.soles, self.states, self.ground.height, self.frame_rate, *plan)

    def project_to_terrain(self, positions: FloatArray, rotations: FloatArray, plan: FootPlan) -> _ProjectedFoot:
        """Foot of a level ``plan``, projected to uneven ground.

        A foot whose heel would stand over a drop comes down flat; ``states`` are updated.
        """
        states = self.states
        prints = find_footprints(states, plan.ankles, plan.feet, self.soles, self.ground)
        if prints.hanging.any():
            for first, last in zip(prints.first[prints.hanging], prints.last[prints.hanging], strict=True):
                states[first : last + 1][states[first : last + 1] == HEEL_STANDS] = SOLE_STANDS
            self.plan(positions, rotations, plan)
            prints = find_footprints(states, plan.ankles, plan.feet, self.soles, self.ground)
        draped = project_to_terrain(prints, *plan, self.ground, self.frame_rate)
        level, foot = Sole.of(*plan, self.soles), Sole.of(draped.ankles, draped.feet, draped.toes, self.soles)
        led = clear_swing_foot(level, foot, states, self.ground, self.frame_rate)
        return _ProjectedFoot(FootPlan(led.ankles, led.feet, led.toes), plan.ankles, draped.heights)


def root_follow(
    off: FloatArray, states: NDArray[np.int64], frame_rate: float, positions: FloatArray, body: AnyMorphology
) -> FloatArray:
    """Displacement (F, 3) in metres by which a body follows feet that are displaced by ``off`` (2, F, 3).

    It is the mean over the standing feet, averaged over ``ROOT_AVERAGE_SECONDS`` on either side, so that the leg of a
    single support is unchanged. For two flat feet with different displacements the legs keep their lengths.
    ``positions`` (F, P, 3).
    """
    stands = states != 0
    if not stands.any():
        return np.zeros(off.shape[1:])
    off = np.where(stands[..., None], off, 0.0)
    for side in range(2):
        interpolate_gaps(off[side], stands[side])
    frames, carried = np.arange(stands.shape[1]), np.flatnonzero(stands.any(axis=0))
    fraction = np.interp(frames, carried, (stands[0] / np.maximum(stands.sum(axis=0), 1))[carried])
    weights = hann_average(np.column_stack([fraction, *(states == SOLE_STANDS)]), ROOT_AVERAGE_SECONDS, frame_rate)
    displacement = off[1] + weights[:, :1] * (off[0] - off[1])
    keep_leg_lengths(off, weights, (body.layout.hip_point(0), body.layout.hip_point(1)), positions, displacement)
    return bell_average(displacement, FOLLOW_SMOOTHING_SECONDS * frame_rate)


def leg_freedoms(states: NDArray[np.int64], frame_rate: float) -> FloatArray:
    """Release weights (2, F) of both feet from their contacts."""
    return np.array([release_weight(planted, frame_rate) for planted in states != 0])


def leg_soft_thresholds(motion: NormalizedMotion, states: NDArray[np.int64], is_level: bool) -> FloatArray:
    """Soft-IK thresholds (2, F) of the legs of feet with ``states`` (2, F), as fractions of their lengths.

    On a level floor a standing leg's threshold is halfway from the motion's own extension to a straight leg, so that a
    nearly straight knee extends before the hips sink, and a leg in the air extends as far as the motion's own. On other
    ground the hips sink first: a leg that reaches down a step would be straight for the one frame in which it lands.
    """
    own = np.subtract(1.0, motion.channels[:, LIMB_SLACK + 2 : LIMB_SLACK + 4].T, order="C")
    standing = (0.5 * ((1.0 if is_level else SOLE_SOFT_IK_THRESHOLD) + own)).clip(SOLE_SOFT_IK_THRESHOLD, 1.0 - 1e-9)
    swinging = own.clip(SOFT_IK_THRESHOLD, 1.0 - 1e-9) if is_level else SOFT_IK_THRESHOLD
    return np.asarray(standing + leg_freedoms(states, motion.frame_rate) * (swinging - standing))


def reach_relaxation(free: FloatArray) -> FloatArray:
    """Additional extension (F,), in limb lengths, that the root may cause during a smooth release of ``free`` (F,); inf
    if 1.
    """
    return np.asarray(np.divide(HALF_FREE_REACH * free, 1.0 - free, out=np.full(free.shape, np.inf), where=free < 1.0))
