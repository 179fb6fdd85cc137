"""Row of clips that are cross-faded in channels, which hold no lengths, before any body is known.

It is used for bodies supported by more than their feet, and for layers. Overlapping clips are cross-faded; at other
changes the difference decays (``transition``). A contact in both clips lasts through their blend as one contact, so it
has one footprint.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import spans_of
from studio.core.curves.activation import EaseShape, ease
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.differences import blended_channels, channel_difference, with_difference
from studio.core.normalized.joining import ClipAlignment, FootStep
from studio.core.normalized.pieces import PIECE_CONTACT_POINTS, ChannelSource, HeldPose, Mask, PieceSource
from studio.core.normalized.row import AssembledRow
from studio.core.normalized.transition import Inertialisation, joint_peaks

FloatArray = NDArray[np.float64]

OLD_CONTACT_END, NEW_CONTACT_BEGIN = 0.1, 0.9
"""Fractions of a blend: until the first, contacts of the old clip alone still hold; from the second on, those of the
new clip.
"""
BLEND_STEP_SECONDS = 0.4
"""Duration in seconds of a step in a transition, and additional seconds for each leg length of the step."""
STEP_HEIGHT_FRACTION, STEP_HEIGHT_RANGE = 0.25, (0.04, 0.12)
"""Height of a foot in a step as a fraction of the step's length, and its least and greatest height in leg lengths."""


@dataclass
class BlendedRow(AssembledRow):
    """Row of clips in which changes are blended.

    ``peaks`` are the ``joint_peaks`` of the assembled frames before ``measured``; at first those of the hidden part of
    the first piece.
    """

    peaks: FloatArray | None = None
    measured: int = 0

    def _begin(self, source: PieceSource, first: int, last: int) -> None:
        super()._begin(source, first, last)
        self.measured = 0 if self.peaks is None else last + 2

    def _hold(self, until: int) -> None:
        held = HeldPose(self.channels[self.end - 1], self.contact_mask[:, self.end - 1])
        transition = self._transition(held, self.end, until - 1)
        self._take_over(held, self.end, until - 1, transition, ClipAlignment(self.placement))

    def _follow(self, source: PieceSource, first: int, last: int) -> int:
        shared = (first, min(self.end - 1, last)) if first < self.end - 1 else (self.end - 1, self.end - 1)
        found = self._alignment(source, first, *shared)
        self.placement, takes_over = found.placement, source.placed(found.placement)
        transition = self._transition(takes_over, first, last)
        if self._fades(transition, first, last, found):
            self._fade(takes_over, first, last, found)
        else:
            self.end = first
            self._take_over(takes_over, first, last, transition, found, source.piece.ease)
        return first

    def _fade(self, source: ChannelSource, first: int, last: int, found: ClipAlignment) -> None:
        """Cross-fade from the assembled frames to a piece that overlaps them."""
        stop = min(self.end, last + 1)
        frames = np.arange(first, last + 1)
        channels, over = source.channels(frames), stop - first
        shares = ease(np.arange(1, over + 1) / (over + 1.0), EaseShape.QUINTIC)
        channels[:over] = blended_channels(self.channels[first:stop], channels[:over], shares)
        self._go_on(channels, source.contact_mask(frames), first, over, found)

    def _take_over(
        self,
        source: ChannelSource,
        first: int,
        last: int,
        transition: Inertialisation,
        found: ClipAlignment,
        seconds: float = 0.0,
    ) -> None:
        """Change to a piece at frame ``first``, the end of the assembled frames; the difference decays in ``seconds``.

        If ``seconds`` is 0, the difference decays in the time that its size needs.
        """
        rate, frames = self.timing.frame_rate, np.arange(first, last + 1)
        seconds = seconds or max(transition.seconds, step_seconds(found))
        transition = replace(transition, seconds=seconds)
        channels = source.channels(frames)
        fading = min(round(seconds * rate), len(frames))
        channels[:fading] = with_difference(
            channels[:fading], transition.remaining_offset(np.arange(1, fading + 1) / rate)
        )
        self._go_on(channels, source.contact_mask(frames), first, fading, found)

    def _transition(self, source: ChannelSource, first: int, last: int) -> Inertialisation:
        """Inertialisation from the assembled frames to a piece that begins at ``first``."""
        rate, before = self.timing.frame_rate, np.arange(max(first - 2, 0), first)
        gaps = channel_difference(source.channels(before), self.channels[before])
        new = joint_peaks(self.channels[max(self.measured - 2, 0) : first], rate)
        self.peaks, self.measured = (
            (new if self.peaks is None else np.maximum(self.peaks, new)),
            max(first, self.measured),
        )
        peaks = np.maximum(self.peaks, joint_peaks(source.channels(np.arange(first, last + 1)), rate))
        return Inertialisation.of(gaps[-1], (gaps[-1] - gaps[0]) * rate, peaks)

    def _fades(self, transition: Inertialisation, first: int, last: int, found: ClipAlignment) -> bool:
        """True if a piece overlaps the assembled frames for as long as a blend needs."""
        if first > self.end - 2:
            return False
        needed = max(transition.seconds, step_seconds(found))
        return needed <= (min(self.end, last + 1) - first) / self.timing.frame_rate

    def _go_on(self, channels: FloatArray, stands: Mask, first: int, blending: int, found: ClipAlignment) -> None:
        """Write ``channels`` and the contacts ``stands`` from ``first`` on, of which ``blending`` frames
        are a blend.
        """
        old_until, new_from = (
            first + int(OLD_CONTACT_END * blending),
            first + int(np.ceil(NEW_CONTACT_BEGIN * blending)),
        )
        flights = planned_steps(found.steps, min(old_until, self.end - 1), new_from)
        raise_feet(channels, flights, first)
        self._merge(stands, first, old_until, new_from, flights)
        last = first + len(channels) - 1
        self.channels[first : last + 1], self.end = channels, last + 1

    def _merge(self, stands: Mask, first: int, old_until: int, new_from: int, flights: Sequence["Flight"]) -> None:
        """Merge the contacts across a blend: one in both clips continues; others end or begin outside the middle of the
        blend.

        A stepping foot is in contact until it is lifted, and again once it has landed.
        """
        flying = {each.step.side: each for each in flights}
        new, old = np.zeros_like(self.contact_mask), np.array(self.contact_mask)
        new[:, first : first + stands.shape[1]] = stands
        old[:, self.end :] = False
        self.contact_mask[:, first:] = False
        for row, point in enumerate(PIECE_CONTACT_POINTS):
            olds, news = spans_of(old[row]), spans_of(new[row])
            flight = flying.get(point.side) if point.is_foot else None
            leaves, lands = (flight.last_contact, flight.next_contact) if flight else (old_until, new_from)
            for a, b in olds:
                meets = any(c <= b + 1 and d >= a for c, d in news)
                until = leaves if flight and meets else min(b, leaves)
                self.contact_mask[row, a : (b if meets and not flight else until) + 1] = True
            for c, d in news:
                meets = not flight and any(c <= b + 1 and d >= a for a, b in olds)
                self.contact_mask[row, (c if meets else max(c, lands)) : d + 1] = True


