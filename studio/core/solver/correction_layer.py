"""Manual corrections applied to poses: below the constraints to the grounded motion, above them to the solved one.

A correction rotates segments about their joints by forward kinematics: with local rotations L of the motion, offsets Q
and weights w in time, L' = L exp(w log Q). Below the constraints planted feet keep their footprints: ankles follow the
corrected pose only as far as their contacts release them, the root is lowered where a planted leg would be too short,
and the legs are placed on their ankles like those of the motion.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.morphology import AnimatedMorphology, at_frames
from studio.core.curves.activation import LEAST_FULL_ACTIVATION, QUINTIC_PEAK_SLOPE
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.limbs.legs import required_root_lowering
from studio.core.kernels.solve_clip import place_frames
from studio.core.normalized.encode import encode_motion
from studio.core.project_cache import project_cache
from studio.core.rotations import from_matrix, from_rotation_vector, inverse, multiply, to_matrix, to_rotation_vector
from studio.core.runs import runs_of
from studio.core.solver.grounding.contact_blending import RELEASE_SECONDS, release_weight, smooth_drops
from studio.core.solver.grounding.footing import Footing
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import targets_of
from studio.core.solver.task_assembly.measured_residuals import full_residuals
from studio.core.stage.correction import Correction

FloatArray = NDArray[np.float64]
SegmentRotations = Mapping[int, FloatArray]
"""Rotations (N, 3, 3) of segments, in the segments' own axes, by segment index."""


class PosedFrames(NamedTuple):
    """Poses of N frames of a body."""

    positions: FloatArray
    """(N, P, 3) metres."""
    rotations: FloatArray
    """(N, S, 3, 3) in the world."""


FREED_FOOT_SPEED = 2.0
"""Highest speed, metres a second and relative to the motion, at which a foot leaves its contact for a corrected pose
and comes back: about that of a step.
"""
LIMB_CHANNELS = slice(channel.CLAVICLE, channel.HEAD_SHIFT)
"""Channels of arms and legs, from which limbs are placed on their ends."""


@project_cache(maxsize=4)
def with_corrections_below(standing: GroundedMotion, corrections: tuple[Correction, ...]) -> GroundedMotion:
    """Grounded motion with those ``corrections`` that are below the constraints; the same object if none is active."""
    below = tuple(each for each in corrections if not each.above)
    times = standing.motion.times
    acting = np.zeros(len(times), dtype=np.bool_)
    for each in below:
        acting |= each.fractions(times) > 0.0
    if not acting.any():
        return standing
    positions, rotations = standing.positions.copy(), standing.rotations.copy()
    channels = np.array(standing.motion.channels)
    footing = replace(
        standing.footing,
        ankles=standing.footing.ankles.copy(),
        feet=standing.footing.feet.copy(),
        toes=standing.footing.toes.copy(),
    )
    drops = np.zeros(len(times))
    for run in runs_of(acting):
        window = slice(*run)
        before = PosedFrames(standing.positions[window], standing.rotations[window])
        posed = _posed(standing, below, window, before)
        channels[window, LIMB_CHANNELS] = _limb_channels(standing, window, posed)
        _release_feet(standing, footing, window, before, posed)
        drops[window] = _lowering(standing, footing, window, before, posed)
        positions[window], rotations[window] = posed.positions, posed.rotations
    channels.setflags(write=False)
    motion = replace(standing.motion, channels=channels)
    drops = smooth_drops(drops, motion.frame_rate)
    for run in runs_of(acting | (drops > 0.0)):
        window = slice(*run)
        placed = PosedFrames(np.array(positions[window]), np.array(rotations[window]))
        rows = at_frames(standing.morphology.rows, window)
        place_frames(rows, drops[window], footing.legs(motion, window), *placed)
        positions[window], rotations[window] = placed.positions, placed.rotations
    return replace(standing, motion=motion, footing=footing, positions=positions, rotations=rotations)


