"""Grounding of a motion before any constraint: scaled to one body, with feet on the ground and arms out of the body."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval, ground_contacts
from studio.core.compact_array import CompactArray, PoseArray, compact_array
from studio.core.grounds.ground import Ground
from studio.core.kernels import records
from studio.core.kernels.solve_clip import place_frames
from studio.core.kernels.support.body_settling import place_arms
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.kernels.time.acceleration_peaks import segment_peaks
from studio.core.mesh.volume import BodyVolume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.runs import runs_in
from studio.core.solver.grounding.body_support import GroundContact, find_support, limb_freedom
from studio.core.solver.grounding.captured_floor import captured_floor
from studio.core.solver.grounding.contact_settling import ArmStance, settle_on_contacts
from studio.core.solver.grounding.flight_height import flight_heights
from studio.core.solver.grounding.footing import Footing, find_footing
from studio.core.solver.grounding.inertialisation import Stance, inertialised_motion
from studio.core.solver.grounding.raised_arms import raise_arms
from studio.core.solver.grounding.row_parts import join_parts, parts_of, windows_in
from studio.core.solver.request import AdaptRequest, UnconstrainedPoses
from studio.core.solver.task_assembly.self_contact import (
    PUSH_OUT_ROUNDS,
    SelfContact,
    self_contact_of,
    standing_hand_weights,
)

FloatArray = NDArray[np.float64]

PEAK_CHUNK_FRAMES = 4096
"""Number of frames whose accelerations are computed at a time."""
CONTEXT_SECONDS = 1.0
"""Seconds around a frame whose poses affect its solution, for example by a balance's support polygon."""


@dataclass(frozen=True, eq=False)
class GroundedMotion:
    """Grounded motion on one body. It does not depend on constraints, so that these can be dragged quickly."""

    motion: NormalizedMotion
    morphology: AnyMorphology
    contacts: tuple[ContactInterval, ...]
    ground: Ground
    footing: Footing
    """Leg targets."""
    holds: tuple[GroundContact, ...]
    """Contacts of hands, knees and seat."""
    arms: ArmStance | None
    """Targets of arms in contact, if any."""
    positions: PoseArray
    """(F, P, 3) metres."""
    rotations: PoseArray
    """(F, S, 3, 3) in the world."""
    volume: BodyVolume | None = None
    actor: Morphology | None = None
    limited: bool = True
    """True if limb joints stay within human range."""
    self_contact: SelfContact | None = None

    @property
    def unconstrained(self) -> UnconstrainedPoses:
        """Poses before constraints, those of this motion."""
        return UnconstrainedPoses(self.positions, self.rotations)

    def kept(self, store: Callable[[PoseArray], CompactArray] = compact_array) -> "GroundedMotion":
        """Copy with poses in half the memory (``core.compact_array``); ``store`` compresses an array and chooses its
        place.
        """
        footing = replace(self.footing, feet=store(self.footing.feet), toes=store(self.footing.toes))
        return replace(self, footing=footing, positions=store(self.positions), rotations=store(self.rotations))

    def with_arms_right(self, windows: Sequence[slice]) -> "GroundedMotion":
        """Solve self-contacts in at least the frames of ``windows``, in place, and return this motion.

        In the windows, and a second around, the result equals that of solving all frames. To be called before ``kept``.
        """
        contact, motion = self.self_contact, self.motion
        if contact is None:
            return self
        target = np.zeros(motion.frame_count, dtype=np.bool_)
        for window in windows:
            target[
                contact.affecting_frames(
                    contact.affecting_frames(self.around(window, CONTEXT_SECONDS)), PUSH_OUT_ROUNDS
                )
            ] = True
        free = 1.0 - standing_hand_weights(self.contacts, motion.frame_count, motion.frame_rate)
        positions, rotations = np.asarray(self.positions), np.asarray(self.rotations)
        for run in runs_in(slice(0, motion.frame_count), target, 1):
            contact.close_contacts(run, free[run], positions[run], rotations[run])
        raise_arms(self.morphology, self.ground, self.arms, motion.frame_rate, positions, rotations)
        return self

    def around(self, window: slice, seconds: float) -> slice:
        """``window`` extended by ``seconds`` on either side, within the motion."""
        frames = math.ceil(seconds * self.motion.frame_rate)
        return slice(max(window.start - frames, 0), min(window.stop + frames, self.motion.frame_count))

    @cached_property
    def limb_freedoms(self) -> FloatArray:
        """Release weights (4, F) of the limbs from their contacts: 0 in contact."""
        count, rate = self.motion.frame_count, self.motion.frame_rate
        return np.array([limb_freedom(self.contacts, limb, count, rate) for limb in range(4)])

    @cached_property
    def peak_angular_accelerations(self) -> FloatArray:
        """Greatest angular acceleration (S,) of each segment in its parent over all frames, rad/s2."""
        parents = np.array(self.morphology.layout.parent_segments())
        greatest, peaks = np.zeros(len(parents)), np.empty((len(parents), 2))
        for first in range(
            0, max(self.motion.frame_count - 2, 1), PEAK_CHUNK_FRAMES
        ):  # all rotations of a long take are large
            segment_peaks(parents, self.rotations[first : first + PEAK_CHUNK_FRAMES + 2], self.motion.frame_rate, peaks)
            greatest = np.maximum(greatest, peaks[:, 1])
        return greatest

    @cached_property
    def root_peak(self) -> float:
        """Greatest angular acceleration in rad/s2 of a bone that follows the root's displacement."""
        pushes = np.linalg.norm(np.diff(self.positions[:, 0], 2, axis=0), axis=1)
        return float(pushes.max(initial=0.0)) * self.motion.frame_rate**2 / RADIAN_LENGTH


