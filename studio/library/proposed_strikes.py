"""Proposal of the strikes in a motion: their frames, limb and moment of the hit, found by speed and reach.

A strike moves fast from a bent limb out to its greatest horizontal reach, which is taken as the hit. Other fast motions
lack this pattern: blocks and waves do not reach far from where they began, jumps and runs carry both arms or the whole
body, victory poses go up. While a leg kicks, the arms only keep the balance. Speeds are in limb lengths per second,
reaches and heights in limb lengths. All thresholds were chosen on real captures.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from studio.core.body.canonical import BodyLayout
from studio.core.body.morphology import Morphology
from studio.library.clip_labels import ClipLabel, HitSegment, Kind, Limb

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LIMB_SWING_SECONDS, HIT_WINDOW_SECONDS, HIT_SPACING_SECONDS = 0.45, 0.15, 0.4
"""In seconds: time of a limb's swing before its hit, time on either side in which a hit has the greatest reach, and
least time between two hits of a limb.
"""
SPEED_SPAN_SECONDS = 1 / 30
"""Seconds before and after a frame between which its speed is measured."""
SECONDS_BEFORE_HIT, SECONDS_AFTER_HIT = 0.6, 0.5
"""Length of a proposed clip in seconds before and after its hit."""
KICK_BALANCE_SECONDS = 0.6
"""Seconds before and after a raised leg in which arm motions are taken as balancing and not as strikes."""
ARM_STRIKE_THRESHOLDS = {"reach": 0.6, "rise": 0.36, "speed": 6.0, "outward": 3.3, "bent": 0.66}
"""Least reach, gain in reach, speed and outward speed of a punch; the arm is stretched to ``bent`` or less before it.
"""
LEG_STRIKE_THRESHOLDS = {"reach": 0.75, "rise": 0.3, "speed": 2.8, "outward": 1.5}
"""Least reach, gain in reach, speed and outward speed of a kick."""
PUNCH_HEIGHTS, KICK_HEIGHT = (-0.55, 0.5), -0.35
"""Lowest and highest wrist relative to the shoulder, and lowest ankle relative to the hip, in limb lengths."""
FIST_BEHIND_SHOULDER = -0.3
"""Least distance of a fist ahead of its shoulder in limb lengths; negative is behind."""
LEAST_HIP_HEIGHT, LEAST_HEAD_HEIGHT = 0.6, {True: 0.45, False: 0.3}
"""Least height of the hips above the ground in leg lengths; and of the head above the hips, as a fraction of the length
of trunk, neck and head, for the strikes of arms (True) and of legs (False).
"""
HIGHEST_SUPPORT_ANKLE = -0.7
"""Highest ankle of the supporting leg relative to its hip, in leg lengths; if it is higher, both legs are in the air.
"""
RUNNING_SPEED = 2.0
"""Mean speed of the hips, in leg lengths a second, above which the body runs."""
BOTH_ARMS_FRACTION = 0.6
"""Fraction of a punch's gain in reach and of its speed; if the other arm exceeds both at the same time, the arms move
together and it is no punch.
"""
RETRACTED_REACH_FRACTION = 0.6
"""Fraction of an arm's reach below which it is drawn back, and may hit again at once."""
LONGEST_BURST_SECONDS, FAST_PUNCH_SPEED = 0.135, 8.5
"""Longest time in seconds in which a fist moves out at more than half its peak speed; and the speed above which it may
take longer, as in hooks.
"""
KICK_RETURN_SECONDS, HELD_REACH_FRACTION = 0.3, 0.9
"""Seconds in which a leg comes back after a kick, and the fraction of its reach above which it has not come back."""
MOST_BEAT_SECONDS, DANCE_SWINGS = 0.7, 4
"""Longest time in seconds from one leg's swing to the other's in a dance, and the number of alternate swings that make
a dance.
"""


@dataclass(frozen=True, eq=False)
class LimbTrack:
    """Motion of one limb over F frames, relative to its root, in limb lengths and limb lengths per second.

    ``reach`` is horizontal, ``stretch`` is the distance in space, ``speed`` is relative to the hips, and ``outward`` is
    the speed of the reach, all (F,). ``from_root`` (F, 3) is the vector to the end of the limb.
    """

    reach: FloatArray
    stretch: FloatArray
    speed: FloatArray
    outward: FloatArray
    from_root: FloatArray


@dataclass(frozen=True, eq=False)
class BodyTrack:
    """Motion of a body over F frames: all four limbs, headings (F, 2), heights (F,) and hip speed (F,)."""

    limbs: tuple[LimbTrack, ...]
    heading: FloatArray
    hip_height: FloatArray
    head_height: FloatArray
    hip_speed: FloatArray
    rate: float

    def window(self, frame: int, before: float, after: float = 0.0) -> slice:
        """Frames from ``before`` seconds before ``frame`` to ``after`` seconds after it, both included."""
        return slice(max(frame - int(before * self.rate), 0), frame + int(after * self.rate) + 1)


