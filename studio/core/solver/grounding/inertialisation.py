"""Inertialised transition of a grounded motion from the previous poses of a body.

Grounding looks ahead: footprints, root height and arm clearance depend on later frames. So the new motion is grounded
by itself (its *own* poses), and the decaying difference to the *previous* poses (``seen``) is added to it, as in
``normalized.transition``: of the root, of every joint, and of feet over the ground. A standing foot keeps its contact
until it is lifted; one in the air lands where its own motion does.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology, sole_rows
from studio.core.captures.contacts import FOOT_POINTS
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.solve_clip import place_frames
from studio.core.normalized.differences import rotation_vectors
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.transition import (
    LEAST_TRANSITION_SECONDS,
    offset_decay_seconds,
    remaining_offset_fraction,
    remaining_speed_offset,
    speed_decay_times,
)
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.solver.grounding.contact_blending import smooth_drops
from studio.core.solver.grounding.foot_tipping import depths_of, early_envelope, heights_of, raised_out_of_ground
from studio.core.solver.grounding.footing import Footing, foot_contacts, leg_freedoms, reach_relaxation
from studio.core.solver.grounding.held_foot import FootPath, HeldFoot, rotated_by_vectors
from studio.core.solver.grounding.stepping import FootFlight, carrying, flights_of, states_of

if TYPE_CHECKING:
    from studio.core.solver.grounding.grounded_motion import GroundedMotion

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stance:
    """Last two frames of a body before a transition, without constraints."""

    positions: FloatArray
    """(2, P, 3) metres."""
    rotations: FloatArray
    """(2, S, 3, 3) in the world."""
    ankles: FloatArray
    """(2, 2, 3) ankle targets by side and frame, metres."""
    feet: FloatArray
    """(2, 2, 3, 3) by side and frame."""
    toes: FloatArray
    """(2, 2, 3, 3) by side and frame."""
    states: NDArray[np.int64]
    """(2,) contacts that each foot has in both frames."""
    soft_thresholds: FloatArray
    """(2,) soft-IK thresholds of the legs."""
    peaks: FloatArray
    """(S,) acceleration peaks of the motion before, rad/s2."""
    root_peak: float
    """Acceleration peak of its root, rad/s2."""

    @classmethod
    def of(cls, standing: "GroundedMotion", frames: NDArray[np.int64]) -> "Stance":
        """Stance in the last two of the given ``frames``."""
        rows, footing = frames[-2:], standing.footing
        legs = footing.ankles[:, rows, :3], footing.feet[:, rows], footing.toes[:, rows]
        stood = footing.states[:, rows[0]] & footing.states[:, rows[-1]]  # what comes down only now still moves
        known = stood, footing.soft_thresholds[:, rows[-1]], standing.peak_angular_accelerations
        return cls(standing.positions[rows], standing.rotations[rows], *legs, *known, standing.root_peak)

    @classmethod
    def last_of(cls, standing: "GroundedMotion") -> "Stance":
        """Stance in the last two frames of a grounded motion."""
        last = standing.motion.frame_count - 1
        return cls.of(standing, np.array([max(last - 1, 0), last]))

    @classmethod
    def before(cls, standing: "GroundedMotion", first: int) -> "Stance":
        """Stance in two frames extrapolated backwards from frame ``first``."""
        rows, footing = [first, min(first + 1, standing.motion.frame_count - 1)], standing.footing
        places = standing.positions[rows], *footing.ankles[:, rows, :3]
        rotation_matrices = standing.rotations[rows], *footing.feet[:, rows], *footing.toes[:, rows]
        positions, *ankles = (np.stack([3.0 * now - 2.0 * then, 2.0 * now - then]) for now, then in places)
        rotations, *legs = (_turned_back(*each) for each in rotation_matrices)
        known = footing.states[:, first], footing.soft_thresholds[:, first], standing.peak_angular_accelerations
        stance = np.array(ankles), np.array(legs[:2]), np.array(legs[2:])
        return cls(positions, rotations, *stance, *known, standing.root_peak)


def inertialised_motion(
    standing: "GroundedMotion", first: int, seen: Stance, seconds: float = 0.0, planned: bool = False
) -> "GroundedMotion":
    """Grounded motion that is inertialised at frame ``first`` from the previous stance ``seen``; earlier frames are
    that stance.

    The transition takes ``seconds``, or the time that the joints need if that is 0. In a ``planned`` transition feet in
    the air step to where they land.
    """
    change = _Change(standing, first, seen, Stance.before(standing, first), seconds, planned)
    positions, rotations = standing.positions[:].copy(), standing.rotations[:].copy()
    bases = [change.held_foot(side, flight) for side, flight in enumerate(change.flights)]
    near = change.displace_body(np.mean([each.carries for each in bases], axis=0), positions, rotations)
    positions[first:, :, 2] += change.carried(bases, positions)[:, None]
    motion = _with_limbs(standing, near, positions, rotations)
    footing = change.footing(bases, positions, rotations)
    drops = np.zeros(motion.frame_count)
    drops[first:] = change.drops(motion, footing, positions, rotations)
    place_frames(standing.morphology.rows, drops, footing.legs(motion), positions, rotations)
    positions[:first], rotations[:first] = seen.positions[1], seen.rotations[1]
    others = [each for each in standing.contacts if each.point not in FOOT_POINTS]
    touching = np.append(np.zeros(first), 1.0 - remaining_offset_fraction(change.times, change.seconds))
    return replace(
        standing,
        motion=motion,
        contacts=(*others, *foot_contacts(footing.states)),
        footing=footing,
        positions=positions,
        rotations=rotations,
        self_contact=standing.self_contact and standing.self_contact.inertialised(touching, positions, rotations),
    )


def _with_limbs(
    standing: "GroundedMotion", near: slice, positions: FloatArray, rotations: FloatArray
) -> NormalizedMotion:
    """Motion with the limb channels of posed frames ``near`` the transition, so that knees keep their directions."""
    body, channels = standing.morphology, standing.motion.channels.copy()
    still = body.at(near.start) if isinstance(body, AnimatedMorphology) else body
    limbs = slice(channel.LIMB_FRAME, channel.HAND)
    posed = encode_motion(positions[near], rotations[near], still, standing.motion.frame_rate)
    channels[near, limbs] = posed.channels[:, limbs]
    return replace(standing.motion, channels=channels)


class _InertialisedFoot(NamedTuple):
    """Path of a foot in a transition, and its horizontal offset (F, 3) from its own path, which the body follows."""

    path: FootPath
    carries: FloatArray


@dataclass(frozen=True, eq=False)
class _Change:
    """Transition to a grounded motion at frame ``first``."""

    standing: "GroundedMotion"
    first: int
    seen: Stance
    """Previous stance."""
    own: Stance
    """Stance of the grounded motion itself before ``first``."""
    given: float
    """Duration in seconds, 0 for as long as the joints need."""
    planned: bool

    @property
    def rate(self) -> float:
        """Frames a second."""
        return self.standing.motion.frame_rate

    @cached_property
    def times(self) -> FloatArray:
        """Seconds (F,) of each frame after the previous pose."""
        return np.arange(1, self.standing.motion.frame_count - self.first + 1) / self.rate

    @cached_property
    def peaks(self) -> FloatArray:
        """Acceleration peaks (S,) in rad/s2 of each segment, the greater of both motions."""
        return np.maximum(self.standing.peak_angular_accelerations, self.seen.peaks)

    @cached_property
    def legs(self) -> FloatArray:
        """Acceleration peaks (2, 3) in rad/s2 of each leg: of its quieter bone, of the foot and of the toes."""
        four = self.peaks[self.standing.morphology.layout.thigh_segment(0) :].reshape(2, 4)
        return np.stack([four[:, :2].min(axis=1), four[:, 2], four[:, 3]], axis=1)

    @cached_property
    def root_peak(self) -> float:
        """Acceleration peak in rad/s2 of the legs by the root's displacement, at most that of the quieter leg."""
        return min(float(self.legs[:, 0].min()), max(self.standing.root_peak, self.seen.root_peak))

    @property
    def leg(self) -> float:
        """Leg length in metres."""
        return self.standing.morphology.leg_length

    @cached_property
    def turns(self) -> FloatArray:
        """Rotation vectors (2, S, 3) of each segment in its parent, from its own pose to the previous one, in both
        frames.
        """
        parents = np.array(self.standing.morphology.layout.parent_segments())
        own, seen = (_in_carriers(each.rotations, parents) for each in (self.own, self.seen))
        return _rotation_differences(own, seen)

    @cached_property
    def seconds(self) -> float:
        """Seconds in which differences decay, except those of feet."""
        return self.given or max(
            offset_decay_seconds(np.linalg.norm(self.turns[1], axis=1), self.peaks), self.root_seconds
        )

    @cached_property
    def root_seconds(self) -> float:
        """Seconds in which the root's difference decays."""
        displacement = np.linalg.norm(self.seen.positions[1, 0] - self.own.positions[1, 0]) / self.leg
        return self.given or offset_decay_seconds(np.array([displacement]), np.array([self.root_peak]))

    def left(self, gaps: FloatArray, peak: float, scale: float = 1.0, seconds: float = 0.0) -> FloatArray:
        """Remainder (F, N) of a difference over time, given its last two values ``gaps`` (2, N).

        ``peak`` is the acceptable acceleration in rad/s2; ``scale`` is the number of units of the difference in a
        radian.
        """
        speed, seconds = (gaps[1] - gaps[0]) * self.rate, seconds or self.seconds
        halting = float(speed_decay_times(np.array([np.linalg.norm(speed)]) / scale, np.array([peak]), seconds)[0])
        place, pace = remaining_offset_fraction(self.times, seconds), remaining_speed_offset(self.times, halting)
        return np.asarray(place[:, None] * gaps[1] + pace[:, None] * speed)

    @cached_property
    def feet(self) -> tuple[HeldFoot, HeldFoot]:
        """Both feet, with own and previous paths."""
        left, right = (self.foot(side) for side in range(2))
        return left, right

    def foot(self, side: int) -> HeldFoot:
        """Foot of one side, with own and previous paths."""
        footing, seen, body = self.standing.footing, self.seen, self.standing.morphology.first_frame_body
        on, state = slice(self.first, None), int(seen.states[side])
        own = FootPath(footing.ankles[side, on, :3], footing.feet[side, on], footing.toes[side, on])
        before = FootPath(seen.ankles[side], seen.feet[side], seen.toes[side])
        known = own, footing.states[side, on], before, state, sole_rows(body, side)
        return HeldFoot(*known, self.legs[side, 1:], self.rate)

    @cached_property
    def flights(self) -> tuple[FootFlight, ...]:
        """Flight of each foot to its own position."""
        displacements = np.array([np.linalg.norm(foot.aside) for foot in self.feet]) / self.leg
        joints = np.linalg.norm(self.turns[1], axis=1)
        rotation_matrices = [abs(foot.heading) for foot in self.feet]
        stepping = [
            offset_decay_seconds(np.array(each), leg[:2])
            for *each, leg in zip(displacements, rotation_matrices, self.legs, strict=True)
        ]
        swinging = [offset_decay_seconds(joints[legs], self.peaks[legs]) for legs in self.leg_segments]
        needed = np.array([stepping, swinging])
        own = self.standing.footing.states[:, self.first :]
        return flights_of(own, self.seen.states, displacements, needed, self.given, self.rate, self.planned)

    @property
    def leg_segments(self) -> tuple[slice, slice]:
        """Segments of the left and of the right leg."""
        legs = self.standing.morphology.layout.thigh_segment(0)
        return slice(legs, legs + 4), slice(legs + 4, legs + 8)

    def footing(self, bases: Sequence[_InertialisedFoot], positions: FloatArray, rotations: FloatArray) -> Footing:
        """Footing of the inertialised body: swing feet follow the joints of their legs, others are at their
        ``bases``.
        """
        own, on = self.standing.footing, slice(self.first, None)
        states, soft_thresholds, ankles = own.states.copy(), own.soft_thresholds.copy(), own.ankles.copy()
        feet, toes = own.feet[:].copy(), own.toes[:].copy()
        for side, flight in enumerate(self.flights):
            states[side, : self.first], states[side, on] = self.seen.states[side], self.states(side, flight)
            swung = self.swung_foot(side, flight, bases[side].path, positions, rotations)
            foot = self.above_ground(side, swung, states[side, on])
            ankles[side, on, :3], feet[side, on], toes[side, on] = foot.ankles, foot.feet, foot.toes
        soft_thresholds[:, on] += remaining_offset_fraction(self.times, self.seconds) * (
            self.seen.soft_thresholds[:, None] - soft_thresholds[:, on]
        )
        runs = reach_relaxation(leg_freedoms(states, self.rate))
        return replace(
            own, states=states, soft_thresholds=soft_thresholds, runs=runs, ankles=ankles, feet=feet, toes=toes
        )

    def states(self, side: int, flight: FootFlight) -> NDArray[np.int64]:
        """States (F,) of a foot from the transition on."""
        foot = self.feet[side]
        return states_of(foot.states, foot.state, flight, round(foot.settling(flight, self.seconds) * self.rate))

    def held_foot(self, side: int, flight: FootFlight) -> _InertialisedFoot:
        """Path of a foot that keeps its contact until it is lifted, with an offset that decays until the foot lands."""
        foot = self.feet[side]
        if not flight.held:
            return _InertialisedFoot(foot.own, np.zeros_like(foot.own.ankles))
        path, carries = foot.path(flight, self.seconds, self.times)
        if flight.is_step:  # who steps with both feet goes there in one way
            lands = max(each.lands for each in self.flights if each.is_step)
            carries = remaining_offset_fraction(self.times, lands / self.rate)[:, None] * foot.aside * [1.0, 1.0, 0.0]
        path.ankles[:, 2] += flight.rise(self.times, self.rate) * self.leg
        return _InertialisedFoot(path, carries)

    def carried(self, bases: Sequence[_InertialisedFoot], positions: FloatArray) -> FloatArray:
        """Rise (F,) in metres of the body with which standing legs keep the lengths that their joints give them.

        Nearly straight knees move as the joints do, then.
        """
        layout, displacements, fractions = self.standing.morphology.layout, [], []
        for side, (flight, base) in enumerate(zip(self.flights, bases, strict=True)):
            hips, ankles = (
                positions[self.first :, point] for point in (layout.hip_point(side), layout.ankle_point(side))
            )
            off = base.path.ankles - hips
            below = self.leg_lengths(side, ankles - hips, off) ** 2 - np.sum(off[:, :2] ** 2, axis=1)
            displacements.append(off[:, 2] + np.sqrt(np.maximum(below, 0.0)))
            fractions.append(carrying(self.states(side, flight), self.rate))
        both = np.array(fractions) / (1.0 + fractions[0] * fractions[1])
        return np.asarray((both * np.array(displacements)).sum(axis=0))

    def leg_lengths(self, side: int, led: FloatArray, off: FloatArray) -> FloatArray:
        """Length (F,) in metres of a leg for a foot at ``off`` (F, 3) from its hip, whose joints put the ankle at
        ``led`` (F, 3).

        The leg extends to a foot farther away, by METHOD (11), before the body sinks.
        """
        aside, own = (np.sum(each[:, :2] ** 2, axis=1) for each in (off, led))
        whole, length = self.standing.morphology.first_frame_body.leg[side].sum(), np.sum(led**2, axis=1)
        soft_threshold = np.maximum(self.standing.footing.soft_thresholds[side, self.first :], np.sqrt(length) / whole)
        needed, more = np.sqrt(length + np.maximum(aside - own, 0.0)) / whole, np.maximum(1.0 - soft_threshold, 1e-3)
        soft = np.minimum(needed, soft_threshold + more * -np.expm1(np.minimum(soft_threshold - needed, 0.0) / more))
        return np.asarray(whole * soft)

    def drops(
        self, motion: NormalizedMotion, footing: Footing, positions: FloatArray, rotations: FloatArray
    ) -> FloatArray:
        """Root lowering (F,) in metres with which legs reach displaced feet, fading in."""
        on = slice(self.first, None)
        rows, needed = self.standing.morphology.rows, np.empty(len(self.times))
        ankles = footing.ankles[:, on, :3] - positions[on, 0]
        required_root_lowering(
            motion.channels[on], rows if len(rows) == 1 else rows[on], rotations[on], ankles,
            np.ascontiguousarray(footing.soft_thresholds[:, on]), np.ascontiguousarray(footing.states[:, on]), needed,
        )  # fmt: skip
        return smooth_drops(needed, self.rate) * (1.0 - remaining_offset_fraction(self.times, LEAST_TRANSITION_SECONDS))

    def swung_foot(
        self, side: int, flight: FootFlight, base: FootPath, positions: FloatArray, rotations: FloatArray
    ) -> FootPath:
        """Path of a swing foot that follows the joints of its leg, blended with its ``base`` at both ends of the
        flight.
        """
        if flight.is_step:
            return base
        layout, free = self.standing.morphology.layout, flight.free(self.times, self.rate)[:, None]
        segment = layout.foot_segment(side)
        feet, toes = (
            rotated_by_vectors(free * _rotation_differences(part, rotations[self.first :, segment + off]), part)
            for off, part in enumerate((base.feet, base.toes))
        )
        ankles = base.ankles + free * (positions[self.first :, layout.ankle_point(side)] - base.ankles)
        return self.lifted(side, flight, FootPath(ankles, feet, toes))

    def lifted(self, side: int, flight: FootFlight, foot: FootPath) -> FootPath:
        """Path of a foot raised over the ground as high as its ``flight`` rises, by a smooth maximum."""
        rise = flight.rise(self.times, self.rate) * self.leg
        if not rise.any():
            return foot
        high = np.maximum(heights_of(foot, self.soles(side), self.standing.ground).min(axis=0), 0.0)
        raised = (high**4 + rise**4) ** 0.25 - high
        return FootPath(foot.ankles + raised[:, None] * [0.0, 0.0, 1.0], foot.feet, foot.toes)

    def soles(self, side: int) -> FloatArray:
        """Measures (F or 1, 6) of a foot from the transition on (``kernels.support.sole``)."""
        measures = sole_rows(self.standing.morphology, side)
        return measures if len(measures) == 1 else measures[self.first :]

    def above_ground(self, side: int, foot: FootPath, states: NDArray[np.int64]) -> FootPath:
        """Path of a foot raised so that it is no deeper in the ground than in its own motion."""
        measures, ground = self.soles(side), self.standing.ground
        own = depths_of(self.feet[side].own, measures, ground)
        deeper = np.maximum(depths_of(foot, measures, ground) - own, 0.0)
        return raised_out_of_ground(foot, measures, early_envelope(deeper, states != 0, self.rate))

    def displace_body(self, goes: FloatArray, positions: FloatArray, rotations: FloatArray) -> slice:
        """Displace the root by ``goes`` (F, 3), and add the remaining differences to root and joints, in place.

        Legs are placed on their ankles later. Returns the frames of the transition.
        """
        layout = self.standing.morphology.layout
        parents, proximal = layout.parent_segments(), layout.proximal_points()
        gaps = self.seen.positions[:, 0] - self.own.positions[:, 0] - goes[0]
        goes = goes + self.left(gaps, self.root_peak, self.leg, self.root_seconds)
        seconds = np.full(len(self.peaks), self.seconds)  # a leg in the air has until it lands
        for legs, flight in zip(self.leg_segments, self.flights, strict=True):
            seconds[legs] = self.seconds if flight.held else flight.seconds
        near = slice(self.first, self.first + int(np.searchsorted(self.times, seconds.max(), "right")) + 1)
        led = _InertialisedFrames(positions[near].copy(), rotations[near].copy(), positions[near], rotations[near])
        count = len(led.places)
        led.places[:, 0] += goes[:count]
        for segment in range(len(self.peaks)):
            left = self.left(self.turns[:, segment], float(self.peaks[segment]), 1.0, seconds[segment])[:count]
            if segment == 0:
                led.turns[:, 0] = rotated_by_vectors(left, led.old_turns[:, 0])
                continue
            parent = parents[segment]
            led.carry(proximal[segment], parent, proximal[parent])
            local = np.swapaxes(led.old_turns[:, parent], 1, 2) @ led.old_turns[:, segment]
            led.turns[:, segment] = led.turns[:, parent] @ rotated_by_vectors(left, local)
        hands = [(layout.wrist_point(side) + 1, layout.hand_segment(side)) for side in range(2)]
        toes = [(layout.ankle_point(side) + 2, layout.toe_segment(side)) for side in range(2)]
        for end, segment in ((layout.head_end, layout.spine_count + 1), *hands, *toes):
            led.carry(end, segment, proximal[segment])
        positions[near.stop :] += goes[count:, None]
        return near


