"""Detection of touches of the hands: with each other, with an object between them, or with the own body.

Wrists whose distance is about the length of a hand are *together*; wrists before the chest at a constant distance hold
a *thing*; a palm that rests on a capsule of the body's volume touches that part of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import Span, Touch, spans_of
from studio.core.mesh.volume import PALM_SURFACE_PROBE, PART_CAPSULES, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.windows import sliding_maximum, sliding_minimum

FloatArray = NDArray[np.float64]
Mask = NDArray[np.bool_]

HANDS_MEET_DISTANCE = (0.31, 0.36)
"""Distances between the wrists in leg lengths: below the first, hands come together; above the second, they part."""
SWING_SPEED, SWING_SIDE = 1.5, 0.06
"""Least speed in leg lengths per second at which the hands of a runner swing past each other, and least distance in leg
lengths of each from the middle of the chest, on its own side.
"""
PASSING_SECONDS = 0.04
"""Longest time in seconds for which hands are together without counting as a touch."""
TOUCH_GAP_SECONDS = 0.15
"""Longest interruption in seconds of one touch."""
HELD_WRIST_RANGE = (0.3, 0.75)
"""Least and greatest distance in leg lengths between wrists that hold an object."""
LEAST_WRIST_AHEAD = 0.2
"""Least distance in leg lengths of wrists that hold an object in front of the neck's base, in the chest's axes."""
STEADY_WRIST_CHANGE, STEADY_SECONDS = 0.035, 0.5
"""Greatest change in leg lengths of the distance between wrists that hold an object, and the seconds in which it is
measured.
"""
SHORTEST_HOLD_SECONDS, CARRIED_DISTANCE = 1.0, 0.25
"""Least time in seconds for which an object is held, and least distance in leg lengths that it is carried in the
chest's axes: a fighter on guard holds nothing.
"""
HAND_REST_DISTANCE = (0.03, 0.05)
"""Distances in leg lengths between palm and body: below the first, a hand comes to rest; above the second,
it leaves.
"""
RESTING_HAND_SPEED = 0.4
"""Greatest speed in leg lengths per second of a resting hand over the body."""
HANGING_ARM_LIMITS = (0.9, 0.85)
"""Least stretch of a hanging arm as a fraction of its length, and least cosine of its angle to the chest's down axis:
such an arm beside hips and thighs does not touch them.
"""
LEAST_REST_SECONDS = 0.6
"""Least time in seconds for which a hand rests on the body."""


@dataclass(frozen=True, eq=False)
class PalmPositions:
    """Positions of a palm relative to one capsule of the body's volume, in every frame.

    ``fractions_along_axis`` (F,) are of the capsule's length; ``directions`` (F, 3) point outward, in the axes of the
    segment at the capsule's begin; ``clearances`` (F,) are metres from surface to surface.
    """

    fractions_along_axis: FloatArray
    directions: FloatArray
    clearances: FloatArray


def palm_centres(side: int, body: Morphology, positions: FloatArray) -> FloatArray:
    """Centres (F, 3) of the palm of a hand."""
    wrist = body.layout.wrist_point(side)
    return np.asarray(positions[:, wrist] + PALM_SURFACE_PROBE * (positions[:, wrist + 1] - positions[:, wrist]))


def palm_positions(
    side: int, capsule: int, body: Morphology, volume: BodyVolume, positions: FloatArray, rotations: FloatArray
) -> PalmPositions:
    """Positions of a palm relative to a capsule of ``volume``, for posed bodies (F, P, 3), (F, S, 3, 3)."""
    begin, end = (_end(volume, capsule, end, body, positions, rotations) for end in range(2))
    axis, way = end - begin, palm_centres(side, body, positions) - begin
    along = np.clip((axis * way).sum(axis=1) / (axis * axis).sum(axis=1), 0.0, 1.0)
    away = way - along[:, None] * axis
    distance = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
    first, last = volume.radii[capsule]
    local = np.einsum("fji,fj->fi", rotations[:, volume.segments[capsule, 0]], away / distance[:, None])
    return PalmPositions(along, local, distance - first - along * (last - first) - volume.girths[3])


def _end(
    volume: BodyVolume, capsule: int, end: int, body: Morphology, positions: FloatArray, rotations: FloatArray
) -> FloatArray:
    segment = volume.segments[capsule, end]
    origin = body.layout.proximal_points()[segment]
    return np.asarray(positions[:, origin] + rotations[:, segment] @ volume.places[capsule, end])


def find_touches(
    motion: NormalizedMotion, actor: Morphology, free: Mask, first_frame: int = 0
) -> Iterator[tuple[Touch, Span]]:
    """Yield each touch of the hands, with its frames, in the motion on its ``actor`` from ``first_frame`` on.

    ``free`` (2, F) is True where a hand is off the ground.
    """
    positions, rotations = (each[first_frame:] for each in realize_motion(motion, actor, play=True))
    free = free[:, first_frame:]
    together, held = hands_together_or_holding(actor, positions, rotations, motion.frame_rate)
    both = free.all(axis=0)
    found = {Touch.HANDS_TOGETHER: together & both, Touch.HANDS_ON_THING: held & both}
    volume = usual_volume(actor)
    for side, name in enumerate(("left", "right")):
        parts = {}
        for part, capsules in PART_CAPSULES.items():
            near = [palm_positions(side, capsule, actor, volume, positions, rotations) for capsule in capsules]
            rests, clearances = _resting(near, actor.leg_length, motion.frame_rate)
            hangs = part in ("hips", "thigh") and _hanging(side, actor, positions, rotations)
            parts[part] = rests & ~np.asarray(hangs), clearances
        found |= {Touch(f"{name}_hand_on_{part}"): mask & free[side] for part, mask in _nearest(parts).items()}
    least = {Touch.HANDS_TOGETHER: PASSING_SECONDS, Touch.HANDS_ON_THING: SHORTEST_HOLD_SECONDS}
    for touch, mask in found.items():
        for first, last in _joined(mask, round(TOUCH_GAP_SECONDS * motion.frame_rate)):
            if last - first + 1 > least.get(touch, LEAST_REST_SECONDS) * motion.frame_rate:
                yield touch, (first + first_frame, last + first_frame)


def hands_together_or_holding(
    actor: Morphology, positions: FloatArray, rotations: FloatArray, rate: float
) -> tuple[Mask, Mask]:
    """Masks (F,) of frames with hands together, and with an object between hands, of posed bodies (F, P, 3), (F, S, 3,
    3).
    """
    layout, leg = actor.layout, actor.leg_length
    chest = rotations[:, layout.spine_count - 1]
    wrists = positions[:, [layout.wrist_point(0), layout.wrist_point(1)]] - positions[:, None, layout.neck_base]
    wrists = np.einsum("fij,fwi->fwj", chest, wrists) / leg
    gap = np.linalg.norm(wrists[:, 1] - wrists[:, 0], axis=1)
    swinging = _speed_of(wrists[:, 1] - wrists[:, 0], rate) > SWING_SPEED
    swinging &= np.minimum(wrists[:, 0, 1], -wrists[:, 1, 1]) > SWING_SIDE
    together = _between(np.where(swinging, np.maximum(gap, HANDS_MEET_DISTANCE[0]), gap), *HANDS_MEET_DISTANCE)
    before = wrists[:, :, 0].min(axis=1)
    around = round(0.5 * STEADY_SECONDS * rate)
    spread = sliding_maximum(gap, around) - sliding_minimum(gap, around)
    steady = sliding_maximum(spread < STEADY_WRIST_CHANGE, around)  # a steady stretch is so as a whole
    held = steady & (before > LEAST_WRIST_AHEAD) & (gap > HELD_WRIST_RANGE[0]) & (gap < HELD_WRIST_RANGE[1]) & ~together
    for first, last in spans_of(held):
        held[first : last + 1] = np.ptp(wrists[first : last + 1].mean(axis=1), axis=0).max() > CARRIED_DISTANCE
    return together, held


def _hanging(side: int, actor: Morphology, positions: FloatArray, rotations: FloatArray) -> Mask:
    """Mask (F,) of frames in which an arm hangs down."""
    wrist = actor.layout.wrist_point(side)
    arm = positions[:, wrist] - positions[:, wrist - 2]
    length = np.linalg.norm(arm, axis=1)
    down = -(arm * rotations[:, actor.layout.spine_count - 1, :, 2]).sum(axis=1)
    return np.asarray(
        (length > HANGING_ARM_LIMITS[0] * actor.arm[side].sum()) & (down > HANGING_ARM_LIMITS[1] * length)
    )


def _resting(near: list[PalmPositions], leg: float, rate: float) -> tuple[Mask, FloatArray]:
    """Mask (F,) of frames in which a palm rests beside one of several capsules, and its distances (F,) from the
    nearest.
    """
    clearances = np.min([each.clearances for each in near], axis=0)
    speeds = np.min([_speed(each, rate) for each in near], axis=0)
    return _between(clearances / leg, *HAND_REST_DISTANCE) & (speeds < RESTING_HAND_SPEED * leg), clearances


def _speed(spot: PalmPositions, rate: float) -> FloatArray:
    """Speeds (F,) of a palm around or away from a capsule, in metres per second."""
    return _speed_of(spot.directions * (spot.clearances + 0.1)[:, None], rate)


def _speed_of(track: FloatArray, rate: float) -> FloatArray:
    """Speeds (F,) of ``track`` (F, 3) over a tenth of a second, in its unit per second."""
    half, frames = max(1, round(0.05 * rate)), np.arange(len(track))
    ahead, behind = np.minimum(frames + half, len(track) - 1), np.maximum(frames - half, 0)
    seconds = np.maximum(ahead - behind, 1) / rate
    return np.asarray(np.linalg.norm(track[ahead] - track[behind], axis=1) / seconds)


def _nearest(parts: dict[str, tuple[Mask, FloatArray]]) -> dict[str, Mask]:
    """Mask of the rests of a hand on each part; each rest belongs to the part that is nearest to it overall."""
    anywhere = np.any([mask for mask, _ in parts.values()], axis=0)
    found = {part: np.zeros_like(anywhere) for part in parts}
    for first, last in spans_of(anywhere):
        span = slice(first, last + 1)
        best = min(parts, key=lambda part: float(parts[part][1][span].mean()))
        found[best][span] = True
    return found


def _between(track: FloatArray, begins: float, ends: float) -> Mask:
    """Mask (F,) of runs in which ``track`` (F,) stays below ``ends`` and falls below ``begins``."""
    found = np.zeros(len(track), dtype=np.bool_)
    for first, last in spans_of(track < ends):
        if (track[first : last + 1] < begins).any():
            found[first : last + 1] = True
    return found


def _joined(mask: Mask, gap: int) -> list[Span]:
    """Spans of True in ``mask`` (F,), with gaps of up to ``gap`` frames closed."""
    joined: list[Span] = []
    for first, last in spans_of(mask):
        if joined and first - joined[-1][1] - 1 <= gap:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    return joined
