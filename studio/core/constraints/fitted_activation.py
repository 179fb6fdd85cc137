"""Activation of a new constraint whose target is where the limb is now: it lets the limb keep its speed."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from studio.core.curves.activation import ActivationCurve, EaseShape, ease, weighted_progress

FloatArray = NDArray[np.float64]

HOLD, RAMP = 0.1, 0.3
"""Seconds held on either side of the playhead, and eased beyond, wherever the limb keeps its speed with them."""
CHANGE = 1.1
"""Factor by which the peak speed of a limb may grow or shrink."""
SLOW_LIMB = 0.1
"""Metres or radians a second: slower speeds count as this."""
HOLDS = (HOLD, 0.05, 0.02, 0.0)
RAMPS = (RAMP, 0.2, 0.4, 0.5, 0.7, 1.0)
WEIGHTS = (1.0, 0.5, 0.25)
"""Weights of the end of the hold: a limb that only passes is let go sooner, and need not catch up so fast."""
LONGEST = max(HOLDS) + max(RAMPS)
"""Seconds on either side that matter."""


def fitted_activation(seconds: FloatArray, values: FloatArray, now: float, begin: float, end: float) -> ActivationCurve:
    """Activation around ``now``, from ``begin`` to ``end`` at most, that keeps the peak speed within a tenth.

    ``values`` (F, D), metres or radians, are those of the limb at ``seconds`` (F,); the target is the value at ``now``.
    Each side is fitted by itself: the usual hold and ramp, else the nearest to them that do, else the gentlest.
    """
    here = np.array([np.interp(now, seconds, column) for column in values.T])
    away = values - here
    hold_in, ramp_in, weight_in = _fitted_side(now - seconds[::-1], away[::-1], now - begin)
    hold_out, ramp_out, weight_out = _fitted_side(seconds - now, away, end - now)
    times = now - hold_in - ramp_in, now - hold_in, now + hold_out, now + hold_out + ramp_out
    return ActivationCurve(*times, weights=(1.0, weight_in, weight_out, 1.0))


def _fitted_side(since: FloatArray, away: FloatArray, room: float) -> tuple[float, float, float]:
    """Hold and ramp in seconds, and weight, of one side: ``away`` (F, D) from the target at ``since`` (F,) seconds.

    Hold and ramp end within the ``room`` to the end of the clip.
    """
    gentlest, least = _within(room, HOLD, RAMP, 1.0), np.inf
    kept = (since >= -1e-9) & (since <= LONGEST)
    since, away = since[kept], away[kept]
    if len(since) < 3:
        return gentlest
    steps = np.diff(since)
    natural = np.linalg.norm(np.diff(away, axis=0), axis=1) / steps
    for usual in sorted(product(HOLDS, RAMPS, WEIGHTS), key=_change):
        hold, ramp, weight = _within(room, *usual)
        progress = np.clip((hold + ramp - since) / ramp, 0.0, 1.0) if ramp > 0.0 else (since <= hold) * 1.0
        activation = ease(weighted_progress(progress, 1.0, weight), EaseShape.QUINTIC)
        speeds = np.linalg.norm(np.diff((1.0 - activation)[:, None] * away, axis=0), axis=1) / steps
        compared = since[1:] <= max(hold + ramp, min(HOLD + RAMP, room)) + 1e-9
        peak, usual_peak = (max(float(each[compared].max(initial=0.0)), SLOW_LIMB) for each in (speeds, natural))
        change = abs(math.log(peak / usual_peak))
        if change <= math.log(CHANGE):
            return hold, ramp, weight
        if change < least:
            gentlest, least = (hold, ramp, weight), change
    return gentlest


def _within(room: float, hold: float, ramp: float, weight: float) -> tuple[float, float, float]:
    hold = min(hold, room)
    return hold, min(ramp, room - hold), weight


def _change(side: tuple[float, float, float]) -> float:
    """Size of the change from the usual hold and ramp; a shorter ramp counts twice, since a dragged target needs it."""
    hold, ramp, weight = side
    ramp_change = ramp - RAMP if ramp > RAMP else 2.0 * (RAMP - ramp)
    return 3.0 * (HOLD - hold) + ramp_change + 0.1 * (1.0 - weight)