def with_corrections_above(adapted: AdaptedMotion, standing: GroundedMotion, request: AdaptRequest) -> AdaptedMotion:
    """Solved motion with those corrections of ``request`` that are above the constraints; residuals are measured again.

    ``standing`` is the grounded motion that was solved.
    """
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    times = standing.motion.times[window]
    above = [each for each in request.corrections if each.above and each.fractions(times).any()]
    if not above:
        return adapted
    posed = _posed(standing, above, window, PosedFrames(adapted.positions[:], adapted.rotations[:]))
    moved = replace(adapted, positions=posed.positions, rotations=posed.rotations)
    if not request.constraints:
        return moved
    targets = targets_of(standing, request.constraints, window, request.tracks)
    measured = full_residuals(request.constraints, targets, moved)
    full = np.array([each.activation.at(times) >= LEAST_FULL_ACTIVATION for each in request.constraints])
    acting = np.any([each.fractions(times) > 0.0 for each in above], axis=0)
    measurable = full & acting & np.isfinite(adapted.residuals)
    return replace(moved, residuals=np.where(measurable, measured, adapted.residuals))


def segment_turns(layout: BodyLayout, turns: Mapping[BodyPart, FloatArray]) -> SegmentRotations:
    """Rotations (N, 3, 3) of segments from rotation vectors (N, 3) of body parts.

    The abdomen's rotation is divided evenly among the inner vertebrae.
    """
    found: dict[int, FloatArray] = {}
    for part, vectors in turns.items():
        inner = range(1, layout.spine_count - 1) if part is BodyPart.ABDOMEN else ()
        segments = inner or (layout.segment_of_part(part),)
        turn = to_matrix(from_rotation_vector(vectors / len(segments)))
        for segment in segments:
            found[segment] = found[segment] @ turn if segment in found else turn
    return found


def with_segments_turned(
    layout: BodyLayout, posed: PosedFrames, turns: SegmentRotations, shift: FloatArray | None = None
) -> PosedFrames:
    """Copy of frames with segments rotated in their own axes by ``turns``, and the root moved by ``shift`` (N, 3)
    metres.
    """
    positions, rotations, original = posed.positions.copy(), posed.rotations.copy(), posed.positions
    parents, proximal, distal = layout.parent_segments(), layout.proximal_points(), layout.distal_points()
    deltas: list[FloatArray | None] = []
    if shift is not None:
        positions[:, 0] += shift
    for segment, parent in enumerate(parents):
        carried = deltas[parent] if parent >= 0 else None
        own, first = rotations[:, segment], proximal[segment]
        if parent >= 0 and first != distal[parent]:  # collars and hips lie beside the far end of what carries them
            base = distal[parent] if parent else 0
            positions[:, first] = positions[:, base] + _carried(carried, original[:, first] - original[:, base])
        delta = carried
        if segment in turns:
            local = own @ turns[segment] @ own.transpose(0, 2, 1)
            delta = local if carried is None else carried @ local
        deltas.append(delta)
        last = distal[segment]
        positions[:, last] = positions[:, first] + _carried(delta, original[:, last] - original[:, first])
        if delta is not None:
            rotations[:, segment] = delta @ own
    return PosedFrames(positions, rotations)


def _carried(delta: FloatArray | None, vectors: FloatArray) -> FloatArray:
    """Vectors (N, 3) rotated by ``delta`` (N, 3, 3); unchanged without."""
    return vectors if delta is None else np.asarray((delta @ vectors[..., None])[..., 0])


def _posed(
    standing: GroundedMotion, corrections: Sequence[Correction], window: slice, posed: PosedFrames
) -> PosedFrames:
    """Poses of the frames of ``window`` with ``corrections`` applied to ``posed``, one after the other."""
    layout, times = standing.morphology.layout, standing.motion.times[window]
    heading = standing.motion.channels[window, channel.YAW]
    for each in corrections:
        posed = with_offsets(each, times, layout, standing.morphology.leg_length, heading, posed)
    return posed


def with_offsets(
    correction: Correction,
    times: FloatArray,
    layout: BodyLayout,
    leg_length: FloatArray | float,
    heading: FloatArray,
    posed: PosedFrames,
    sign: float = 1.0,
) -> PosedFrames:
    """Frames with the offsets of a correction at ``times`` (N,) seconds of the stage; with those removed if ``sign`` is
    -1. ``leg_length`` is in metres, ``heading`` (N,) in radians.
    """
    fractions = sign * correction.fractions(times)[:, None]
    vectors = {
        part: fractions * to_rotation_vector(from_matrix(correction.keys.turns_at(part, times)))
        for part in correction.keys.parts
    }
    shift = None
    if correction.keys.moves_hips:
        shift = leg_length * fractions * along_heading(correction.keys.hips_at(times), heading)
    return with_segments_turned(layout, posed, segment_turns(layout, vectors), shift)


