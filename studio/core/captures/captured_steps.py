"""Detection of the steps on which a capture was recorded: its feet stand at several heights with equal differences."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import STILL_SPEED, point_speeds
from studio.core.grounds.slope import direction_vector
from studio.core.grounds.steps import Steps
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

SHORTEST_STANCE_SECONDS = 0.1
"""Least duration of a stance in seconds."""
LOWEST_RISE_METRES = 0.08
"""Least rise of a step in metres; soles on one level differ by less than half of it."""
TREAD_HEIGHT_ERROR = 0.03
"""Greatest distance in metres of a stance above or below the fitted tread."""
LEAST_TREAD_FRACTION = 0.95
"""Least fraction of the stances that lie on the fitted treads."""
SHORTEST_TREAD_METRES = 0.1
"""Least length of a tread in metres."""


@dataclass(frozen=True, eq=False)
class CapturedStance:
    """Stance of one foot (0 left, 1 right), which carries the body from frame ``first`` to before frame ``past``."""

    side: int
    first: int
    past: int
    position: FloatArray
    """Middle of the sole (2,) in metres."""
    height: float
    """Height in metres of the lower one of heel and ball."""


def find_stances(soles: FloatArray, upright: NDArray[np.bool_], frame_rate: float) -> list[CapturedStance]:
    """Stances at any height, in order of time, of ``soles`` (F, 2, 3, 3: side, heel, ball and tip, position) in metres.

    ``upright`` (F, 2) masks the legs that stand upright. A foot held still in the air is no stance: the other one
    stands lower at the same time.
    """
    found = []
    levels = np.full(upright.shape, np.inf)
    for side in range(2):
        ends = soles[:, side, :2]
        speeds = [point_speeds(ends[:, end], upright[:, side], frame_rate) for end in range(2)]
        for first, past in runs_of(upright[:, side] & (np.minimum(*speeds) < STILL_SPEED)):
            if past - first >= SHORTEST_STANCE_SECONDS * frame_rate:
                height = float(np.median(ends[first:past, :, 2].min(axis=1)))
                position = np.median(soles[first:past, side, :, :2].mean(axis=1), axis=0)
                levels[first:past, side] = height
                found.append(CapturedStance(side, first, past, position, height))
    carries = [
        np.mean(levels[each.first : each.past, 1 - each.side] < each.height - LOWEST_RISE_METRES / 2) < 0.5
        for each in found
    ]
    return sorted((each for each, does in zip(found, carries, strict=True) if does), key=lambda each: each.first)


def find_steps(stances: list[CapturedStance]) -> Steps | None:
    """Flight of equal steps, or a single step, on which the stances lie; None if they are on one level or fit no steps.

    The ``height`` of the steps is that of the soles on the lowest level.
    """
    heights, places = np.array([each.height for each in stances]), np.array([each.position for each in stances])
    ordered = np.sort(heights)
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) > LOWEST_RISE_METRES / 2) + 1)
    levels = np.array([np.median(group) for group in groups if len(group)])
    if len(levels) < 2 or np.diff(levels).min() < LOWEST_RISE_METRES:
        return None
    on = np.rint((heights - levels[0]) / np.diff(levels).min()).astype(int)
    count = on.max()
    way = np.zeros(2)
    for side in range(2):  # from each stance of a foot to its next: the feet are beside each other
        own = np.array([each.side == side for each in stances])
        way += np.sign(np.diff(on[own])) @ np.diff(places[own], axis=0)
    if not way.any():
        return None
    direction = math.atan2(way[1], way[0])
    along = places @ direction_vector(direction)
    between = np.unique(on[(on > 0) & (on < count)])
    middles = np.array([np.median(along[on == level]) for level in between])
    if len(middles) > 1:
        tread, begin = np.polyfit(between, middles, 1)
    else:  # the stances nearest to the steps say where they end
        tread = (along[on == count].min() - along[on == 0].max()) / count
        begin = middles[0] - tread * between[0] if len(middles) else along[on == 0].max()
    if tread < SHORTEST_TREAD_METRES:
        return None
    start = tuple((direction_vector(direction) * (begin + tread / 2)).tolist())
    steps = Steps(float(levels[0]), float(np.ptp(levels) / count), float(tread), int(count), direction, start)
    right = np.abs(steps.height_at(places) - heights) < TREAD_HEIGHT_ERROR
    return steps if right.mean() >= LEAST_TREAD_FRACTION else None


def foot_levels(stances: list[CapturedStance], steps: Steps, soles: FloatArray) -> FloatArray:
    """Heights (F, 2) in metres, above the lowest level, of the tread under each foot.

    Between two stances, it is the higher one of the two treads that the sole is above. ``soles`` is (F, 2, 3, 3).
    """
    levels = np.zeros(soles.shape[:2])
    heights = soles[..., 2].min(axis=2) - steps.height + TREAD_HEIGHT_ERROR
    for side in range(2):
        own = [each for each in stances if each.side == side]
        if not own:
            continue
        treads = steps.rise_at(np.array([each.position for each in own]))
        firsts, pasts = [each.first for each in own], [each.past for each in own]
        before = treads[np.maximum(np.searchsorted(firsts, np.arange(len(soles)), side="right") - 1, 0)]
        after = treads[np.minimum(np.searchsorted(pasts, np.arange(len(soles)), side="right"), len(own) - 1)]
        higher = np.maximum(before, after)
        levels[:, side] = np.where(heights[:, side] > higher, higher, np.minimum(before, after))
    return levels
