"""Range of a new correction of a whole pose: its fades are long enough that no limb is much faster than it was."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.fitted_activation import PEAK_SPEED_LOSS
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.correction import CORRECTION_HOLD, CORRECTION_SECONDS, PoseOffsets, new_correction_range
from studio.core.stage.holding import REACH_SPEED
from studio.core.stage.timing import Timing
from studio.engine.posed_performer import rows_at

FloatArray = NDArray[np.float64]

FADES = ((CORRECTION_SECONDS - CORRECTION_HOLD) / 2.0, 0.3, 0.4, 0.5, 0.7, 1.0)
"""Seconds of a fade, from the usual one on."""


def fitted_range(timing: Timing, motion: AdaptedMotion, pose: PoseOffsets, time: float) -> ActivationCurve:
    """Range of a correction of ``motion`` with ``pose`` at ``time`` seconds of the stage.

    Its fades are the shortest with which no limb exceeds its own peak speed by more than a tenth, or that at which a
    hand reaches; else those with the least excess. Each side is fitted separately.
    """
    count = round((CORRECTION_HOLD + FADES[-1]) * motion.frame_rate)
    times = time + np.arange(-count, count + 1) / motion.frame_rate
    rows = rows_at(motion, timing, times)
    allowed = np.maximum(
        PEAK_SPEED_LOSS * _speeds(motion, rows, PoseOffsets(), np.zeros(len(rows))).max(axis=0), REACH_SPEED
    )
    _, full, full_end, _ = new_correction_range(time).times
    curves = [ActivationCurve(full - fade, full, full_end, full_end + fade) for fade in FADES]
    speeds = [_speeds(motion, rows, pose, curve.at(times)) for curve in curves]

    def fitted_fade(side: slice) -> float:
        peaks = [each[side].max(axis=0) for each in speeds]
        excesses = [round(float(np.log(np.maximum(peak / allowed, 1.0)).sum()), 2) for peak in peaks]
        return FADES[int(np.argmin(excesses))]

    return ActivationCurve(
        full - fitted_fade(slice(None, count)), full, full_end, full_end + fitted_fade(slice(count, None))
    )


def _speeds(motion: AdaptedMotion, rows: NDArray[np.intp], pose: PoseOffsets, activation: FloatArray) -> FloatArray:
    """Speeds (N - 1, 6), metres a second, of hips, head, wrists and ankles in the frames ``rows`` (N,) with a pose at
    the weight ``activation`` (N,). Ankles follow it as far as their contacts release them.
    """
    from studio.core.solver.asking.points import limb_of  # these load kernels
    from studio.core.solver.correction_layer import PosedFrames, along_heading, segment_turns, with_segments_turned
    from studio.core.solver.grounding.body_support import limb_freedom

    layout, weight = motion.morphology.layout, activation[:, None]
    own = PosedFrames(motion.positions[rows], motion.rotations[rows])
    forward = own.rotations[:, 0, :, 0]
    heading = np.arctan2(forward[:, 1], forward[:, 0])
    hips = motion.body.leg_length * weight * along_heading(np.tile(pose.hips, (len(rows), 1)), heading)
    turns = segment_turns(layout, {part: weight * np.array(turn) for part, turn in pose.turns})
    moved = with_segments_turned(layout, own, turns, hips).positions
    limbs = [point(side) for point in (layout.wrist_point, layout.ankle_point) for side in range(2)]
    ends = [0, layout.head_joint, *limbs]
    freedoms, frames = np.ones((len(rows), len(ends))), rows + motion.first_frame
    for place, foot in ((-2, BodyPart.LEFT_FOOT), (-1, BodyPart.RIGHT_FOOT)):
        release = limb_freedom(motion.contacts, limb_of(foot), int(frames.max()) + 1, motion.frame_rate)
        freedoms[:, place] = release[frames]
    paths = own.positions[:, ends] + freedoms[..., None] * (moved[:, ends] - own.positions[:, ends])
    return np.asarray(np.linalg.norm(np.diff(paths, axis=0), axis=2) * motion.frame_rate)
