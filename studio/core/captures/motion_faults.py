"""Faults of motion that was estimated from images or depth: spikes, swapped limbs, tremble and foot skate."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.body_sides import LIMB_PARTS
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.pose import PoseSequence
from studio.core.rotations import normalized, sign_continuous
from studio.core.runs import runs_of
from studio.core.windows import bell_average

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

SPIKE_ANGLE = np.radians(55.0)
"""Angle in radians by which a joint rotates within one frame into a spike, and out of it again: twice what kicks reach.
"""
LEAST_SPIKE_JUMP_METRES = 0.15
"""Distance in metres by which the root jumps within one frame into a spike, and out of it again."""
SPIKE_RETURN = 0.35
"""Greatest difference of the frames before and after a spike, as a fraction of its jumps."""
LONGEST_SPIKE_SECONDS = 0.5
"""Longest duration of a spike or a swap in seconds; a longer one is a real pose."""
SWAP_FLIP, SWAP_RETURN, SWAP_JUMP_RATIO = 0.3, 0.35, 2.5
"""Thresholds of exchanged limbs: metres by which the line between a left and a right joint turns over in one frame, the
fraction of that by which it then differs from its opposite, and the ratio of the jump to that in the frames before and
after.
"""
TREMBLE_ANGLE, TREMBLE_LENGTH = np.radians(1.2), 0.008
"""Standard deviations of tremble: of half the joints in radians, and of the root in metres."""
SMOOTHING_WINDOWS_SECONDS = 0.012 * 1.25 ** np.arange(12)
"""Standard deviations in seconds of the smoothing windows, of which the widest that fits is used."""
SKATE_SECONDS = 0.1
"""Time in seconds over which the travel of a standing foot is measured."""
_QUARTILE = np.sqrt(20.0) * 1.101
"""Lowest quartile of the lengths of third differences of noise with a standard deviation of 1 along three axes."""
_FEWEST_FRAMES, _SHOWN = 12, 4


@dataclass(frozen=True)
class MotionFaults:
    """Faults measured in a recorded motion; cleaning is offered if there are any."""

    spikes: int
    """Number of moments in which a joint or the root leaves its course and comes back."""
    swaps: tuple[tuple[str, int, int], ...]
    """Swaps of left and right as (``legs`` or ``arms``, first frame, last frame)."""
    tremble: float
    """Median over the joints of the standard deviation in radians of their rotation about each axis."""
    root_tremble: float
    """Standard deviation in metres of the root along each axis."""
    skate: float
    """Median distance in metres that the slower foot travels along the ground in ``SKATE_SECONDS``."""

    @property
    def trembles(self) -> bool:
        """True if joints or root tremble more than in recordings by suits and good cameras."""
        return self.tremble > TREMBLE_ANGLE or self.root_tremble > TREMBLE_LENGTH

    @property
    def any(self) -> bool:
        """True if there is anything to clean."""
        return bool(self.spikes or self.swaps or self.trembles)

    @property
    def words(self) -> str:
        """The faults as a clause: ``3 spikes; legs exchanged in frames 20 to 24; ...``."""
        parts = [f"{self.spikes} spike{'' if self.spikes == 1 else 's'}"] if self.spikes else []
        parts += [
            f"left and right {limb} exchanged in frames {first} to {last}" for limb, first, last in self.swaps[:_SHOWN]
        ]
        if len(self.swaps) > _SHOWN:
            parts.append(f"{len(self.swaps) - _SHOWN} more exchanges")
        if self.trembles:
            parts.append(
                f"joints tremble by {np.degrees(self.tremble):.1f}° and the hips by {1000 * self.root_tremble:.0f} mm"
            )
        parts.append(f"the slower foot moves by {1000 * self.skate:.0f} mm in {SKATE_SECONDS:g} s")
        return "; ".join(parts)


def clean_motion(
    poses: PoseSequence, positions: FloatArray, body_map: BodyMap, frame_rate: float
) -> tuple[PoseSequence, MotionFaults]:
    """Motion without spikes, swaps and tremble, and the faults that it had; ``positions`` (F, J, 3) are those of its
    joints.

    Frames of spikes and swaps are interpolated from the frames around them. Each joint is smoothed by the widest window
    that removes no more than its own noise, so that fast moves keep their amplitude. A motion without faults is
    returned unchanged.
    """
    pelvis, joints = body_map.spine[0], sorted({*body_map.parts.values(), *body_map.spine})
    skate = _skate(positions[:, [body_map[BodyPart.LEFT_FOOT], body_map[BodyPart.RIGHT_FOOT]]], frame_rate)
    if poses.frame_count < _FEWEST_FRAMES:
        return poses, MotionFaults(0, (), 0.0, 0.0, skate)
    longest = max(1, round(LONGEST_SPIKE_SECONDS * frame_rate))
    swaps, exchanged = _find_swaps(positions, body_map, longest)
    tracks, spikes = dict[int, FloatArray](), 0
    for joint in joints:
        track = _interpolated_rotations(poses.local_rotations[:, joint], exchanged.get(joint))
        tracks[joint], count = _without_spikes(track, _angle, SPIKE_ANGLE, longest)
        spikes += count
    root, count = _without_spikes(poses.local_translations[:, pelvis], _distance, LEAST_SPIKE_JUMP_METRES, longest)
    noises = [2.0 * _noise(track) for track in tracks.values()]
    faults = MotionFaults(spikes + count, swaps, float(np.median(noises)), _noise(root), skate)
    if not faults.any:
        return poses, faults
    if faults.trembles:
        for (joint, track), noise in zip(tracks.items(), noises, strict=True):
            tracks[joint] = normalized(_calmed(track, noise / 2.0, frame_rate))
        root = _calmed(root, faults.root_tremble, frame_rate)
    rotations, translations = poses.local_rotations.copy(), poses.local_translations.copy()
    for joint, track in tracks.items():
        rotations[:, joint] = track
    translations[:, pelvis] = root
    return replace(poses, local_rotations=rotations, local_translations=translations), faults


def _skate(feet: FloatArray, frame_rate: float) -> float:
    """Median distance in metres that the slower of ``feet`` (F, 2, 3) travels along the ground in ``SKATE_SECONDS``."""
    apart = max(1, round(SKATE_SECONDS * frame_rate))
    travel = np.linalg.norm((feet[apart:] - feet[:-apart])[..., :2], axis=-1)
    return float(np.median(travel.min(axis=1))) if len(travel) else 0.0


def _find_swaps(
    positions: FloatArray, body_map: BodyMap, longest: int
) -> tuple[tuple[tuple[str, int, int], ...], dict[int, BoolArray]]:
    """Swaps of limbs, each with its first and last frame, and for each joint the frames (F,) to interpolate.

    Only swaps of up to ``longest`` frames are found. If hips or shoulders are exchanged, the trunk is rotated with
    them.
    """
    spans: list[tuple[str, int, int]] = []
    joints: dict[int, BoolArray] = {}
    for limb, parts in LIMB_PARTS.items():
        sides = {part: [body_map.parts.get(BodyPart[f"{side}_{part}"]) for side in ("LEFT", "RIGHT")] for part in parts}
        pairs = {part: (left, right) for part, (left, right) in sides.items() if left is not None and right is not None}
        turned = {part: _turned_over(positions[:, left] - positions[:, right]) for part, (left, right) in pairs.items()}
        wrong = np.any(list(turned.values()), axis=0)
        short = np.zeros_like(wrong)
        for first, past in runs_of(wrong):
            spans.append((limb, first, past - 1))
            short[first:past] = past - first <= longest
        trunk = body_map.spine if turned["THIGH" if limb == "legs" else "UPPER_ARM"].any() else ()
        if short.any():
            touched = (*trunk, *(joint for pair in pairs.values() for joint in pair))
            joints |= {joint: short | joints.get(joint, short) for joint in touched}
    return tuple(spans), joints


def _turned_over(line: FloatArray) -> BoolArray:
    """Mask (F,) of frames in which ``line`` (F, 3), from a right to a left joint, is opposite to its direction in most
    frames.
    """
    flip = _distance(line[1:], line[:-1])
    around = np.minimum(np.append(flip[1:], 0.0), np.append(0.0, flip[:-1]))
    opposite = np.linalg.norm(line[1:] + line[:-1], axis=1) < SWAP_RETURN * flip
    turns = opposite & (flip > SWAP_FLIP) & (flip > SWAP_JUMP_RATIO * around)
    wrong = np.append(False, np.cumsum(turns) % 2 == 1)
    return ~wrong if wrong.mean() > 0.5 else wrong


def _angle(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles (F,) in radians between unit quaternions (F, 4), exact to 1e-7; ten times as fast as ``angle_between``."""
    return np.asarray(2.0 * np.arccos(np.minimum(np.abs(np.einsum("fi,fi->f", first, second)), 1.0)))