@dataclass(frozen=True, eq=False)
class _InertialisedFrames:
    """Poses of the transition's frames, own and inertialised; the latter are written."""

    old_places: FloatArray
    """(F, P, 3) own positions, metres."""
    old_turns: FloatArray
    """(F, S, 3, 3) own rotations."""
    places: FloatArray
    """(F, P, 3) inertialised positions, metres."""
    turns: FloatArray
    """(F, S, 3, 3) inertialised rotations."""

    def carry(self, point: int, segment: int, origin: int) -> None:
        """Write the inertialised position of a point that moves with ``segment`` about the point ``origin``."""
        arm = self.old_places[:, point] - self.old_places[:, origin]
        rotation = self.turns[:, segment] @ np.swapaxes(self.old_turns[:, segment], 1, 2)
        self.places[:, point] = self.places[:, origin] + (rotation @ arm[:, :, None])[:, :, 0]


def _turned_back(now: FloatArray, then: FloatArray) -> FloatArray:
    """Rotations (2, ..., 3, 3) two frames and one frame before ``now``, extrapolated from ``then``, one frame after."""
    back = now @ np.swapaxes(then, -1, -2)
    return np.stack([back @ back @ now, back @ now])


def _in_carriers(rotations: FloatArray, parents: NDArray[np.int64]) -> FloatArray:
    """Rotations (N, S, 3, 3) of segments in the axes of their parents; of the pelvis in the world."""
    local = rotations[:].copy()
    local[:, 1:] = np.swapaxes(rotations[:, parents[1:]], 2, 3) @ rotations[:, 1:]
    return np.asarray(local)


def _rotation_differences(own: FloatArray, led: FloatArray) -> FloatArray:
    """Rotation vectors (F, ..., 3) from ``own`` (F, ..., 3, 3) to ``led``, continuous in time back from the last
    frame.
    """
    rotation_matrices = sign_continuous(from_matrix(led @ np.swapaxes(own, -1, -2))[::-1])[::-1]
    return rotation_vectors(rotation_matrices * np.where(rotation_matrices[-1, ..., 3:] < 0.0, -1.0, 1.0))
