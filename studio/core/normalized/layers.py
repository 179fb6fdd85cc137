"""Layers over a row of clips: a part of the body plays another clip, or the difference of a clip from a reference pose
is added.

Layers are applied in channels, which hold no lengths: the trunk relative to the pelvis, head and arms to the thorax,
legs with the hips in the world. Contacts of a limb are those of the layer that moves it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch, spans_of
from studio.core.curves.activation import EaseShape, ease
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.blending import Flight, planned_steps, raise_feet, step_seconds
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.differences import blended_channels, channel_difference, with_difference
from studio.core.normalized.joining import ClipAlignment, PlanarTransform, alignment_by_steps, clip_alignment
from studio.core.normalized.mirror import mirrored_motion
from studio.core.normalized.pieces import PIECE_CONTACT_POINTS, Mask, MotionPiece
from studio.core.normalized.resample import ResampledMotion
from studio.core.normalized.row import FOOT_MASK_ROWS
from studio.core.normalized.transition import MOST_TRANSITION_SECONDS, fade_seconds, joint_peaks, placed_channels
from studio.core.project_cache import project_cache
from studio.core.stage.layer import Region

FloatArray = NDArray[np.float64]

OWN_CONTACTS_BEGIN, OWN_CONTACTS_ONLY = 0.1, 0.9
"""Weights of a layer: below the first, contacts of the motion under it hold; above the second, its own contacts do."""

CONTACT_BREAK_SECONDS = 0.1
"""Least time in seconds without contact in another clip for which a contact is interrupted."""


@dataclass(frozen=True)
class PlayedLayer:
    """Layer as it is played: ``pieces`` are the repeats of its clip; the other fields are those of ``Layer``."""

    pieces: tuple[MotionPiece, ...]
    region: Region
    weight: float
    fades: tuple[float, float]
    additive: bool
    reference: int


@project_cache(maxsize=64)
def with_layers(pieces: tuple[MotionPiece, ...], overlays: tuple[PlayedLayer, ...]) -> Composite:
    """Composite of a row of ``pieces`` with ``overlays``, the later over the earlier; equal arguments give the same
    cached value.
    """
    row = compose_pieces(pieces, blends=any(piece.is_carried for overlay in overlays for piece in overlay.pieces))
    for overlay in overlays:
        if overlay.weight > 0.0:
            row = _LayeredRow(row, overlay).composite()
    return row


class _LayeredRow:
    """Row with one layer over it, in the frames in which the layer plays."""

    def __init__(self, row: Composite, overlay: PlayedLayer) -> None:
        self._row, self._overlay = row, overlay
        self._own = compose_pieces(overlay.pieces, blends=True)
        self._places = row.motion.spine_places
        self._columns = columns_of(overlay.region, row.motion.channels.shape[1])
        timing = row.timing
        times = timing.begin + np.arange(row.motion.frame_count) / timing.frame_rate
        within = (times > self._own.timing.start - 1e-9) & (times < self._own.timing.end + 1e-9)
        self._frames = np.flatnonzero(within[timing.first : timing.last + 1]) + timing.first
        self._times = times[self._frames]

    def composite(self) -> Composite:
        """The row with the layer over it."""
        if not len(self._frames):
            return self._row
        below = self._row.motion.channels[self._frames]
        own = ResampledMotion(self._own.motion, self._places).at(self._own.timing.frames_at(self._times))
        comes, goes = ClipAlignment(PlanarTransform()), ClipAlignment(PlanarTransform())
        if self._overlay.additive:
            own = self._added(below, own)
        elif Region.LEGS in self._overlay.region.parts:
            own, comes, goes = self._placed(below, own)
        shares = self._shares(below, own, step_seconds(comes), step_seconds(goes))
        flights = self._flights(shares, comes, goes)
        over = blended_channels(below, own, shares)
        over[shares == 1.0] = own[shares == 1.0]
        channels = np.array(self._row.motion.channels)
        changed = self._frames[shares > 0.0]
        channels[np.ix_(changed, self._columns)] = over[shares > 0.0][:, self._columns]
        raise_feet(channels, flights, 0)
        channels.setflags(write=False)
        contacts = self._row.contacts if self._overlay.additive else self._contacts(shares, flights)
        return replace(self._row, motion=replace(self._row.motion, channels=channels), contacts=contacts)

    def _added(self, below: FloatArray, own: FloatArray) -> FloatArray:
        """Channels ``below`` plus the clip's difference from its reference pose; ground offsets rotate with
        the body.
        """
        piece = self._overlay.pieces[0]
        motion = mirrored_motion(piece.motion) if piece.mirrored else piece.motion
        frame = piece.first if self._overlay.reference < 0 else min(self._overlay.reference, motion.frame_count - 1)
        pose = ResampledMotion(motion, self._places).at(np.array([float(frame)]))
        by = channel_difference(np.tile(pose, (len(own), 1)), own)
        turn = below[:, channel.YAW] - pose[0, channel.YAW]
        x, y = by[:, channel.HIPS].copy(), by[:, channel.HIPS + 1].copy()
        by[:, channel.HIPS], by[:, channel.HIPS + 1] = (
            np.cos(turn) * x - np.sin(turn) * y,
            np.sin(turn) * x + np.cos(turn) * y,
        )
        return with_difference(below, by)

    def _placed(self, below: FloatArray, own: FloatArray) -> tuple[FloatArray, ClipAlignment, ClipAlignment]:
        """Channels of the clip, placed so that its legs stand as those below at its begin, and the steps as it fades in
        and out.
        """
        count = max(round(MOST_TRANSITION_SECONDS / 2 * self._row.timing.frame_rate), 1)
        both = (self._stands(self._row)[FOOT_MASK_ROWS] & self._own_stands()[FOOT_MASK_ROWS])[:, self._frames].T
        begin, end = slice(0, count), slice(max(len(own) - count, 0), len(own))
        comes = clip_alignment(below[begin], own[begin], both[begin], self._places, np.ones(len(both[begin])))
        if comes.placement != PlanarTransform():
            own = placed_channels(own, comes.placement.turn, np.array(comes.placement.offset))
        return own, comes, alignment_by_steps(own[end], below[end], both[end], self._places, PlanarTransform())

    def _flights(self, shares: FloatArray, comes: ClipAlignment, goes: ClipAlignment) -> list[Flight]:
        """Flights of the feet that step while the layer fades in and out, in the row's frames."""
        share, middle = shares / self._overlay.weight, len(shares) // 2
        first = self._frames[0]
        ends = (
            (comes, np.flatnonzero((share[:middle] > OWN_CONTACTS_BEGIN) & (share[:middle] < OWN_CONTACTS_ONLY))),
            (
                goes,
                middle + np.flatnonzero((share[middle:] > OWN_CONTACTS_BEGIN) & (share[middle:] < OWN_CONTACTS_ONLY)),
            ),
        )
        return [
            flight
            for join, fading in ends
            if len(fading)
            for flight in planned_steps(join.steps, first + fading[0], first + fading[-1])
        ]

    def _shares(self, below: FloatArray, own: FloatArray, coming: float, going: float) -> FloatArray:
        """Weights (N,) of the layer: it fades in and out, except where the row itself begins or ends.

        ``coming`` and ``going`` are the seconds that steps of the feet need in the two fades.
        """
        row, rate = self._row.timing, self._row.timing.frame_rate
        begin, end = self._own.timing.start, self._own.timing.end
        by = np.where(self._columns, channel_difference(below, own), 0.0)
        peaks = np.maximum(self._peaks_below(), joint_peaks(own, rate))
        reach = min(round(MOST_TRANSITION_SECONDS * rate), len(by))
        longest = (end - begin) / 2.0
        shares = np.full(len(self._times), self._overlay.weight)
        ends = (
            (begin > row.start + 0.5 / rate, self._overlay.fades[0], by[:reach], self._times - begin, coming),
            (end < row.end - 0.5 / rate, self._overlay.fades[1], by[len(by) - reach :], end - self._times, going),
        )
        for fades, asked, differs, since, steps in ends:
            seconds = min(asked or max(fade_seconds(differs, peaks), steps), longest)
            if fades and seconds > 0.0:
                shares *= ease(since / seconds, EaseShape.QUINTIC)
        return shares

    def _peaks_below(self) -> FloatArray:
        """Peak joint accelerations of the clips under this layer, without the jumps at changes of clips."""
        motion, first, stop = self._row.motion, self._frames[0], self._frames[-1] + 1
        between = [slice(max(each.start, first), min(each.stop, stop)) for each in motion.parts]
        peaks = [joint_peaks(motion.channels[each], motion.frame_rate) for each in between if each.stop > each.start]
        return np.asarray(np.max(peaks, axis=0))

    def _contacts(self, shares: FloatArray, flights: Sequence[Flight]) -> tuple[ContactInterval, ...]:
        """Contacts of the row under the layer, with those of the layer on its limbs.

        A contact in both motions lasts through the fades, unless its foot steps.
        """
        own, ended = points_of(self._overlay.region)
        if not own and not ended:
            return self._row.contacts
        share = np.zeros(self._row.motion.frame_count)
        share[self._frames] = shares
        below, theirs = self._stands(self._row), self._own_stands()
        contacts: list[ContactInterval] = []
        for row, point in enumerate(PIECE_CONTACT_POINTS):
            as_before = [each for each in self._row.contacts if each.point is point]
            standing = below[row]
            if point in own:
                kept = (share < OWN_CONTACTS_BEGIN) | theirs[row]
                standing = (below[row] & kept) | (theirs[row] & (share > OWN_CONTACTS_ONLY))
                longest = CONTACT_BREAK_SECONDS * self._row.timing.frame_rate
                for first, last in spans_of(below[row] & ~standing):
                    if (
                        last - first < longest
                        and standing[max(first - 1, 0)]
                        and standing[min(last + 1, len(share) - 1)]
                    ):
                        standing[first : last + 1] = True
                for each in flights:
                    if point.is_foot and point.side == each.step.side:
                        standing[each.last_contact + 1 : each.next_contact] = False
            elif point in ended:
                standing = below[row] & (share < OWN_CONTACTS_BEGIN)
            if np.array_equal(standing, below[row]):
                contacts += as_before
            else:
                contacts += [ContactInterval("", point, first, last) for first, last in spans_of(standing)]
        return tuple(contacts)

    def _stands(self, row: Composite) -> Mask:
        """Contact mask (P, F) of a row, in its frames."""
        standing = np.zeros((len(PIECE_CONTACT_POINTS), row.motion.frame_count), dtype=bool)
        for contact in row.contacts:
            standing[PIECE_CONTACT_POINTS.index(contact.point), contact.first : contact.last + 1] = True
        return standing

    def _own_stands(self) -> Mask:
        """Contact mask (P, F) of the layer, in the row's frames; False where it does not play."""
        standing = np.zeros((len(PIECE_CONTACT_POINTS), self._row.motion.frame_count), dtype=bool)
        rows = np.rint(self._own.timing.frames_at(self._times)).astype(np.int64)
        standing[:, self._frames] = self._stands(self._own)[:, rows]
        return standing


