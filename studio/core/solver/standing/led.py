"""A standing motion led on from where a body was: what was decided as it plays takes over without a jump.

A motion on the ground looks ahead: where a foot stands, how low hips are and how arms keep clear has to do with what
comes. So the motion that takes over stands as it does by itself, as smoothly as ever, and what was different when it
took over dies away on top of that, as in ``normalized.transition``: of the root, of every joint, and of feet over the
ground. A foot that stands stays where it stands until it is lifted; one in the air lands where the motion has it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology, sole_rows
from studio.core.captures.contacts import FOOT_POINTS
from studio.core.kernels import layout as at
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.solve_clip import place_frames
from studio.core.normalized.differences import rotation_vectors
from studio.core.normalized.encode import encode
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.transition import SHORTEST, halts_of, pace_left, place_left, seconds_of
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.solver.standing.blends import smooth_drops
from studio.core.solver.standing.footing import Footing, foot_contacts, leg_stretches
from studio.core.solver.standing.held_foot import FootPath, HeldFoot, turned
from studio.core.solver.standing.stepping import Flight, carrying, flights_of, states_of
from studio.core.solver.standing.tipping import depths_of, out_of_ground, seen_coming

if TYPE_CHECKING:
    from studio.core.solver.standing.stand import Standing

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stance:
    """A body in two frames, the last ones that were seen, before anything is asked of it.

    ``positions`` (2, P, 3), ``rotations`` (2, S, 3, 3); ``ankles`` (2, 2, 3), ``feet`` and ``toes`` (2, 2, 3, 3) of
    each side in each frame; ``states`` (2,) of what stands in both, ``comforts`` (2,) of its footing in the last one;
    ``peaks`` (S,) and ``root_peak`` of the motion that it was seen in.
    """

    positions: FloatArray
    rotations: FloatArray
    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray
    states: NDArray[np.int64]
    soft_thresholds: FloatArray
    peaks: FloatArray
    root_peak: float

    @classmethod
    def of(cls, standing: "Standing", frames: NDArray[np.int64]) -> "Stance":
        """In the last two of ``frames``."""
        rows, footing = frames[-2:], standing.footing
        legs = footing.ankles[:, rows, :3], footing.feet[:, rows], footing.toes[:, rows]
        stood = footing.states[:, rows[0]] & footing.states[:, rows[-1]]  # what comes down only now still moves
        known = stood, footing.soft_thresholds[:, rows[-1]], standing.peaks
        return cls(standing.positions[rows], standing.rotations[rows], *legs, *known, standing.root_peak)

    @classmethod
    def last_of(cls, standing: "Standing") -> "Stance":
        """In its last two frames."""
        last = standing.motion.frame_count - 1
        return cls.of(standing, np.array([max(last - 1, 0), last]))

    @classmethod
    def before(cls, standing: "Standing", first: int) -> "Stance":
        """In the two frames before ``first``, as if it went there as fast as it goes on."""
        rows, footing = [first, min(first + 1, standing.motion.frame_count - 1)], standing.footing
        places = standing.positions[rows], *footing.ankles[:, rows, :3]
        turns = standing.rotations[rows], *footing.feet[:, rows], *footing.toes[:, rows]
        positions, *ankles = (np.stack([3.0 * now - 2.0 * then, 2.0 * now - then]) for now, then in places)
        rotations, *legs = (_turned_back(*each) for each in turns)
        known = footing.states[:, first], footing.soft_thresholds[:, first], standing.peaks
        stance = np.array(ankles), np.array(legs[:2]), np.array(legs[2:])
        return cls(positions, rotations, *stance, *known, standing.root_peak)


def led_from(standing: "Standing", first: int, seen: Stance, seconds: float = 0.0) -> "Standing":
    """``standing`` from frame ``first`` on led from the body as it was ``seen`` until then, in ``seconds``.

    0 takes as many as it needs.
    """
    change = _Change(standing, first, seen, Stance.before(standing, first), seconds)
    positions, rotations = standing.positions[:].copy(), standing.rotations[:].copy()
    bases = [change.held_foot(side, flight) for side, flight in enumerate(change.flights)]
    near = change.lead_body(np.mean([each.carries for each in bases], axis=0), positions, rotations)
    positions[first:, :, 2] += change.carried(bases, positions)[:, None]
    motion = _with_limbs(standing, near, positions, rotations)
    footing = change.footing(motion, bases, positions, rotations)
    drops = np.zeros(motion.frame_count)
    drops[first:] = change.drops(motion, footing, positions, rotations)
    place_frames(standing.morphology.rows, drops, footing.legs(motion), positions, rotations)
    positions[:first], rotations[:first] = seen.positions[1], seen.rotations[1]
    others = [each for each in standing.contacts if each.point not in FOOT_POINTS]
    touching = np.append(np.zeros(first), 1.0 - place_left(change.times, change.seconds))
    return replace(
        standing,
        motion=motion,
        contacts=(*others, *foot_contacts(footing.states)),
        footing=footing,
        positions=positions,
        rotations=rotations,
        self_contact=standing.self_contact and standing.self_contact.led(touching, positions, rotations),
    )


def _with_limbs(standing: "Standing", near: slice, positions: FloatArray, rotations: FloatArray) -> NormalizedMotion:
    """Its motion whose limbs lie as in posed frames; ``near`` are those in which they do not as they do by themselves.

    Legs are put on their ankles from there, so knees look where they did.
    """
    body, channels = standing.morphology, standing.motion.channels.copy()
    still = body.at(near.start) if isinstance(body, AnimatedMorphology) else body
    limbs = slice(at.LIMB_FRAME, at.HAND)
    posed = encode(positions[near], rotations[near], still, standing.motion.frame_rate)
    channels[near, limbs] = posed.channels[:, limbs]
    return replace(standing.motion, channels=channels)


class _LedFoot(NamedTuple):
    """Where a foot goes; ``carries`` (F, 3) how far it stands aside over the ground, which the body goes along with."""

    path: FootPath
    carries: FloatArray


@dataclass(frozen=True, eq=False)
class _Change:
    """``standing`` takes over at ``first``, where it is at its ``own`` in the frames before, and was ``seen``."""

    standing: "Standing"
    first: int
    seen: Stance
    own: Stance
    given: float

    @property
    def rate(self) -> float:
        return self.standing.motion.frame_rate

    @cached_property
    def times(self) -> FloatArray:
        """(F,) seconds after what was seen last."""
        return np.arange(1, self.standing.motion.frame_count - self.first + 1) / self.rate

    @cached_property
    def peaks(self) -> FloatArray:
        """(S,) radians a second squared, the greater one of either motion."""
        return np.maximum(self.standing.peaks, self.seen.peaks)

    @cached_property
    def legs(self) -> FloatArray:
        """(2, 3) ``peaks`` of each leg: of the quieter one of its bones, of its foot and of its toes."""
        four = self.peaks[self.standing.morphology.layout.spine_count + 10 :].reshape(2, 4)
        return np.stack([four[:, :2].min(axis=1), four[:, 2], four[:, 3]], axis=1)

    @cached_property
    def root_peak(self) -> float:
        """Radians a second squared of a leg that the root's travel turns, no more than those of the quieter leg."""
        return min(float(self.legs[:, 0].min()), max(self.standing.root_peak, self.seen.root_peak))

    @property
    def leg(self) -> float:
        return self.standing.morphology.leg_length

    @cached_property
    def turns(self) -> FloatArray:
        """(2, S, 3) rotation vectors from each segment in its carrier as it is by itself to how it was seen."""
        carriers = np.array(self.standing.morphology.layout.parent_segments())
        own, seen = (_in_carriers(each.rotations, carriers) for each in (self.own, self.seen))
        return _ways(own, seen)

    @cached_property
    def seconds(self) -> float:
        """In which all that is different dies away but feet."""
        return self.given or max(seconds_of(np.linalg.norm(self.turns[1], axis=1), self.peaks), self.root_seconds)

    @cached_property
    def root_seconds(self) -> float:
        """In which what is different of the root's place dies away."""
        way = np.linalg.norm(self.seen.positions[1, 0] - self.own.positions[1, 0]) / self.leg
        return self.given or seconds_of(np.array([way]), np.array([self.root_peak]))

    def left(self, gaps: FloatArray, peak: float, scale: float = 1.0, seconds: float = 0.0) -> FloatArray:
        """(F, N) what is left of ``gaps`` (2, N), the last two that were seen; ``scale`` of them makes a radian."""
        speed, seconds = (gaps[1] - gaps[0]) * self.rate, seconds or self.seconds
        halting = float(halts_of(np.array([np.linalg.norm(speed)]) / scale, np.array([peak]), seconds)[0])
        place, pace = place_left(self.times, seconds), pace_left(self.times, halting)
        return np.asarray(place[:, None] * gaps[1] + pace[:, None] * speed)

    @cached_property
    def feet(self) -> tuple[HeldFoot, HeldFoot]:
        """Each foot, by itself and as it was seen."""
        left, right = (self.foot(side) for side in range(2))
        return left, right

    def foot(self, side: int) -> HeldFoot:
        """One of ``feet``."""
        footing, seen, body = self.standing.footing, self.seen, self.standing.morphology.still
        on, state = slice(self.first, None), int(seen.states[side])
        own = FootPath(footing.ankles[side, on, :3], footing.feet[side, on], footing.toes[side, on])
        before = FootPath(seen.ankles[side], seen.feet[side], seen.toes[side])
        heel = np.array([-body.heel_length[side], 0.0, -body.ankle_height[side]])
        known = own, footing.states[side, on], before, state, heel, np.asarray(body.foot[side])
        return HeldFoot(*known, self.legs[side, 1:], self.rate)

    @cached_property
    def flights(self) -> tuple[Flight, ...]:
        """When each foot is in the air to where the motion has it."""
        ways = np.array([np.linalg.norm(foot.aside) for foot in self.feet]) / self.leg
        joints = np.linalg.norm(self.turns[1], axis=1)
        turns = [abs(foot.heading) for foot in self.feet]
        stepping = [seconds_of(np.array(each), leg[:2]) for *each, leg in zip(ways, turns, self.legs, strict=True)]
        swinging = [seconds_of(joints[legs], self.peaks[legs]) for legs in self.leg_segments]
        needed = np.array([stepping, swinging])
        own = self.standing.footing.states[:, self.first :]
        return flights_of(own, self.seen.states, ways, needed, self.given, self.rate)

    @property
    def leg_segments(self) -> tuple[slice, slice]:
        legs = self.standing.morphology.layout.spine_count + 10
        return slice(legs, legs + 4), slice(legs + 4, legs + 8)

    def footing(
        self, motion: NormalizedMotion, bases: Sequence[_LedFoot], positions: FloatArray, rotations: FloatArray
    ) -> Footing:
        """Where the feet of a led body are: in the air as the joints of its legs have them, else at their ``bases``."""
        own, on = self.standing.footing, slice(self.first, None)
        states, soft_thresholds, ankles = own.states.copy(), own.soft_thresholds.copy(), own.ankles.copy()
        feet, toes = own.feet[:].copy(), own.toes[:].copy()
        for side, flight in enumerate(self.flights):
            states[side, : self.first], states[side, on] = self.seen.states[side], self.states(side, flight)
            swung = self.swung_foot(side, flight, bases[side].path, positions, rotations)
            foot = self.above_ground(side, swung, states[side, on])
            ankles[side, on, :3], feet[side, on], toes[side, on] = foot.ankles, foot.feet, foot.toes
        soft_thresholds[:, on] += place_left(self.times, self.seconds) * (
            self.seen.soft_thresholds[:, None] - soft_thresholds[:, on]
        )
        _, runs = leg_stretches(motion, states)
        return replace(
            own, states=states, soft_thresholds=soft_thresholds, runs=runs, ankles=ankles, feet=feet, toes=toes
        )

    def states(self, side: int, flight: Flight) -> NDArray[np.int64]:
        """(F,) how a foot stands from the change on."""
        foot = self.feet[side]
        return states_of(foot.states, foot.state, flight, round(foot.settling(flight, self.seconds) * self.rate))

    def held_foot(self, side: int, flight: Flight) -> _LedFoot:
        """It stands aside until it is lifted, then what is different dies away until it lands."""
        foot = self.feet[side]
        if not flight.held:
            return _LedFoot(foot.own, np.zeros_like(foot.own.ankles))
        path, carries = foot.path(flight, self.seconds, self.times)
        if flight.height > 0.0:  # who steps with both feet goes there in one way
            lands = max(each.lands for each in self.flights if each.height > 0.0)
            carries = place_left(self.times, lands / self.rate)[:, None] * foot.aside * [1.0, 1.0, 0.0]
        path.ankles[:, 2] += flight.rise(self.times, self.rate) * self.leg
        return _LedFoot(path, carries)

    def carried(self, bases: Sequence[_LedFoot], positions: FloatArray) -> FloatArray:
        """(F,) metres by which a body whose joints are led rises for standing legs to be as long as their joints have
        them: knees that are nearly straight go as joints do.
        """
        layout, ways, shares = self.standing.morphology.layout, [], []
        for side, (flight, base) in enumerate(zip(self.flights, bases, strict=True)):
            hips, ankles = (positions[self.first :, point] for point in (layout.hip(side), layout.ankle(side)))
            off = base.path.ankles - hips
            below = self.leg_lengths(side, ankles - hips, off) ** 2 - np.sum(off[:, :2] ** 2, axis=1)
            ways.append(off[:, 2] + np.sqrt(np.maximum(below, 0.0)))
            shares.append(carrying(self.states(side, flight), self.rate))
        both = np.array(shares) / (1.0 + shares[0] * shares[1])
        return np.asarray((both * np.array(ways)).sum(axis=0))

    def leg_lengths(self, side: int, led: FloatArray, off: FloatArray) -> FloatArray:
        """(F,) metres of a leg whose joints take its ankle ``led`` (F, 3) from its hip, where it stands ``off`` (F, 3):
        to a foot that is farther aside it stretches, as METHOD (11) has it, before the body comes down.
        """
        aside, own = (np.sum(each[:, :2] ** 2, axis=1) for each in (off, led))
        whole, length = self.standing.morphology.still.leg[side].sum(), np.sum(led**2, axis=1)
        soft_threshold = np.maximum(self.standing.footing.soft_thresholds[side, self.first :], np.sqrt(length) / whole)
        needed, more = np.sqrt(length + np.maximum(aside - own, 0.0)) / whole, np.maximum(1.0 - soft_threshold, 1e-3)
        soft = np.minimum(needed, soft_threshold + more * -np.expm1(np.minimum(soft_threshold - needed, 0.0) / more))
        return np.asarray(whole * soft)

    def drops(
        self, motion: NormalizedMotion, footing: Footing, positions: FloatArray, rotations: FloatArray
    ) -> FloatArray:
        """(F,) metres by which the root comes down for legs to reach feet that stand aside; not at once."""
        on = slice(self.first, None)
        rows, needed = self.standing.morphology.rows, np.empty(len(self.times))
        ankles = footing.ankles[:, on, :3] - positions[on, 0]
        required_root_lowering(
            motion.channels[on], rows if len(rows) == 1 else rows[on], rotations[on], ankles,
            np.ascontiguousarray(footing.soft_thresholds[:, on]), np.ascontiguousarray(footing.states[:, on]), needed,
        )  # fmt: skip
        return smooth_drops(needed, self.rate) * (1.0 - place_left(self.times, SHORTEST))

    def swung_foot(
        self, side: int, flight: Flight, base: FootPath, positions: FloatArray, rotations: FloatArray
    ) -> FootPath:
        """In the air it goes as the joints of its leg do, of a body that is led: from its ``base``, and back there."""
        if flight.height > 0.0:
            return base
        layout, free = self.standing.morphology.layout, flight.free(self.times, self.rate)[:, None]
        segment = layout.spine_count + 12 + 4 * side
        feet, toes = (
            turned(free * _ways(part, rotations[self.first :, segment + off]), part)
            for off, part in enumerate((base.feet, base.toes))
        )
        ankles = base.ankles + free * (positions[self.first :, layout.ankle(side)] - base.ankles)
        return FootPath(ankles, feet, toes)

    def above_ground(self, side: int, foot: FootPath, states: NDArray[np.int64]) -> FootPath:
        """No deeper in the ground than the motion has it by itself."""
        measures, ground = sole_rows(self.standing.morphology, side), self.standing.ground
        measures = measures if len(measures) == 1 else measures[self.first :]
        own = depths_of(self.feet[side].own, measures, ground)
        deeper = np.maximum(depths_of(foot, measures, ground) - own, 0.0)
        return out_of_ground(foot, measures, seen_coming(deeper, states != 0, self.rate))

    def lead_body(self, goes: FloatArray, positions: FloatArray, rotations: FloatArray) -> slice:
        """Root by ``goes`` (F, 3), and it and all joints by what is left of where they were, in place.

        Legs are put on their ankles later. The frames are given back in which joints are led.
        """
        layout = self.standing.morphology.layout
        parents, proximal = layout.parent_segments(), layout.proximal_points()
        gaps = self.seen.positions[:, 0] - self.own.positions[:, 0] - goes[0]
        goes = goes + self.left(gaps, self.root_peak, self.leg, self.root_seconds)
        near = slice(self.first, self.first + int(np.searchsorted(self.times, self.seconds, "right")) + 1)
        led = _Led(positions[near].copy(), rotations[near].copy(), positions[near], rotations[near])
        count = len(led.places)
        led.places[:, 0] += goes[:count]
        seconds = np.zeros(len(self.peaks))  # a leg in the air has until it lands
        for legs, flight in zip(self.leg_segments, self.flights, strict=True):
            seconds[legs] = 0.0 if flight.held else flight.seconds
        for segment in range(len(self.peaks)):
            left = self.left(self.turns[:, segment], float(self.peaks[segment]), 1.0, seconds[segment])[:count]
            if segment == 0:
                led.turns[:, 0] = turned(left, led.old_turns[:, 0])
                continue
            carrier = parents[segment]
            led.carry(proximal[segment], carrier, proximal[carrier])
            local = np.swapaxes(led.old_turns[:, carrier], 1, 2) @ led.old_turns[:, segment]
            led.turns[:, segment] = led.turns[:, carrier] @ turned(left, local)
        hands = [(layout.wrist(side) + 1, layout.spine_count + 5 + 4 * side) for side in range(2)]
        toes = [(layout.ankle(side) + 2, layout.spine_count + 13 + 4 * side) for side in range(2)]
        for end, segment in ((layout.head_end, layout.spine_count + 1), *hands, *toes):
            led.carry(end, segment, proximal[segment])
        positions[near.stop :] += goes[count:, None]
        return near


