"""Touches of the hands: each other, a thing between them, their own body, as the motion's actor does.

Wrists whose distance is about the length of a hand are *together*; wrists before the chest at a constant distance hold
a *thing*; a palm that rests on a capsule of the body's volume touches that part of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import Span, Touch, spans_of
from studio.core.mesh.volume import CAPSULES_OF, PALM_SURFACE_PROBE, BodyVolume, usual_volume
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.core.windows import highest, lowest

FloatArray = NDArray[np.float64]
Mask = NDArray[np.bool_]

HANDS_MEET_DISTANCE = (0.31, 0.36)
"""Parts of the leg's length between the wrists below which hands come together, and beyond which they part."""
SWING_SPEED, SWING_SIDE = 1.5, 0.06
"""Least speed in leg lengths a second at which the hands of a runner swing past each other, and least distance in leg
lengths of each from the middle of the chest, on its own side.
"""
PASSING = 0.04
"""Seconds for which hands may be together without being counted."""
TOUCH_GAP = 0.15
"""Seconds for which a touch may be given up without being two."""
HELD_WRIST_RANGE = (0.3, 0.75)
"""Parts of the leg's length between which wrists hold a thing."""
WRIST_AHEAD = 0.2
"""Parts of the leg's length that wrists which hold a thing are in front of the neck's base, in the chest's axes."""
STEADY_WRIST_CHANGE, STEADY_FOR = 0.035, 0.5
"""Parts of the leg's length by which the distance of wrists that hold a thing changes at most in so many seconds."""
SHORTEST_HOLD, CARRIED_DISTANCE = 1.0, 0.25
"""Seconds for which a thing is held at least, and parts of the leg's length that it is carried in the chest's axes: who
is on guard holds nothing.
"""
HAND_REST_DISTANCE = (0.03, 0.05)
"""Parts of the leg's length between palm and body below which a hand comes to rest, and beyond which it leaves."""
LYING_STILL = 0.4
"""Parts of the leg's length a second that a resting hand goes over the body at most."""
HANGING = (0.9, 0.85)
"""Part of its length to which an arm hangs at least, and cosine of how far off the chest's down: beside hips and thighs
such an arm only hangs.
"""
RESTS_FOR = 0.6
"""Seconds for which a hand rests at least."""


@dataclass(frozen=True, eq=False)
class PalmPositions:
    """Position of a palm relative to one capsule of its body, in every frame.

    ``fractions_along_axis`` (F,) of the capsule's length; outward ``directions`` (F, 3) in the axes of the segment at
    its begin; ``clearances`` (F,) metres from surface to surface.
    """

    fractions_along_axis: FloatArray
    directions: FloatArray
    clearances: FloatArray


def palm_centres(side: int, body: Morphology, positions: FloatArray) -> FloatArray:
    """(F, 3) centre of a hand's palm."""
    wrist = body.layout.wrist_point(side)
    return np.asarray(positions[:, wrist] + PALM_SURFACE_PROBE * (positions[:, wrist + 1] - positions[:, wrist]))


