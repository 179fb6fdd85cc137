"""Composition of a row of clips into one motion: trimmed, retimed, mirrored and placed, in channels without lengths.

The result is a motion like any other, scaled, grounded and solved for any body. At a change of clips the body is
inertialised after it is grounded (``row``); a body that is supported by more than its feet is blended before
(``blending``).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_poses import FingerPoses
from studio.core.captures.contacts import ContactInterval
from studio.core.errors import StudioError
from studio.core.normalized.blending import BlendedRow
from studio.core.normalized.joining import PlanarTransform
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.pieces import MotionPiece, PlayedPiece
from studio.core.normalized.resample import ResampledMotion, common_spine
from studio.core.normalized.row import AssembledRow
from studio.core.normalized.transition import joint_peaks
from studio.core.project_cache import project_cache
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]
FRAME_LIMIT = 250_000
"""Maximum number of frames of a row, pauses included: half an hour at 120 frames per second, about a gigabyte for each
body.
"""


@dataclass(frozen=True, eq=False)
class Composite:
    """Motion composed of a row of pieces, with its contacts, its timing on the stage, and the frames of each piece."""

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    timing: Timing
    played: tuple[PlayedPiece, ...]
    fingers_before: FingerPoses | None = None
    """Finger poses of the last frame shown before this row takes over from another; None if there is none."""

    @property
    def is_plain(self) -> bool:
        """True if this is a single unchanged motion, apart from layers over it."""
        return len(self.played) == 1 and self.played[0].piece.is_plain

    def at(self, frame: int) -> "Composite":
        """Composite of the single ``frame``, which becomes frame 0."""
        motion, timing = self.motion, self.timing
        still = NormalizedMotion(
            motion.name, motion.frame_rate, motion.channels[frame : frame + 1], motion.spine_places, motion.girdle
        )
        played = tuple(replace(each, first=each.first - frame, last=each.last - frame) for each in self.played)
        return Composite(still, (), Timing(timing.stage_time(frame), timing.frame_rate, 0, 0), played)

    def piece_at(self, frame: int) -> PlayedPiece:
        """Piece that plays in ``frame``; of two the later one."""
        begun = [each for each in self.played if each.first <= frame]
        return begun[-1] if begun else self.played[0]


@project_cache(maxsize=64)
def compose_pieces(pieces: tuple[MotionPiece, ...], blends: bool = False) -> Composite:
    """Motion composed of ``pieces`` in the order of their start; equal pieces give the same cached value.

    A single unchanged piece gives its whole motion. The frame rate is the highest of the pieces. With ``blends`` the
    clips are cross-faded, and the result, which has no ``changes``, can be mixed with others.
    """
    ordered = sorted(pieces, key=lambda piece: piece.start)
    first = ordered[0]
    if len(ordered) == 1 and first.is_plain:
        rate = first.motion.frame_rate
        timing = Timing(first.start - first.first / rate, rate, first.first, first.last)
        whole = PlayedPiece(first, 0, first.motion.frame_count - 1, PlanarTransform())
        return Composite(first.motion, first.contacts, timing, (whole,))
    kind = BlendedRow if blends or any(piece.is_carried for piece in ordered) else AssembledRow
    return _filled(kind(*_empty(ordered)), ordered)


def blended_continuation(shown: MotionPiece, played: NormalizedMotion, pieces: Sequence[MotionPiece]) -> Composite:
    """Row of ``pieces`` that continues from ``shown``, a short piece of the latest frames, by a blend.

    The allowed acceleration is that of the recent motion ``played``.
    """
    ordered = [shown, *pieces]
    row = BlendedRow(*_empty(ordered))
    channels = ResampledMotion(played, row.spine_places).at(np.arange(played.frame_count, dtype=np.float64))
    row.peaks = joint_peaks(channels, played.frame_rate)
    return _filled(row, ordered)


def pieces_after(shown: MotionPiece, pieces: Sequence[MotionPiece]) -> Composite:
    """Row of ``pieces`` placed to follow ``shown``, whose own frames are replaced by earlier frames of the
    first piece.
    """
    row = AssembledRow(*_empty([shown, *pieces]))
    row.add(shown)
    row.add_lead_in(pieces[0])
    return _filled(row, pieces[1:])


def _empty(pieces: Sequence[MotionPiece]) -> tuple[FloatArray, Timing]:
    """Spine positions and timing of a row for ``pieces``."""
    return common_spine([piece.motion for piece in pieces]), timing_of_pieces(pieces)


def _filled(row: AssembledRow, pieces: Sequence[MotionPiece]) -> Composite:
    """Composite of ``row`` after ``pieces`` have been added to it."""
    for piece in pieces:
        row.add(piece)
    row.hold_last_pose(row.timing.last + 1)
    name = " + ".join(dict.fromkeys(each.piece.motion.name for each in row.played))
    row.channels.setflags(write=False)
    known = [each.piece.motion.girdle for each in row.played if each.piece.motion.girdle is not None]
    girdle = max(known, key=lambda each: each.length, default=None)
    channels, changes = row.channels, tuple(row.changes)
    motion = NormalizedMotion(name, row.timing.frame_rate, channels, row.spine_places, girdle, changes)
    return Composite(motion, row.contacts(), row.timing, tuple(row.played))


def timing_of_pieces(pieces: Sequence[MotionPiece]) -> Timing:
    """Timing of a row at the highest frame rate of its pieces. Raises StudioError if the row is far too long."""
    rate = max(piece.motion.frame_rate for piece in pieces)
    begin, end = min(piece.start for piece in pieces), max(piece.end for piece in pieces)
    last = round((end - begin) * rate)
    if last >= FRAME_LIMIT:
        raise StudioError(
            f"Its clips play from {begin:,.1f} to {end:,.1f} s: {last + 1:,} frames, of which {FRAME_LIMIT:,} are the"
            " most that are adapted together. Move them nearer to each other."
        )
    return Timing(begin, rate, 0, last)
