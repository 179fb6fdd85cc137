"""Interpretation of recordings of joints, such as a BVH file, as captures."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_positions
from studio.core.body.moving_offsets import with_measured_offsets
from studio.core.body.pose import PoseSequence
from studio.core.body.rehanging import reparented_motion, reparented_order, with_body_over_feet
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.kernels.body.file_channels import change_axes
from studio.core.rotations import IDENTITY_QUATERNION, normalized
from studio.core.threads import over_frames
from studio.io.bvh.reader import read_bvh
from studio.io.capture_guesses import (
    ReadJoints,
    body_by_shape_in,
    body_guesses,
    loose_guesses,
    make_capture,
    with_sides_right,
)
from studio.io.figure.body_maps import find_body, loose_feet, loose_hands
from studio.io.guessing import Scale, choose_unit, guess_frame_rate, leg_and_trunk
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture
from studio.io.up_axis import BVH_UP_PRIOR, BodyPoints, guess_up_axis, parse_axis, stated_axis_prior, turn_to_world

FloatArray = NDArray[np.float64]

_TURNING = "Turning it to world axes"
_LOOKED_AT = 128
"""Frames, spread over the clip, that decide about the body and the up axis."""


class JointRecording(Protocol):
    """Moving joints of a file, in its own units and axes."""

    @property
    def skeleton(self) -> Skeleton: ...
    @property
    def frame_count(self) -> int: ...
    @property
    def frame_time(self) -> float | None: ...
    @property
    def frame_time_digit(self) -> float: ...
    @property
    def repairs(self) -> tuple[str, ...]: ...
    @property
    def stated_unit(self) -> Scale | None:
        """Unit that the file states; None if it states none."""

    @property
    def stated_up_axis(self) -> str | None:
        """Up axis that the file states; None if it states none."""

    def transforms(self, frames: NDArray[np.int64] | slice) -> tuple[FloatArray, FloatArray]:
        """Local rotations (N, J, 4) and translations (N, J, 3) of ``frames`` (N,)."""


def load_bvh(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture of the BVH file at ``path``."""
    return read_capture_of(read_bvh(path, lambda share, text: progress(0.6 * share, text)), path, options, progress)


