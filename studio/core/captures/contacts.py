"""Contacts: frames in which heels, toes, hands, knees and seat are on the ground, and hands touch the body or each
other.
"""

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
from studio.core.windows import bell_average, sliding_minimum

FloatArray = NDArray[np.float64]
Span = tuple[int, int]
"""First and last frame of a contact, both included."""


class _SidedName(StrEnum):
    """Name made of a side and a member, such as ``left_heel`` or ``right_hand_on_head``."""

    @cached_property
    def side(self) -> int:
        """Index of the side: 0 left, 1 right; 0 for a name without a single side."""
        return 1 if self.value.startswith("right") else 0

    @cached_property
    def member(self) -> str:
        """Last word of the name: the point without its side (``heel``), or the part that a hand touches (``head``)."""
        return self.value.rpartition("_")[2]


class ContactPoint(_SidedName):
    """Point of the body that can touch the ground.

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
        """True for both heels."""
        return self.member == "heel"

    @cached_property
    def is_foot(self) -> bool:
        """True for heels and toes."""
        return self.member in ("heel", "toe")

    @cached_property
    def limb(self) -> int:
        """Index of the limb: left arm, right arm, left leg, right leg; -1 for the seat."""
        return -1 if self.member == "seat" else self.side + (0 if self.member == "hand" else 2)

    @cached_property
    def words(self) -> str:
        """Name for the user: ``left heel``."""
        return self.value.replace("_", " ")


def touching_points(point: ContactPoint, layout: BodyLayout) -> list[int]:
    """Indices of the canonical points whose mean is the position of a contact point: one joint, or both hips for the
    seat.
    """
    match point.member:
        case "seat":
            return [layout.hip_point(0), layout.hip_point(1)]
        case "hand":
            return [layout.wrist_point(point.side)]
    return [layout.hip_point(point.side) + {"knee": 1, "heel": 2, "toe": 3}[point.member]]


class Touch(_SidedName):
    """Contact of the hands with each other, with a held object or with the body.

    Hands in contact keep their offset from each other, scaled by the length of the arms; an object between them keeps
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
        """False: a touch is a contact of hands."""
        return False

    @property
    def limb(self) -> int:
        """-1: a touch makes no limb a support of the body."""
        return -1

    @cached_property
    def words(self) -> str:
        """Name for the user: ``left hand on hips``."""
        return self.value.replace("_", " ").replace("on thing", "on object").replace("trunk", "torso")


FOOT_POINTS = tuple(point for point in ContactPoint if point.is_foot)
BODY_POINTS = tuple(point for point in ContactPoint if not point.is_foot)
"""Hands, knees and seat: points that support a body that is not on its feet."""
CONTACT_POINTS = (*ContactPoint, *Touch)
"""All contact points with the ground, and all touches of the hands."""


def contact_point(name: str) -> ContactPoint | Touch:
    """Contact point or touch of that name; ValueError if there is none."""
    return Touch(name) if name in tuple(Touch) else ContactPoint(name)


@dataclass(frozen=True)
class ContactInterval:
    """Contact of a motion from frame ``first`` to ``last``, both included.

    ``point`` is a point that stands still on the ground, or a touch of the hands.
    """

    motion_id: str
    point: ContactPoint | Touch
    first: int
    last: int
    scope: Scope = EVERYONE
    """Performers or clip to which it applies. At one point, contacts of a narrower scope replace those of wider ones.
    """

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", contact_point(self.point))
        if not 0 <= self.first <= self.last:
            raise ValueError(f"A contact runs from a frame to a later one, not from {self.first} to {self.last}.")


def ground_contacts(contacts: Iterable[ContactInterval]) -> tuple[ContactInterval, ...]:
    """Contacts with the ground, without touches."""
    return tuple(each for each in contacts if isinstance(each.point, ContactPoint))


def points_on_ground(contacts: Iterable[ContactInterval], frame: int) -> tuple[ContactPoint, ...]:
    """Points that are on the ground in ``frame``."""
    there = (each.point for each in contacts if each.first <= frame <= each.last)
    return tuple(point for point in there if isinstance(point, ContactPoint))


