"""Row of clips, filled from left to right: each clip continues from the previous one, placed where that leaves the
body.

Clips change in one frame, at which channels jump; later the body is inertialised on the ground
(``solver.grounding.inertialisation``), where feet are known. Of overlapping frames, up to the first second, the change
is in the frame in which both clips are most alike, so that the same feet stand, and every hit, step or touch keeps its
time in its clip.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import FOOT_POINTS, ContactInterval, spans_of
from studio.core.curves.activation import EaseShape, ease
from studio.core.curves.retiming import speed_at
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.differences import channel_difference
from studio.core.normalized.joining import (
    FOOT_STEP_LIMIT,
    ClipAlignment,
    PlanarTransform,
    alignment_by_steps,
    clip_alignment,
)
from studio.core.normalized.motion import Change
from studio.core.normalized.pieces import (
    IDENTITY_TRANSFORM,
    PIECE_CONTACT_POINTS,
    ChannelSource,
    Mask,
    MotionPiece,
    PieceSource,
    PlayedPiece,
)
from studio.core.normalized.transition import LEAST_TRANSITION_SECONDS, MOST_TRANSITION_SECONDS, joint_vectors
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]

FOOT_MASK_ROWS = [PIECE_CONTACT_POINTS.index(point) for point in FOOT_POINTS]
"""Rows of a contact mask that belong to the points of the feet."""
PACE_ERROR_SECONDS = 0.3
"""Seconds over which a difference of joint speeds is integrated in the comparison of two clips."""
FOOT_MISMATCH_COST = 0.5
"""Cost, in radians squared, of a heel or toe that stands in only one of two clips."""
SAME_FRAME_TOLERANCE = 0.01
"""Difference in frames up to which the parts of a split clip count as continuous."""


@dataclass
class AssembledRow:
    """Row of clips as it is filled: ``channels`` (F, C) and ``contact_mask`` (9, F), valid up to ``end``, exclusive."""

    spine_places: FloatArray
    timing: Timing
    channels: FloatArray = field(init=False)
    contact_mask: Mask = field(init=False)
    end: int = 0
    placement: PlanarTransform = PlanarTransform()
    played: list[PlayedPiece] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)

    def __post_init__(self) -> None:
        count = self.timing.last + 1
        self.channels = np.empty((count, channel.SPINE + 4 * (len(self.spine_places) - 1)))
        self.contact_mask = np.zeros((len(PIECE_CONTACT_POINTS), count), dtype=bool)

    def add(self, piece: MotionPiece) -> None:
        """Append a piece, which takes over from frames that it overlaps; a gap before it holds the last pose."""
        first = round((piece.start - self.timing.begin) * self.timing.frame_rate)
        last = max(round((piece.end - self.timing.begin) * self.timing.frame_rate), first)
        source = PieceSource(piece, self.spine_places, self.timing)
        if self.played:
            self.hold_last_pose(first)  # where nothing plays between them
            first = min(max(first, 1), self.end)
            last = max(first, last)
            if first <= self.timing.last:
                first = self._follow(source, first, last)
            else:  # clips of less than a frame leave none in which it would be seen
                last = first - 1
        else:
            self._begin(source, first, last)
        self.played.append(PlayedPiece(piece, first, last, self.placement))

    def add_lead_in(self, piece: MotionPiece) -> None:
        """Add a piece after the assembled frames, and replace these by the earlier frames of the piece's motion."""
        first, last = self.end, round((piece.end - self.timing.begin) * self.timing.frame_rate)
        source = PieceSource(piece, self.spine_places, self.timing)
        self.placement = self._alignment(source, first, first - 1, first - 1).placement
        self.played.append(PlayedPiece(piece, first, max(last, first), self.placement))
        frames = np.arange(self.played[-1].last + 1)
        there = self.played[-1].motion_frames(frames, self.timing) > -0.5 * speed_at(piece.speed, 0.0)
        source, frames = source.placed(self.placement), np.maximum(frames, frames[there][0])
        self.channels[: len(frames)], self.contact_mask[:, : len(frames)] = (
            source.channels(frames),
            source.contact_mask(frames),
        )
        self.end = len(frames)

    def contacts(self) -> tuple[ContactInterval, ...]:
        """Contact intervals of the row."""
        return tuple(
            ContactInterval("", point, first, last)
            for point, mask in zip(PIECE_CONTACT_POINTS, self.contact_mask, strict=True)
            for first, last in spans_of(mask)
        )

    def _alignment(self, source: PieceSource, begins: int, first: int, last: int) -> ClipAlignment:
        """Placement and steps of a piece that begins in frame ``begins``, from both motions in ``first`` to
        ``last``.
        """
        frames = np.arange(first, last + 1)
        both = (
            self.contact_mask[FOOT_MASK_ROWS][:, frames]
            & source.contact_mask(frames)[FOOT_MASK_ROWS]
            & self._stay(source, last)
        ).T
        shares = ease((frames - first + 1.0) / (len(frames) + 1.0), EaseShape.QUINTIC)
        weights = shares * (1.0 - shares) + 1e-3
        piece, known = source.piece, (self.channels[frames], source.channels(frames), both, self.spine_places)
        if not piece.joined:
            return alignment_by_steps(*known, source.placement_about_root(begins, piece.own))
        found = clip_alignment(*known, weights)
        if piece.own == IDENTITY_TRANSFORM:
            return found
        return alignment_by_steps(*known, source.placement_about_root(begins, piece.own, found.placement))

    def _stay(self, source: PieceSource, frame: int) -> Mask:
        """Mask (4, 1) of the ``FOOT_MASK_ROWS`` whose foot keeps standing after ``frame``.

        A foot that is lifted soon counts as in the air.
        """
        soon = source.contact_mask(
            np.arange(frame, frame + round(LEAST_TRANSITION_SECONDS * self.timing.frame_rate) + 1)
        )[FOOT_MASK_ROWS]
        stays = (soon[0::2] | soon[1::2]).all(axis=1)
        return np.repeat(stays, 2)[:, None]

    def _begin(self, source: PieceSource, first: int, last: int) -> None:
        """Add the first piece."""
        self.placement = source.placement_about_root(first, source.piece.own)
        self._put(source.placed(self.placement), first, last)

    def hold_last_pose(self, until: int) -> None:
        """Hold the last pose up to frame ``until``, exclusive."""
        if until > self.end:
            self._hold(until)

    def _hold(self, until: int) -> None:
        self._change(Change(self.end))
        frames = slice(self.end, until)
        self.channels[frames], self.contact_mask[:, frames] = (
            self.channels[self.end - 1],
            self.contact_mask[:, [self.end - 1]],
        )
        self.end = until

    def _change(self, change: Change) -> None:
        """Add ``change``, and remove those at the same time or later, whose motion is never seen."""
        self.changes = [*(each for each in self.changes if each.first < change.first), change]

    def _follow(self, source: PieceSource, first: int, last: int) -> int:
        """Add a piece whose change is at ``first`` or later, at the latest where the row ends; return the frame of the
        change.
        """
        if not self._goes_on(source, first):
            first = self._most_alike(source, first, min(self.end, last))
            self.placement = self._alignment(source, first, first - 1, first - 1).placement
            there = source.placed(self.placement).channels(np.array([first - 1]))
            way = float(np.linalg.norm((there[0] - self.channels[first - 1])[channel.HIPS : channel.HIPS + 2]))
            self._change(Change(first, source.piece.ease, way > FOOT_STEP_LIMIT, planned=not source.piece.ease))
        self._put(source.placed(self.placement), first, last)
        self.played[-1] = replace(self.played[-1], last=min(self.played[-1].last, first - 1))
        return first

    def _goes_on(self, source: PieceSource, frame: int) -> bool:
        """True if a piece continues the motion of the previous piece in ``frame``, as the parts of a split clip do."""
        piece, before = source.piece, self.played[-1]
        alike = piece.motion is before.piece.motion and piece.mirrored == before.piece.mirrored
        if not alike or not piece.joined or piece.own != IDENTITY_TRANSFORM or piece.speed != before.piece.speed:
            return False
        frames = [each.motion_frames(np.array([frame]), self.timing) for each in (before, replace(before, piece=piece))]
        return bool(np.abs(frames[1] - frames[0])[0] < SAME_FRAME_TOLERANCE)

    def _most_alike(self, source: PieceSource, first: int, last: int) -> int:
        """Frame from ``first`` to ``last``, within ``MOST_TRANSITION_SECONDS``, before which both motions are most
        alike.
        """
        last = min(last, first + round(MOST_TRANSITION_SECONDS * self.timing.frame_rate))
        if last - first < 2:
            return first
        frames = np.arange(first - 1, last)
        gaps = joint_vectors(channel_difference(self.channels[frames], source.channels(frames)))
        paces = np.gradient(gaps, axis=0) * self.timing.frame_rate * PACE_ERROR_SECONDS
        others = (self.contact_mask[FOOT_MASK_ROWS][:, frames] != source.contact_mask(frames)[FOOT_MASK_ROWS]).sum(
            axis=0
        )
        unlike = (gaps**2 + paces**2).sum(axis=(1, 2)) + FOOT_MISMATCH_COST * others
        return first + int(unlike.argmin())

    def _put(self, source: ChannelSource, first: int, last: int) -> None:
        frames = np.arange(first, last + 1)
        self.contact_mask[:, first:] = False
        self.channels[frames], self.contact_mask[:, frames] = source.channels(frames), source.contact_mask(frames)
        self.end = last + 1
