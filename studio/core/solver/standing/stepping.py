"""When feet are in the air as one motion takes over from another: they stand on, step, or land where it has them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.normalized.blending import STEP_HEIGHT, STEP_HEIGHTS, STEP_SECONDS
from studio.core.normalized.joining import SAME_PLACE
from studio.core.normalized.transition import LONGEST, SHORTEST, place_left
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]
States = NDArray[np.int64]


@dataclass(frozen=True)
class Flight:
    """A foot leaves the ground in frame ``leaves`` after the change, 0 at once, and stands again in ``lands``.

    What is different of it dies away in ``seconds``; ``height`` in leg lengths is what it is lifted for that. It was
    ``held`` where it stood until it left.
    """

    leaves: int
    lands: int
    seconds: float
    height: float = 0.0
    held: bool = False

    def free(self, times: FloatArray, rate: float) -> FloatArray:
        """(F,) in [0, 1] how far it is off the ground, or of what it comes from, ``times`` seconds after the change."""
        lifted = 1.0 - place_left(times - self.leaves / rate, self.seconds) if self.held else 1.0
        return np.asarray(lifted * place_left(times - (self.lands / rate - self.seconds), self.seconds))

    def rise(self, times: FloatArray, rate: float) -> FloatArray:
        """(F,) leg lengths by which it is lifted ``times`` seconds after what was seen last."""
        share = np.clip((times - self.leaves / rate) / self.seconds, 0.0, 1.0)
        return np.asarray(self.height * (4.0 * share * (1.0 - share)) ** 3)


def flights_of(
    own: States, seen: States, ways: FloatArray, needed: FloatArray, given: float, rate: float
) -> tuple[Flight, ...]:
    """The flight of each foot, which the motion lets stand as ``own`` (2, F) has it, and which was ``seen`` (2,) last.

    ``ways`` (2,) leg lengths that it is aside, ``needed`` (2, 2) seconds to get there from the ground, and through the
    air; steps take ``given`` seconds all together, 0 as many as they need. A foot steps while the other stands,
    once the weight is there; one that the motion lifts before goes to its place in that. One that it lifts within
    ``SHORTEST`` is in the air at once: there is no time to come to lie as the motion has it leave.
    """
    flights: dict[int, Flight] = {}
    shifted = 0 if given else round(SHORTEST * rate)
    stays = np.array([_run(each) for each in own]) >= min(SHORTEST * rate, own.shape[1])
    standing = stays & ((seen & own[:, 0]) != 0)
    steps = standing & (ways >= SAME_PLACE)
    free = 0
    for side in sorted(range(2), key=lambda side: bool(standing[side])):
        leaves, height, seconds = 0, 0.0, needed[1, side]
        if standing[side]:
            least, seconds = (
                given / max(steps.sum(), 1) or max(needed[0, side], STEP_SECONDS + each * ways[side])
                for each in (1.0, 2.0)
            )
            leaves = len(own[side])
            if steps[side]:
                other, free = own[1 - side], max(free, shifted)
                leaves, until = _free_to_step(other, free, round(least * rate))
                if leaves > LONGEST * rate:  # by then the body has gone on: rather a hop
                    leaves, until = free, free
                seconds = min(seconds, max((until - leaves) / rate, least))
            if leaves >= _run(own[side]):
                flights[side] = _lifted(own[side], needed[0, side], rate)
                continue
            height = float(np.clip(STEP_HEIGHT * ways[side], *STEP_HEIGHTS))
        lands = _landing(own[side], leaves + round(seconds * rate), rate)
        flights[side] = Flight(leaves, lands, seconds, height, bool(standing[side]))
        free = max(free, lands)
    return flights[0], flights[1]


def _free_to_step(other: States, free: int, frames: int) -> tuple[int, int]:
    """The first frame from ``free`` on from which the ``other`` foot stands for some ``frames``, and until when; if
    there is none, the last.
    """
    for first, stop in runs_of(other != 0):
        if stop - max(first, free) >= min(frames, len(other) - max(first, free)) > 0:
            return max(first, free), stop
    return len(other), len(other)


def states_of(own: States, seen: int, flight: Flight, settles: int) -> States:
    """(F,) how a foot stands: as it does by itself, but for its flight; no more of it than was ``seen`` to stand while
    it settles.
    """
    states = own.copy()
    held = states[: min(flight.leaves, settles, _run(own))]
    both = held & seen
    held[both != 0] = both[both != 0]
    states[flight.leaves : flight.lands] = 0
    return states


def carrying(states: States, rate: float) -> FloatArray:
    """(F,) in [0, 1] how far a leg carries the body whose foot stands as ``states`` (F,): no more as the foot leaves,
    again once it has landed.
    """
    times, shares = np.arange(1, len(states) + 1) / rate, np.ones(len(states))
    for leaves, lands in runs_of(states == 0):
        until = place_left(times - (leaves / rate - SHORTEST), SHORTEST)
        shares *= until + 1.0 - place_left(times - lands / rate, SHORTEST)
    return shares


def _run(states: States) -> int:
    """Frames for which a foot stands on."""
    lifted = np.flatnonzero(states == 0)
    return int(lifted[0]) if len(lifted) else len(states)


def _lifted(own: States, needed: float, rate: float) -> Flight:
    """The first flight of the motion itself that lasts long enough: until then it goes aside."""
    stands = [*runs_of(own != 0), (len(own), 2 * len(own))]
    for (leaves, lands), (_, next_leaves) in zip(runs_of(own == 0), stands[1:], strict=False):
        if lands - leaves >= SHORTEST * rate or lands == len(own):
            late = min(leaves + round(needed * rate), (lands + next_leaves) // 2)
            lands = min(max(lands, late), len(own))
            return Flight(leaves, lands, min(needed, (lands - leaves) / rate), held=True)
    return Flight(len(own), len(own), needed, held=True)


def _landing(own: States, earliest: int, rate: float) -> int:
    """The frame in which the motion has a foot stand that lands no earlier than that, not to leave again at once: of
    the short stances of a run half is enough.
    """
    for first, stop in runs_of(own != 0):
        lands = max(first, earliest)
        if lands < stop and (stop - lands >= min(SHORTEST * rate, (stop - first) / 2.0) or stop == len(own)):
            return lands
    return len(own)