def read_capture_of(file: JointRecording, path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture of a recording, and a function that interprets the same recording with other options."""

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        return capture_of(file, path, options, progress)

    return ReadCapture(interpret(options, progress), interpret=interpret)


def capture_of(file: JointRecording, path: Path, options: ImportOptions, progress: Progress) -> Capture:
    """Capture of a recording in world axes and metres, with guesses for everything that ``options`` leave open.

    ``progress`` continues from the fraction 0.6.
    """
    progress(0.6, f"Finding the body in {path.name}")
    looked_at = np.unique(np.linspace(0, file.frame_count - 1, _LOOKED_AT).astype(int))
    sample = PoseSequence(*file.transforms(looked_at))
    after = PoseSequence(*file.transforms(np.minimum(looked_at + 1, file.frame_count - 1)))
    skeleton = with_measured_offsets(file.skeleton, sample)
    feet, hands = loose_feet(skeleton), loose_hands(skeleton)
    loose = feet | hands
    if feet:
        sample, after = (with_body_over_feet(skeleton, poses, feet)[0] for poses in (sample, after))
    both = np.stack([joint_positions(skeleton, poses) for poses in (sample, after)])
    if loose:
        hanging = reparented_order(skeleton.parents, loose)
        skeleton, _ = reparented_motion(skeleton, sample, hanging)
        both = both[:, :, hanging.order]
    found = find_body(skeleton, both[0], options.body_map)
    if found.body_map is None:
        found = body_by_shape_in(skeleton, _zero_pose(skeleton), both[0], options.up_axis) or found
    guesses: list[Guess] = body_guesses(skeleton, found, options)
    if not options.body_map:
        found = with_sides_right(found, both[0], guesses)
    leg, trunk = leg_and_trunk(both[0], found.body_map)
    scale, unit_guess = choose_unit(leg, file.stated_unit, options.unit, trunk)
    guesses += [unit_guess] if unit_guess else []
    up_axis = _up_axis(file.stated_up_axis, skeleton, both, found.body_map, options, guesses)
    skeleton, poses = to_world(
        file, turn_to_world(up_axis), scale.metres, lambda share: progress(0.6 + 0.2 * share, _TURNING)
    )
    skeleton = with_measured_offsets(skeleton, poses)
    if loose:
        poses, behind = with_body_over_feet(skeleton, poses, feet) if feet else (poses, 0.0)
        skeleton, poses = reparented_motion(skeleton, poses, hanging)
        guesses += loose_guesses(feet, hands, behind)
    frame_rate = _frame_rate(file.frame_time, file.frame_time_digit, options, guesses)
    progress(0.8, f"Finding floor and reference pose of {path.name}")
    positions = joint_positions(skeleton, poses)
    read = ReadJoints(path, skeleton, poses, positions, frame_rate, scale.unit, up_axis, file.repairs)
    capture = make_capture(read, found, options, guesses)
    progress(1.0, f"Loaded {path.name}")
    return capture


def to_world(
    file: JointRecording, file_to_world: FloatArray, metres: float, progress: Callable[[float], object]
) -> tuple[Skeleton, PoseSequence]:
    """Skeleton and poses in world axes and metres: offsets C o, translations C t, rotations C R C^T.

    A long file is converted in pieces by two threads, with progress, so that the window stays responsive.
    """
    skeleton, frame_count = file.skeleton, file.frame_count
    offsets = metres * (skeleton.offsets @ file_to_world.T)
    turned = Skeleton(skeleton.names, skeleton.parents, offsets, skeleton.end_sites)
    rotations = np.empty((frame_count, skeleton.joint_count, 4))
    translations = np.empty((frame_count, skeleton.joint_count, 3))

    def turn(run: slice) -> None:
        change_axes(*file.transforms(run), file_to_world, metres, rotations[run], translations[run])

    for done in over_frames(turn, frame_count):
        progress(done)
    translations.setflags(write=False)
    return turned, PoseSequence(rotations, translations, own=True)


def _up_axis(
    said: str | None,
    skeleton: Skeleton,
    points: FloatArray,
    body_map: BodyMap | None,
    options: ImportOptions,
    guesses: list[Guess],
) -> str:
    """Up axis chosen by the user or stated by the file (``said``), unless the body stands along another one.

    ``points`` (2, F, J, 3) are positions of the joints. A guess is added to ``guesses``.
    """
    if options.up_axis is not None:
        return parse_axis(options.up_axis)
    if body_map is None:
        if said is None:
            words = "Without a human body nothing tells what is up; most files have Y up."
            guesses.append(Guess("up axis", "Y", words, Confidence.DOUBTFUL))
        return said or "Y"
    standing = BodyPoints.of_joints(_zero_pose(skeleton)[None, None], body_map)
    rest = normalized(standing.shoulders.mean(axis=2) - standing.ankles.mean(axis=2))[0, 0]
    body = BodyPoints.of_joints(points, body_map)
    guess = guess_up_axis(body, BVH_UP_PRIOR, rest) if said is None else guess_up_axis(body, stated_axis_prior(said))
    guesses += [guess] if guess.value != said else []
    return guess.value


def _zero_pose(skeleton: Skeleton) -> FloatArray:
    """Positions (J, 3) of the joints with all rotations zero, in the file's axes."""
    still = PoseSequence(np.tile(IDENTITY_QUATERNION, (1, skeleton.joint_count, 1)), skeleton.offsets[None])
    positions: FloatArray = joint_positions(skeleton, still)[0]
    return positions


def _frame_rate(frame_time: float | None, digit: float, options: ImportOptions, guesses: list[Guess]) -> float:
    if options.frame_rate is not None:
        return options.frame_rate
    rate, guess = guess_frame_rate(frame_time, digit)
    guesses += [guess] if guess else []
    return rate