HEIGHT_MARGIN = 0.04
"""Greatest height in metres of a standing heel, ball or tip above the lowest height that this point usually has."""
STILL_SPEED = 0.35
"""Speed in metres per second below which a point of the foot may be standing."""
ROLLING_SPEED = 0.55
"""Speed in metres per second below which a point of the foot stays in contact between two times of rest."""
HEEL_SPEEDS, TOE_SPEEDS = (0.43, STILL_SPEED), (STILL_SPEED, 0.5)
"""Speeds in metres per second below which a point may stand as its contact begins, and as it ends. A foot rolls onto
its heel and off its ball and tip while they touch the ground.
"""
REST_SPEED = 0.15
"""Speed in metres per second below which toes near the ground stand while the heel does, though they sink further
before they roll off.
"""
SLIDING_SPEED = 0.2
"""Speed in metres per second below which a foot that slides over the ground rests at one of its positions."""
PIVOT_SPEED, PIVOT_METRES = 0.2, 0.04
"""Speed in metres per second of ball and heel relative to each other while a foot pivots on one of them; and distance
in metres that the other one travels farther meanwhile.
"""
ROLLING_SECONDS = 0.06
"""Time in seconds by which a contact may begin earlier or end later at the speeds ``HEEL_SPEEDS`` and ``TOE_SPEEDS``.
"""
SHORTEST_CONTACT_SECONDS = 0.05
"""Duration in seconds: shorter contacts are dropped, shorter gaps are closed."""
UNMOVED_METRES = 0.015
"""Greatest distance in metres that a foot moves over a gap in the contact of its toes that is closed."""
SPEED_SMOOTHING_SECONDS = 0.012
"""Standard deviation in seconds of the smoothing of positions before speeds are computed."""
NOISE_SPEED = 0.12
"""Greatest speed in metres per second along an axis that noise may add; noisier speeds are taken over more frames."""
LONGEST_SPEED_STEP_SECONDS = 0.15
"""Longest time in seconds over which a speed is taken."""
LEAST_NOISE_SAMPLES = 8
"""Least number of third differences from which noise is estimated."""
NOISE_THIRD_DIFFERENCE = np.sqrt(20.0) * 0.76
"""Lower quartile of the lengths of third differences of noise with standard deviation 1 along each of two axes."""
DRIFT_WINDOW_SECONDS = 1.0
"""Seconds before and after a frame in which a foot is assumed to touch the ground at least once."""
GREATEST_DRIFT_METRES = 0.04
"""Greatest rise in metres of the ground of a capture above its usual low level."""
HOVERING_HEIGHT = 0.025
"""Height in metres, above its lowest position near the ground, from which a point is in the air."""
SINKING_SPEED = 0.1
"""Speed in metres per second below which a point above ``HOVERING_HEIGHT`` is on yielding ground, or under yielding
skin.
"""
GREATEST_FOOT_LEVEL_DIFFERENCE = 0.12
"""Greatest difference in metres of the usual low heights of both feet; a higher foot never stands."""


BODY_CONTACT_HEIGHTS = {"hand": 0.15, "knee": 0.12, "seat": 0.17}
"""Heights above the floor, as fractions of the leg length, below which wrist, knee and middle of the hips may be
standing.
"""
BODY_CONTACT_SPEEDS = {"hand": 1.0, "knee": 0.2, "seat": STILL_SPEED}
"""Speeds in metres per second below which these points may be standing: a wrist rolls over a standing palm, while a
knee that is dragged hardly rests.
"""
SHORTEST_BODY_CONTACT_SECONDS = {"hand": SHORTEST_CONTACT_SECONDS, "knee": 0.3, "seat": SHORTEST_CONTACT_SECONDS}
"""Least duration of these contacts in seconds."""
SEAT_TO_KNEES_SECONDS = 0.3
"""Time in seconds in which a body passes from its seat to its knees, or back."""
LOW_KNEE_HEIGHT = 0.14
"""Height above the floor, as a fraction of the leg length, below which a knee is that of a lying or kneeling leg, whose
toes may be dragged.
"""
GREATEST_WANDER_METRES = 0.08
"""Distance in metres that a standing hand, knee or seat may stray from its mean position; what strays farther does not
stand. Also the distance that such a point or a foot may move in a moment in which it is not still.
"""
REST_SECONDS = 0.5
"""Seconds that a hand, knee or seat stands at another position before or after; a creeping one rests nowhere for so
long.
"""
TRAILING_TOE_WANDER_METRES = 0.05
"""Distance in metres that standing toes of a kneeling or lying body may stray from their mean position."""
LYING_HIP_HEIGHT = 0.14
"""Height above the floor of the middle of the hips of a prone body, as a fraction of the leg length: half a pelvis."""
LEAST_PRONE_COMPONENT = 0.7
"""Least downward component of the unit forward direction of a prone body."""
GREATEST_LEG_LEAN = np.radians(35.0)
"""Angle in radians by which a leg may lean over its toes while the heel stands: ankles bend no farther, and a bent knee
leaves the hip behind.
"""