@dataclass(frozen=True, eq=False)
class _Led:
    """Frames of a body as they were, and as they are led, which are written."""

    old_places: FloatArray
    old_turns: FloatArray
    places: FloatArray
    turns: FloatArray

    def carry(self, point: int, segment: int, origin: int) -> None:
        """A point goes with the segment that carries it and turns about ``origin``."""
        arm = self.old_places[:, point] - self.old_places[:, origin]
        turn = self.turns[:, segment] @ np.swapaxes(self.old_turns[:, segment], 1, 2)
        self.places[:, point] = self.places[:, origin] + (turn @ arm[:, :, None])[:, :, 0]


def _turned_back(now: FloatArray, then: FloatArray) -> FloatArray:
    """(2, ..., 3, 3) turns two frames and one frame before ``now``, after which they are ``then`` in one."""
    back = now @ np.swapaxes(then, -1, -2)
    return np.stack([back @ back @ now, back @ now])


def _in_carriers(rotations: FloatArray, carriers: NDArray[np.int64]) -> FloatArray:
    """(N, S, 3, 3) segments in the axes of their carriers, the pelvis in the world's."""
    local = rotations[:].copy()
    local[:, 1:] = np.swapaxes(rotations[:, carriers[1:]], 2, 3) @ rotations[:, 1:]
    return np.asarray(local)


def _ways(own: FloatArray, led: FloatArray) -> FloatArray:
    """(F, ..., 3) rotation vectors from ``own`` (F, ..., 3, 3) to ``led``: from the last frame backwards they go on,
    where the shorter way would change.
    """
    turns = sign_continuous(from_matrix(led @ np.swapaxes(own, -1, -2))[::-1])[::-1]
    return rotation_vectors(turns * np.where(turns[-1, ..., 3:] < 0.0, -1.0, 1.0))
