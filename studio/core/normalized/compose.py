"""A row of clips as one motion: trimmed, retimed, mirrored, placed and blended where channels hold no lengths.

What comes out is a motion like any other, scaled, set on the ground and solved for any body. Where two clips overlap
one fades into the other; where they meet, or where nothing plays between them, what was different dies away
(``transition``). What stands in both clips stands through their blend as one contact, so it is one footprint.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, spans_of
from studio.core.constraints.activation import EaseShape, ease
from studio.core.kernels import layout as at
from studio.core.normalized.differences import blended, difference, moved
from studio.core.normalized.joining import Join, Planar, Step, join, stepping_there
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import AS_IT_IS, POINTS, Held, Mask, Piece, PieceSource, Played, Source
from studio.core.normalized.resample import Resampled, common_spine
from studio.core.normalized.transition import Transition, joint_peaks
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]

FEET = [POINTS.index(point) for point in FOOT_POINTS]
OLD_UNTIL, NEW_FROM = 0.1, 0.9
"""Parts of a blend until which a contact of the old clip alone still holds, and from which one of the new."""
STEP_SECONDS = 0.4
"""Seconds that a step takes in a transition, and one more for each leg length of it."""
STEP_HEIGHT, STEP_HEIGHTS = 0.25, (0.04, 0.12)
"""How high a foot is lifted for a step, in parts of its length, and the least and the most in leg lengths."""


@dataclass(frozen=True, eq=False)
class Composite:
    """What a row of pieces comes to: a motion with its contacts, when it plays, and where each piece is in it."""

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    timing: Timing
    played: tuple[Played, ...]

    @property
    def is_plain(self) -> bool:
        """Whether it is one motion whose frames are its own, whatever lies over them."""
        return len(self.played) == 1 and self.played[0].piece.is_plain

    def at(self, frame: int) -> "Composite":
        """One frame of it, which is frame 0 then."""
        motion, timing = self.motion, self.timing
        still = NormalizedMotion(
            motion.name, motion.frame_rate, motion.channels[frame : frame + 1], motion.spine_places, motion.girdle
        )
        played = tuple(replace(each, first=each.first - frame, last=each.last - frame) for each in self.played)
        return Composite(still, (), Timing(timing.stage_time(frame), timing.frame_rate, 0, 0), played)

    def playing(self, frame: int) -> Played:
        """The piece that plays in a frame: of two the one that takes over."""
        begun = [each for each in self.played if each.first <= frame]
        return begun[-1] if begun else self.played[0]


@lru_cache(maxsize=64)
def compose(pieces: tuple[Piece, ...]) -> Composite:
    """One motion out of pieces, in the order of their start; the same pieces give the same value.

    A single piece that plays a motion as it is gives that motion itself, whole. The frame rate is the highest.
    """
    ordered = sorted(pieces, key=lambda piece: piece.start)
    first = ordered[0]
    if len(ordered) == 1 and first.is_plain:
        rate = first.motion.frame_rate
        timing = Timing(first.start - first.first / rate, rate, first.first, first.last)
        whole = Played(first, 0, first.motion.frame_count - 1, Planar())
        return Composite(first.motion, first.contacts, timing, (whole,))
    return _composed(ordered)


def go_on(shown: Piece, played: NormalizedMotion, pieces: Sequence[Piece]) -> Composite:
    """``compose``, where all that is there before ``pieces`` is what was ``shown`` last, no more than a moment.

    How fast it may change is known by what has ``played`` of late.
    """
    return _composed([shown, *pieces], played)


def _composed(ordered: Sequence[Piece], played: NormalizedMotion | None = None) -> Composite:
    spine_places = common_spine([piece.motion for piece in ordered])
    row = _Row(spine_places, timing_of_pieces(ordered))
    if played is not None:
        channels = Resampled(played, spine_places).at(np.arange(played.frame_count, dtype=np.float64))
        row.peaks = joint_peaks(channels, played.frame_rate)
    for piece in ordered:
        row.add(piece)
    return row.composite()


def led_on(shown: Piece, pieces: Sequence[Piece]) -> Composite:
    """``pieces`` behind what was ``shown``, where that puts them, as if nothing had been before but themselves."""
    ordered = [shown, *pieces]
    row = _Row(common_spine([piece.motion for piece in ordered]), timing_of_pieces(ordered))
    row.add(shown)
    row.lead(pieces[0])
    for piece in pieces[1:]:
        row.add(piece)
    return row.composite()


def timing_of_pieces(pieces: Sequence[Piece]) -> Timing:
    """When a row plays, at the highest frame rate among its pieces."""
    rate = max(piece.motion.frame_rate for piece in pieces)
    begin, end = min(piece.start for piece in pieces), max(piece.end for piece in pieces)
    return Timing(begin, rate, 0, round((end - begin) * rate))


@dataclass
class _Row:
    """Filled from left to right: ``channels`` (F, C) and what ``stands`` (9, F), as far as ``end``, not included."""

    spine_places: FloatArray
    timing: Timing
    peaks: FloatArray | None = None
    """``joint_peaks`` of what is there before frame ``measured``; at first of what the first piece does not show."""
    measured: int = 0
    channels: FloatArray = field(init=False)
    stands: Mask = field(init=False)
    end: int = 0
    placement: Planar = Planar()
    played: list[Played] = field(default_factory=list)

    def __post_init__(self) -> None:
        count = self.timing.last + 1
        self.channels = np.empty((count, at.SPINE + 4 * (len(self.spine_places) - 1)))
        self.stands = np.zeros((len(POINTS), count), dtype=bool)

    def add(self, piece: Piece) -> None:
        """Play a piece from its start on, over or behind what is there."""
        first = round((piece.start - self.timing.begin) * self.timing.frame_rate)
        last = max(round((piece.end - self.timing.begin) * self.timing.frame_rate), first)
        source = PieceSource(piece, self.spine_places, self.timing)
        if self.played and first > self.end:  # nothing plays between them: the last pose holds
            held = Held(self.channels[self.end - 1], self.stands[:, self.end - 1])
            transition = self._transition(held, self.end, first - 1)
            self._take_over(held, self.end, first - 1, transition, Join(self.placement))
        if not self.played:
            self.placement = source.around(first, piece.own)
            self._put(source.placed(self.placement), first, last)
            self.measured = 0 if self.peaks is None else last + 2
        else:
            first = min(max(first, 1), self.end)
            shared = (first, min(self.end - 1, last)) if first < self.end - 1 else (self.end - 1, self.end - 1)
            found = self._join(source, first, *shared)
            self.placement, takes_over = found.placement, source.placed(found.placement)
            transition = self._transition(takes_over, first, last)
            if self._fades(transition, first, last, found):
                self._fade(takes_over, first, last, found)
            else:
                self.end = first
                self._take_over(takes_over, first, last, transition, found, piece.ease)
        self.played.append(Played(piece, first, last, self.placement))

    def lead(self, piece: Piece) -> None:
        """Play a piece behind what is there, and instead of that what its motion has before."""
        first, last = self.end, round((piece.end - self.timing.begin) * self.timing.frame_rate)
        source = PieceSource(piece, self.spine_places, self.timing)
        self.placement = self._join(source, first, first - 1, first - 1).placement
        self.played.append(Played(piece, first, max(last, first), self.placement))
        frames = np.arange(self.played[-1].last + 1)
        there = self.played[-1].motion_frames(frames, self.timing) > -0.5 * piece.speed
        source, frames = source.placed(self.placement), np.maximum(frames, frames[there][0])
        self.channels[: len(frames)], self.stands[:, : len(frames)] = source.channels(frames), source.stands(frames)
        self.end = len(frames)

    def composite(self) -> Composite:
        """All that was added, as one motion."""
        name = " + ".join(dict.fromkeys(each.piece.motion.name for each in self.played))
        self.channels.setflags(write=False)
        known = [each.piece.motion.girdle for each in self.played if each.piece.motion.girdle is not None]
        girdle = max(known, key=lambda each: each.length, default=None)
        motion = NormalizedMotion(name, self.timing.frame_rate, self.channels, self.spine_places, girdle)
        return Composite(motion, self.contacts(), self.timing, tuple(self.played))

    def contacts(self) -> tuple[ContactInterval, ...]:
        """What stands, as intervals."""
        return tuple(
            ContactInterval("", point, first, last)
            for point, mask in zip(POINTS, self.stands, strict=True)
            for first, last in spans_of(mask)
        )

    def _join(self, source: PieceSource, begins: int, first: int, last: int) -> Join:
        """How a piece that ``begins`` in a frame is placed, from what both play in frames ``first`` to ``last``."""
        frames = np.arange(first, last + 1)
        both = (self.stands[FEET][:, frames] & source.stands(frames)[FEET]).T
        shares = ease((frames - first + 1.0) / (len(frames) + 1.0), EaseShape.QUINTIC)
        weights = shares * (1.0 - shares) + 1e-3
        piece, known = source.piece, (self.channels[frames], source.channels(frames), both, self.spine_places)
        if not piece.joined:
            return stepping_there(*known, source.around(begins, piece.own))
        found = join(*known, weights)
        if piece.own == AS_IT_IS:
            return found
        return stepping_there(*known, source.around(begins, piece.own, found.placement))

    def _put(self, source: Source, first: int, last: int) -> None:
        frames = np.arange(first, last + 1)
        self.channels[frames], self.stands[:, frames] = source.channels(frames), source.stands(frames)
        self.end = last + 1

    def _fade(self, source: Source, first: int, last: int, found: Join) -> None:
        """From what is there to a piece that begins before it ends."""
        stop = min(self.end, last + 1)
        frames = np.arange(first, last + 1)
        channels, over = source.channels(frames), stop - first
        shares = ease(np.arange(1, over + 1) / (over + 1.0), EaseShape.QUINTIC)
        channels[:over] = blended(self.channels[first:stop], channels[:over], shares)
        self._go_on(channels, source.stands(frames), first, over, found)

    def _take_over(
        self, source: Source, first: int, last: int, transition: Transition, found: Join, seconds: float = 0.0
    ) -> None:
        """A piece takes over at ``first``, the end of what is there; what was different dies away in ``seconds``, or
        in as many as it needs.
        """
        rate, frames = self.timing.frame_rate, np.arange(first, last + 1)
        seconds = seconds or max(transition.seconds, step_seconds(found))
        transition = replace(transition, seconds=seconds)
        channels = source.channels(frames)
        fading = min(round(seconds * rate), len(frames))
        channels[:fading] = moved(channels[:fading], transition.left(np.arange(1, fading + 1) / rate))
        self._go_on(channels, source.stands(frames), first, fading, found)

    def _transition(self, source: Source, first: int, last: int) -> Transition:
        """From what is there to a piece that takes over at ``first``, in as many seconds as that needs."""
        rate, before = self.timing.frame_rate, np.arange(max(first - 2, 0), first)
        gaps = difference(source.channels(before), self.channels[before])
        new = joint_peaks(self.channels[max(self.measured - 2, 0) : first], rate)
        self.peaks, self.measured = (
            (new if self.peaks is None else np.maximum(self.peaks, new)),
            max(first, self.measured),
        )
        peaks = np.maximum(self.peaks, joint_peaks(source.channels(np.arange(first, last + 1)), rate))
        return Transition.of(gaps[-1], (gaps[-1] - gaps[0]) * rate, peaks)

    def _fades(self, transition: Transition, first: int, last: int, found: Join) -> bool:
        """Whether a piece overlaps what is there for as long as a blend needs."""
        if first > self.end - 2:
            return False
        needed = max(transition.seconds, step_seconds(found))
        return needed <= (min(self.end, last + 1) - first) / self.timing.frame_rate

    def _go_on(self, channels: FloatArray, stands: Mask, first: int, blending: int, found: Join) -> None:
        """Put ``channels`` and what ``stands`` from ``first`` on, of which ``blending`` frames are a blend."""
        old_until, new_from = first + int(OLD_UNTIL * blending), first + int(np.ceil(NEW_FROM * blending))
        flights = flights_of(found.steps, min(old_until, self.end - 1), new_from)
        raise_feet(channels, flights, first)
        self._merge(stands, first, old_until, new_from, flights)
        last = first + len(channels) - 1
        self.channels[first : last + 1], self.end = channels, last + 1

    def _merge(self, stands: Mask, first: int, old_until: int, new_from: int, flights: Sequence["Flight"]) -> None:
        """Contacts across a blend: one that goes on in the new clip is one; others keep clear of it.

        Who steps stands until it is lifted, and again once it has landed.
        """
        flying = {each.step.side: each for each in flights}
        new, old = np.zeros_like(self.stands), np.array(self.stands)
        new[:, first : first + stands.shape[1]] = stands
        old[:, self.end :] = False
        self.stands[:, first:] = False
        for row, point in enumerate(POINTS):
            olds, news = spans_of(old[row]), spans_of(new[row])
            flight = flying.get(point.side) if point.is_foot else None
            leaves, lands = (flight.leaves, flight.lands) if flight else (old_until, new_from)
            for a, b in olds:
                meets = any(c <= b + 1 and d >= a for c, d in news)
                until = leaves if flight and meets else min(b, leaves)
                self.stands[row, a : (b if meets and not flight else max(until, a)) + 1] = True
            for c, d in news:
                meets = not flight and any(c <= b + 1 and d >= a for a, b in olds)
                self.stands[row, (c if meets else max(c, lands)) : d + 1] = True


def step_seconds(found: Join) -> float:
    """Seconds that feet need for the steps they have to do."""
    return sum(STEP_SECONDS + each.way for each in found.steps)


@dataclass(frozen=True)
class Flight:
    """A step that stands last in the frame ``leaves`` and first again in ``lands``."""

    step: Step
    leaves: int
    lands: int


def flights_of(steps: Sequence[Step], first: int, last: int) -> list[Flight]:
    """Steps between two frames, one after the other, all as long."""
    ends = np.rint(np.linspace(first, last, len(steps) + 1)).astype(int).tolist()
    return [Flight(step, *between) for step, *between in zip(steps, ends, ends[1:], strict=False)]


def raise_feet(channels: FloatArray, flights: Sequence[Flight], first: int) -> None:
    """Lift feet for their steps, in place, in ``channels`` that begin with frame ``first``."""
    for each in flights:
        frames = np.arange(each.leaves, each.lands + 1)
        height = np.clip(STEP_HEIGHT * each.step.way, *STEP_HEIGHTS)
        rise = height * np.sin(np.pi * (frames - each.leaves) / max(len(frames) - 1, 1)) ** 2
        inside = frames - first < len(channels)
        channels[frames[inside] - first, at.LIMB_SLACK + 2 + each.step.side] += rise[inside]
