"""A motion on one body and on the ground, before any constraint: scaled, on its feet, out of its own way."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval, on_ground
from studio.core.grounds.ground import Ground
from studio.core.kernels import records
from studio.core.kernels.solve_clip import place_frames
from studio.core.kernels.support.body_settling import place_arms
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.kernels.time.acceleration_peaks import segment_peaks
from studio.core.mesh.volume import BodyVolume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize
from studio.core.runs import runs_in
from studio.core.single import PoseArray, single
from studio.core.solver.asking.self_contact import LOOKS, SelfContact, hands_standing, self_contact_of
from studio.core.solver.request import AdaptRequest, Unasked
from studio.core.solver.standing.carrying import Hold, find_carrying, limb_freedom
from studio.core.solver.standing.flights import leaps
from studio.core.solver.standing.footing import Footing, find_footing
from studio.core.solver.standing.led import Stance, led_from
from studio.core.solver.standing.raised_arms import raise_arms
from studio.core.solver.standing.row import joined, parts_of, windows_in
from studio.core.solver.standing.settling import Arms, settle
from studio.core.solver.standing.shown_floor import shown_floor

FloatArray = NDArray[np.float64]

AROUND = 1.0
"""Seconds around frames whose poses have to do with what is solved in them, as a balance's support has."""


@dataclass(frozen=True, eq=False)
class Standing:
    """A motion on one body and on the ground, before any constraint: what a dragged constraint need not ask again."""

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...]
    ground: Ground
    footing: Footing
    holds: tuple[Hold, ...]
    arms: Arms | None
    positions: PoseArray
    rotations: PoseArray
    volume: BodyVolume | None = None
    actor: Morphology | None = None
    limited: bool = True
    self_contact: SelfContact | None = None

    @property
    def unasked(self) -> Unasked:
        """Its poses."""
        return Unasked(self.positions, self.rotations)

    def kept(self) -> "Standing":
        """The same with its poses in half the memory, see ``core.single``."""
        footing = replace(self.footing, feet=single(self.footing.feet), toes=single(self.footing.toes))
        return replace(self, footing=footing, positions=single(self.positions), rotations=single(self.rotations))

    def with_arms_right(self, windows: Sequence[slice]) -> "Standing":
        """The same with hands where they touch and arms out of the body, in place, in some ``windows`` at least.

        There, and a second around, it is as with all frames in one window. It comes before ``kept``.
        """
        contact, motion = self.self_contact, self.motion
        if contact is None:
            return self
        wanted = np.zeros(motion.frame_count, dtype=np.bool_)
        for window in windows:
            wanted[contact.around(contact.around(self.around(window, AROUND)), LOOKS)] = True
        free = 1.0 - hands_standing(self.contacts, motion.frame_count, motion.frame_rate)
        positions, rotations = np.asarray(self.positions), np.asarray(self.rotations)
        for run in runs_in(slice(0, motion.frame_count), wanted, 1):
            contact.close(run, free[run], positions[run], rotations[run], LOOKS)
        raise_arms(self.morphology, self.ground, self.arms, motion.frame_rate, positions, rotations)
        return self

    def around(self, window: slice, seconds: float) -> slice:
        """``window`` and ``seconds`` on either side, as far as there are frames."""
        frames = math.ceil(seconds * self.motion.frame_rate)
        return slice(max(window.start - frames, 0), min(window.stop + frames, self.motion.frame_count))

    @cached_property
    def limb_freedoms(self) -> FloatArray:
        """(4, F) how free of its contacts each limb is."""
        count, rate = self.motion.frame_count, self.motion.frame_rate
        return np.array([limb_freedom(self.contacts, limb, count, rate) for limb in range(4)])

    @cached_property
    def peaks(self) -> FloatArray:
        """(S,) radians a second squared: the greatest angular acceleration of each segment in its carrier."""
        carriers = np.array(self.morphology.layout.parent_segments())
        peaks = np.empty((len(carriers), 2))
        segment_peaks(carriers, self.rotations[:], self.motion.frame_rate, peaks)
        return peaks[:, 1]

    @cached_property
    def root_peak(self) -> float:
        """The same of a bone that the root's travel turns (``kernels.time.acceleration_peaks``)."""
        pushes = np.linalg.norm(np.diff(self.positions[:, 0], 2, axis=0), axis=1)
        return float(pushes.max(initial=0.0)) * self.motion.frame_rate**2 / RADIAN_LENGTH


