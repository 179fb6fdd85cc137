"""Ground adaptation: where the ankles stand, how the feet lie, and how far the root comes down (METHOD 4)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, leg_rows, sole_rows
from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, ContactPoint, spans_of
from studio.core.grounds.ground import Ground
from studio.core.kernels.layout import LIMB_SLACK
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.limbs.limb import SOFT_IK_THRESHOLD, SOLE_SOFT_IK_THRESHOLD
from studio.core.kernels.limits.root_reach_limit import HALF_FREE_REACH
from studio.core.kernels.records import LegTargets
from studio.core.kernels.support.foot_plan import FootPlan, plan_foot
from studio.core.kernels.support.gap_interpolation import interpolate_gaps
from studio.core.kernels.support.heel_roll import roll_feet
from studio.core.kernels.support.leg_lengths import keep_leg_lengths
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS
from studio.core.kernels.support.swing_foot_clearance import raise_swing_foot
from studio.core.normalized.motion import NormalizedMotion
from studio.core.single import PoseArray
from studio.core.solver.standing.blends import AVERAGED, GOES_ALONG, LET_GO, averaged, freedom, smooth_drops
from studio.core.solver.standing.footprints import drape, find_footprints
from studio.core.solver.standing.obliquity import dip_pelvis
from studio.core.solver.standing.swing import Sole, led_clear
from studio.core.windows import smoothed

FloatArray = NDArray[np.float64]

FOLDED, FOLD_ROOM, FOLD_CORNER = 0.3, 0.12, 0.03
"""Part of its length by which a folded leg's ankle hangs below the hip, and parts by which it may come nearer; less
the farther it is from below the hip, nothing at a leg's length. The corner where the motion's own leg folds that much
is rounded.
"""
FOLLOWED = AVERAGED / 5.0
"""Seconds, standard deviation, over which the body follows where its feet stand."""
CLIMB_SMOOTHING = 0.09
"""Seconds, standard deviation, over which the root follows the heights of the footprints."""


@dataclass(frozen=True, eq=False)
class Footing:
    """What the ground asks of one body: ``states`` (2, F) bit 1 heel, bit 2 toe; ``comforts`` (2, F) part of its
    length to which each leg stretches freely; ``runs`` (2, F) how much farther the root may stretch it, inf where its
    foot is free; ``ankles`` (2, F, 3 or 7) targets, with those of knees that stand as
    ``kernels.limbs.legs.place_leg`` takes them; ``feet``, ``toes`` (2, F, 3, 3) world
    rotations; ``drops`` (F,) metres by which the root is lowered.
    """

    states: NDArray[np.int64]
    soft_thresholds: FloatArray
    runs: FloatArray
    ankles: FloatArray
    feet: PoseArray
    toes: PoseArray
    drops: FloatArray

    @property
    def root_reaches(self) -> FloatArray:
        """(2, F) part of its length to which the root may stretch each leg; inf where its foot is free.

        A standing foot holds the root within the leg's comfort; on the way there and away its reach grows smoothly.
        """
        return self.soft_thresholds + self.runs

    def legs(self, motion: NormalizedMotion, window: slice = slice(None)) -> LegTargets:
        """How legs stand in a stretch of frames, as kernels want it: contiguous."""
        stance = self.soft_thresholds, self.ankles, self.feet, self.toes
        return LegTargets(motion.channels[window], *(np.ascontiguousarray(each[:, window]) for each in stance))


def foot_states(contacts: Sequence[ContactInterval], frame_count: int) -> NDArray[np.int64]:
    """(2, F) of bits: 1 where the heel stands, 2 where the toe does."""
    toes, heels = np.zeros((2, 2, frame_count), dtype=np.int64)
    for contact in contacts:
        point = contact.point
        if isinstance(point, ContactPoint) and point.is_foot:
            bit, bits = (HEEL_STANDS, heels) if point.is_heel else (TOE_STANDS, toes)
            bits[point.side, contact.first : contact.last + 1] = bit
    return np.asarray(toes | heels)


def foot_contacts(states: NDArray[np.int64]) -> tuple[ContactInterval, ...]:
    """The contacts of feet that stand as ``states`` (2, F) say: ``foot_states`` the other way round."""
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
    """Plan the feet of a whole clip from its retargeted pose, raised to the ground's own height; feet themselves from
    the ``upright`` one, positions and rotations, where the body leans with the ground.

    The body follows its feet, and on ground that is not level the low-passed mean of both feet's footprints (h1 of
    METHOD 4): ``positions`` go along, in place, and ``drops`` take the footprints' heights off. Where hands, knees or
    seat stand now and then, it does by as much of its weight as the feet carry, ``carried`` (F,), and what legs lack is
    left to the least move (10): a leg that lies back as in a plank gains nothing by hips that come down.
    """
    states = foot_states(contacts, motion.frame_count)
    pose = (positions, rotations) if upright is None else upright
    count = motion.frame_count
    ankles, feet, toes = np.empty((2, count, 3)), np.empty((2, count, 3, 3)), np.empty((2, count, 3, 3))
    plans = [FootPlan(ankles[side], feet[side], toes[side]) for side in range(2)]
    soft_thresholds, runs = leg_stretches(motion, states)
    standing = [
        _Foot(side, morphology, ground, motion.frame_rate, states[side], sole_rows(morphology, side))
        for side in range(2)
    ]
    for foot, plan in zip(standing, plans, strict=True):
        foot.plan(*pose, plan)
    if ground.is_level:
        off = ankles - positions[:, [morphology.layout.ankle(side) for side in range(2)]].transpose(1, 0, 2)
        dips = np.zeros_like(off)
        if carried is None:  # hands, knees and seat that stand leave the pelvis no room
            dips = dip_pelvis(off, states, morphology, motion.frame_rate, positions, rotations)
        goes = followed(off - dips, states, motion.frame_rate, positions, morphology)
        goes *= 1.0 if carried is None else carried[:, None]
        positions += goes[:, None]
        for side, planted in enumerate(states != 0):
            free = freedom(planted, motion.frame_rate, GOES_ALONG)[:, None]
            ankles[side] += free * (goes + dips[side] - off[side])
        for foot, soft_threshold, plan in zip(standing, soft_thresholds, plans, strict=True):
            foot.roll(soft_threshold, positions, plan)
        drops = np.zeros(count)
        if carried is None and np.count_nonzero(states):
            drops = _drops(motion, morphology, rotations, ankles - positions[:, 0], soft_thresholds, states)
            drops = smooth_drops(drops, motion.frame_rate)
        return Footing(states, soft_thresholds, runs, ankles, feet, toes, drops)
    draped = [foot.drape(*pose, plan) for foot, plan in zip(standing, plans, strict=True)]
    return _draped_footing(motion, morphology, positions, rotations, states, draped, carried)


def _draped_footing(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    positions: FloatArray,
    rotations: FloatArray,
    states: NDArray[np.int64],
    draped: "Sequence[_DrapedFoot]",
    carried: FloatArray | None,
) -> Footing:
    """``find_footing`` on ground that is not level, of feet that are ``draped`` on it."""
    feet_share = np.ones(motion.frame_count) if carried is None else carried
    ankles, feet, toes = _stacked([each.foot for each in draped])
    climb = np.mean([each.heights for each in draped], axis=0)
    climb = feet_share * smoothed(climb, CLIMB_SMOOTHING * motion.frame_rate)
    soft_thresholds, runs = leg_stretches(motion, states)  # draping has put down heels that would hang
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
    drops = np.maximum(drops, early) if carried is None else feet_share * early
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
    """Ankles (2, F, 3) of feet in the air come no nearer below their hips than a folded leg does, in place.

    Over a flight of steps taken in long strides they would, and the leg would swing round; on the floor they stay.
    """
    for side in range(2):
        hips = positions[:, morphology.layout.hip(side)]
        bones = leg_rows(morphology, side)
        legs = bones.sum(axis=1)
        folded = np.maximum(FOLDED * legs, np.abs(bones[:, 0] - bones[:, 1]) + 0.5 * FOLDED * legs)
        own = positions[:, morphology.layout.ankle(side), 2] - hips[:, 2]
        aside = np.linalg.norm(ankles[side, :, :2] - hips[:, :2], axis=1) / legs
        least = -folded * (1.0 - np.minimum(aside, 1.0) ** 2) ** 2
        over = own - least
        highest = least + 0.5 * (over + np.hypot(over, FOLD_CORNER * legs))  # the higher one, without a corner
        beyond = ankles[side, :, 2] - (hips[:, 2] - drops) - highest
        softened = FOLD_ROOM * legs * -np.expm1(-np.maximum(beyond, 0.0) / (FOLD_ROOM * legs))
        ankles[side, :, 2] -= freedom(states[side] != 0, frame_rate) * (np.maximum(beyond, 0.0) - softened)


def _drops(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    rotations: FloatArray,
    ankles: FloatArray,
    soft_thresholds: FloatArray,
    states: NDArray[np.int64],
) -> FloatArray:
    """(F,) metres by which the root must come down for standing legs to reach; ``ankles`` from the root."""
    drops = np.empty(motion.frame_count)
    required_root_lowering(motion.channels, morphology.rows, rotations, ankles, soft_thresholds, states, drops)
    return drops


@dataclass(frozen=True, eq=False)
class _DrapedFoot:
    """One ``foot`` on the ground, its ankles as planned level (F, 3), and the heights (F,) of its footprints."""

    foot: FootPlan
    level_ankles: FloatArray
    heights: FloatArray


def _stacked(plans: Sequence[FootPlan]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Ankles (2, F, 3), feet and toes (2, F, 3, 3) of both sides."""
    ankles, feet, toes = (np.array(part) for part in zip(*plans, strict=True))
    return ankles, feet, toes


