"""Contacts: frames in which heels, toes, hands, knees and seat are on the ground, and hands touch something."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.runs import runs_of
from studio.core.windows import bell_average, lowest

FloatArray = NDArray[np.float64]
Span = tuple[int, int]
"""The first and the last frame of a contact."""


class _SidedName(StrEnum):
    """Name made of a side and a member: ``left_heel``, ``right_hand_on_head``."""

    @cached_property
    def side(self) -> int:
        """Side, 0 left, 1 right; a name of neither side, or of both, counts as left."""
        return 1 if self.value.startswith("right") else 0

    @cached_property
    def member(self) -> str:
        """Last word of the name: the point without its side (``heel``), or the part that a hand is on (``head``)."""
        return self.value.rpartition("_")[2]


class ContactPoint(_SidedName):
    """Point of a body that can touch the ground.

    The heel moves with the ankle, the toe with the toe joint, the hand with the wrist; the seat is the middle of the
    hips.
    """

    LEFT_HEEL = "left_heel"
    LEFT_TOE = "left_toe"
    RIGHT_HEEL = "right_heel"
    RIGHT_TOE = "right_toe"
    LEFT_HAND = "left_hand"
    RIGHT_HAND = "right_hand"
    LEFT_KNEE = "left_knee"
    RIGHT_KNEE = "right_knee"
    SEAT = "seat"

    @cached_property
    def is_heel(self) -> bool:
        return self.member == "heel"

    @cached_property
    def is_foot(self) -> bool:
        return self.member in ("heel", "toe")

    @cached_property
    def limb(self) -> int:
        """0, 1 left and right arm, 2, 3 left and right leg, -1 for a point on no limb."""
        return -1 if self.member == "seat" else self.side + (0 if self.member == "hand" else 2)

    @cached_property
    def words(self) -> str:
        """Name for the user: ``left heel``."""
        return self.value.replace("_", " ")


def touching_points(point: ContactPoint, layout: BodyLayout) -> list[int]:
    """Canonical points whose mean is the position of a contact point: one joint, or both hips for the seat."""
    match point.member:
        case "seat":
            return [layout.hip_point(0), layout.hip_point(1)]
        case "hand":
            return [layout.wrist_point(point.side)]
    return [layout.hip_point(point.side) + {"knee": 1, "heel": 2, "toe": 3}[point.member]]


class Touch(_SidedName):
    """Contact of the hands with each other, with a held object or with the body.

    Hands in contact keep their offset from each other, scaled with the length of the arms; an object between them keeps
    its size. A hand on the body keeps its position on the surface of any body shape.
    """

    HANDS_TOGETHER = "hands_together"
    HANDS_ON_THING = "hands_on_thing"
    LEFT_HAND_ON_HEAD = "left_hand_on_head"
    LEFT_HAND_ON_TRUNK = "left_hand_on_trunk"
    LEFT_HAND_ON_HIPS = "left_hand_on_hips"
    LEFT_HAND_ON_THIGH = "left_hand_on_thigh"
    RIGHT_HAND_ON_HEAD = "right_hand_on_head"
    RIGHT_HAND_ON_TRUNK = "right_hand_on_trunk"
    RIGHT_HAND_ON_HIPS = "right_hand_on_hips"
    RIGHT_HAND_ON_THIGH = "right_hand_on_thigh"

    @property
    def is_foot(self) -> bool:
        return False

    @property
    def limb(self) -> int:
        """-1: a touch does not make a limb a support."""
        return -1

    @cached_property
    def words(self) -> str:
        """Name for the user: ``left hand on hips``."""
        return self.value.replace("_", " ").replace("on thing", "on object").replace("trunk", "torso")


FOOT_POINTS = tuple(point for point in ContactPoint if point.is_foot)
BODY_POINTS = tuple(point for point in ContactPoint if not point.is_foot)
"""Hands, knees and seat: the points that carry a body that is not on its feet."""
CONTACT_POINTS = (*ContactPoint, *Touch)
"""All contact points and touches."""


def contact_point(name: str) -> ContactPoint | Touch:
    """Contact point or touch of that name; ValueError if there is none."""
    return Touch(name) if name in tuple(Touch) else ContactPoint(name)


@dataclass(frozen=True)
class ContactInterval:
    """One contact of a motion from frame ``first`` to ``last``, both included.

    ``point`` is a point that stands still on the ground, or a touch of the hands.
    """

    motion_id: str
    point: ContactPoint | Touch
    first: int
    last: int
    scope: Scope = EVERYONE
    """Performers or clip of the contact. Contacts of a narrower scope replace those of wider ones at the same point."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", contact_point(self.point))
        if not 0 <= self.first <= self.last:
            raise ValueError(f"A contact runs from a frame to a later one, not from {self.first} to {self.last}.")