def standing_of(request: AdaptRequest, windows: Sequence[slice] | None = None) -> Standing:
    """How the motion of ``request`` stands before its constraints; its arms right in some ``windows`` at least, all by
    default: that takes most of the time.

    Where one clip takes over from another, each stands by itself, led on from where the one before it left the body.
    """
    motion, parts = request.motion, list[Standing]()
    known = motion, request.morphology, request.contacts, request.volume, request.actor, request.clears
    self_contact = self_contact_of(*known)
    for frames, part in parts_of(request):
        own = self_contact and self_contact.part(frames)
        alone = replace(_stand_alone(part), self_contact=own)
        alone.with_arms_right(windows_in(frames, motion.frame_count, windows))
        change = motion.changes[len(parts) - 1] if parts else None
        if change and not change.cut:
            alone = led_from(alone, 0, Stance.last_of(parts[-1]), change.seconds)
        parts.append(alone)
    whole = joined(request, parts)
    if self_contact is None or len(parts) == 1:
        return whole
    return replace(whole, self_contact=self_contact.as_in([each.self_contact for each in parts if each.self_contact]))


def stand(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    volume: BodyVolume | None = None,
    actor: Morphology | None = None,
    limited: bool = True,
    clears: bool = False,
) -> Standing:
    """Scale a motion to a body and set it on the ground: feet, and what else carries it (K05 sections 6 and 7).

    What its hands touch they touch here; where it ``clears``, its arms stay out of it (``solver.self_contact``).
    """
    known = motion, morphology, tuple(contacts)
    return standing_of(AdaptRequest(*known, (), ground, {}, volume, actor, limited, False, clears))


def _stand_alone(request: AdaptRequest) -> Standing:
    """A motion without changes as it stands, but for its arms."""
    motion, morphology, contacts, ground = request.motion, request.morphology, request.contacts, request.ground
    volume, actor, limited = request.volume, request.actor, request.limited
    positions, rotations = realize(motion, morphology)
    contacts = on_ground(contacts)
    ground = ground.felt_at(positions)
    positions[:, :, 2] += (ground.height - shown_floor(contacts, positions, morphology, motion.frame_rate))[:, None]
    positions[:, :, 2] += leaps(contacts, morphology, ground.height, positions)[:, None]
    carrying = find_carrying(motion, morphology, contacts, ground, positions, rotations, actor)
    upright, share = (positions, rotations), None if carrying is None else carrying.feet_share
    if carrying is not None:
        positions += carrying.shift[:, None]
        if not ground.is_level:  # feet keep their heights above it
            upright = carrying.upright + carrying.shift[:, None] * [1.0, 1.0, 0.0], rotations
            positions, rotations = carrying.pose[0] + carrying.shift[:, None], carrying.pose[1]
    footing = find_footing(motion, morphology, contacts, ground, positions, rotations, share, upright)
    arms: Arms | None = None
    holds: tuple[Hold, ...] = ()
    if carrying is not None:
        footing, arms, holds = settle(carrying, footing, motion, morphology, ground, positions, rotations)
    measures = morphology.rows
    place_frames(measures, footing.drops, footing.legs(motion), positions, rotations)
    if arms is not None:
        stance = records.ArmTargets(motion.channels, arms.soft_thresholds, arms.wrists, arms.hands, arms.bends)
        place_arms(measures, stance, positions, rotations)
    raise_arms(morphology, ground, arms, motion.frame_rate, positions, rotations)
    known = contacts, ground
    return Standing(motion, morphology, *known, footing, holds, arms, positions, rotations, volume, actor, limited)
