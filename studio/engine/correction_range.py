"""Fades of a correction that is posed at a key: they are long enough that no limb is much faster than it was."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.fitted_activation import PEAK_SPEED_LOSS
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.correction import CORRECTION_HOLD, CORRECTION_SECONDS, Correction
from studio.core.stage.holding import REACH_SPEED
from studio.core.stage.timing import Timing
from studio.engine.posed_performer import rows_at

FloatArray = NDArray[np.float64]

FADES = ((CORRECTION_SECONDS - CORRECTION_HOLD) / 2.0, 0.3, 0.4, 0.5, 0.7, 1.0)
"""Seconds of a fade, from the usual one on. Fades of another length are the user's."""


def with_fitted_fades(
    correction: Correction, before: Correction | None, timing: Timing, motion: AdaptedMotion, time: float
) -> Correction:
    """Copy of ``correction``, just posed at ``time`` seconds of the stage, whose fades to its first and from its last
    key are fitted if they begin or end there and the user has not set them.

    A fitted fade is the shortest with which no limb exceeds its own peak speed by more than a tenth, or that at which a
    hand reaches; else that with the least excess. ``motion`` is adapted with the correction as it was ``before``.
    """
    curve, keys = correction.activation, correction.keys.times
    fade_in, fade_out = curve.full - curve.start, curve.end - curve.full_end
    is_fitted = np.abs(np.array([[fade_in], [fade_out]]) - FADES).min(axis=1) < 1e-6
    count = round((CORRECTION_HOLD + FADES[-1]) * motion.frame_rate)
    times = time + np.arange(-count, count + 1) / motion.frame_rate
    rows = rows_at(motion, timing, times)
    candidates = [
        replace(correction, activation=curve.with_times(curve.full - fade, *curve.times[1:3], curve.full_end + fade))
        for fade in FADES
    ]
    own, *speeds = _speeds(motion, rows, times, before, candidates)
    allowed = np.maximum(PEAK_SPEED_LOSS * own.max(axis=0), REACH_SPEED)

    def fitted_fade(side: slice) -> float:
        peaks = [each[side].max(axis=0) for each in speeds]
        excesses = [round(float(np.log(np.maximum(peak / allowed, 1.0)).sum()), 2) for peak in peaks]
        return FADES[int(np.argmin(excesses))]

    if is_fitted[0] and time == keys[0]:
        fade_in = fitted_fade(slice(None, count))
    if is_fitted[1] and time == keys[-1]:
        fade_out = fitted_fade(slice(count, None))
    fitted = curve.with_times(curve.full - fade_in, *curve.times[1:3], curve.full_end + fade_out)
    return replace(correction, activation=fitted)


def _speeds(
    motion: AdaptedMotion,
    rows: NDArray[np.intp],
    times: FloatArray,
    before: Correction | None,
    corrections: Sequence[Correction],
) -> list[FloatArray]:
    """Speeds (N - 1, 6), metres a second, of hips, head, wrists and ankles in the frames ``rows`` (N,) at ``times``
    (N,): without the correction ``before``, which ``motion`` has, and with each of ``corrections`` in its place. Ankles
    follow a correction as far as their contacts release them.
    """
    from studio.core.solver.correction_layer import PosedFrames, with_offsets
    from studio.core.solver.grounding.body_support import limb_freedom
    from studio.core.solver.task_assembly.points import limb_of  # these load kernels

    layout, leg_length = motion.morphology.layout, motion.body.leg_length
    shown = PosedFrames(motion.positions[rows], motion.rotations[rows])
    forward = shown.rotations[:, 0, :, 0]
    heading = np.arctan2(forward[:, 1], forward[:, 0])
    limbs = [point(side) for point in (layout.wrist_point, layout.ankle_point) for side in range(2)]
    ends = [0, layout.head_joint, *limbs]
    freedoms, frames = np.ones((len(rows), len(ends), 1)), rows + motion.first_frame
    for place, foot in ((-2, BodyPart.LEFT_FOOT), (-1, BodyPart.RIGHT_FOOT)):
        release = limb_freedom(motion.contacts, limb_of(foot), int(frames.max()) + 1, motion.frame_rate)
        freedoms[:, place, 0] = release[frames]
    plain = shown
    if before is not None:
        plain = with_offsets(before, times, layout, leg_length, heading, plain, sign=-1.0)
    posed = [with_offsets(each, times, layout, leg_length, heading, plain) for each in corrections]
    own = shown.positions[:, ends] + freedoms * (plain.positions - shown.positions)[:, ends]
    moved = [own, *(own + freedoms * (each.positions - plain.positions)[:, ends] for each in posed)]
    return [np.asarray(np.linalg.norm(np.diff(each, axis=0), axis=2) * motion.frame_rate) for each in moved]