def grounded_motion_of(request: AdaptRequest, windows: Sequence[slice] | None = None) -> GroundedMotion:
    """Grounded motion of ``request`` before its constraints.

    Clips are grounded separately, and inertialised at their transitions. Self-contacts, the most expensive part, are
    solved at least in ``windows``, by default everywhere.
    """
    motion, parts = request.motion, list[GroundedMotion]()
    self_contact = self_contact_of(
        motion, request.morphology, request.contacts, request.volume, request.actor, request.clears
    )
    for frames, part in parts_of(request):
        own = self_contact and self_contact.in_frames(frames)
        alone = replace(_stand_alone(part), self_contact=own)
        alone.with_arms_right(windows_in(frames, motion.frame_count, windows))
        change = motion.changes[len(parts) - 1] if parts else None
        if change and not change.cut:
            alone = inertialised_motion(alone, 0, Stance.last_of(parts[-1]), change.seconds, change.planned)
        parts.append(alone)
    whole = join_parts(request, parts)
    if self_contact is None or len(parts) == 1:
        return whole
    return replace(
        whole, self_contact=self_contact.joined_from_parts([each.self_contact for each in parts if each.self_contact])
    )


def ground_motion(
    motion: NormalizedMotion,
    morphology: AnyMorphology,
    contacts: Sequence[ContactInterval],
    ground: Ground,
    volume: BodyVolume | None = None,
    actor: Morphology | None = None,
    limited: bool = True,
    clears: bool = False,
) -> GroundedMotion:
    """Grounded motion of a motion on a body: with feet and all other contacts on the ground (K05 sections 6 and 7).

    Hands touch what the actor's touch; with ``clears`` arms stay out of the body
    (``solver.task_assembly.self_contact``).
    """
    known = motion, morphology, tuple(contacts)
    return grounded_motion_of(AdaptRequest(*known, (), ground, {}, volume, actor, limited, False, clears))


def _stand_alone(request: AdaptRequest) -> GroundedMotion:
    """Grounded motion of a request without transitions, before its self-contacts are solved."""
    motion, morphology, contacts, ground = request.motion, request.morphology, request.contacts, request.ground
    volume, actor, limited = request.volume, request.actor, request.limited
    positions, rotations = realize_motion(motion, morphology)
    contacts = ground_contacts(contacts)
    ground = ground.felt_at(positions)
    positions[:, :, 2] += (ground.height - captured_floor(contacts, positions, morphology, motion.frame_rate))[:, None]
    positions[:, :, 2] += flight_heights(contacts, morphology, ground.height, positions)[:, None]
    carrying = find_support(motion, morphology, contacts, ground, positions, rotations, actor)
    upright, fraction = (positions, rotations), None if carrying is None else carrying.feet_fraction
    if carrying is not None:
        positions += carrying.shift[:, None]
        if not ground.is_level:  # feet keep their heights above it
            upright = carrying.upright + carrying.shift[:, None] * [1.0, 1.0, 0.0], rotations
            positions, rotations = carrying.pose[0] + carrying.shift[:, None], carrying.pose[1]
    footing = find_footing(motion, morphology, contacts, ground, positions, rotations, fraction, upright)
    arms: ArmStance | None = None
    holds: tuple[GroundContact, ...] = ()
    if carrying is not None:
        footing, arms, holds = settle_on_contacts(carrying, footing, motion, morphology, ground, positions, rotations)
    measures = morphology.rows
    place_frames(measures, footing.drops, footing.legs(motion), positions, rotations)
    if arms is not None:
        stance = records.ArmTargets(motion.channels, arms.soft_thresholds, arms.wrists, arms.hands, arms.bends)
        place_arms(measures, stance, positions, rotations)
    raise_arms(morphology, ground, arms, motion.frame_rate, positions, rotations)
    return GroundedMotion(
        motion=motion,
        morphology=morphology,
        contacts=contacts,
        ground=ground,
        footing=footing,
        holds=holds,
        arms=arms,
        positions=positions,
        rotations=rotations,
        volume=volume,
        actor=actor,
        limited=limited,
    )