def step_seconds(found: ClipAlignment) -> float:
    """Seconds that the steps of the alignment ``found`` need."""
    return sum(BLEND_STEP_SECONDS + each.displacement for each in found.steps)


@dataclass(frozen=True)
class Flight:
    """Flight of a foot in a step, from its ``last_contact`` frame to its ``next_contact`` frame."""

    step: FootStep
    last_contact: int
    next_contact: int


def planned_steps(steps: Sequence[FootStep], first: int, last: int) -> list[Flight]:
    """Flights of ``steps`` from frame ``first`` to ``last``, one after the other, of equal duration."""
    ends = np.rint(np.linspace(first, last, len(steps) + 1)).astype(int).tolist()
    return [Flight(step, *between) for step, *between in zip(steps, ends, ends[1:], strict=False)]


def raise_feet(channels: FloatArray, flights: Sequence[Flight], first: int) -> None:
    """Lift feet for their steps, in place, in ``channels`` that begin with frame ``first``."""
    for each in flights:
        frames = np.arange(each.last_contact, each.next_contact + 1)
        height = np.clip(STEP_HEIGHT_FRACTION * each.step.displacement, *STEP_HEIGHT_RANGE)
        rise = height * np.sin(np.pi * (frames - each.last_contact) / max(len(frames) - 1, 1)) ** 2
        inside = frames - first < len(channels)
        channels[frames[inside] - first, channel.LIMB_SLACK + 2 + each.step.side] += rise[inside]
