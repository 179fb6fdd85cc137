"""Flights of feet during an inertialised transition: feet keep their contact, step, or land where the motion has them.

The *own* states are those of the new motion; the previous ones (``seen``) are those before the transition.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.normalized.blending import BLEND_STEP_SECONDS, STEP_HEIGHT_FRACTION, STEP_HEIGHT_RANGE
from studio.core.normalized.joining import SAME_FOOTHOLD_DISTANCE
from studio.core.normalized.transition import (
    LEAST_TRANSITION_SECONDS,
    MOST_TRANSITION_SECONDS,
    remaining_offset_fraction,
)
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]
States = NDArray[np.int64]

SWING_SECONDS_PER_LEG = 0.4
"""Additional seconds of a foot in the air for each leg length of its displacement, in planned transitions."""
SHORTEST_SWING_SECONDS = 0.35
"""Least seconds of a foot in the air that is to land where its own motion already stands."""


@dataclass(frozen=True)
class FootFlight:
    """Flight of one foot during a transition."""

    leaves: int
    """Frame after the transition at which the foot is lifted, 0 at once."""
    lands: int
    """Frame at which it lands."""
    seconds: float
    """Seconds in which its offset decays."""
    height: float = 0.0
    """Greatest lift in leg lengths."""
    held: bool = False
    """True if the foot keeps its contact before."""

    @property
    def is_step(self) -> bool:
        """True for an added step: the foot is lifted during the transition although it is in contact in the clip."""
        return self.held and self.height > 0.0

    def free(self, times: FloatArray, rate: float) -> FloatArray:
        """Weight (F,) in [0, 1] to which the foot is in the air, ``times`` (F,) seconds after the transition; ``rate``
        in frames a second.
        """
        lifted = 1.0 - remaining_offset_fraction(times - self.leaves / rate, self.seconds) if self.held else 1.0
        return np.asarray(lifted * remaining_offset_fraction(times - (self.lands / rate - self.seconds), self.seconds))

    def rise(self, times: FloatArray, rate: float) -> FloatArray:
        """Lift (F,) in leg lengths, ``times`` (F,) seconds after the transition."""
        fraction = np.clip((times - self.leaves / rate) / self.seconds, 0.0, 1.0)
        return np.asarray(self.height * (4.0 * fraction * (1.0 - fraction)) ** 3)


def flights_of(
    own: States,
    seen: States,
    displacements: FloatArray,
    needed: FloatArray,
    given: float,
    rate: float,
    planned: bool = False,
) -> tuple[FootFlight, ...]:
    """Flight of each foot during a transition, from own states ``own`` (2, F) and previous ones ``seen`` (2,).

    ``displacements`` (2,) are leg lengths to the foot's own position, ``needed`` (2, 2) seconds to get there from the
    ground, and through the air; all steps together take ``given`` seconds, 0 as many as they need. A foot steps while
    the other one stands; a foot that the motion lifts before uses that flight. One that is lifted within
    ``LEAST_TRANSITION_SECONDS`` leaves at once. If the transition is ``planned``, a foot in the air takes the time and
    the height of a step to a position aside.
    """
    flights: dict[int, FootFlight] = {}
    shifted = 0 if given else round(LEAST_TRANSITION_SECONDS * rate)
    stays = np.array([_run(each) for each in own]) >= min(LEAST_TRANSITION_SECONDS * rate, own.shape[1])
    standing = stays & ((seen & own[:, 0]) != 0)
    steps = standing & (displacements >= SAME_FOOTHOLD_DISTANCE)
    free = 0
    for side in sorted(range(2), key=lambda side: bool(standing[side])):
        leaves, height, seconds = 0, 0.0, needed[1, side]
        swings = not standing[side] and (own[side, 0] or not seen[side])  # else the motion itself lifts it at once
        if planned and swings and displacements[side] >= SAME_FOOTHOLD_DISTANCE:
            height = step_height(displacements[side])
            seconds = max(seconds, LEAST_TRANSITION_SECONDS + SWING_SECONDS_PER_LEG * displacements[side])
            if own[side, 0]:
                seconds = min(seconds, max(_run(own[side]) / rate / 2.0, SHORTEST_SWING_SECONDS))
        if standing[side]:
            least, seconds = (
                given / max(steps.sum(), 1) or max(needed[0, side], BLEND_STEP_SECONDS + each * displacements[side])
                for each in (0.75, 1.5)
            )
            leaves = len(own[side])
            if steps[side]:
                other, free = own[1 - side], max(free, shifted)
                leaves, until = _free_to_step(other, free, round(least * rate))
                if leaves > MOST_TRANSITION_SECONDS * rate:  # by then the body has gone on: rather a hop
                    leaves, until = free, free
                seconds = min(seconds, max((until - leaves) / rate, least))
            if leaves >= _run(own[side]):
                flights[side] = _lifted(own[side], needed[0, side], rate)
                continue
            height = step_height(displacements[side])
        lands = _landing(own[side], leaves + round(seconds * rate), rate)
        flights[side] = FootFlight(leaves, lands, seconds, height, bool(standing[side]))
        free = max(free, lands)
    return flights[0], flights[1]


def step_height(displacement: float) -> float:
    """Lift in leg lengths of a step over ``displacement`` leg lengths."""
    return float(np.clip(STEP_HEIGHT_FRACTION * displacement, *STEP_HEIGHT_RANGE))


def _free_to_step(other: States, free: int, frames: int) -> tuple[int, int]:
    """(first, end) frame of the first contact of the ``other`` foot, from frame ``free`` on, that leaves ``frames``
    frames for a step.

    Both are the number of frames if there is none.
    """
    for first, stop in runs_of(other != 0):
        if stop - max(first, free) >= min(frames, len(other) - max(first, free)) > 0:
            return max(first, free), stop
    return len(other), len(other)


def states_of(own: States, seen: int, flight: FootFlight, settles: int) -> States:
    """States (F,) of a foot during a transition: its own ones, but 0 in its flight.

    During the first ``settles`` frames it has at most the previous contact ``seen``.
    """
    states = own.copy()
    held = states[: min(flight.leaves, settles, _run(own))]
    both = held & seen
    held[both != 0] = both[both != 0]
    states[flight.leaves : flight.lands] = 0
    return states


def carrying(states: States, rate: float) -> FloatArray:
    """Weight (F,) in [0, 1] with which a leg supports the body, from the foot's states (F,): fading before lift-off and
    after landing.
    """
    times, fractions = np.arange(1, len(states) + 1) / rate, np.ones(len(states))
    for leaves, lands in runs_of(states == 0):
        until = remaining_offset_fraction(times - (leaves / rate - LEAST_TRANSITION_SECONDS), LEAST_TRANSITION_SECONDS)
        fractions *= until + 1.0 - remaining_offset_fraction(times - lands / rate, LEAST_TRANSITION_SECONDS)
    return fractions


def _run(states: States) -> int:
    """Number of frames from the beginning for which a foot stands."""
    lifted = np.flatnonzero(states == 0)
    return int(lifted[0]) if len(lifted) else len(states)


def _lifted(own: States, needed: float, rate: float) -> FootFlight:
    """First flight of the own motion that lasts long enough, as the flight of a foot that keeps its contact before."""
    stands = [*runs_of(own != 0), (len(own), 2 * len(own))]
    for (leaves, lands), (_, next_leaves) in zip(runs_of(own == 0), stands[1:], strict=False):
        if lands - leaves >= LEAST_TRANSITION_SECONDS * rate or lands == len(own):
            late = min(leaves + round(needed * rate), (lands + next_leaves) // 2)
            lands = min(max(lands, late), len(own))
            return FootFlight(leaves, lands, min(needed, (lands - leaves) / rate), held=True)
    return FootFlight(len(own), len(own), needed, held=True)


def _landing(own: States, earliest: int, rate: float) -> int:
    """Frame at which a foot lands in its own motion, no earlier than ``earliest``, at the beginning of a sufficiently
    long stance.

    Half of the stance suffices for the short stances of a run.
    """
    for first, stop in runs_of(own != 0):
        lands = max(first, earliest)
        if lands < stop and (
            stop - lands >= min(LEAST_TRANSITION_SECONDS * rate, (stop - first) / 2.0) or stop == len(own)
        ):
            return lands
    return len(own)