def palm_positions(
    side: int, capsule: int, body: Morphology, volume: BodyVolume, positions: FloatArray, rotations: FloatArray
) -> PalmPositions:
    """``PalmPositions`` beside a capsule of ``volume``, of posed bodies (F, P, 3), (F, S, 3, 3)."""
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

    ``free`` (2, F) is True where each hand is off the ground.
    """
    positions, rotations = (each[first_frame:] for each in realize_motion(motion, actor, play=True))
    free = free[:, first_frame:]
    together, held = hands_together_or_holding(actor, positions, rotations, motion.frame_rate)
    both = free.all(axis=0)
    found = {Touch.HANDS_TOGETHER: together & both, Touch.HANDS_ON_THING: held & both}
    volume = usual_volume(actor)
    for side, name in enumerate(("left", "right")):
        parts = {}
        for part, capsules in CAPSULES_OF.items():
            near = [palm_positions(side, capsule, actor, volume, positions, rotations) for capsule in capsules]
            rests, clearances = _resting(near, actor.leg_length, motion.frame_rate)
            hangs = part in ("hips", "thigh") and _hanging(side, actor, positions, rotations)
            parts[part] = rests & ~np.asarray(hangs), clearances
        found |= {Touch(f"{name}_hand_on_{part}"): mask & free[side] for part, mask in _nearest(parts).items()}
    least = {Touch.HANDS_TOGETHER: PASSING, Touch.HANDS_ON_THING: SHORTEST_HOLD}
    for touch, mask in found.items():
        for first, last in _joined(mask, round(TOUCH_GAP * motion.frame_rate)):
            if last - first + 1 > least.get(touch, RESTS_FOR) * motion.frame_rate:
                yield touch, (first + first_frame, last + first_frame)


def hands_together_or_holding(
    actor: Morphology, positions: FloatArray, rotations: FloatArray, rate: float
) -> tuple[Mask, Mask]:
    """Frames (F,) with hands together, and with a thing between hands, of posed bodies (F, P, 3), (F, S, 3, 3)."""
    layout, leg = actor.layout, actor.leg_length
    chest = rotations[:, layout.spine_count - 1]
    wrists = positions[:, [layout.wrist_point(0), layout.wrist_point(1)]] - positions[:, None, layout.neck_base]
    wrists = np.einsum("fij,fwi->fwj", chest, wrists) / leg
    gap = np.linalg.norm(wrists[:, 1] - wrists[:, 0], axis=1)
    swinging = _speed_of(wrists[:, 1] - wrists[:, 0], rate) > SWING_SPEED
    swinging &= np.minimum(wrists[:, 0, 1], -wrists[:, 1, 1]) > SWING_SIDE
    together = _between(np.where(swinging, np.maximum(gap, HANDS_MEET_DISTANCE[0]), gap), *HANDS_MEET_DISTANCE)
    before = wrists[:, :, 0].min(axis=1)
    around = round(0.5 * STEADY_FOR * rate)
    spread = highest(gap, around) - lowest(gap, around)
    steady = highest(spread < STEADY_WRIST_CHANGE, around)  # a steady stretch is so as a whole
    held = steady & (before > WRIST_AHEAD) & (gap > HELD_WRIST_RANGE[0]) & (gap < HELD_WRIST_RANGE[1]) & ~together
    for first, last in spans_of(held):
        held[first : last + 1] = np.ptp(wrists[first : last + 1].mean(axis=1), axis=0).max() > CARRIED_DISTANCE
    return together, held


def _hanging(side: int, actor: Morphology, positions: FloatArray, rotations: FloatArray) -> Mask:
    """(F,) true where an arm hangs down."""
    wrist = actor.layout.wrist_point(side)
    arm = positions[:, wrist] - positions[:, wrist - 2]
    length = np.linalg.norm(arm, axis=1)
    down = -(arm * rotations[:, actor.layout.spine_count - 1, :, 2]).sum(axis=1)
    return np.asarray((length > HANGING[0] * actor.arm[side].sum()) & (down > HANGING[1] * length))


def _resting(near: list[PalmPositions], leg: float, rate: float) -> tuple[Mask, FloatArray]:
    """(F,) true where a palm rests beside one of some capsules, and its distance from the nearest."""
    clearances = np.min([each.clearances for each in near], axis=0)
    speeds = np.min([_speed(each, rate) for each in near], axis=0)
    return _between(clearances / leg, *HAND_REST_DISTANCE) & (speeds < LYING_STILL * leg), clearances


def _speed(spot: PalmPositions, rate: float) -> FloatArray:
    """(F,) speed of a palm round a capsule or away from it, metres a second."""
    return _speed_of(spot.directions * (spot.clearances + 0.1)[:, None], rate)


def _speed_of(track: FloatArray, rate: float) -> FloatArray:
    """(F,) speed of a track (F, 3) over a tenth of a second, in its unit a second."""
    half, frames = max(1, round(0.05 * rate)), np.arange(len(track))
    ahead, behind = np.minimum(frames + half, len(track) - 1), np.maximum(frames - half, 0)
    seconds = np.maximum(ahead - behind, 1) / rate
    return np.asarray(np.linalg.norm(track[ahead] - track[behind], axis=1) / seconds)


def _nearest(parts: dict[str, tuple[Mask, FloatArray]]) -> dict[str, Mask]:
    """Rests of a hand on each part; each rest belongs to the part that is nearest to it overall."""
    anywhere = np.any([mask for mask, _ in parts.values()], axis=0)
    found = {part: np.zeros_like(anywhere) for part in parts}
    for first, last in spans_of(anywhere):
        span = slice(first, last + 1)
        best = min(parts, key=lambda part: float(parts[part][1][span].mean()))
        found[best][span] = True
    return found


def _between(track: FloatArray, begins: float, ends: float) -> Mask:
    """(F,) true in runs in which ``track`` (F,) stays below ``ends`` and falls below ``begins``."""
    found = np.zeros(len(track), dtype=np.bool_)
    for first, last in spans_of(track < ends):
        if (track[first : last + 1] < begins).any():
            found[first : last + 1] = True
    return found


def _joined(mask: Mask, gap: int) -> list[Span]:
    """Mask (F,) with gaps of up to ``gap`` frames between its runs closed."""
    joined: list[Span] = []
    for first, last in spans_of(mask):
        if joined and first - joined[-1][1] - 1 <= gap:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first, last))
    return joined