LEAST_SHANK_RISE = np.radians(15.0)
"""Least angle in radians from level of the shank over a foot flat on the ground: ankles stretch no farther."""


def detect_contacts(soles: FloatArray, frame_rate: float, first_frame: int = 0) -> dict[ContactPoint, list[Span]]:
    """Contacts (first, last frame) of each point of the feet with the ground, by their heights and speeds (METHOD 5).

    ``soles`` (F, 2, 3, 3) are in metres: left and right; heel, ball and tip of the toes; position with Z up. Frames
    before ``first_frame`` are ignored. The toes are in contact while the ball or the tip is: the ball lands first, the
    tip leaves last. Median errors of strikes and offs are within 10 ms of those of force plates and operators.
    """
    found: dict[ContactPoint, list[Span]] = {}
    tracks = soles[first_frame:]
    lows = np.percentile(tracks[..., 2], 5, axis=0)
    on_the_floor = lows < lows.min(axis=0) + GREATEST_FOOT_LEVEL_DIFFERENCE
    for side, name in enumerate(("left", "right")):
        heights, reach = tracks[:, side, :, 2], round(DRIFT_WINDOW_SECONDS * frame_rate)
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
        shortest = round(SHORTEST_CONTACT_SECONDS * frame_rate)
        rests &= ~_hanging(rests, stands[0], stands[1] | stands[2], heights[:, 0], shortest)
        heel, toe = _without_pivots(stands[0], stands[1] | stands[2] | rests, tracks[:, side], frame_rate)
        middle = tracks[:, side, :2].mean(axis=1)  # of heel and ball: a foot that turns on the spot goes nowhere
        for kind, standing in (("heel", heel), ("toe", toe)):
            spans = _without_flicker(standing, middle, shortest)
            found[ContactPoint(f"{name}_{kind}")] = [(a + first_frame, b + first_frame) for a, b in spans]
    return found


def _near(heights: FloatArray, low: float, reach: int) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a point is within ``low`` of its lowest height in the ``reach`` frames around.

    A sliding window is used because the floors of captures drift by centimetres.
    """
    return np.asarray(
        heights < np.clip(sliding_minimum(heights, reach), low, low + GREATEST_DRIFT_METRES) + HEIGHT_MARGIN
    )


def _come_down(heights: FloatArray, speeds: FloatArray, near: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a point ``near`` the ground (F,) is about as low as it gets before it rises again.

    A foot that is lowered or raised slowly is in the air until it is down, unless it sinks no faster than soles do
    under load.
    """
    low = near.copy()
    for first, last in spans_of(near):
        span = slice(first, last + 1)
        low[span] = heights[span] < sliding_minimum(heights[span], reach) + HOVERING_HEIGHT
    down = low.copy()
    for first, last in spans_of(near & (low | (speeds < SINKING_SPEED))):
        down[first : last + 1] = low[first : last + 1].any()
    return down


