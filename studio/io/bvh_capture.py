"""A BVH file as a capture."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.capture import Capture, Guess
from studio.core.errors import StudioError
from studio.core.humanoid import BodyMap
from studio.core.kinematics import joint_world
from studio.core.pose import PoseSequence
from studio.core.reference_pose import ReferencePose, find_reference_pose, stand_up
from studio.core.rotations import IDENTITY
from studio.core.skeleton import Skeleton
from studio.io.body_maps import FoundBody, find_body, similar_joints
from studio.io.bvh import BvhFile, read_bvh
from studio.io.guessing import (
    AXES,
    Scale,
    guess_first_frame,
    guess_floor,
    guess_frame_rate,
    guess_unit,
    guess_up_axis,
    leg_length,
    unit_called,
)
from studio.io.importing import ImportOptions
from studio.io.registry import Progress

FloatArray = NDArray[np.float64]

_TURNING = "Turning it to world axes"
_PIECE = 2048
"""Frames turned at a time."""
_LOOKED_AT = 128
"""Frames, spread over the clip, that decide about the body and the up axis."""


def load_bvh(path: Path, options: ImportOptions, progress: Progress) -> Capture:
    """The capture in the BVH file at ``path``."""
    file = read_bvh(path, lambda share, text: progress(0.6 * share, text))
    progress(0.6, f"Finding the body in {path.name}")
    looked_at = np.unique(np.linspace(0, len(file.frames) - 1, _LOOKED_AT).astype(int))
    sample = PoseSequence(*file.transforms(looked_at))
    points = joint_world(file.skeleton, sample)[0]
    found = find_body(file.skeleton, points, options.body_map)
    guesses: list[Guess] = _body_guesses(file.skeleton, found, options)
    scale = _unit(points, found.body_map, options, guesses)
    up_axis = _up_axis(file.skeleton, points, found.body_map, options, guesses)
    skeleton, poses = to_world(file, AXES[up_axis], scale.metres, lambda share: progress(0.6 + 0.2 * share, _TURNING))
    frame_rate = _frame_rate(file.frame_time, file.frame_time_digit, options, guesses)
    progress(0.8, f"Finding floor and reference pose of {path.name}")
    positions = joint_world(skeleton, poses)[0]
    first_frame, guess = guess_first_frame(positions, frame_rate)
    guesses += [guess] if guess else []
    floor = _floor(skeleton, positions[first_frame:], found.body_map, options, guesses)
    reference = _reference(skeleton, poses, found.body_map, options, guesses)
    progress(1.0, f"Loaded {path.name}")
    return Capture(
        name=path.stem,
        source=path.name,
        skeleton=skeleton,
        poses=poses,
        frame_rate=frame_rate,
        body_map=found.body_map,
        reference_rotations=reference,
        floor=floor,
        unit=scale.unit,
        up_axis=up_axis,
        first_frame=first_frame,
        guesses=tuple(guesses),
        repairs=file.repairs,
    )


def to_world(
    file: BvhFile, file_to_world: FloatArray, metres: float, progress: Callable[[float], object]
) -> tuple[Skeleton, PoseSequence]:
    """The body in world axes and metres: offsets C o, translations C t, rotations C R C^T.

    Turned like that, a quaternion has its axis turned. A long file is taken in pieces, which tells how far it is and
    never keeps the window waiting.
    """
    skeleton, frames = file.skeleton, np.arange(len(file.frames))
    scaled = metres * file_to_world.T
    turned = Skeleton(skeleton.names, skeleton.parents, skeleton.offsets @ scaled, skeleton.end_sites)
    rotations = np.empty((len(frames), skeleton.joint_count, 4))
    translations = np.empty((len(frames), skeleton.joint_count, 3))
    for first in range(0, len(frames), _PIECE):
        piece = slice(first, first + _PIECE)
        local, translations[piece] = file.transforms(frames[piece])
        rotations[piece, :, :3], rotations[piece, :, 3] = local[..., :3] @ file_to_world.T, local[..., 3]
        translations[piece] = translations[piece] @ scaled
        progress(first / len(frames))
    return turned, PoseSequence(rotations, translations)


def _body_guesses(skeleton: Skeleton, found: FoundBody, options: ImportOptions) -> list[Guess]:
    if found.body_map is None:
        offers = {limb: similar_joints(skeleton, limb) for limb in found.missing}
        reason = "; ".join(f"no {limb} (candidates: {', '.join(names) or 'none'})" for limb, names in offers.items())
        return [Guess("body map", "none", f"This is no complete human body: {reason}.")]
    if options.body_map:
        return []
    parts = len(found.body_map.parts)
    reason = f"Names as in {found.family}; topology, constant bones and symmetry agree."
    return [Guess("body map", f"{parts} parts, {len(found.body_map.spine)} spine joints", reason)]


def _unit(points: FloatArray, body_map: BodyMap | None, options: ImportOptions, guesses: list[Guess]) -> Scale:
    leg = leg_length(points, body_map) if body_map else None
    if options.unit is not None:
        return unit_called(options.unit, leg)
    if leg is None:
        guesses.append(Guess("unit", "cm", "Without a human body nothing tells the unit; most files are in cm."))
        return Scale("cm", 0.01)
    scale, guess = guess_unit(leg)
    guesses.append(guess)
    return scale


def _up_axis(
    skeleton: Skeleton,
    points: FloatArray,
    body_map: BodyMap | None,
    options: ImportOptions,
    guesses: list[Guess],
) -> str:
    if options.up_axis is not None:
        axis = options.up_axis.upper()
        if axis not in AXES:
            raise StudioError(f"'{options.up_axis}' is no up axis. Choose {', '.join(AXES)}.")
        return axis
    if body_map is None:
        guesses.append(Guess("up axis", "Y", "Without a human body nothing tells what is up; most files have Y up."))
        return "Y"
    still = PoseSequence(np.tile(IDENTITY, (1, skeleton.joint_count, 1)), skeleton.offsets[None])
    guesses.append(guess_up_axis(joint_world(skeleton, still)[0][0], points, body_map))
    return guesses[-1].value


def _frame_rate(frame_time: float | None, digit: float, options: ImportOptions, guesses: list[Guess]) -> float:
    if options.frame_rate is not None:
        return options.frame_rate
    rate, guess = guess_frame_rate(frame_time, digit)
    guesses += [guess] if guess else []
    return rate


def _floor(
    skeleton: Skeleton,
    positions: FloatArray,
    body_map: BodyMap | None,
    options: ImportOptions,
    guesses: list[Guess],
) -> float:
    if options.floor is not None:
        return options.floor
    if body_map is None:
        guesses.append(Guess("floor", "0 m", "Without feet nothing tells where the ground is."))
        return 0.0
    guesses.append(guess_floor(skeleton, positions, body_map))
    return float(guesses[-1].value.split()[0])


def _reference(
    skeleton: Skeleton,
    poses: PoseSequence,
    body_map: BodyMap | None,
    options: ImportOptions,
    guesses: list[Guess],
) -> FloatArray:
    zero = np.tile(IDENTITY, (skeleton.joint_count, 1))
    if options.reference is not None:
        return _chosen_reference(skeleton, poses, body_map, options.reference, zero)
    if body_map is None:
        reference = ReferencePose(zero, "zero pose", "Without a human body no other pose is known to be upright.")
    else:
        reference = find_reference_pose(skeleton, poses, body_map)
    guesses.append(Guess("reference pose", reference.source, reference.reason))
    return reference.rotations


def _chosen_reference(
    skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap | None, chosen: str, zero: FloatArray
) -> FloatArray:
    if chosen == "zero":
        stood = stand_up(skeleton, zero, body_map) if body_map else None
        return zero if stood is None else stood
    if not (chosen.isdecimal() and int(chosen) < poses.frame_count):
        raise StudioError(
            f"'{chosen}' is no reference pose. Choose 'zero' or a frame from 0 to {poses.frame_count - 1}."
        )
    rotations: FloatArray = poses.local_rotations[int(chosen)]
    return rotations