def ground_contacts(contacts: Iterable[ContactInterval]) -> tuple[ContactInterval, ...]:
    """Contacts with the ground, without touches."""
    return tuple(each for each in contacts if isinstance(each.point, ContactPoint))


def points_on_ground(contacts: Iterable[ContactInterval], frame: int) -> tuple[ContactPoint, ...]:
    """Points that are in contact with the ground in a frame."""
    there = (each.point for each in contacts if each.first <= frame <= each.last)
    return tuple(point for point in there if isinstance(point, ContactPoint))


HEIGHT_MARGIN = 0.04
"""Greatest height in metres of a standing heel, ball or tip of the toes above its own usual low."""
STILL_SPEED = 0.35
"""Metres a second below which a foot point may be standing."""
ROLLING_SPEED = 0.55
"""Metres a second below which a foot point stays in contact between two rests."""
HEEL_SPEEDS, TOE_SPEEDS = (0.43, STILL_SPEED), (STILL_SPEED, 0.5)
"""Metres a second below which a point may stand as its contact begins and as it ends: a foot rolls on to its heel, and
off the ball and the tip of its toes, while they touch the ground.
"""
REST_SPEED = 0.15
"""Metres a second below which toes near the ground stand while their heel does, though they sink later to roll off."""
SLIDING_SPEED = 0.2
"""Metres a second below which a foot that slides over the ground rests at one of its places."""
PIVOT_SPEED, PIVOT = 0.2, 0.04
"""Metres a second of ball and heel about each other while a foot turns on one of them, and metres that the other one
travels farther meanwhile.
"""
ROLLING_SECONDS = 0.06
"""Seconds by which a contact may begin earlier or end later at ``HEEL_SPEEDS`` or ``TOE_SPEEDS``."""
SHORTEST_CONTACT = 0.05
"""Seconds: shorter contacts are dropped, shorter gaps closed."""
UNMOVED_METRES = 0.015
"""Metres that a foot goes at most from where a gap in the contact of its toes begins, if they stand through it."""
SMOOTHING = 0.012
"""Seconds, standard deviation of the smoothing before speed is taken."""
NOISE_SPEED = 0.12
"""Metres a second along an axis that noise may add to a speed, which is taken over more frames where it adds more."""
LONGEST_SPEED_STEP = 0.15
"""Seconds over which a speed is taken at most."""
ENOUGH = 8
"""Third differences that show how much noise there is."""
THIRDS_OF_NOISE = np.sqrt(20.0) * 0.76
"""Lowest quartile of the third differences of noise whose standard deviation along each of two axes is 1."""
DRIFT_WINDOW = 1.0
"""Seconds to each side in which a foot is taken to touch the ground at least once."""
GREATEST_DRIFT = 0.04
"""Metres by which the ground of a capture may rise above its usual low."""
HOVERING_HEIGHT = 0.025
"""Metres above the lowest that it comes to while it is near the ground at which a point is in the air."""
SINKING_SPEED = 0.1
"""Metres a second below which a point above that is on ground, or under skin, that gives way."""
ON_THE_FLOOR = 0.12
"""Metres that one foot's usual low may lie above the other's; higher, and it never stands."""