def proposed_labels(
    positions: FloatArray, rotations: FloatArray, body: Morphology, rate: float, first_frame: int = 0
) -> list[ClipLabel]:
    """Labels of the proposed strikes of a motion on its own actor's body, in order of time.

    ``positions`` (F, K+23, 3) and ``rotations`` (F, K+18, 3, 3) are those of the posed body; ``first_frame`` is the
    number of the first frame.
    """
    if len(positions) < 2:
        return []
    track = body_track(positions, rotations, body, rate)
    hits: list[tuple[int, Limb]] = []
    for limb in Limb:
        likely = [frame for frame in _peaks(track, limb, first_frame) if _strikes(track, limb, frame)]
        hits += [(frame, limb) for frame in _apart(track, limb, likely)]
    hits = _without_dance(hits, rate)
    return [_clip(track, frame, limb, first_frame, len(positions) - 1) for frame, limb in sorted(hits)]


def body_track(positions: FloatArray, rotations: FloatArray, body: Morphology, rate: float) -> BodyTrack:
    """Motion of the limbs, hips and head of a posed body."""
    layout = body.layout
    hips = 0.5 * (positions[:, layout.hip_point(0)] + positions[:, layout.hip_point(1)])
    forward = rotations[:, 0, :2, 0]
    heading = forward / np.maximum(np.linalg.norm(forward, axis=1, keepdims=True), 1e-9)
    trunk = body.spine_length + body.neck
    return BodyTrack(
        tuple(_limb_track(positions, layout, limb, hips, rate) for limb in Limb),
        heading,
        hips[:, 2] / body.leg_length,
        (positions[:, layout.head_end, 2] - hips[:, 2]) / (trunk + body.head),
        np.linalg.norm(np.gradient(hips[:, :2], axis=0), axis=1) * rate / body.leg_length,
        rate,
    )


def _limb_track(positions: FloatArray, layout: BodyLayout, limb: Limb, hips: FloatArray, rate: float) -> LimbTrack:
    root = layout.collar_point(limb.side) + 1 if limb.is_arm else layout.hip_point(limb.side)
    bones = np.linalg.norm(np.diff(positions[:, root : root + 3], axis=1), axis=2)
    length = float(np.median(bones.sum(axis=1)))
    end = positions[:, root + 2]
    away = (end - positions[:, root]) / length
    reach = np.linalg.norm(away[:, :2], axis=1)
    speed = np.linalg.norm(_slope(end - hips, rate), axis=1) / length
    return LimbTrack(reach, np.linalg.norm(away, axis=1), speed, _slope(reach, rate), away)


def _slope(values: FloatArray, rate: float) -> FloatArray:
    """Rate of change per second of ``values`` (F, ...), measured over the same time at every frame rate."""
    half = max(round(SPEED_SPAN_SECONDS * rate), 1)
    frames = np.arange(len(values))
    before, after = np.maximum(frames - half, 0), np.minimum(frames + half, len(values) - 1)
    seconds = (after - before).reshape(-1, *[1] * (values.ndim - 1)) / rate
    return (values[after] - values[before]) / seconds


def _peaks(track: BodyTrack, limb: Limb, first_frame: int) -> list[int]:
    """Frames in which the reach of a limb is the greatest within ``HIT_WINDOW_SECONDS``."""
    reach = track.limbs[limb].reach
    farthest = maximum_filter1d(reach, 2 * max(round(HIT_WINDOW_SECONDS * track.rate), 1) + 1, mode="nearest")
    frames = np.flatnonzero(reach >= farthest)
    return [int(frame) for frame in frames if first_frame + 2 < frame < len(reach) - 1]


def _strikes(track: BodyTrack, limb: Limb, frame: int) -> bool:
    own, least = track.limbs[limb], ARM_STRIKE_THRESHOLDS if limb.is_arm else LEG_STRIKE_THRESHOLDS
    swing = track.window(frame, LIMB_SWING_SECONDS)
    thrown = slice(swing.start, frame + 2)  # the speed of a hit is seen a frame later
    gained = own.reach[frame] - own.reach[swing].min()
    fast = own.speed[thrown].max() >= least["speed"] and own.outward[thrown].max() >= least["outward"]
    far = own.reach[frame] >= least["reach"] and gained >= least["rise"]
    if not (fast and far and _stands(track, limb, frame)):
        return False
    return _punches(track, limb, frame, swing, gained) if limb.is_arm else _kicks(track, limb, frame)


def _stands(track: BodyTrack, limb: Limb, frame: int) -> bool:
    return bool(
        track.hip_height[frame] > LEAST_HIP_HEIGHT and track.head_height[frame] > LEAST_HEAD_HEIGHT[limb.is_arm]
    )


def _kicks(track: BodyTrack, limb: Limb, frame: int) -> bool:
    other = track.limbs[limb ^ 1].from_root[frame, 2]
    raised = track.limbs[limb].from_root[frame, 2] > KICK_HEIGHT
    return bool(raised and other < HIGHEST_SUPPORT_ANKLE) and not _is_shown(track, limb, frame)


