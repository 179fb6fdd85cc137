"""Self-contact of arms: hands that touch keep their contact, and arms stay out of the rest of the body.

Both are solved on the grounded body. During the search hands keep their contacts (``kernels.limbs.touching_arms``), and
arms are pushed out of the solved body again. A hand with constraints or ground contact is left alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d, maximum_filter1d

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval, Touch, contact_mask
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.limits import arm_clearance as clearing
from studio.core.kernels.limits.arm_clearance import ARM_STEP_SIZE, ELBOW_SWIVEL, HAND_ROTATION
from studio.core.kernels.limits.hand_contact import (
    SPOT_WEIGHT,
    apply_arm_steps,
    push_out_steps,
    solve_hand_body_contact,
    solve_hand_hand_contact,
)
from studio.core.kernels.records import HAND_CONTACT, ActorClearance
from studio.core.mesh.volume import PART_CAPSULES, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.touching import PalmPositions, palm_positions
from studio.core.project_cache import project_cache
from studio.core.runs import runs_of
from studio.core.solver.grounding.body_support import limb_freedom
from studio.core.solver.grounding.contact_blending import (
    RELEASE_SECONDS,
    SLOW_RELEASE_SECONDS,
    hann_window,
    release_weight,
    smoothstep_array,
)
from studio.core.solver.task_assembly.clearance import actor_clearances, clearances_of, packed_volume, rest_clearances

FloatArray = NDArray[np.float64]

PUSH_OUT_FADE_SECONDS = RELEASE_SECONDS
"""Seconds before and after a push of an arm out of its body over which it is spread."""
MAX_WRIST_PUSH = 0.4
"""Greatest displacement of a wrist by a push, in arm lengths, approached softly: farther away it would be in the body
elsewhere.
"""
PUSH_OUT_ROUNDS = 3
"""Rounds of pushing arms out of a grounded body: smoothing in time may move them in elsewhere."""
TOUCH_FADE_DEPTH = 0.01
"""Range of the actor's depth in metres over which a hand that penetrates, or leaves, the actor begins to do so on the
adapted body.
"""


@dataclass(frozen=True, eq=False)
class HandBodyContact:
    """Contact of one hand with its body."""

    side: int
    """0 for the left hand, 1 for the right."""
    capsules: NDArray[np.int64]
    """(M,) indices of the touched capsules of the body."""
    firm: FloatArray
    """(F,) weight of the contact, 0 to 1."""
    palm_positions: FloatArray
    """(F, M, 6) contact points on the capsules, in the columns of ``kernels.limits.hand_contact``."""


@dataclass(frozen=True, eq=False)
class HandContacts:
    """Contacts of an actor's hands in every frame."""

    gaps: FloatArray
    """(F, 3) vector from the left wrist to the right, metres."""
    together: FloatArray
    """(F,) weight of hands that touch."""
    held: FloatArray
    """(F,) weight of hands on one object."""
    resting: tuple[HandBodyContact, ...]
    """Contacts with the body."""