BODY_HEIGHTS = {"hand": 0.15, "knee": 0.12, "seat": 0.17}
"""Wrist, knee, middle of the hips above the floor, in parts of the leg's length, below which they may be standing."""
BODY_SPEEDS = {"hand": 1.0, "knee": 0.2, "seat": STILL_SPEED}
"""Metres a second below which they may be standing: a wrist rolls over a palm that stands, a knee that is dragged along
hardly rests.
"""
BODY_SHORTEST = {"hand": SHORTEST_CONTACT, "knee": 0.3, "seat": SHORTEST_CONTACT}
"""Seconds that they stand at least."""
SEAT_TO_KNEES_SECONDS = 0.3
"""Seconds in which a body passes from its seat to its knees, or back."""
LOW_KNEE = 0.14
"""The same of the knee of a leg that lies, or kneels: its toes may trail."""
WANDER = 0.08
"""Metres from its own middle that a standing hand, knee or seat may stray: what creeps farther does not stand. Metres
that it, or a foot, may go in a moment in which it is not still.
"""
REST_SECONDS = 0.5
"""Seconds that it stands at another place, before or after; what creeps on is nowhere for so long."""
TRAILING = 0.05
"""The same of the toes of who kneels or lies."""
LYING_HIP_HEIGHT = 0.14
"""Middle of the hips above the floor of who lies on its front, in parts of the leg's length: half a pelvis."""
PRONE = 0.7
"""Part of the front's direction that points down on a body that is prone."""
FARTHEST_OVER = np.radians(35.0)
"""Radians by which the leg of a heel that stands leans over its toes: ankles bend no farther, and a bent knee leaves
the hip behind.
"""

FLATTEST_SHANK = np.radians(15.0)
"""Radians from level that the shank of a foot that is flat on the ground rises at least: ankles stretch no farther."""


def detect_contacts(soles: FloatArray, frame_rate: float, first_frame: int = 0) -> dict[ContactPoint, list[Span]]:
    """Frames (first, last) in which each foot point is on the ground, from its height and its speed (METHOD 5).

    ``soles`` (F, 2, 3, 3) metres, left and right, heel, ball and tip of the toes, Z up; frames before ``first_frame``
    are ignored. The toes are on the ground while either end is: the ball lands first, the tip leaves last. Median
    errors of strikes and offs are within 10 ms of those of force plates and operators.
    """
    found: dict[ContactPoint, list[Span]] = {}
    tracks = soles[first_frame:]
    lows = np.percentile(tracks[..., 2], 5, axis=0)
    on_the_floor = lows < lows.min(axis=0) + ON_THE_FLOOR
    for side, name in enumerate(("left", "right")):
        heights, reach = tracks[:, side, :, 2], round(DRIFT_WINDOW * frame_rate)
        near = [_near(heights[:, end], lows[side, end], reach) & on_the_floor[side, end] for end in range(3)]
        speeds = np.array([point_speeds(tracks[:, side, end], near[end], frame_rate) for end in range(3)])
        down = [_come_down(heights[:, end], speeds[end], near[end], reach) for end in range(3)]
        down[1] = down[2] = down[1] | down[2]  # toes that roll over one end are not in the air
        stands = [
            _stands(tracks[:, side, end], near[end] & down[end], *limits, frame_rate)
            for end, limits in enumerate((HEEL_SPEEDS, TOE_SPEEDS, TOE_SPEEDS))
        ]
        over_lows = heights - lows[side]
        stands[0] &= over_lows[:, 0] < over_lows[:, 1:].max(axis=1) + HEIGHT_MARGIN  # else the foot is on tiptoe
        rests = stands[0] & near[1] & (speeds[1:] < REST_SPEED).all(axis=0)
        shortest = round(SHORTEST_CONTACT * frame_rate)
        rests &= ~_hanging(rests, stands[0], stands[1] | stands[2], heights[:, 0], shortest)
        heel, toe = _without_pivots(stands[0], stands[1] | stands[2] | rests, tracks[:, side], frame_rate)
        middle = tracks[:, side, :2].mean(axis=1)  # of heel and ball: a foot that turns on the spot goes nowhere
        for kind, standing in (("heel", heel), ("toe", toe)):
            spans = _without_flicker(standing, middle, shortest)
            found[ContactPoint(f"{name}_{kind}")] = [(a + first_frame, b + first_frame) for a, b in spans]
    return found