def _distance(first: FloatArray, second: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(first - second, axis=-1))


def _without_spikes(
    track: FloatArray, distance: Callable[[FloatArray, FloatArray], FloatArray], jump: float, longest: int
) -> tuple[FloatArray, int]:
    """``track`` (F, 3 or 4) interpolated through its spikes, and the number of spikes; shorter ones are removed first.

    A spike begins and ends with a ``jump`` of ``distance`` and lasts for up to ``longest`` frames.
    """
    count = 0
    for length in range(1, min(longest, len(track) - 2) + 1):
        steps = distance(track[1:], track[:-1])
        if steps.max() < jump:
            break
        least = np.minimum(steps[:-length], steps[length:])
        starts = np.flatnonzero(least > jump)
        back = distance(track[starts], track[starts + length + 1])
        spike = np.zeros(len(track), dtype=bool)
        for start in starts[back < SPIKE_RETURN * least[starts]]:
            spike[start + 1 : start + 1 + length] = True
        count += len(runs_of(spike))
        track = _interpolated_rotations(track, spike) if track.shape[1] == 4 else _interpolated(track, spike)
    return track, count


def _interpolated_rotations(track: FloatArray, bad: BoolArray | None) -> FloatArray:
    """Unit quaternions ``track`` (F, 4) with those of ``bad`` frames (F,) interpolated from the others."""
    if bad is None or not bad.any():
        return track
    signed = track.copy()
    signed[~bad] = sign_continuous(track[~bad])
    return normalized(_interpolated(signed, bad))


def _interpolated(track: FloatArray, bad: BoolArray) -> FloatArray:
    """The ``track`` (F, N) with ``bad`` frames (F,) interpolated linearly from the others."""
    if not bad.any():
        return track
    frames = np.arange(len(track))
    columns = [np.interp(frames, frames[~bad], column[~bad]) for column in track.T]
    return np.stack(columns, axis=1)


def _noise(track: FloatArray) -> float:
    """Standard deviation along an axis of the noise of a ``track`` (F, 3 or 4), by its smallest third differences."""
    thirds = np.linalg.norm(np.diff(track, 3, axis=0), axis=1)
    return float(np.quantile(thirds, 0.25) / _QUARTILE)


def _calmed(track: FloatArray, noise: float, frame_rate: float) -> FloatArray:
    """``track`` (F, N) smoothed by the widest window that removes no more than ``noise`` along three axes."""
    calm = track
    for seconds in SMOOTHING_WINDOWS_SECONDS:
        smooth = bell_average(track, seconds * frame_rate)
        if np.sqrt(np.mean(np.sum((track - smooth) ** 2, axis=1))) > np.sqrt(3.0) * noise:
            break
        calm = smooth
    return calm
