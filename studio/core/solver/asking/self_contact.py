"""What arms have to do with their own body: hands that touch stay where they touch, and arms stay out of the rest.

It has the first word, on the body as it stands, and the last, once constraints are solved: hands follow each other
then, and the body. Only a hand of which something is asked, or that stands on the ground, is left where it is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d, maximum_filter1d

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.captures.contacts import ContactInterval, Touch, contact_mask
from studio.core.captures.touching import Spots, spots
from studio.core.kernels import layout as at
from studio.core.kernels.limits import clearance as clearing
from studio.core.kernels.limits.clearance import HAND, STEP, SWIVEL
from studio.core.kernels.limits.hands import find_ways_out, join_hands, move_arms, rest_hands
from studio.core.kernels.records import ActorRooms
from studio.core.mesh.volume import CAPSULES_OF, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize
from studio.core.project_cache import project_cache
from studio.core.solver.asking.clearance import actor_rooms, packed, rest_rooms, rooms_of
from studio.core.solver.standing.blends import LET_GO, SLOWLY_LET_GO, freedom, hann_window
from studio.core.solver.standing.carrying import limb_freedom

FloatArray = NDArray[np.float64]

EASED = LET_GO
"""Seconds before and after for which an arm that has to come out of its body does so."""
FARTHEST = 0.4
"""Part of an arm's length to which the way of its wrist tends: farther away it would be in the body elsewhere."""
LOOKS = 3
"""Times that arms of a body that stands are brought out of it: what is eased in time may lead them in elsewhere."""
SKIN = 0.01
"""Metres over which a hand that sinks into the actor, or leaves it, does so on another body."""


@dataclass(frozen=True, eq=False)
class Resting:
    """A hand of a ``side`` on the ``capsules`` (M,) of its body: ``firm`` (F,) in [0, 1], ``spots`` (F, M, 6)."""

    side: int
    capsules: NDArray[np.int64]
    firm: FloatArray
    spots: FloatArray


@dataclass(frozen=True, eq=False)
class Touching:
    """What the hands of a motion's actor touch and hold, in every frame.

    ``gaps`` (F, 3) metres from the left wrist to the right; ``together`` and ``held`` (F,) how firmly hands are so, and
    hold a thing.
    """

    gaps: FloatArray
    together: FloatArray
    held: FloatArray
    resting: tuple[Resting, ...]