def columns_of(region: Region, width: int) -> Mask:
    """Mask (C,) of the columns of channels, ``width`` in number, that belong to a region."""
    mask = np.zeros(width, dtype=bool)
    for part in region.parts:
        for first, count in _columns(part, width):
            mask[first : first + count] = True
    return mask


def _columns(part: Region, width: int) -> list[tuple[int, int]]:
    match part:
        case Region.TRUNK:
            return [(channel.SPINE, width - channel.SPINE)]
        case Region.HEAD:
            return [(channel.NECK, 8), (channel.HEAD_SHIFT, 3)]
        case Region.LEFT_ARM | Region.RIGHT_ARM:
            side = int(part is Region.RIGHT_ARM)
            return [(channel.CLAVICLE + 4 * side, 4), (channel.HAND + 4 * side, 4), *_limb(side)]
    return [(channel.HIPS, 8), (channel.FOOT, 16), (channel.HIP_SHIFT, 6), *_limb(2), *_limb(3)]


def _limb(limb: int) -> list[tuple[int, int]]:
    folds = [(column + limb, 1) for column in (channel.LIMB_SLACK, channel.LIMB_OFF_PLANE, channel.LIMB_BEND)]
    return [(channel.LIMB_FRAME + 4 * limb, 4), *folds, (channel.LIMB_TWIST + 2 * limb, 2)]


Points = frozenset[ContactPoint | Touch]


def points_of(region: Region) -> tuple[Points, Points]:
    """Contact points and touches of the limbs of a region, and the two-handed touches that end if the region has one
    arm.
    """
    arms = region.parts & Region.ARMS.parts
    hands: set[ContactPoint | Touch] = set()
    for arm in arms:
        side = int(arm is Region.RIGHT_ARM)
        hands |= {
            each
            for each in PIECE_CONTACT_POINTS
            if each.member not in ("heel", "toe", "knee", "seat") and each.side == side
        }
    both = frozenset[ContactPoint | Touch]((Touch.HANDS_TOGETHER, Touch.HANDS_ON_THING))
    legs = {each for each in PIECE_CONTACT_POINTS if each.member in ("heel", "toe", "knee", "seat")}
    own = frozenset(hands) | (frozenset(legs) if Region.LEGS in region.parts else frozenset())
    if len(arms) == 2:
        return own, frozenset()
    return own - both, both if arms else frozenset()