def _near(heights: FloatArray, low: float, reach: int) -> NDArray[np.bool_]:
    """(F,) true where a point is within ``low`` of its lowest height in the ``reach`` frames around, because the floors
    of captures drift by centimetres.
    """
    return np.asarray(heights < np.clip(lowest(heights, reach), low, low + GREATEST_DRIFT) + HEIGHT_MARGIN)


def _come_down(heights: FloatArray, speeds: FloatArray, near: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """(F,) true where a point that is ``near`` the ground (F,) is about as low as it gets before it rises again.

    A foot that is lowered or raised slowly is in the air until it is down, unless it sinks no faster than soles do
    under their load.
    """
    low = near.copy()
    for first, last in spans_of(near):
        span = slice(first, last + 1)
        low[span] = heights[span] < lowest(heights[span], reach) + HOVERING_HEIGHT
    down = low.copy()
    for first, last in spans_of(near & (low | (speeds < SINKING_SPEED))):
        down[first : last + 1] = low[first : last + 1].any()
    return down


def _stands(
    track: FloatArray, near: NDArray[np.bool_], landing: float, leaving: float, frame_rate: float
) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a point of a sole (F, 3) is in contact: ``near`` the ground (F,) and still, or
    slower than ``landing`` or ``leaving`` metres a second as it comes to rest or leaves.
    """
    speeds = point_speeds(track, near, frame_rate)
    standing = near & (speeds < STILL_SPEED)
    for first, last in spans_of(near & (speeds < ROLLING_SPEED)):
        for (_, before), (after, _) in pairwise(spans_of(standing[first : last + 1])):
            if np.linalg.norm(track[first + after] - track[first + before]) < WANDER:
                standing[first + before : first + after] = True
    lands, leaves = near & (speeds < landing), near & (speeds < leaving)
    for _ in range(round(ROLLING_SECONDS * frame_rate)):
        standing[:-1] |= standing[1:] & lands[:-1]
        standing[1:] |= standing[:-1] & leaves[1:]
    return standing


def _hanging(
    rests: NDArray[np.bool_],
    heel: NDArray[np.bool_],
    toe: NDArray[np.bool_],
    heel_height: FloatArray,
    shortest: int,
) -> NDArray[np.bool_]:
    """(F,) true where toes at rest, ``rests`` (F,), hang for ``shortest`` frames over a ``heel`` that has landed.

    They land later, ``toe`` (F,), faster than at rest, while the heel is no higher. Toes that sink as their heel rises
    stood before.
    """
    hanging = np.zeros(len(rests), dtype=bool)
    for first, last in spans_of(heel):
        lands = np.flatnonzero(toe[first : last + 1] & ~rests[first : last + 1])
        for begin, end in spans_of(rests[first : last + 1] & ~toe[first : last + 1]):
            after = lands[lands > end]
            if end - begin >= shortest and len(after) and heel_height[first + after[0]] <= heel_height[first + end]:
                hanging[first + begin : first + end + 1] = True
    return hanging


def _without_pivots(
    heel: NDArray[np.bool_], toe: NDArray[np.bool_], sole: FloatArray, frame_rate: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Contacts ``heel`` and ``toe`` (F,) of a ``sole`` (F, 3, 3) without the frames in which the foot pivots on the
    other point.
    """
    both = heel & toe
    turning = both & (point_speeds(sole[:, 1] - sole[:, 0], both, frame_rate) > PIVOT_SPEED)
    heel, toe = heel.copy(), toe.copy()
    for first, last in spans_of(turning):
        heel_travel, ball_travel = np.linalg.norm((sole[last] - sole[first])[:2, :2], axis=1)
        if abs(ball_travel - heel_travel) > PIVOT:
            (toe if ball_travel > heel_travel else heel)[first : last + 1] = False
    return heel, toe


def parted_at_slides(
    spans: list[Span], own: FloatArray, middle: FloatArray, lies: NDArray[np.bool_], frame_rate: float
) -> list[Span]:
    """Contacts of a foot point; one whose foot slides on from place to place is parted between them.

    ``own`` and ``middle`` (F, 3) are the point and the middle of its foot: one that turns moves one of them alone. A
    foot whose leg ``lies`` (F,) may trail.
    """
    standing = contact_mask(spans, len(own))
    rests = point_speeds(middle, standing, frame_rate) < SLIDING_SPEED
    for first, last in spans:
        parts = [(first + a, first + b) for a, b in spans_of(rests[first : last + 1])]
        parts = [(a, b) for a, b in parts if b - a >= SHORTEST_CONTACT * frame_rate]
        places = np.array([[track[a : b + 1].mean(axis=0) for track in (own, middle)] for a, b in parts])
        if len(parts) < 2 or np.linalg.norm(np.ptp(places, axis=0), axis=1).min() < WANDER:
            continue
        ways = np.linalg.norm(np.diff(places, axis=0), axis=2).min(axis=1)
        for (_, leaves), (arrives, _), way in zip(parts, parts[1:], ways, strict=False):
            if way > PIVOT and not lies[leaves:arrives].any():
                standing[leaves + 1 : arrives] = False
    return spans_of(standing)


def joined_over_still_gaps(spans: list[Span], middle: FloatArray) -> list[Span]:
    """The ``spans`` of toe contacts, joined over gaps in which the ``middle`` (F, 3) of the foot hardly moves.

    In marker captures the soles of standing feet rise and sink by centimetres, because skin moves over bones.
    """
    standing = contact_mask(spans, len(middle))
    for (_, before), (after, _) in pairwise(spans):
        if np.linalg.norm(middle[before : after + 1] - middle[before], axis=1).max() < UNMOVED_METRES:
            standing[before:after] = True
    return spans_of(standing)


def with_step_gaps_closed(
    heel: list[Span], toe: list[Span], middle: FloatArray, longest: int
) -> tuple[list[Span], list[Span]]:
    """Contacts of a foot's ``heel`` and ``toe``, with gaps of up to ``longest`` frames from one to the other closed.

    The later contact is extended to the end of the earlier one. ``middle`` (F, 3) is the middle of the foot, metres.
    """
    foot = spans_of(contact_mask([*heel, *toe], len(middle)))
    begins = {
        first: end + 1
        for (_, end), (first, _) in pairwise(foot)
        if first - end - 1 <= longest and np.linalg.norm(middle[first] - middle[end]) < WANDER
    }
    return [(begins.get(a, a), b) for a, b in heel], [(begins.get(a, a), b) for a, b in toe]


def detect_body_contacts(
    tracks: Mapping[ContactPoint, FloatArray], leg_length: float, frame_rate: float, first_frame: int = 0
) -> dict[ContactPoint, list[Span]]:
    """Frames (first, last) in which hands, knees and seat are on the ground: low above the floor, and almost still.

    ``tracks`` (F, 3) metres above the capture's floor, since points that seldom touch the ground show no level of their
    own. The knees of a body that sits or lies are no supports. Hips on the ground count as the seat, face up or down.
    """
    found: dict[ContactPoint, list[Span]] = {}
    for point, track in tracks.items():
        near = track[first_frame:, 2] < BODY_HEIGHTS[point.member] * leg_length
        speeds = point_speeds(track[first_frame:], near, frame_rate)
        standing = near & (speeds < BODY_SPEEDS[point.member])
        if point.member == "hand":
            standing = _until_it_leaves(standing, speeds < STILL_SPEED, track[first_frame:, 2])
        spans = _without_flicker(standing, track[first_frame:], round(SHORTEST_CONTACT * frame_rate))
        rest = round(REST_SECONDS * frame_rate)
        stays = [stay for first, last in spans for stay in _stays(track[first_frame:], first, last, rest)]
        least = BODY_SHORTEST[point.member] * frame_rate
        found[point] = [(a + first_frame, b + first_frame) for a, b in stays if b - a + 1 > least]
    for knee in (ContactPoint.LEFT_KNEE, ContactPoint.RIGHT_KNEE):
        seats, room = found[ContactPoint.SEAT], round(SEAT_TO_KNEES_SECONDS * frame_rate)
        seated = contact_mask([(max(first - room, 0), last + room) for first, last in seats], len(tracks[knee]))
        found[knee] = spans_outside_mask(found[knee], seated, round(2 * SHORTEST_CONTACT * frame_rate))
    return found


def _until_it_leaves(standing: NDArray[np.bool_], still: NDArray[np.bool_], heights: FloatArray) -> NDArray[np.bool_]:
    """Contacts ``standing`` (F,) of a hand, each cut at its last ``still`` frame (F,) if the hand rises from there,
    because a hand that is kept on the ground while it leaves holds the body back. A contact without a still frame is
    not cut.
    """
    cut = standing.copy()
    for first, last in spans_of(standing):
        rests = first + np.flatnonzero(still[first : last + 1])
        if len(rests) and heights[last] > heights[rests[-1]]:
            cut[rests[-1] + 1 : last + 1] = False
    return cut


def prone_mask(hips: FloatArray, shoulders: FloatArray) -> NDArray[np.bool_]:
    """(F,) true where a body is prone: it lies, crawls or is stretched face down. Hips and shoulders (F, 2, 3)."""
    front = np.cross(hips[:, 0] - hips[:, 1], shoulders.mean(axis=1) - hips.mean(axis=1))
    return np.asarray(front[:, 2] < -PRONE * np.linalg.norm(front, axis=1))


def plank_leg_mask(hip: FloatArray, ankle: FloatArray, toe: FloatArray) -> NDArray[np.bool_]:
    """(F,) true where a leg leans over its toes as in a plank, so that its heel cannot be on the
    ground; points (F, 3).
    """
    ahead = toe[:, :2] - ankle[:, :2]
    over = np.sum((hip - ankle)[:, :2] * ahead, axis=1) / np.maximum(np.linalg.norm(ahead, axis=1), 1e-9)
    return np.asarray(over > np.tan(FARTHEST_OVER) * (hip - ankle)[:, 2])


def lying_shank_mask(knee: FloatArray, ankle: FloatArray) -> NDArray[np.bool_]:
    """(F,) true where a shank lies, so that its foot cannot be flat on the ground; points (F, 3)."""
    shank = knee - ankle
    return np.asarray(shank[:, 2] < np.sin(FLATTEST_SHANK) * np.linalg.norm(shank, axis=1))


def longest_still_span(track: FloatArray, first: int, last: int, wander: float = WANDER) -> Span:
    """Longest part of a span in which the track (F, 3) stays within ``wander`` metres of its middle."""
    from studio.core.kernels.algebra.medians import geometric_median  # not before it is needed: it loads kernels

    while True:
        part = track[first : last + 1]
        near = np.linalg.norm(part - geometric_median(np.ascontiguousarray(part)), axis=1) < wander
        if near.all():
            return first, last
        if not near.any():  # round its middle, and never in it
            return first, first
        begin, end = max(spans_of(near), key=lambda run: run[1] - run[0])
        first, last = first + begin, first + end


def _stays(track: FloatArray, first: int, last: int, rest: int) -> list[Span]:
    """Span of ``longest_still_span``, if the track also stays for ``rest`` frames before and after it, a quarter of
    that while it travels.
    """
    begin, end = longest_still_span(track, first, last)
    sides = (first, begin - 1 - rest // 4), (end + 1 + rest // 4, last)
    others = [stay for a, b in sides if b - a >= rest for stay in _stays(track, a, b, rest)]
    return sorted([(begin, end), *((a, b) for a, b in others if b - a >= rest)])


def trailing_toe_contacts(
    spans: list[Span], toes: FloatArray, down: NDArray[np.bool_], frame_rate: float
) -> list[Span]:
    """The parts of the ``spans`` of toes (F, 3) that are contacts.

    While their leg lies ``down`` (F,), toes that move farther than ``TRAILING``, or rest only for a moment, are dragged
    and left out.
    """
    trail, whole = round(BODY_SHORTEST["knee"] * frame_rate), round(SHORTEST_CONTACT * frame_rate)
    found = []
    for span in spans:
        standing = contact_mask([span], len(down))
        for first, last in spans_of(standing & down):
            begin, end = longest_still_span(toes, first, last, TRAILING)
            standing[first:begin] = standing[end + 1 : last + 1] = False
        rest = spans_of(standing)
        least = whole if rest == [span] and not down[span[0] : span[1] + 1].any() else trail
        found += [(first, last) for first, last in rest if last - first >= least]
    return found


def point_speeds(track: FloatArray, near: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """(F,) speed of a track (F, 3), metres a second: the lesser of a backward and a forward difference, so that the
    first and the last frame of a rest are still. The differences span more frames the noisier the track is while it
    is ``near`` the ground (F,).
    """
    smooth = bell_average(track, SMOOTHING * frame_rate)
    noise = np.sqrt(2.0) * noise_deviation(track, near) * min(1.0, (3.5 * SMOOTHING * frame_rate) ** -0.5)
    apart = int(np.clip(np.ceil(noise * frame_rate / NOISE_SPEED), 1, max(1, round(LONGEST_SPEED_STEP * frame_rate))))
    if len(track) <= apart:
        return np.full(len(track), np.inf)
    steps = np.linalg.norm(smooth[apart:] - smooth[:-apart], axis=1) * frame_rate / apart
    beyond = np.full(apart, np.inf)
    return np.asarray(np.minimum(np.append(steps, beyond), np.append(beyond, steps)))


def noise_deviation(track: FloatArray, near: NDArray[np.bool_]) -> float:
    """Standard deviation in metres of a track's noise (F, 3) along an axis, by its third differences ``near`` the
    ground. At rest, which lasts for at least a quarter of that time, those of the motion are far smaller.
    """
    if len(track) < ENOUGH:
        return 0.0
    whole = near[3:] & near[2:-1] & near[1:-2] & near[:-3]
    thirds = np.linalg.norm(np.diff(track, 3, axis=0), axis=1)[whole]
    return float(np.quantile(thirds, 0.25) / THIRDS_OF_NOISE) if len(thirds) >= ENOUGH else 0.0


def contact_mask(spans: Iterable[Span], frame_count: int) -> NDArray[np.bool_]:
    """(F,) true in every frame of the given (first, last) spans."""
    mask = np.zeros(frame_count, dtype=bool)
    for first, last in spans:
        mask[first : last + 1] = True
    return mask


def spans_outside_mask(spans: list[Span], mask: NDArray[np.bool_], shortest: int) -> list[Span]:
    """``spans`` cut where ``mask`` (F,) is true, without remainders of at most ``shortest`` frames.

    Spans outside the mask are returned unchanged.
    """
    if not any(mask[first : last + 1].any() for first, last in spans):
        return spans
    rest = spans_of(contact_mask(spans, len(mask)) & ~mask)
    return [(first, last) for first, last in rest if last - first + 1 > shortest]


def spans_of(mask: NDArray[np.bool_]) -> list[Span]:
    """(first, last), both included, of each unbroken run of true in a mask."""
    return [(first, past - 1) for first, past in runs_of(mask)]


def _without_flicker(standing: NDArray[np.bool_], track: FloatArray, shortest: int) -> list[Span]:
    """The (first, last) of contacts (F,), with gaps closed and contacts dropped that last no more than ``shortest``
    frames. Gaps in which the ``track`` (F, 3) moves farther than ``WANDER``, as in a skid, stay; so do contacts at
    the beginning or end of the motion.
    """
    joined: list[Span] = []
    for first, last in spans_of(standing):
        before = joined[-1][1] if joined else first
        if joined and first - before - 1 <= shortest and np.linalg.norm(track[first] - track[before]) < WANDER:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    ends = (0, len(standing) - 1)
    return [(a, b) for a, b in joined if b - a + 1 > shortest or (a < b and (a == ends[0] or b == ends[1]))]