def _stands(
    track: FloatArray, near: NDArray[np.bool_], landing: float, leaving: float, frame_rate: float
) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a point of a sole (F, 3) is in contact: ``near`` the ground (F,), and still.

    As it comes to rest or leaves, it may be as fast as ``landing`` or ``leaving``, in metres per second.
    """
    speeds = point_speeds(track, near, frame_rate)
    standing = near & (speeds < STILL_SPEED)
    for first, last in spans_of(near & (speeds < ROLLING_SPEED)):
        for (_, before), (after, _) in pairwise(spans_of(standing[first : last + 1])):
            if np.linalg.norm(track[first + after] - track[first + before]) < GREATEST_WANDER_METRES:
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
    """Mask (F,) of resting toes, ``rests`` (F,), that hang for ``shortest`` frames after ``heel`` landed.

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
        if abs(ball_travel - heel_travel) > PIVOT_METRES:
            (toe if ball_travel > heel_travel else heel)[first : last + 1] = False
    return heel, toe


def parted_at_slides(
    spans: list[Span], own: FloatArray, middle: FloatArray, lies: NDArray[np.bool_], frame_rate: float
) -> list[Span]:
    """Contacts of a point of a foot, split where the foot slides from one position of rest to another.

    ``own`` and ``middle`` (F, 3) are the point and the middle of its foot: a foot that turns moves one of them alone. A
    foot whose leg ``lies`` (F,) may be dragged.
    """
    standing = contact_mask(spans, len(own))
    rests = point_speeds(middle, standing, frame_rate) < SLIDING_SPEED
    for first, last in spans:
        parts = [(first + a, first + b) for a, b in spans_of(rests[first : last + 1])]
        parts = [(a, b) for a, b in parts if b - a >= SHORTEST_CONTACT_SECONDS * frame_rate]
        places = np.array([[track[a : b + 1].mean(axis=0) for track in (own, middle)] for a, b in parts])
        if len(parts) < 2 or np.linalg.norm(np.ptp(places, axis=0), axis=1).min() < GREATEST_WANDER_METRES:
            continue
        ways = np.linalg.norm(np.diff(places, axis=0), axis=2).min(axis=1)
        for (_, leaves), (arrives, _), way in zip(parts, parts[1:], ways, strict=False):
            if way > PIVOT_METRES and not lies[leaves:arrives].any():
                standing[leaves + 1 : arrives] = False
    return spans_of(standing)


def joined_over_still_gaps(spans: list[Span], middle: FloatArray) -> list[Span]:
    """Toe contacts ``spans``, joined over gaps in which the ``middle`` (F, 3) of the foot hardly moves.

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
    """Contacts of a foot's ``heel`` and ``toe``, with gaps of up to ``longest`` frames between the two closed.

    The later contact is extended to the end of the earlier one. ``middle`` (F, 3) is the middle of the foot in metres.
    """
    foot = spans_of(contact_mask([*heel, *toe], len(middle)))
    begins = {
        first: end + 1
        for (_, end), (first, _) in pairwise(foot)
        if first - end - 1 <= longest and np.linalg.norm(middle[first] - middle[end]) < GREATEST_WANDER_METRES
    }
    return [(begins.get(a, a), b) for a, b in heel], [(begins.get(a, a), b) for a, b in toe]


def detect_body_contacts(
    tracks: Mapping[ContactPoint, FloatArray], leg_length: float, frame_rate: float, first_frame: int = 0
) -> dict[ContactPoint, list[Span]]:
    """Contacts (first, last frame) of hands, knees and seat with the ground: frames in which they are low and almost
    still.

    ``tracks`` (F, 3) are in metres above the capture's floor, since points that seldom touch the ground show no level
    of their own. The knees of a sitting or lying body are no supports. Hips on the ground count as the seat, face up or
    down.
    """
    found: dict[ContactPoint, list[Span]] = {}
    for point, track in tracks.items():
        near = track[first_frame:, 2] < BODY_CONTACT_HEIGHTS[point.member] * leg_length
        speeds = point_speeds(track[first_frame:], near, frame_rate)
        standing = near & (speeds < BODY_CONTACT_SPEEDS[point.member])
        spans = _without_flicker(standing, track[first_frame:], round(SHORTEST_CONTACT_SECONDS * frame_rate))
        rest = round(REST_SECONDS * frame_rate)
        stays = [stay for first, last in spans for stay in _stays(track[first_frame:], first, last, rest)]
        if point.member == "hand":
            stays = [part for stay in stays for part in _resting(stay, speeds < STILL_SPEED, track[first_frame:, 2])]
        least = SHORTEST_BODY_CONTACT_SECONDS[point.member] * frame_rate
        found[point] = [(a + first_frame, b + first_frame) for a, b in stays if b - a + 1 > least]
    for knee in (ContactPoint.LEFT_KNEE, ContactPoint.RIGHT_KNEE):
        seats, room = found[ContactPoint.SEAT], round(SEAT_TO_KNEES_SECONDS * frame_rate)
        seated = contact_mask([(max(first - room, 0), last + room) for first, last in seats], len(tracks[knee]))
        found[knee] = spans_outside_mask(found[knee], seated, round(2 * SHORTEST_CONTACT_SECONDS * frame_rate))
    return found


def _resting(contact: Span, still: NDArray[np.bool_], heights: FloatArray) -> list[Span]:
    """Contact of a hand without the frames before its first ``still`` one (F,) if the hand sinks until there, and
    after its last one if it rises from there; in a list.

    A hand that is kept on the ground while it comes down or leaves would hurry the body, or hold it back. One that is
    never still stands if it comes down and rises again, and passes by if it does not.
    """
    first, last = contact
    rests = first + np.flatnonzero(still[first : last + 1])
    if not len(rests):
        return [contact] if 0 < heights[first : last + 1].argmin() < last - first else []
    begin = rests[0] if heights[first] > heights[rests[0]] else first
    end = rests[-1] if heights[last] > heights[rests[-1]] else last
    return [(int(begin), int(end))]


def prone_mask(hips: FloatArray, shoulders: FloatArray) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a body lies or crawls face down, for positions of hips and shoulders (F, 2, 3)."""
    front = np.cross(hips[:, 0] - hips[:, 1], shoulders.mean(axis=1) - hips.mean(axis=1))
    return np.asarray(front[:, 2] < -LEAST_PRONE_COMPONENT * np.linalg.norm(front, axis=1))


