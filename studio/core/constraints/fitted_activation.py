"""Activation of a new constraint at the present position of a limb, fitted so that the limb keeps its speed."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from studio.core.curves.activation import ActivationCurve, EaseShape, ease, weighted_progress

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
DrawnValues = Callable[[FloatArray, IntArray], FloatArray]
"""Function that returns the values (R, D) in the frames ``rows`` (R,), drawn to the target by an activation (R,)."""

DEFAULT_HOLD_SECONDS, DEFAULT_RAMP_SECONDS = 0.1, 0.3
"""Seconds held on either side of the playhead, and seconds of the ramps beyond; used wherever the limb then keeps its
speed.
"""
PEAK_SPEED_GROWTH, PEAK_SPEED_LOSS = 1.03, 1.1
"""Factors by which the peak speed of a limb may grow and shrink; after solving it has grown by a few hundredths more.
"""
SLOW_LIMB = 0.1
"""Speed in metres or radians per second that replaces slower speeds of the limb."""
HOLD_CANDIDATES_SECONDS = (DEFAULT_HOLD_SECONDS, 0.05, 0.02, 0.0)
"""Holds that are tried, in seconds."""
RAMP_CANDIDATES_SECONDS = (DEFAULT_RAMP_SECONDS, 0.05, 0.07, 0.1, 0.15, 0.2, 0.4, 0.5, 0.7, 1.0)
"""Ramps that are tried, in seconds."""
HOLD_END_WEIGHTS = (1.0, 0.5, 0.25, 0.1)
"""Weights at the end of the hold that are tried: a passing limb is released sooner, and need not catch up so fast."""
LONGEST_SIDE_SECONDS = max(HOLD_CANDIDATES_SECONDS) + max(RAMP_CANDIDATES_SECONDS)
"""Longest hold and ramp together, in seconds."""
STRETCHED_LIMB_FRACTION = 0.9
"""Fraction of its length to which a limb is stretched before its root follows."""
LEAST_LENGTH, SMALL_ANGLE = 1e-6, 1e-6


@dataclass(frozen=True, eq=False)
class LimbPath:
    """Path of the end of a limb as it is blended to a ``target`` (3,), with both segments rotated along shortest arcs.

    ``root``, ``joint`` and ``end`` (F, 3), metres, are shoulder, elbow and hand, or hip, knee and foot. The root
    follows if the limb is too short.
    """

    root: FloatArray
    joint: FloatArray
    end: FloatArray
    target: FloatArray

    def end_positions(self, activation: FloatArray, rows: IntArray) -> FloatArray:
        """Positions (R, 3) of the end in the frames ``rows`` (R,) for ``activation`` (R,)."""
        part = activation[:, None]
        upper = _rotated(self._upper[rows], self._held[0][rows], part)
        lower = _rotated(self._lower[rows], self._held[1][rows], part)
        return np.asarray(self.root[rows] + part * self._held[2][rows] + upper + lower)

    @cached_property
    def _upper(self) -> FloatArray:
        return self.joint - self.root

    @cached_property
    def _lower(self) -> FloatArray:
        return self.end - self.joint

    @cached_property
    def _held(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Both segments (F, 3) with the end at the target and the present bend direction, and the displacement of the
        root.
        """
        long, short = (np.linalg.norm(each, axis=1, keepdims=True) for each in (self._upper, self._lower))
        way = self.target - self.root
        distance = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), LEAST_LENGTH)
        axis = way / distance
        follow = np.maximum(distance - STRETCHED_LIMB_FRACTION * (long + short), 0.0) * axis
        distance = np.clip(distance, np.abs(long - short) + LEAST_LENGTH, STRETCHED_LIMB_FRACTION * (long + short))
        bend = self._upper - np.sum(self._upper * axis, axis=1, keepdims=True) * axis
        bend /= np.maximum(np.linalg.norm(bend, axis=1, keepdims=True), LEAST_LENGTH)
        along = (long**2 - short**2 + distance**2) / (2.0 * distance)
        upper = along * axis + np.sqrt(np.maximum(long**2 - along**2, 0.0)) * bend
        return upper, distance * axis - upper, follow


def _rotated(begin: FloatArray, end: FloatArray, part: FloatArray) -> FloatArray:
    """Vectors (R, 3) at the fraction ``part`` (R, 1) of the arcs from ``begin`` to ``end``, which have
    equal lengths.
    """
    lengths = np.maximum(np.sum(begin * begin, axis=1, keepdims=True), LEAST_LENGTH**2)
    angle = np.arccos(np.clip(np.sum(begin * end, axis=1, keepdims=True) / lengths, -1.0, 1.0))
    sine = np.where(np.sin(angle) < SMALL_ANGLE, 1.0, np.sin(angle))
    arc = (np.sin((1.0 - part) * angle) * begin + np.sin(part * angle) * end) / sine
    return np.where(np.sin(angle) < SMALL_ANGLE, begin + part * (end - begin), arc)