@dataclass(frozen=True, eq=False)
class _Foot:
    """One foot of a body over its ground: ``states`` (F,) of its heel and toe, ``soles`` (F or 1, 6) its measures."""

    side: int
    body: AnyMorphology
    ground: Ground
    frame_rate: float
    states: NDArray[np.int64]
    soles: FloatArray

    def plan(self, positions: FloatArray, rotations: FloatArray, plan: FootPlan) -> None:
        """What it does on the level floor at the ground's own height, before it rolls; ``plan`` is written."""
        ankle, foot = self.body.layout.ankle(self.side), self.body.layout.spine_count + 12 + 4 * self.side
        plan.ankles[:], plan.feet[:], plan.toes[:] = positions[:, ankle], rotations[:, foot], rotations[:, foot + 1]
        balls, reach = np.ascontiguousarray(positions[:, ankle + 1, 2]), LET_GO * self.frame_rate
        plan_foot(self.states, self.soles, self.ground.height, self.ground.is_level, reach, balls, plan)
        if not self.ground.is_level:
            self._keep_above(plan)

    def roll(self, soft_thresholds: FloatArray, positions: FloatArray, plan: FootPlan) -> None:
        """Roll it on the level floor to where its leg reaches it, and keep it above the floor; ``plan`` is written."""
        bones = leg_rows(self.body, self.side)
        # Contiguous, which a single frame is by itself: kernels are compiled for one layout.
        hips = np.ascontiguousarray(positions[:, self.body.layout.hip(self.side)])
        reaches = soft_thresholds * bones.sum(axis=1)
        roll_feet(self.soles, self.states, hips, reaches, LET_GO * self.frame_rate, plan.ankles, plan.feet)
        self._keep_above(plan)

    def _keep_above(self, plan: FootPlan) -> None:
        raise_swing_foot(self.soles, self.states, self.ground.height, self.frame_rate, *plan)

    def drape(self, positions: FloatArray, rotations: FloatArray, plan: FootPlan) -> _DrapedFoot:
        """Set it, planned level, on ground that is not.

        A heel that would stand over nothing does not: that foot comes down flat; ``states`` tell so after.
        """
        states = self.states
        prints = find_footprints(states, plan.ankles, plan.feet, self.soles, self.ground)
        if prints.hanging.any():
            for first, last in zip(prints.first[prints.hanging], prints.last[prints.hanging], strict=True):
                states[first : last + 1][states[first : last + 1] == HEEL_STANDS] = SOLE_STANDS
            self.plan(positions, rotations, plan)
            prints = find_footprints(states, plan.ankles, plan.feet, self.soles, self.ground)
        draped = drape(prints, *plan, self.ground, self.frame_rate)
        level, foot = Sole.of(*plan, self.soles), Sole.of(draped.ankles, draped.feet, draped.toes, self.soles)
        led = led_clear(level, foot, states, self.ground, self.frame_rate)
        return _DrapedFoot(FootPlan(led.ankles, led.feet, led.toes), plan.ankles, draped.heights)