@dataclass(frozen=True, eq=False)
class SelfContact:
    """The same on one body: ``gaps`` (F, 3) and how ``firm`` (F,) hands keep them, None where they never do.

    ``rooms`` are (F, 2, 5) that probes are to have, the actor's, and its ways out (F, 2, 5, 3); None where arms may go
    through their body.
    """

    body: AnyMorphology
    frame_rate: float
    volume: BodyVolume
    gaps: FloatArray
    firm: FloatArray
    resting: tuple[Resting, ...]
    rooms: tuple[FloatArray, FloatArray, FloatArray] | None

    def led(self, shares: FloatArray, positions: FloatArray, rotations: FloatArray) -> "SelfContact":
        """The same on posed frames (F, P, 3), (F, S, 3, 3) that lie as by themselves by ``shares`` (F,) only.

        Hands touch by as much of how they do, and arms have no more room than they are led with.
        """
        resting, rooms, led = (
            tuple(replace(each, firm=shares * each.firm) for each in self.resting),
            self.rooms,
            shares < 1.0,
        )
        if rooms is not None:
            wanted = rooms[0].copy()
            there, _ = rooms_of(self.body, self.volume, positions[led], rotations[led])
            wanted[led] = np.minimum(wanted[led], there)
            rooms = wanted, *rooms[1:]
        return replace(self, firm=shares * self.firm, resting=resting, rooms=rooms)

    def part(self, frames: slice) -> "SelfContact":
        """The same in some frames, which are all there are then."""
        return replace(
            self,
            gaps=self.gaps[frames],
            firm=self.firm[frames],
            resting=tuple(replace(each, firm=each.firm[frames], spots=each.spots[frames]) for each in self.resting),
            rooms=self.rooms and (self.rooms[0][frames], self.rooms[1][frames], self.rooms[2][frames]),
        )

    def as_in(self, parts: "Sequence[SelfContact]") -> "SelfContact":
        """The same of hands that touch, and arms that have room, as in its ``parts``, one after the other."""
        firm, *rests = (
            np.concatenate(each) for each in zip(*((part.firm, *part._rests) for part in parts), strict=True)
        )
        resting = tuple(replace(each, firm=firm) for each, firm in zip(self.resting, rests, strict=True))
        wanted = [part.rooms[0] for part in parts if part.rooms]
        rooms = self.rooms and (np.concatenate(wanted), *self.rooms[1:])
        return replace(self, firm=firm, resting=resting, rooms=rooms)

    @property
    def _rests(self) -> list[FloatArray]:
        return [each.firm for each in self.resting]

    def around(self, window: slice, looks: int = 1) -> slice:
        """The frames that have to do with where the arms are in a ``window`` when they are put right in so many."""
        if self.rooms is None:
            return window
        reach = 2 * _eased_over(self.frame_rate)
        near = self._wider(window, looks * reach)
        touches = self.firm[near].any() or any(each.firm[near].any() for each in self.resting)
        return self._wider(window, max(2 * looks - 1, 2) * reach) if touches else near  # they are looked at again

    def _wider(self, window: slice, frames: int) -> slice:
        return slice(max(window.start - frames, 0), min(window.stop + frames, len(self.firm)))

    def beside(self, acts: FloatArray) -> FloatArray:
        """(F,) how far arms are put right again after what ``acts`` (F,) in [0, 1]: eased before and after that."""
        half = _eased_over(self.frame_rate)
        near = maximum_filter1d(acts, 2 * half + 1, mode="constant")
        return np.asarray(convolve1d(near, hann_window(half), mode="nearest"))

    def close(
        self, window: slice, free: FloatArray, positions: FloatArray, rotations: FloatArray, looks: int = 1
    ) -> None:
        """Put the arms of posed frames of a ``window`` (F, P, 3), (F, S, 3, 3) right, in place.

        ``free`` (F, 2, 2) how far the wrist, and the elbow, of each arm may be moved for it. Frames are right that
        have all that are ``around`` them, with as many ``looks``, in the window.
        """
        volume, proximal = packed(self.volume), np.array(self.body.layout.proximal_points())
        firm = self.firm[window]
        lying = np.zeros((len(positions), 2))
        for each in self.resting:
            lying[:, each.side] = np.maximum(lying[:, each.side], each.firm[window])
        led = np.ones(len(firm), dtype=np.bool_)
        for _ in range(looks):
            led = self._clear(window, free, lying, 0.0 * firm, led, positions, rotations)
        for each in self.resting:
            rest_hands(
                each.side, each.capsules, each.spots[window], each.firm[window] * free[:, each.side, 0], volume,
                proximal, positions, rotations,
            )  # fmt: skip
        wrists = free[:, :, 0]
        ways = wrists / np.maximum(wrists.sum(axis=1), 1e-6)[:, None]
        whole = firm * (1.0 - (1.0 - wrists).prod(axis=1))
        self._join(window, whole[:, None] * ways, positions, rotations)
        touches = (lying > 0.0).any(axis=1) | (firm > 0.0)
        for _ in range(max(looks - 1, 1) if touches.any() else 0):
            touches &= self._clear(window, free, lying, firm, touches, positions, rotations)
        self._join(window, (firm**3 * whole)[:, None] * ways, positions, rotations)  # coming out may part them

    def _join(self, window: slice, shares: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Bring hands together, each by its part of the way, ``shares`` (F, 2)."""
        if shares.any():
            join_hands(self.gaps[window], shares, positions, rotations)

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
        """Bring arms, as far as they are ``free`` (F, 2, 2), out of the body where it is to be ``looked`` (F,); tell
        where they were led.

        Hands that are ``lying`` (F, 2) on it touch it; those that are ``firm`` (F,) together go together.
        """
        if self.rooms is None:
            return np.zeros_like(looked)
        proximal = np.array(self.body.layout.proximal_points())
        wanted, own, ways = (each[window] for each in self.rooms)
        wanted = wanted - lying[:, :, None] * np.maximum(wanted, 0.0) if lying.any() else wanted
        moves = np.empty((len(positions), 2, STEP))
        able = free * looked[:, None, None]
        actor = ActorRooms(packed(self.volume), own, ways)
        find_ways_out(wanted, actor, able, proximal, positions, rotations, moves)
        if not moves.any():
            return np.zeros_like(looked)
        self._ease(moves, free, firm, rotations[:, self.body.layout.spine_count - 1])
        move_arms(moves, positions, rotations)
        return np.asarray(moves.any(axis=(1, 2)))

    def _ease(self, moves: FloatArray, free: FloatArray, firm: FloatArray, chest: FloatArray) -> None:
        """Steps of both arms (F, 2, 7) that go on in time, in place, and no farther than arms may: as they are seen
        from the ``chest`` (F, 3, 3). Hands that are ``firm`` (F,) together go the same way, and do not turn.
        """
        vectors = moves[:, :, :SWIVEL].reshape(len(moves), 4, 3)
        out = np.einsum("fij,fvi->fvj", chest, vectors)
        wrists = out[:, ::2]
        lengths = np.linalg.norm(wrists, axis=2, keepdims=True)
        both = (lengths * wrists).sum(axis=1, keepdims=True) / np.maximum(lengths.sum(axis=1, keepdims=True), 1e-9)
        wrists += firm[:, None, None] * (both - wrists)
        least = free[:, :, 0].min(axis=1, keepdims=True)
        able = (free[:, :, 0] + firm[:, None] * (least - free[:, :, 0]))[:, :, None]
        eased = np.einsum("fij,fvj->fvi", chest, eased_ways(out, self.frame_rate)).reshape(len(moves), 2, SWIVEL)
        farthest = FARTHEST * self.body.rows[:, at.M_ARM : at.M_ARM + 2].sum(axis=1).max()
        far = np.linalg.norm(eased[:, :, :HAND], axis=2, keepdims=True) / farthest
        moves[:, :, :HAND] = able * eased[:, :, :HAND] / (1.0 + far**4) ** 0.25
        moves[:, :, HAND:SWIVEL] = able * (1.0 - firm)[:, None, None] * eased[:, :, HAND:]
        moves[:, :, SWIVEL:] = eased_ways(moves[:, :, SWIVEL:], self.frame_rate) * free[:, :, 1:]


def _eased_over(frame_rate: float) -> int:
    """``EASED`` in frames; ``eased_ways`` looks twice as far to either side."""
    return max(1, round(EASED * frame_rate))


def eased_ways(ways: FloatArray, frame_rate: float) -> FloatArray:
    """Ways (F, N, D) as long as they are within ``EASED`` seconds of each moment, and averaged over time.

    Where they contradict each other they are shorter: an arm that passes through the body passes through.
    """
    half, eased = _eased_over(frame_rate), np.zeros_like(ways)
    near, wide = hann_window(half), hann_window(2 * half)
    some = np.flatnonzero(ways.any(axis=(1, 2)))
    if not len(some):
        return eased
    rows = slice(max(some[0] - 2 * half, 0), some[-1] + 2 * half + 1)
    ways = ways[rows]
    lengths = np.linalg.norm(ways, axis=2)
    longest = convolve1d(maximum_filter1d(lengths, 2 * half + 1, axis=0, mode="nearest"), near, axis=0, mode="nearest")
    around = convolve1d(lengths, wide, axis=0, mode="nearest")[:, :, None]
    mean = convolve1d(ways, wide, axis=0, mode="nearest")
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
    """What a motion has to do with its own body on ``body``; None where that is nothing, or the actor is not known."""
    touches = tuple(each for each in contacts if isinstance(each.point, Touch) and each.first < motion.frame_count)
    if actor is None or not (touches or clears):
        return None
    nothing, known = np.zeros(motion.frame_count), volume or usual_volume(body.still)
    touching = touching_of(motion, actor, touches) if touches else Touching(np.zeros((1, 3)), nothing, nothing, ())
    rooms = None
    if clears:
        own, ways = actor_rooms(motion, actor)
        wanted = np.empty_like(own)
        clearing.wanted_rooms(own, 0.0, wanted)
        # What the actor has inside is left inside, and what the body itself has at rest.
        rooms = np.minimum(np.minimum(wanted, own), rest_rooms(body.still, known)), own, ways
    arms = [rows[:, at.M_ARM : at.M_ARM + 4].sum(axis=1)[:, None] for rows in (body.rows, actor.rows)]
    scale = arms[0] / arms[1]
    both = np.maximum(touching.together, touching.held)
    sizes = scale + (1.0 - scale) * (touching.held * (1.0 - touching.together) / np.maximum(both, 1e-9))[:, None]
    return SelfContact(
        body, motion.frame_rate, known, np.ascontiguousarray(sizes * touching.gaps), both, touching.resting, rooms
    )


@project_cache(maxsize=8)
def touching_of(motion: NormalizedMotion, actor: Morphology, touches: tuple[ContactInterval, ...]) -> Touching:
    """``touches`` as the actor has them."""
    positions, rotations = realize(motion, actor, play=True)
    layout, volume = actor.layout, usual_volume(actor)
    resting = []
    for each in touches:
        if not isinstance(each.point, Touch) or each.point.member not in CAPSULES_OF:
            continue
        members = CAPSULES_OF[each.point.member]
        near = [spots(each.point.side, capsule, actor, volume, positions, rotations) for capsule in members]
        firm = _firm((each,), motion)
        resting.append(Resting(each.point.side, np.array(members), firm, _told(near, each)))
    return Touching(
        positions[:, layout.wrist(1)] - positions[:, layout.wrist(0)],
        _firm([each for each in touches if each.point is Touch.HANDS_TOGETHER], motion),
        _firm([each for each in touches if each.point is Touch.HANDS_ON_THING], motion),
        tuple(resting),
    )


def _firm(touches: Sequence[ContactInterval], motion: NormalizedMotion) -> FloatArray:
    """(F,) 1 during touches, eased to 0 before and after."""
    mask = contact_mask([(each.first, each.last) for each in touches], motion.frame_count)
    return 1.0 - freedom(mask, motion.frame_rate, SLOWLY_LET_GO) if mask.any() else np.zeros(motion.frame_count)


def _told(near: Sequence[Spots], contact: ContactInterval) -> FloatArray:
    """(F, M, 6) for the kernel: a hand that rests lies on the surface, however deep the actor seems to sink in."""
    rooms = np.stack([each.rooms for each in near], axis=1)
    least = rooms.min(axis=1)
    shares = np.exp((least[:, None] - rooms) / clearing.BLEND)
    shares /= shares.sum(axis=1, keepdims=True)
    above = rooms - np.median(least[contact.first : contact.last + 1])
    lifted = np.where(above >= SKIN, above, np.maximum(above + SKIN, 0.0) ** 2 / (4.0 * SKIN))
    along, ways = (np.stack(each, axis=1) for each in ([one.along for one in near], [one.ways for one in near]))
    told = shares[:, :, None], along[:, :, None], ways, lifted[:, :, None]
    return np.ascontiguousarray(np.concatenate(told, axis=2))


def arms_asked(tasks: NDArray[np.void], activations: FloatArray, body: AnyMorphology) -> FloatArray:
    """(F, 2, 2) how far ``tasks`` (C,) of the kernels have the wrist, and the elbow, of each arm.

    ``activations`` (C, F); what has but the hand leaves the elbow free.
    """
    asked = np.zeros((activations.shape[1], 2, 2))
    for side in range(2):
        of_arm, hand = tasks["limbs"] == side, tasks["points"] >= body.layout.wrist(side)
        asked[:, side, 0] = activations[of_arm.any(axis=1)].max(axis=0, initial=0.0)
        asked[:, side, 1] = activations[(of_arm & ~hand).any(axis=1)].max(axis=0, initial=0.0)
    return asked


def hands_standing(contacts: Sequence[ContactInterval], frame_count: int, frame_rate: float) -> FloatArray:
    """(F, 2, 2) how far the ground has the wrist of each arm, and nothing its elbow."""
    free = [limb_freedom(contacts, side, frame_count, frame_rate) for side in range(2)]
    asked = np.zeros((frame_count, 2, 2))
    asked[:, :, 0] = 1.0 - np.stack(free, axis=1)
    return asked