def fitted_activation(
    seconds: FloatArray,
    values: FloatArray,
    now: float,
    begin: float,
    end: float,
    limb: LimbPath | None = None,
    freedom: FloatArray | None = None,
) -> ActivationCurve:
    """Activation around second ``now``, from ``begin`` to ``end`` at most, that raises the peak speed by at most a
    tenth.

    ``values`` (F, D), metres or radians, are those of the limb at ``seconds`` (F,); the target is the value at ``now``.
    The values are blended to it linearly, or as the end of ``limb`` moves, multiplied by ``freedom`` (F,), the fraction
    to which contacts have released the limb. Each side is fitted separately: the default hold and ramp, else the
    nearest to them that suffice, else the gentlest.
    """
    here = np.array([np.interp(now, seconds, column) for column in values.T])

    def drawn(activation: FloatArray, rows: IntArray) -> FloatArray:
        part = activation if freedom is None else activation * freedom[rows]
        if limb is not None:
            return limb.end_positions(part, rows)
        return np.asarray(values[rows] + part[:, None] * (here - values[rows]))

    rows = np.arange(len(seconds))
    hold_in, ramp_in, weight_in = _fitted_side(now - seconds, rows[::-1], values, drawn, now - begin)
    hold_out, ramp_out, weight_out = _fitted_side(seconds - now, rows, values, drawn, end - now)
    times = now - hold_in - ramp_in, now - hold_in, now + hold_out, now + hold_out + ramp_out
    return ActivationCurve(*times, weights=(1.0, weight_in, weight_out, 1.0))


def free_frames(stands: NDArray[np.bool_], frame: int) -> tuple[int, int]:
    """Number of frames from ``frame`` back to the last stance of a limb, and number of frames on to its next stance.

    ``stands`` (F,) masks the stances. A stance at ``frame`` counts as one with the motion around it.
    """
    return _to_next_stance(stands[frame::-1]), _to_next_stance(stands[frame:])


def _to_next_stance(stands: NDArray[np.bool_]) -> int:
    """Number of frames from the first frame of ``stands`` (F,) to the next stance, not counting a stance at the first
    frame.
    """
    own = int(np.argmin(stands)) if not stands.all() else len(stands)
    later = np.flatnonzero(stands[own:])
    return own + int(later[0]) if len(later) else len(stands)


def _fitted_side(
    since: FloatArray, rows: IntArray, values: FloatArray, drawn: DrawnValues, room: float
) -> tuple[float, float, float]:
    """Hold and ramp in seconds, and weight, of one side of the activation.

    ``rows`` are the frames of ``values`` (F, D) on that side, ``since`` (F,) their seconds from the playhead. Hold and
    ramp fit into ``room`` seconds, the time to the end of the clip.
    """
    gentlest, least = _within(room, DEFAULT_HOLD_SECONDS, DEFAULT_RAMP_SECONDS, 1.0), np.inf
    rows = rows[(since[rows] >= -1e-9) & (since[rows] <= LONGEST_SIDE_SECONDS)]
    since = since[rows]
    if len(since) < 3:
        return gentlest
    steps = np.diff(since)
    natural = np.linalg.norm(np.diff(values[rows], axis=0), axis=1) / steps
    for usual in sorted(product(HOLD_CANDIDATES_SECONDS, RAMP_CANDIDATES_SECONDS, HOLD_END_WEIGHTS), key=_change):
        hold, ramp, weight = _within(room, *usual)
        progress = np.clip((hold + ramp - since) / ramp, 0.0, 1.0) if ramp > 0.0 else (since <= hold) * 1.0
        activation = ease(weighted_progress(progress, 1.0, weight), EaseShape.QUINTIC)
        speeds = np.linalg.norm(np.diff(drawn(activation, rows), axis=0), axis=1) / steps
        compared = since[1:] <= max(hold + ramp, min(DEFAULT_HOLD_SECONDS + DEFAULT_RAMP_SECONDS, room)) + 1e-9
        peak, usual_peak = (max(float(each[compared].max(initial=0.0)), SLOW_LIMB) for each in (speeds, natural))
        change = math.log(peak / usual_peak)
        if -math.log(PEAK_SPEED_LOSS) <= change <= math.log(PEAK_SPEED_GROWTH):
            return hold, ramp, weight
        if abs(change) < least:
            gentlest, least = (hold, ramp, weight), abs(change)
    return gentlest


def _within(room: float, hold: float, ramp: float, weight: float) -> tuple[float, float, float]:
    hold = min(hold, room)
    return hold, min(ramp, room - hold), weight


def _change(side: tuple[float, float, float]) -> float:
    """Difference of a side from the default hold and ramp, in seconds of a longer ramp.

    A shorter ramp counts twice, since a dragged target needs it. Half the weight counts as a ramp that is longer by
    half its length, because the limb stops more sharply.
    """
    hold, ramp, weight = side
    ramp_change = ramp - DEFAULT_RAMP_SECONDS if ramp > DEFAULT_RAMP_SECONDS else 2.0 * (DEFAULT_RAMP_SECONDS - ramp)
    return 3.0 * (DEFAULT_HOLD_SECONDS - hold) + ramp_change - 0.15 * math.log2(weight)