def plank_leg_mask(hip: FloatArray, ankle: FloatArray, toe: FloatArray) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a leg leans over its toes as in a plank, so that its heel cannot be on the ground.

    ``hip``, ``ankle`` and ``toe`` (F, 3) are positions in metres.
    """
    ahead = toe[:, :2] - ankle[:, :2]
    over = np.sum((hip - ankle)[:, :2] * ahead, axis=1) / np.maximum(np.linalg.norm(ahead, axis=1), 1e-9)
    return np.asarray(over > np.tan(GREATEST_LEG_LEAN) * (hip - ankle)[:, 2])


def lying_shank_mask(knee: FloatArray, ankle: FloatArray) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a shank lies, so that its foot cannot be flat on the ground; positions (F, 3)."""
    shank = knee - ankle
    return np.asarray(shank[:, 2] < np.sin(LEAST_SHANK_RISE) * np.linalg.norm(shank, axis=1))


def longest_still_span(track: FloatArray, first: int, last: int, wander: float = GREATEST_WANDER_METRES) -> Span:
    """Longest part of the frames ``first`` to ``last`` in which ``track`` (F, 3) stays within ``wander`` metres of its
    mean.
    """
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
    """Result of ``longest_still_span`` in a list; empty unless the track also rests for ``rest`` frames before and
    after.

    While the track travels, a quarter of that rest suffices.
    """
    begin, end = longest_still_span(track, first, last)
    sides = (first, begin - 1 - rest // 4), (end + 1 + rest // 4, last)
    others = [stay for a, b in sides if b - a >= rest for stay in _stays(track, a, b, rest)]
    return sorted([(begin, end), *((a, b) for a, b in others if b - a >= rest)])


def trailing_toe_contacts(
    spans: list[Span], toes: FloatArray, down: NDArray[np.bool_], frame_rate: float
) -> list[Span]:
    """Those parts of the ``spans`` of ``toes`` (F, 3) that are contacts and not dragged toes.

    While the leg lies ``down`` (F,), toes that stray farther than ``TRAILING_TOE_WANDER_METRES``, or rest only for a
    moment, are dragged.
    """
    trail, whole = (
        round(SHORTEST_BODY_CONTACT_SECONDS["knee"] * frame_rate),
        round(SHORTEST_CONTACT_SECONDS * frame_rate),
    )
    found = []
    for span in spans:
        standing = contact_mask([span], len(down))
        for first, last in spans_of(standing & down):
            begin, end = longest_still_span(toes, first, last, TRAILING_TOE_WANDER_METRES)
            standing[first:begin] = standing[end + 1 : last + 1] = False
        rest = spans_of(standing)
        least = whole if rest == [span] and not down[span[0] : span[1] + 1].any() else trail
        found += [(first, last) for first, last in rest if last - first >= least]
    return found


def point_speeds(track: FloatArray, near: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """Speeds (F,) of ``track`` (F, 3) in metres per second: the lesser of a backward and a forward difference.

    The first and the last frame of a rest are therefore still. The noisier the track is while it is ``near`` the ground
    (F,), the more frames the differences span.
    """
    smooth = bell_average(track, SPEED_SMOOTHING_SECONDS * frame_rate)
    noise = np.sqrt(2.0) * noise_deviation(track, near) * min(1.0, (3.5 * SPEED_SMOOTHING_SECONDS * frame_rate) ** -0.5)
    apart = int(
        np.clip(np.ceil(noise * frame_rate / NOISE_SPEED), 1, max(1, round(LONGEST_SPEED_STEP_SECONDS * frame_rate)))
    )
    if len(track) <= apart:
        return np.full(len(track), np.inf)
    steps = np.linalg.norm(smooth[apart:] - smooth[:-apart], axis=1) * frame_rate / apart
    beyond = np.full(apart, np.inf)
    return np.asarray(np.minimum(np.append(steps, beyond), np.append(beyond, steps)))


def noise_deviation(track: FloatArray, near: NDArray[np.bool_]) -> float:
    """Standard deviation in metres of the noise of ``track`` (F, 3) along an axis, by third differences ``near`` the
    ground.

    A rest takes at least a quarter of the time near the ground, and third differences of its motion are far smaller
    than those of noise.
    """
    if len(track) < LEAST_NOISE_SAMPLES:
        return 0.0
    whole = near[3:] & near[2:-1] & near[1:-2] & near[:-3]
    thirds = np.linalg.norm(np.diff(track, 3, axis=0), axis=1)[whole]
    return float(np.quantile(thirds, 0.25) / NOISE_THIRD_DIFFERENCE) if len(thirds) >= LEAST_NOISE_SAMPLES else 0.0


def contact_mask(spans: Iterable[Span], frame_count: int) -> NDArray[np.bool_]:
    """Mask (F,) of the frames in the given (first, last) spans."""
    mask = np.zeros(frame_count, dtype=bool)
    for first, last in spans:
        mask[first : last + 1] = True
    return mask


def spans_outside_mask(spans: list[Span], mask: NDArray[np.bool_], shortest: int) -> list[Span]:
    """``spans`` cut where ``mask`` (F,) is True; remainders of at most ``shortest`` frames are dropped.

    Spans that the mask does not touch are unchanged.
    """
    if not any(mask[first : last + 1].any() for first, last in spans):
        return spans
    rest = spans_of(contact_mask(spans, len(mask)) & ~mask)
    return [(first, last) for first, last in rest if last - first + 1 > shortest]


def spans_of(mask: NDArray[np.bool_]) -> list[Span]:
    """Runs of True in ``mask``, as (first, last) frames, both included."""
    return [(first, past - 1) for first, past in runs_of(mask)]


def _without_flicker(standing: NDArray[np.bool_], track: FloatArray, shortest: int) -> list[Span]:
    """Contacts ``standing`` (F,) as spans, with gaps closed and contacts dropped that last at most ``shortest`` frames.

    Gaps in which ``track`` (F, 3) moves farther than ``GREATEST_WANDER_METRES``, as in a skid, stay; so do contacts at
    the beginning or end of the motion.
    """
    joined: list[Span] = []
    for first, last in spans_of(standing):
        before = joined[-1][1] if joined else first
        if (
            joined
            and first - before - 1 <= shortest
            and np.linalg.norm(track[first] - track[before]) < GREATEST_WANDER_METRES
        ):
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    ends = (0, len(standing) - 1)
    return [(a, b) for a, b in joined if b - a + 1 > shortest or (a < b and (a == ends[0] or b == ends[1]))]