@dataclass(frozen=True, eq=False)
class SelfContact:
    """Self-contact of one adapted body: contacts of its hands, and clearance of its arms."""

    body: AnyMorphology
    frame_rate: float
    volume: BodyVolume
    gaps: FloatArray
    """(F, 3) required vector from the left wrist to the right, metres."""
    firm: FloatArray
    """(F,) weight of hands that touch each other or hold one object."""
    resting: tuple[HandBodyContact, ...]
    """Contacts of hands with the body."""
    clearances: tuple[FloatArray, FloatArray, FloatArray] | None
    """Required signed distances (F, 2, 5), those of the actor, and outward directions (F, 2, 5, 3) of the actor's body;
    None where arms may penetrate.
    """

    def inertialised(self, fractions: FloatArray, positions: FloatArray, rotations: FloatArray) -> "SelfContact":
        """Copy for posed frames (F, P, 3), (F, S, 3, 3) of an inertialised transition; ``fractions`` (F,) rise from 0
        to 1 during it.

        Weights of contacts are multiplied by the fractions, and required distances are at most those of these poses.
        """
        resting, clearances, led = (
            tuple(replace(each, firm=fractions * each.firm) for each in self.resting),
            self.clearances,
            fractions < 1.0,
        )
        if clearances is not None:
            target = clearances[0].copy()
            there, _ = clearances_of(self.body, self.volume, positions[led], rotations[led])
            target[led] = np.minimum(target[led], there)
            clearances = target, *clearances[1:]
        return replace(self, firm=fractions * self.firm, resting=resting, clearances=clearances)

    @property
    def has_contacts(self) -> bool:
        """True if a hand touches the other hand or the body in any frame."""
        return bool(self.firm.any() or any(firm.any() for firm in self._rests))

    @property
    def without_touches(self) -> "SelfContact":
        """Copy without contacts of hands: arms only stay out of the body."""
        return replace(self, firm=np.zeros_like(self.firm), resting=())

    def in_frames(self, frames: slice) -> "SelfContact":
        """Copy for the frames of a slice."""
        return replace(
            self,
            gaps=self.gaps[frames],
            firm=self.firm[frames],
            resting=tuple(
                replace(each, firm=each.firm[frames], palm_positions=each.palm_positions[frames])
                for each in self.resting
            ),
            clearances=self.clearances
            and (self.clearances[0][frames], self.clearances[1][frames], self.clearances[2][frames]),
        )

    def joined_from_parts(self, parts: "Sequence[SelfContact]") -> "SelfContact":
        """Copy with the weights and required distances of ``parts``, one after the other in time."""
        firm, *rests = (
            np.concatenate(each) for each in zip(*((part.firm, *part._rests) for part in parts), strict=True)
        )
        resting = tuple(replace(each, firm=firm) for each, firm in zip(self.resting, rests, strict=True))
        target = [part.clearances[0] for part in parts if part.clearances]
        clearances = self.clearances and (np.concatenate(target), *self.clearances[1:])
        return replace(self, firm=firm, resting=resting, clearances=clearances)

    @property
    def _rests(self) -> list[FloatArray]:
        """Weights (F,) of each contact with the body."""
        return [each.firm for each in self.resting]

    def affecting_frames(self, window: slice, looks: int = 1) -> slice:
        """Frames that affect the arms of a ``window`` in ``looks`` rounds of smoothed pushes."""
        if self.clearances is None:
            return window
        reach = 2 * _fade_frames(self.frame_rate)
        near = self._wider(window, looks * reach)
        touches = self.firm[near].any() or any(each.firm[near].any() for each in self.resting)
        return self._wider(window, max(2 * looks - 1, 2) * reach) if touches else near  # they are looked at again

    def _wider(self, window: slice, frames: int) -> slice:
        """``window`` extended by ``frames`` on either side."""
        return slice(max(window.start - frames, 0), min(window.stop + frames, len(self.firm)))

    def correction_weights(self, acts: NDArray[np.bool_]) -> FloatArray:
        """Weights (F,) by which arms are corrected again in frames where constraints act (F,).

        They are zero at the ends of a run of such frames, so that frames beside a run stay as grounded. A run that is
        too short for both fades has shorter ones.
        """
        weights, fade = np.zeros(len(acts)), 2 * _fade_frames(self.frame_rate)
        for first, past in runs_of(acts):
            frames, fades = np.arange(first, past), min(fade, (past - first + 1) / 2)
            since = np.where(first == 0, fades, frames - first + 1)
            until = np.where(past == len(acts), fades, past - frames)
            weights[first:past] = smoothstep_array(np.minimum(np.minimum(since, until) / fades, 1.0))
        return weights

    def close_contacts(self, window: slice, free: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Correct the arms of grounded frames of a ``window``, (F, P, 3) and (F, S, 3, 3), in place: hands touch, and
        arms stay out of the body.

        ``free`` (F, 2, 2) are the weights of wrist and elbow of each arm. Frames are final if all frames that affect
        them (``affecting_frames`` with ``PUSH_OUT_ROUNDS``) are in the window.
        """
        volume, proximal = packed_volume(self.volume), np.array(self.body.layout.proximal_points())
        firm, lying = self.firm[window], self._lying(window)
        led = np.ones(len(firm), dtype=np.bool_)
        for _ in range(PUSH_OUT_ROUNDS):
            led = self._clear(window, free, lying, 0.0 * firm, led, positions, rotations)
        for each in self.resting:
            solve_hand_body_contact(
                each.side,
                each.capsules,
                each.palm_positions[window],
                each.firm[window] * free[:, each.side, 0],
                volume,
                proximal,
                positions,
                rotations,
            )
        wrists = free[:, :, 0]
        displacements = wrists / np.maximum(wrists.sum(axis=1), 1e-6)[:, None]
        whole = firm * (1.0 - (1.0 - wrists).prod(axis=1))
        self._solve_hand_contacts(window, whole[:, None] * displacements, positions, rotations)
        touches = (lying > 0.0).any(axis=1) | (firm > 0.0)
        for _ in range(PUSH_OUT_ROUNDS - 1 if touches.any() else 0):
            touches &= self._clear(window, free, lying, firm, touches, positions, rotations)
        parted = (firm**3 * whole)[:, None] * displacements  # coming out may part them
        self._solve_hand_contacts(window, parted, positions, rotations)

    def push_out(self, window: slice, free: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Push the arms of solved frames of a ``window`` out of the body, in place; hands stay in contact.

        ``free`` (F, 2, 2) are the weights of wrist and elbow of each arm.
        """
        all_frames = np.ones(len(positions), dtype=np.bool_)
        self._clear(window, free, self._lying(window), self.firm[window], all_frames, positions, rotations)

    def hand_contacts(self, window: slice) -> NDArray[np.void]:
        """Records ``HAND_CONTACT`` (2, F) of both hands in the frames of a ``window``."""
        found = np.zeros((2, len(self.firm[window])), HAND_CONTACT)
        found["together"] = self.firm[window]
        for each in self.resting:
            firm, carrier = each.firm[window], self.volume.segments[each.capsules, 0]
            under = carrier[(each.firm[:, None] * each.palm_positions[:, :, SPOT_WEIGHT]).sum(axis=0).argmax()]
            row = found[each.side]
            row["segment"], row["origin"] = (
                np.where(firm > row["resting"], now, was)
                for now, was in ((under, row["segment"]), (self.body.layout.proximal_points()[under], row["origin"]))
            )
            row["resting"] = np.maximum(row["resting"], firm)
        return found

    def _lying(self, window: slice) -> FloatArray:
        """Weights (F, 2) of each hand's contact with the body."""
        lying = np.zeros((len(self.firm[window]), 2))
        for each in self.resting:
            lying[:, each.side] = np.maximum(lying[:, each.side], each.firm[window])
        return lying

    def _solve_hand_contacts(
        self, window: slice, fractions: FloatArray, positions: FloatArray, rotations: FloatArray
    ) -> None:
        """Bring hands into contact with each other, in place; ``fractions`` (F, 2) are the parts of both arms."""
        if fractions.any():
            solve_hand_hand_contact(self.gaps[window], fractions, positions, rotations)

    def _clear(
        self,
        window: slice,
        free: FloatArray,
        lying: FloatArray,
        firm: FloatArray,
        looked: NDArray[np.bool_],
        positions: FloatArray,
        rotations: FloatArray,
    ) -> NDArray[np.bool_]:
        """Push arms, by their weights ``free`` (F, 2, 2), out of the body in the frames ``looked`` (F,), in place; True
        where they moved.

        Hands ``lying`` (F, 2) on the body may touch it; hands together (``firm`` (F,)) move together.
        """
        if self.clearances is None:
            return np.zeros_like(looked)
        proximal = np.array(self.body.layout.proximal_points())
        target, own, displacements = (each[window] for each in self.clearances)
        target = target - lying[:, :, None] * np.maximum(target, 0.0) if lying.any() else target
        moves = np.empty((len(positions), 2, ARM_STEP_SIZE))
        able = free * looked[:, None, None]
        actor = ActorClearance(packed_volume(self.volume), own, displacements)
        push_out_steps(target, actor, able, proximal, positions, rotations, moves)
        if not moves.any():
            return np.zeros_like(looked)
        self._ease(moves, free, firm, rotations[:, self.body.layout.spine_count - 1])
        apply_arm_steps(moves, positions, rotations)
        return np.asarray(moves.any(axis=(1, 2)))

    def _ease(self, moves: FloatArray, free: FloatArray, firm: FloatArray, chest: FloatArray) -> None:
        """Smooth arm steps ``moves`` (F, 2, 7) in time, in place, in the axes of the ``chest`` (F, 3, 3).

        Hands together (``firm`` (F,)) move alike, and do not rotate.
        """
        vectors = moves[:, :, :ELBOW_SWIVEL].reshape(len(moves), 4, 3)
        out = np.einsum("fij,fvi->fvj", chest, vectors)
        wrists = out[:, ::2]
        lengths = np.linalg.norm(wrists, axis=2, keepdims=True)
        both = (lengths * wrists).sum(axis=1, keepdims=True) / np.maximum(lengths.sum(axis=1, keepdims=True), 1e-9)
        wrists += firm[:, None, None] * (both - wrists)
        least = free[:, :, 0].min(axis=1, keepdims=True)
        able = (free[:, :, 0] + firm[:, None] * (least - free[:, :, 0]))[:, :, None]
        eased = np.einsum("fij,fvj->fvi", chest, smoothed_steps(out, self.frame_rate)).reshape(
            len(moves), 2, ELBOW_SWIVEL
        )
        farthest = MAX_WRIST_PUSH * self.body.rows[:, measure.ARM : measure.ARM + 2].sum(axis=1).max()
        far = np.linalg.norm(eased[:, :, :HAND_ROTATION], axis=2, keepdims=True) / farthest
        moves[:, :, :HAND_ROTATION] = able * eased[:, :, :HAND_ROTATION] / (1.0 + far**4) ** 0.25
        moves[:, :, HAND_ROTATION:ELBOW_SWIVEL] = able * (1.0 - firm)[:, None, None] * eased[:, :, HAND_ROTATION:]
        moves[:, :, ELBOW_SWIVEL:] = smoothed_steps(moves[:, :, ELBOW_SWIVEL:], self.frame_rate) * free[:, :, 1:]


def _fade_frames(frame_rate: float) -> int:
    """``PUSH_OUT_FADE_SECONDS`` in frames. ``smoothed_steps`` uses twice as many on either side."""
    return max(1, round(PUSH_OUT_FADE_SECONDS * frame_rate))


def smoothed_steps(displacements: FloatArray, frame_rate: float) -> FloatArray:
    """Steps (F, N, D) smoothed in time: each has the greatest length within ``PUSH_OUT_FADE_SECONDS``, and the mean
    direction.

    Opposite steps shorten each other: an arm that passes through the body in the source still does.
    """
    half, eased = _fade_frames(frame_rate), np.zeros_like(displacements)
    near, wide = hann_window(half), hann_window(2 * half)
    some = np.flatnonzero(displacements.any(axis=(1, 2)))
    if not len(some):
        return eased
    rows = slice(max(some[0] - 2 * half, 0), some[-1] + 2 * half + 1)
    displacements = displacements[rows]
    lengths = np.linalg.norm(displacements, axis=2)
    longest = convolve1d(maximum_filter1d(lengths, 2 * half + 1, axis=0, mode="nearest"), near, axis=0, mode="nearest")
    around = convolve1d(lengths, wide, axis=0, mode="nearest")[:, :, None]
    mean = convolve1d(displacements, wide, axis=0, mode="nearest")
    eased[rows] = longest[:, :, None] * np.divide(mean, around, out=np.zeros_like(mean), where=around > 1e-12)
    return eased


def self_contact_of(
    motion: NormalizedMotion,
    body: AnyMorphology,
    contacts: Sequence[ContactInterval],
    volume: BodyVolume | None,
    actor: Morphology | None,
    clears: bool,
) -> SelfContact | None:
    """``SelfContact`` of a motion on ``body``; None if it has neither contacts nor clearance, or if the actor is
    unknown.
    """
    touches = tuple(each for each in contacts if isinstance(each.point, Touch) and each.first < motion.frame_count)
    if actor is None or not (touches or clears):
        return None
    nothing, known = np.zeros(motion.frame_count), volume or usual_volume(body.first_frame_body)
    touching = (
        hand_contacts_of(motion, actor, touches) if touches else HandContacts(np.zeros((1, 3)), nothing, nothing, ())
    )
    clearances = None
    if clears:
        own, displacements = actor_clearances(motion, actor)
        target = np.empty_like(own)
        clearing.required_distances(own, 0.0, target)
        # What the actor has inside is left inside, and what the body itself has at rest.
        clearances = (
            np.minimum(np.minimum(target, own), rest_clearances(body.first_frame_body, known)),
            own,
            displacements,
        )
    arms = [rows[:, measure.ARM : measure.ARM + 4].sum(axis=1)[:, None] for rows in (body.rows, actor.rows)]
    scale = arms[0] / arms[1]
    both = np.maximum(touching.together, touching.held)
    sizes = scale + (1.0 - scale) * (touching.held * (1.0 - touching.together) / np.maximum(both, 1e-9))[:, None]
    return SelfContact(
        body, motion.frame_rate, known, np.ascontiguousarray(sizes * touching.gaps), both, touching.resting, clearances
    )


@project_cache(maxsize=8)
def hand_contacts_of(motion: NormalizedMotion, actor: Morphology, touches: tuple[ContactInterval, ...]) -> HandContacts:
    """``HandContacts`` of the intervals ``touches``, measured on the actor."""
    positions, rotations = realize_motion(motion, actor, play=True)
    layout, volume = actor.layout, usual_volume(actor)
    resting = []
    for each in touches:
        if not isinstance(each.point, Touch) or each.point.member not in PART_CAPSULES:
            continue
        members = PART_CAPSULES[each.point.member]
        near = [palm_positions(each.point.side, capsule, actor, volume, positions, rotations) for capsule in members]
        firm = _contact_weights((each,), motion)
        resting.append(HandBodyContact(each.point.side, np.array(members), firm, _contact_points(near, each)))
    return HandContacts(
        positions[:, layout.wrist_point(1)] - positions[:, layout.wrist_point(0)],
        _contact_weights([each for each in touches if each.point is Touch.HANDS_TOGETHER], motion),
        _contact_weights([each for each in touches if each.point is Touch.HANDS_ON_THING], motion),
        tuple(resting),
    )


def _contact_weights(touches: Sequence[ContactInterval], motion: NormalizedMotion) -> FloatArray:
    """Weights (F,) of contact intervals: 1 during them, fading before and after."""
    mask = contact_mask([(each.first, each.last) for each in touches], motion.frame_count)
    return (
        1.0 - release_weight(mask, motion.frame_rate, SLOW_RELEASE_SECONDS)
        if mask.any()
        else np.zeros(motion.frame_count)
    )


def _contact_points(near: Sequence[PalmPositions], contact: ContactInterval) -> FloatArray:
    """Contact points (F, M, 6) of a palm on M capsules for the kernel.

    A resting hand is put on the surface, however deep the actor's seems to penetrate.
    """
    clearances = np.stack([each.clearances for each in near], axis=1)
    least = clearances.min(axis=1)
    fractions = np.exp((least[:, None] - clearances) / clearing.SMOOTH_MINIMUM_WIDTH)
    fractions /= fractions.sum(axis=1, keepdims=True)
    above = clearances - np.median(least[contact.first : contact.last + 1])
    lifted = np.where(
        above >= TOUCH_FADE_DEPTH, above, np.maximum(above + TOUCH_FADE_DEPTH, 0.0) ** 2 / (4.0 * TOUCH_FADE_DEPTH)
    )
    along, displacements = (
        np.stack(each, axis=1)
        for each in ([one.fractions_along_axis for one in near], [one.directions for one in near])
    )
    told = fractions[:, :, None], along[:, :, None], displacements, lifted[:, :, None]
    return np.ascontiguousarray(np.concatenate(told, axis=2))


def arm_activations(tasks: NDArray[np.void], activations: FloatArray, body: AnyMorphology) -> FloatArray:
    """Activations (F, 2, 2) of ``tasks`` (C,) on wrist and elbow of each arm, from ``activations`` (C, F).

    A task on the hand alone leaves the elbow free.
    """
    asked = np.zeros((activations.shape[1], 2, 2))
    for side in range(2):
        of_arm, hand = tasks["limbs"] == side, tasks["points"] >= body.layout.wrist_point(side)
        asked[:, side, 0] = activations[of_arm.any(axis=1)].max(axis=0, initial=0.0)
        asked[:, side, 1] = activations[(of_arm & ~hand).any(axis=1)].max(axis=0, initial=0.0)
    return asked


def standing_hand_weights(contacts: Sequence[ContactInterval], frame_count: int, frame_rate: float) -> FloatArray:
    """Weights (F, 2, 2) of ground contacts on wrist and elbow of each arm; elbows have none."""
    free = [limb_freedom(contacts, side, frame_count, frame_rate) for side in range(2)]
    asked = np.zeros((frame_count, 2, 2))
    asked[:, :, 0] = 1.0 - np.stack(free, axis=1)
    return asked