def _is_shown(track: BodyTrack, limb: Limb, frame: int) -> bool:
    """True if a leg stays stretched after ``frame``; False if the motion ends too soon to tell."""
    reach, after = track.limbs[limb].reach, track.window(frame, 0.0, KICK_RETURN_SECONDS)
    return bool(after.stop <= len(reach) and reach[after].min() > HELD_REACH_FRACTION * reach[frame])


def _punches(track: BodyTrack, limb: Limb, frame: int, swing: slice, gained: float) -> bool:
    own, other = track.limbs[limb], track.limbs[limb ^ 1]
    low, high = PUNCH_HEIGHTS
    ahead = own.from_root[frame, :2] @ track.heading[frame]
    if (
        not low < own.from_root[frame, 2] < high
        or ahead < FIST_BEHIND_SHOULDER
        or own.stretch[swing].min() > ARM_STRIKE_THRESHOLDS["bent"]
    ):
        return False
    if track.hip_speed[track.window(frame, 0.5, 0.5)].mean() > RUNNING_SPEED or _raises_a_leg(track, frame):
        return False
    thrown = slice(swing.start, frame + 2)
    if own.speed[thrown].max() < FAST_PUNCH_SPEED and _burst(own.outward, thrown) > LONGEST_BURST_SECONDS * track.rate:
        return False
    together = other.reach[track.window(frame, 0.1, 0.1)].max() - other.reach[swing].min()
    return not (
        together > BOTH_ARMS_FRACTION * gained
        and other.speed[thrown].max() > BOTH_ARMS_FRACTION * own.speed[thrown].max()
    )


def _burst(outward: FloatArray, thrown: slice) -> float:
    """Length in frames, with fractions, of the interval around the peak of ``outward`` in which it exceeds half the
    peak.
    """
    best = thrown.start + int(outward[thrown].argmax())
    half = 0.5 * outward[best]
    slow = np.flatnonzero(outward <= half)
    before, after = slow[slow < best], slow[slow > best]

    def crossing(inner: int, outer: int) -> float:
        return inner + (outer - inner) * float((outward[inner] - half) / (outward[inner] - outward[outer]))

    begin = crossing(before[-1] + 1, before[-1]) if len(before) else 0.0
    end = crossing(after[0] - 1, after[0]) if len(after) else len(outward) - 1.0
    return end - begin


def _raises_a_leg(track: BodyTrack, frame: int) -> bool:
    around = track.window(frame, KICK_BALANCE_SECONDS, KICK_BALANCE_SECONDS)
    legs = (track.limbs[limb] for limb in (Limb.LEFT_LEG, Limb.RIGHT_LEG))
    return any(
        bool(((leg.reach[around] > LEG_STRIKE_THRESHOLDS["reach"]) & (leg.from_root[around, 2] > KICK_HEIGHT)).any())
        for leg in legs
    )


def _without_dance(hits: list[tuple[int, Limb]], rate: float) -> list[tuple[int, Limb]]:
    """Hits, without those of legs that swing alternately to a beat."""
    kicks = sorted(hit for hit in hits if not hit[1].is_arm)
    turns = [list[tuple[int, Limb]]()]
    for kick in kicks:
        if turns[-1] and (kick[1] is turns[-1][-1][1] or kick[0] - turns[-1][-1][0] > MOST_BEAT_SECONDS * rate):
            turns.append([])
        turns[-1].append(kick)
    danced = {kick for turn in turns if len(turn) >= DANCE_SWINGS for kick in turn}
    return [hit for hit in hits if hit not in danced]


def _apart(track: BodyTrack, limb: Limb, frames: list[int]) -> list[int]:
    """Frames of hits that are not too near a longer-reaching hit; an arm that is drawn back between two hits keeps
    both.
    """
    reach, kept = track.limbs[limb].reach, list[int]()

    def one_with(frame: int, other: int) -> bool:
        between = reach[min(frame, other) : max(frame, other) + 1]
        came_back = limb.is_arm and between.min() < RETRACTED_REACH_FRACTION * reach[frame]
        return abs(frame - other) < HIT_SPACING_SECONDS * track.rate and not came_back

    for frame in sorted(frames, key=lambda each: -reach[each]):
        if not any(one_with(frame, other) for other in kept):
            kept.append(frame)
    return kept


def _clip(track: BodyTrack, frame: int, limb: Limb, first_frame: int, last_frame: int) -> ClipLabel:
    span = track.window(frame, SECONDS_BEFORE_HIT, SECONDS_AFTER_HIT)
    kind, segment = (Kind.PUNCH, HitSegment.FIST) if limb.is_arm else (Kind.KICK, HitSegment.BALL)
    return ClipLabel(max(span.start, first_frame), min(span.stop - 1, last_frame), frame, limb, kind, segment)