def along_heading(vectors: FloatArray, heading: FloatArray) -> FloatArray:
    """Vectors (N, 3) in the motion's space from components in the axes of a heading (N,), radians."""
    x, y, z = vectors.T
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)


def _limb_channels(standing: GroundedMotion, window: slice, posed: PosedFrames) -> FloatArray:
    """Channels (N, n) of arms and legs of posed frames, those of ``LIMB_CHANNELS``."""
    body, rate = standing.morphology, standing.motion.frame_rate
    if not isinstance(body, AnimatedMorphology):
        return np.asarray(encode_motion(posed.positions, posed.rotations, body, rate).channels[:, LIMB_CHANNELS])
    frames = range(window.start, window.stop)
    rows = [
        encode_motion(posed.positions[row : row + 1], posed.rotations[row : row + 1], body.at(frame), rate).channels
        for row, frame in enumerate(frames)
    ]
    return np.concatenate(rows)[:, LIMB_CHANNELS]


def _release_feet(
    standing: GroundedMotion,
    footing: Footing,
    window: slice,
    before: PosedFrames,
    posed: PosedFrames,
) -> None:
    """Move targets of ankles, feet and toes with the corrected pose, as far as contacts release the feet, in place."""
    layout = standing.morphology.layout
    for side, foot in enumerate((BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT)):
        planted = standing.limb_freedoms[2 + side] == 0.0
        ankle, segment = layout.ankle_point(side), layout.segment_of_part(foot)
        moved_by = posed.positions[:, ankle] - before.positions[:, ankle]
        free = _foot_release(planted, window, moved_by, standing.motion.frame_rate)[:, None]
        footing.ankles[side, window, :3] += free * moved_by
        for targets, moved in ((footing.feet, segment), (footing.toes, segment + 1)):
            own = from_matrix(np.asarray(targets[side, window]))
            delta = multiply(inverse(from_matrix(before.rotations[:, moved])), from_matrix(posed.rotations[:, moved]))
            targets[side, window] = to_matrix(multiply(own, from_rotation_vector(free * to_rotation_vector(delta))))


def _foot_release(planted: NDArray[np.bool_], window: slice, moved_by: FloatArray, frame_rate: float) -> FloatArray:
    """Part (N,) by which contacts release a foot, ``planted`` in some frames (F,), in each frame of ``window`` for a
    displacement ``moved_by`` (N, 3) that it never follows faster than ``FREED_FOOT_SPEED``: in a short swing it goes
    only a part of the way.
    """
    free, distances = np.zeros(len(planted)), np.zeros(len(planted))
    distances[window] = np.linalg.norm(moved_by, axis=1)
    for first, end in runs_of(~planted):
        needed = QUINTIC_PEAK_SLOPE * float(distances[first:end].max()) / FREED_FOOT_SPEED
        is_swing = first > 0 and end < len(planted)
        seconds = max(RELEASE_SECONDS, min(needed, (end - first) / (2.0 * frame_rate) if is_swing else needed))
        weight = release_weight(planted, frame_rate, seconds)[first:end]
        free[first:end] = weight * min(seconds / needed, 1.0) if needed > 0.0 else weight
    return free[window]


def _lowering(
    standing: GroundedMotion,
    footing: Footing,
    window: slice,
    before: PosedFrames,
    posed: PosedFrames,
) -> FloatArray:
    """Additional root lowering (N,) in metres that keeps corrected planted legs in reach of their ankles."""
    rows = at_frames(standing.morphology.rows, window)
    states, thresholds = (
        np.ascontiguousarray(each[:, window]) for each in (standing.footing.states, footing.soft_thresholds)
    )
    needed = []
    for targets, (positions, rotations) in ((standing.footing, before), (footing, posed)):
        ankles = np.ascontiguousarray(targets.ankles[:, window, :3] - positions[:, 0])
        drops = np.empty(len(positions))
        channels = np.ascontiguousarray(standing.motion.channels[window])
        required_root_lowering(channels, rows, np.ascontiguousarray(rotations), ankles, thresholds, states, drops)
        needed.append(np.maximum(drops, 0.0))
    return np.asarray(np.maximum(needed[1] - needed[0], 0.0))