def followed(
    off: FloatArray, states: NDArray[np.int64], frame_rate: float, positions: FloatArray, body: AnyMorphology
) -> FloatArray:
    """(F, 3) metres by which a body at ``positions`` (F, P, 3) goes along with feet that stand ``off`` (2, F, 3) there.

    Each of those that stand takes its share, passed on over ``AVERAGED`` seconds to either side: so who stands on one
    leg keeps it as it is. Of two that stand flat and want different things the legs keep their lengths.
    """
    stands = states != 0
    if not stands.any():
        return np.zeros(off.shape[1:])
    off = np.where(stands[..., None], off, 0.0)
    for side in range(2):
        interpolate_gaps(off[side], stands[side])
    frames, carried = np.arange(stands.shape[1]), np.flatnonzero(stands.any(axis=0))
    share = np.interp(frames, carried, (stands[0] / np.maximum(stands.sum(axis=0), 1))[carried])
    weights = averaged(np.column_stack([share, *(states == SOLE_STANDS)]), AVERAGED, frame_rate)
    way = off[1] + weights[:, :1] * (off[0] - off[1])
    keep_leg_lengths(off, weights, (body.layout.hip(0), body.layout.hip(1)), positions, way)
    return smoothed(way, FOLLOWED * frame_rate)


def leg_stretches(motion: NormalizedMotion, states: NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
    """The ``comforts`` of a ``Footing``, where it stands halfway from the motion's own leg to a straight one, and its
    ``runs``: a knee that is nearly straight gives way sooner than hips ride lower.
    """
    if not np.count_nonzero(states):
        return np.full(states.shape, SOFT_IK_THRESHOLD), np.full(states.shape, np.inf)
    free = np.array([freedom(planted, motion.frame_rate) for planted in states != 0])
    own = np.subtract(1.0, motion.channels[:, LIMB_SLACK + 2 : LIMB_SLACK + 4].T, order="C")
    standing = (0.5 * (1.0 + own)).clip(SOLE_SOFT_IK_THRESHOLD, 1.0 - 1e-9)
    return standing + free * (SOFT_IK_THRESHOLD - standing), run_out(free)


def run_out(free: FloatArray) -> FloatArray:
    """(F,) how far the reach of a root has grown that is let go smoothly, parts of a limb's length; inf if free."""
    return np.asarray(np.divide(HALF_FREE_REACH * free, 1.0 - free, out=np.full(free.shape, np.inf), where=free < 1.0))
