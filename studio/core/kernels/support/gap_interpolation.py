"""Interpolation of values over frames in which they are unknown (METHOD (6))."""

import math

from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.compiling import kernel, small_kernel

ADDED_ACCELERATION = 0.5
"""Greatest acceleration that a fading correction may add, as a fraction of the track's own in its gap."""
SMOOTHSTEP_ACCELERATION = 10.0 / math.sqrt(3.0)
"""Greatest second derivative of the smoothstep over [0, 1]."""


@kernel
def release_weights(planted, reach, out_free):
    """Write weights (F,): 0 in ``planted`` frames, rising smoothly to 1 within ``reach`` frames of the nearest one
    (METHOD (6)).
    """
    count = planted.shape[0]
    last = -math.inf
    for frame in range(count):
        last = frame if planted[frame] else last
        out_free[frame] = frame - last
    next_one = math.inf
    for frame in range(count - 1, -1, -1):
        next_one = frame if planted[frame] else next_one
        out_free[frame] = smoothstep(min(min(out_free[frame], next_one - frame) / reach, 1.0))


@kernel
def interpolate_gaps(values, known):
    """Interpolate ``values`` (F, N) smoothly where not ``known`` (F,), in place; values are constant before the first
    and after the last known one.

    METHOD (6).
    """
    count = known.shape[0]
    last = -1
    for frame in range(count):
        if not known[frame]:
            continue
        for gap in range(last + 1, frame):
            fraction = 1.0 if last < 0 else smoothstep((gap - last) / (frame - last))
            for axis in range(values.shape[1]):
                begin = values[last, axis] if last >= 0 else values[frame, axis]
                values[gap, axis] = begin + fraction * (values[frame, axis] - begin)
        last = frame
    for gap in range(last + 1, count):
        for axis in range(values.shape[1]):
            values[gap, axis] = values[last, axis] if last >= 0 else 0.0


@kernel
def fade_into_gaps(corrections, known, track, reach, least):
    """Fade ``corrections`` (F, 3) of a ``track`` (F, 3) from both ends into every gap where not ``known`` (F,), in
    place.

    Each correction fades in ``least`` frames, or in as many more as it needs to add at most ``ADDED_ACCELERATION`` of
    the track's own acceleration, at most in the whole gap: both ends then interpolate. Where nothing is known beyond
    the gap, an infinite ``least`` keeps the correction. The velocity of corrections inside a run fades in ``reach``
    frames by Hermite's cubic, which deviates least for its acceleration: without it the track would have its own
    velocity one frame after rest. METHOD (6).
    """
    count, frame = known.shape[0], 0
    while frame < count:
        if known[frame]:
            frame += 1
            continue
        end = frame
        while end < count and not known[end]:
            end += 1
        corrections[frame:end] = 0.0
        whole = end - frame + 1.0 if frame > 0 and end < count else math.inf
        allowed = ADDED_ACCELERATION * max(mean_acceleration(track, frame, end), 1e-12)
        for side in range(2):
            edge, inner = (frame - 1, frame - 2) if side == 0 else (end, end + 1)
            if not 0 <= edge < count:
                continue
            x, y, z = corrections[edge, 0], corrections[edge, 1], corrections[edge, 2]
            span = math.sqrt(SMOOTHSTEP_ACCELERATION * math.sqrt(x * x + y * y + z * z) / allowed)
            span = min(max(span, least), whole)
            leads = min(reach, end - frame + 1.0) if 0 <= inner < count and known[inner] else 1.0
            for gap in range(frame, end):
                steps = abs(gap - edge)
                fraction = 1.0 - smoothstep(min(steps / span, 1.0))
                led = steps * (1.0 - min(steps / leads, 1.0)) ** 2
                for axis in range(3):
                    correction = corrections[edge, axis]
                    corrections[gap, axis] += fraction * correction
                    if led != 0.0:
                        corrections[gap, axis] += led * (correction - corrections[inner, axis])
        frame = end


@kernel
def mean_acceleration(track, first, past):
    """Root mean square of the second differences of a ``track`` (F, 3) in frames ``first`` to ``past``."""
    total, count = 0.0, 0
    for frame in range(max(first, 1), min(past, track.shape[0] - 1)):
        for axis in range(3):
            bend = track[frame + 1, axis] - 2.0 * track[frame, axis] + track[frame - 1, axis]
            total += bend * bend
        count += 1
    return math.sqrt(total / max(count, 1))


@small_kernel
def is_inside_run(frame, known):
    """True if ``known`` (F,) is true for the two frames before and the two frames after ``frame``.

    ``fade_into_gaps`` does not read the correction of such a frame.
    """
    return (
        1 < frame < known.shape[0] - 2
        and known[frame - 2]
        and known[frame - 1]
        and known[frame + 1]
        and known[frame + 2]
    )
