"""Pieces of motions in a row: the frames of each that play, their speed and their placement."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import CONTACT_POINTS, FOOT_POINTS, ContactInterval, ground_contacts
from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import Speed, motion_seconds, playing_seconds
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.joining import PlanarTransform
from studio.core.normalized.mirror import mirrored_contacts, mirrored_motion
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.resample import ResampledMotion
from studio.core.normalized.transition import placed_channels
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]
Mask = NDArray[np.bool_]

PIECE_CONTACT_POINTS = CONTACT_POINTS
IDENTITY_TRANSFORM = PlanarTransform()


@dataclass(frozen=True)
class MotionPiece:
    """Frames ``first`` to ``last`` of a motion, played from ``start`` seconds on at ``speed``.

    ``own`` rotates it about the begin of its root's path, then moves it. If ``joined``, it begins at the end of the
    previous piece. ``ease`` is the length in seconds of a transition without overlap; 0 for as long as it needs.
    """

    motion: NormalizedMotion
    contacts: tuple[ContactInterval, ...]
    first: int
    last: int
    start: float = 0.0
    speed: Speed = 1.0
    mirrored: bool = False
    own: PlanarTransform = IDENTITY_TRANSFORM
    joined: bool = True
    ease: float = 0.0
    origin: tuple[int, int] = (0, 0)
    """Index of the clip in its row, and index of the repeat of that clip."""

    @property
    def end(self) -> float:
        """Time in seconds of its last frame."""
        rate = self.motion.frame_rate
        if not isinstance(self.speed, KeyedNumber):
            return self.start + (self.last - self.first) / (rate * self.speed)
        first, last = playing_seconds(self.speed, (self.first / rate, self.last / rate)).tolist()
        return float(self.start + last - first)

    def frames_after(self, seconds: FloatArray) -> FloatArray:
        """Frames (N,) of the motion, with fractions, at ``seconds`` (N,) after the start."""
        rate = self.motion.frame_rate
        if not isinstance(self.speed, KeyedNumber):
            return np.asarray(self.first + seconds * self.speed * rate)
        return np.asarray(motion_seconds(self.speed, playing_seconds(self.speed, self.first / rate) + seconds) * rate)

    @property
    def is_carried(self) -> bool:
        """True if hands, knees or seat touch the ground in the frames that play."""
        there = [each for each in self.contacts if each.last >= self.first and each.first <= self.last]
        return any(each.point not in FOOT_POINTS for each in ground_contacts(there))

    @property
    def is_plain(self) -> bool:
        """True if the motion plays unchanged: at its own speed, not mirrored and not moved."""
        return self.speed == 1.0 and not self.mirrored and self.own == IDENTITY_TRANSFORM


@dataclass(frozen=True)
class PlayedPiece:
    """Piece as it plays in frames ``first`` to ``last`` of a row, with its ``placement``."""

    piece: MotionPiece
    first: int
    last: int
    placement: PlanarTransform

    def motion_frames(self, frames: NDArray[Any], timing: Timing) -> FloatArray:
        """Frames (N,) of the piece's own motion, with fractions, that play in ``frames`` (N,) of the row."""
        return self.piece.frames_after(timing.begin + frames / timing.frame_rate - self.piece.start)


class ChannelSource(Protocol):
    """Source of channels and contacts for the frames of a row."""

    def channels(self, frames: NDArray[np.int64]) -> FloatArray:
        """Channels, (N, C), in ``frames`` (N,) of the row."""

    def contact_mask(self, frames: NDArray[np.int64]) -> Mask:
        """Contact mask, (P, N), of ``PIECE_CONTACT_POINTS`` in ``frames`` (N,) of the row."""


@dataclass
class HeldPose(ChannelSource):
    """Channel source with one pose and its contacts in every frame."""

    pose: FloatArray
    standing: Mask

    def channels(self, frames: NDArray[np.int64]) -> FloatArray:
        return np.tile(self.pose, (len(frames), 1))

    def contact_mask(self, frames: NDArray[np.int64]) -> Mask:
        return np.tile(self.standing[:, None], (1, len(frames)))


class PieceSource(ChannelSource):
    """Channel source that samples a piece at the frames of the row."""

    def __init__(
        self,
        piece: MotionPiece,
        spine_places: FloatArray,
        timing: Timing,
        placement: PlanarTransform = IDENTITY_TRANSFORM,
    ) -> None:
        self.piece, self._timing, self._places, self.placement = piece, timing, spine_places, placement
        motion = mirrored_motion(piece.motion) if piece.mirrored else piece.motion
        self._motion = ResampledMotion(motion, spine_places)
        self._motion_frames = PlayedPiece(piece, 0, 0, placement).motion_frames

    def placed(self, placement: PlanarTransform) -> "PieceSource":
        """Copy with another placement."""
        return PieceSource(self.piece, self._places, self._timing, placement)

    def channels(self, frames: NDArray[np.int64]) -> FloatArray:
        sampled = self._motion.at(self._motion_frames(frames, self._timing))
        return placed_channels(sampled, self.placement.turn, np.array(self.placement.offset))

    def contact_mask(self, frames: NDArray[np.int64]) -> Mask:
        own = np.rint(self._motion_frames(frames, self._timing)).clip(0, self.piece.motion.frame_count - 1)
        contacts = mirrored_contacts(self.piece.contacts) if self.piece.mirrored else self.piece.contacts
        standing = np.zeros((len(PIECE_CONTACT_POINTS), len(frames)), dtype=bool)
        for contact in contacts:
            standing[PIECE_CONTACT_POINTS.index(contact.point)] |= (own >= contact.first) & (own <= contact.last)
        return standing

    def placement_about_root(
        self, frame: int, own: PlanarTransform, first: PlanarTransform = IDENTITY_TRANSFORM
    ) -> PlanarTransform:
        """Placement ``first``, followed by ``own``: a rotation about the position of the root in ``frame``, and an
        offset.
        """
        channels = placed_channels(self.channels(np.array([frame])), first.turn, np.array(first.offset))
        place = channels[0, channel.HIPS : channel.HIPS + 2]
        c, s = np.cos(own.turn), np.sin(own.turn)
        x, y = place - [c * place[0] - s * place[1], s * place[0] + c * place[1]] + np.array(own.offset)
        return PlanarTransform(own.turn, (float(x), float(y))).after(first)
