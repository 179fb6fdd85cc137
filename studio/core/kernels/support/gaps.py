"""Values that are known in some frames, eased over the gaps between them (METHOD (6))."""

import math

from studio.core.kernels.algebra.eases import smoothstep
from studio.core.kernels.compiling import kernel, small_kernel


@kernel
def free_feet(planted, reach, out_free):
    """0 in frames that are ``planted`` (F,), eased to 1 within ``reach`` frames before and after, (F,) (METHOD (6))."""
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
def fill_gaps(values, known):
    """Values (F, 3) where not ``known`` (F,): eased from the known before to the known after, held at the ends.

    METHOD (6).
    """
    count = known.shape[0]
    last = -1
    for frame in range(count):
        if not known[frame]:
            continue
        for gap in range(last + 1, frame):
            share = 1.0 if last < 0 else smoothstep((gap - last) / (frame - last))
            for axis in range(3):
                begin = values[last, axis] if last >= 0 else values[frame, axis]
                values[gap, axis] = begin + share * (values[frame, axis] - begin)
        last = frame
    for gap in range(last + 1, count):
        for axis in range(3):
            values[gap, axis] = values[last, axis] if last >= 0 else 0.0


@kernel
def ease_gaps(values, known, reach):
    """``fill_gaps``, but for ``reach`` frames beside what is known values go on as fast as they did there, ever less.

    So what is corrected comes to rest, and starts from it, without a jolt: a correction that stood still at once would
    leave the motion its own speed one frame away from where it has none.

    METHOD (6).
    """
    fill_gaps(values, known)
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
                    share = steps * (1.0 - smoothstep(steps / span))
                    for axis in range(3):
                        values[gap, axis] += share * (values[edge, axis] - values[inner, axis])
        frame = end


@small_kernel
def is_inside(frame, known):
    """Whether both frames before and after one are ``known`` (F,), so that ``ease_gaps`` does not look at it."""
    return (
        1 < frame < known.shape[0] - 2
        and known[frame - 2]
        and known[frame - 1]
        and known[frame + 1]
        and known[frame + 2]
    )
