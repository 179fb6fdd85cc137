"""Grounding of a live body, one pose at a time, without knowledge of later poses ([METHOD 6])."""

import math

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import FOOT_POINTS, GREATEST_DRIFT_METRES, ContactInterval
from studio.core.kernels.limbs.limb import SOFT_IK_THRESHOLD
from studio.core.kernels.solve_clip import place_frames
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS, TOE_STANDS
from studio.core.normalized.realize import realize_motion
from studio.core.solver.grounding.footing import Footing, leg_soft_thresholds, reach_relaxation
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.grounding.raised_arms import raise_arms
from studio.core.solver.request import AdaptRequest
from studio.core.solver.task_assembly.self_contact import self_contact_of
from studio.live.foothold import DampedHeight, Foothold, FootPose

FloatArray = NDArray[np.float64]

FLOOR_RISE_SPEED = 0.01
"""Speed (m/s) at which the reference height of low feet rises while no foot comes down to it."""
LOST_POSE_SECONDS = 0.5
"""Seconds without a pose after which the foot contacts are reset."""
STANDING_BITS = {point: HEEL_STANDS if point.is_heel else TOE_STANDS for point in FOOT_POINTS}


class LiveGrounding:
    """Grounding of a body's newest pose by ``ground_motion``; foot contacts are kept from one call to the
    next.
    """

    def __init__(self) -> None:
        self._request: AdaptRequest | None = None
        self._standing: GroundedMotion | None = None
        self._feet: tuple[Foothold, ...] = ()
        self._seconds = -math.inf
        self._low = self._lowest = math.inf
        self._floor = DampedHeight(0.0)

    @property
    def states(self) -> tuple[int, ...]:
        """Standing parts of each foot, as the bits HEEL_STANDS and TOE_STANDS."""
        return tuple(foot.state for foot in self._feet)

    def stand(self, request: AdaptRequest, seconds: float) -> GroundedMotion:
        """Grounded still motion of ``request`` on its body and ground, at the clock time ``seconds``."""
        before, self._request = self._request, request
        same = before is not None and before.morphology is request.morphology and before.ground == request.ground
        if self._standing is None or not (same and before is not None and before.motion is request.motion):
            begins = not same or not seconds - self._seconds < LOST_POSE_SECONDS
            self._standing = self._stand(request, 0.0 if begins else seconds - self._seconds, begins)
            self._seconds = seconds
        return self._standing

    def _stand(self, request: AdaptRequest, dt: float, begins: bool) -> GroundedMotion:
        body = request.morphology.first_frame_body
        positions, rotations = realize_motion(request.motion, body)
        if begins:
            self._low = self._lowest = math.inf
            self._floor = DampedHeight(0.0)
            self._feet = tuple(Foothold(body, side, request.ground, DampedHeight(0.0)) for side in range(2))
        own = [_posed(foot, positions, rotations) for foot in self._feet]
        low = self._low_of(own, dt) - self._floor.value
        positions[:, :, 2] -= self._floor_under(own, dt)
        own = [_posed(foot, positions, rotations) for foot in self._feet]
        aimed = [foot.step(each, low, dt) for foot, each in zip(self._feet, own, strict=True)]
        positions[:, :, 2] += np.mean([foot.climb.value for foot in self._feet])
        footing = self._footing(request, aimed, positions)
        legs = footing.legs(request.motion)
        place_frames(body.rows, footing.drops, legs, positions, rotations)
        for foot in self._feet:
            foot.update(_posed(foot, positions, rotations))
        return self._standing_of(request, footing, positions, rotations)

    def _low_of(self, feet: list[FootPose], dt: float) -> float:
        """Height in metres of the recently lowest heel or ball; it rises by ``GREATEST_DRIFT_METRES`` at most."""
        points = [foot.points_of(pose)[:, 2] for foot, pose in zip(self._feet, feet, strict=True)]
        lowest = float(np.min(points))
        self._lowest = min(self._lowest, lowest)
        self._low = min(self._low + FLOOR_RISE_SPEED * dt, self._lowest + GREATEST_DRIFT_METRES, lowest)
        return self._low

    def _floor_under(self, feet: list[FootPose], dt: float) -> float:
        """Smoothed height in metres of the sender's floor, measured by feet that stand flat."""
        pairs = zip(self._feet, feet, strict=True)
        flat = [foot.points_of(pose)[:, 2].mean() for foot, pose in pairs if foot.state == SOLE_STANDS]
        return self._floor.follow(float(np.mean(flat)), dt) if flat else self._floor.value

    def _footing(self, request: AdaptRequest, aimed: list[FootPose], positions: FloatArray) -> Footing:
        """Footing of both frames of the still motion, which are equal."""
        motion, body = request.motion, request.morphology.first_frame_body
        count = motion.frame_count
        states, weights = (np.array([[each] * count for each in both]) for both in (self.states, self._weights))
        ankles, feet, toes = (
            np.stack([np.stack([part] * count) for part in parts]) for parts in zip(*aimed, strict=True)
        )
        standing = leg_soft_thresholds(motion, np.full_like(states, SOLE_STANDS), request.ground.is_level)
        soft_thresholds = SOFT_IK_THRESHOLD + weights * (standing - SOFT_IK_THRESHOLD)
        hips = np.stack([positions[:, body.layout.hip_point(side)] for side in range(2)])
        off, reaches = ankles - hips, soft_thresholds * body.leg.sum(axis=1)[:, None]
        below = np.sqrt(np.maximum(reaches**2 - np.sum(off[..., :2] ** 2, axis=2), 0.0))
        drops = (weights * np.maximum(-off[..., 2] - below, 0.0)).max(axis=0)
        return Footing(states, soft_thresholds, reach_relaxation(1.0 - weights), ankles, feet, toes, drops)

    @property
    def _weights(self) -> tuple[float, ...]:
        return tuple(foot.weight for foot in self._feet)

    def _standing_of(
        self, request: AdaptRequest, footing: Footing, positions: FloatArray, rotations: FloatArray
    ) -> GroundedMotion:
        motion, body, ground = request.motion, request.morphology.first_frame_body, request.ground
        raise_arms(body, ground, None, motion.frame_rate, positions, rotations)
        contact = self_contact_of(motion, body, (), request.volume, request.actor, request.clears)
        last = motion.frame_count - 1
        contacts = tuple(
            ContactInterval("live", point, 0, last)
            for point, bit in STANDING_BITS.items()
            if self.states[point.side] & bit
        )
        standing = GroundedMotion(
            motion=motion,
            morphology=body,
            contacts=contacts,
            ground=ground,
            footing=footing,
            holds=(),
            arms=None,
            positions=positions,
            rotations=rotations,
            volume=request.volume,
            actor=request.actor,
            limited=request.limited,
            self_contact=contact,
        )
        return standing.with_arms_right([slice(0, last + 1)])


def _posed(foot: Foothold, positions: FloatArray, rotations: FloatArray) -> FootPose:
    layout, side = foot.body.layout, foot.side
    segment = layout.foot_segment(side)
    return FootPose(positions[0, layout.ankle_point(side)].copy(), *rotations[0, segment : segment + 2].copy())
