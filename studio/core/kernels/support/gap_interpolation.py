"""Interpolation of values over the frames in which they are unknown (METHOD (6))."""

import math

from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.compiling import kernel, small_kernel


@kernel
def release_weights(planted, reach, out_free):
    """Write 0 in ``planted`` frames (F,), rising smoothly to 1 within ``reach`` frames before and after
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
    """Interpolate values (F, 3) where not ``known`` (F,), with constant values at both ends, in place.

    METHOD (6).
    """
    count = known.shape[0]
    last = -1
    for frame in range(count):
        if not known[frame]:
            continue
        for gap in range(last + 1, frame):
            fraction = 1.0 if last < 0 else smoothstep((gap - last) / (frame - last))
            for axis in range(3):
                begin = values[last, axis] if last >= 0 else values[frame, axis]
                values[gap, axis] = begin + fraction * (values[frame, axis] - begin)
        last = frame
    for gap in range(last + 1, count):
        for axis in range(3):
            values[gap, axis] = values[last, axis] if last >= 0 else 0.0


@kernel
def interpolate_gaps_smoothly(values, known, reach):
    """Interpolate as ``interpolate_gaps`` with values that continue their velocity, fading, for ``reach`` frames in a
    gap.

    A correction so comes to rest, and starts, without an acceleration peak: a correction that stopped at once would
    leave the motion its own speed one frame away from rest. Hermite's cubic leads away least for its acceleration.
    METHOD (6).
    """
    interpolate_gaps(values, known)
    count, frame = known.shape[0], 0
    while frame < count:
        if known[frame]:
            frame += 1
            continue
        end = frame
        while end < count and not known[end]:
            end += 1
        span = min(reach, end - frame + 1.0)
        for side in range(2):
            edge, inner = (frame - 1, frame - 2) if side == 0 else (end, end + 1)
            if min(edge, inner) < 0 or max(edge, inner) >= count or not known[inner]:
                continue
            for gap in range(frame, end):
                steps = abs(gap - edge)
                if steps < span:
                    fraction = steps * (1.0 - steps / span) ** 2
                    for axis in range(3):
                        values[gap, axis] += fraction * (values[edge, axis] - values[inner, axis])
        frame = end


@small_kernel
def is_inside_run(frame, known):
    """True if ``known`` (F,) is true for the two frames before and the two after: ``interpolate_gaps_smoothly`` does
    not read such a frame.
    """
    return (
        1 < frame < known.shape[0] - 2
        and known[frame - 2]
        and known[frame - 1]
        and known[frame + 1]
        and known[frame + 2]
    )
