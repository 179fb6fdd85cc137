"""Guesses common to all capture readers about values that a file does not state: body, ground, reference pose."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.body_shape import has_human_limbs, moving_body_by_shape
from studio.core.body.body_sides import LIMB_PARTS, exchanged_limbs
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_positions
from studio.core.body.moving_offsets import with_rigid_bones
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.captures.motion_faults import clean_motion
from studio.core.captures.reference_pose import (
    ALL_FRAMES,
    ZERO_POSE,
    ReferencePose,
    find_reference_pose,
    upright_pose,
)
from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.core.rotations import IDENTITY_QUATERNION, normalized
from studio.io.figure.body_maps import FoundBody, named_sides, similar_joints
from studio.io.figure.kept_references import certainty, kept_reference, seconds_at_ease
from studio.io.guessing import guess_first_frame, guess_floor
from studio.io.importing import ImportOptions
from studio.io.up_axis import FILE_AXES, parse_axis, turn_to_world

FloatArray = NDArray[np.float64]


def loose_guesses(feet: Collection[int], hands: Collection[int], behind: float) -> list[Guess]:
    """Guesses about feet and hands that are not descendants of their limbs.

    ``behind`` is the distance of the body from its feet, in the unit of the poses.
    """
    guesses = []
    for ends, subject, limbs, bones in ((feet, "feet", "legs", "shanks"), (hands, "hands", "arms", "forearms")):
        if ends:
            reason = f"In the file they do not hang from the {limbs}, as rigs for inverse kinematics have it;"
            guesses.append(
                Guess(subject, f"hung from the {bones}", f"{reason} they follow the {bones}.", Confidence.SURE)
            )
    if behind:
        moved = "The body does not go with them there; it was put where the ends of its shanks meet them."
        guesses[0] = replace(guesses[0], reason=f"{guesses[0].reason} {moved}", confidence=Confidence.LIKELY)
    return guesses


def body_by_shape_in(skeleton: Skeleton, rest: FloatArray, points: FloatArray, up_axis: str | None) -> FoundBody | None:
    """Body found by the shape of the rest pose ``rest`` (J, 3), whatever the names of its joints; None if it is not
    human.

    ``points`` (F, J, 3), in the file's axes like ``rest``, show how the knees bend. All axes are tried as up axis
    unless the user has chosen one.
    """
    sides = named_sides(skeleton)
    for axis in (parse_axis(up_axis),) if up_axis else FILE_AXES:
        by_shape = moving_body_by_shape(skeleton, rest @ turn_to_world(axis).T, points, sides)
        if by_shape is not None:
            return FoundBody(by_shape, "", ())
    return None


def body_guesses(skeleton: Skeleton, found: FoundBody, options: ImportOptions) -> list[Guess]:
    """Guesses about the body: how it was found, or the missing limbs with similar names; empty if the user has chosen
    it.
    """
    if found.body_map is None:
        offers = {limb: similar_joints(skeleton, limb) for limb in found.missing}
        reason = "; ".join(f"no {limb} (candidates: {', '.join(names) or 'none'})" for limb, names in offers.items())
        return [Guess("body map", "none", f"This is not a complete human body: {reason}.", Confidence.DOUBTFUL)]
    if options.body_map:
        return []
    parts = len(found.body_map.parts)
    if found.family:
        reason = f"Names as in {found.family}; topology, constant bones and symmetry agree."
        confidence = Confidence.SURE
    else:
        reason = "The names of its joints are unknown; legs reach lowest, arms widest, the head highest."
        confidence = Confidence.LIKELY
        if not has_human_limbs(skeleton, found.body_map):
            reason += " Its limbs are not divided like a person's: look at its elbows, wrists, knees and ankles."
            confidence = Confidence.DOUBTFUL
    return [Guess("body map", f"{parts} parts, {len(found.body_map.spine)} spine joints", reason, confidence)]


def with_sides_right(found: FoundBody, points: FloatArray, guesses: list[Guess]) -> FoundBody:
    """Body with left and right according to ``points`` (F, J, 3), in any axes; a guess is added if names disagree."""
    exchanged = exchanged_limbs(found.body_map, points) if found.body_map is not None else ()
    if found.body_map is None or not exchanged:
        return found
    names = [name for limb in exchanged for name in LIMB_PARTS[limb]]
    shown = " and ".join(exchanged)
    reason = f"The names of its {shown} say the other side than their place on the body does; they were put right."
    guesses.append(Guess("sides", f"left and right of {shown} exchanged", reason, Confidence.LIKELY))
    return replace(found, body_map=found.body_map.with_sides_exchanged(names))


@dataclass(frozen=True, eq=False)
class ReadJoints:
    """Joints read from a file, in world axes and metres.

    ``positions`` (F, J, 3) are those of the poses; ``unit`` and ``up_axis`` are those of the file.
    """

    path: Path
    skeleton: Skeleton
    poses: PoseSequence
    positions: FloatArray
    frame_rate: float
    unit: str
    up_axis: str
    repairs: tuple[str, ...] = ()


def make_capture(read: ReadJoints, found: FoundBody, options: ImportOptions, guesses: list[Guess]) -> Capture:
    """Capture of the joints that were read; its first frame, ground and reference pose are found."""
    poses = read.poses
    if found.body_map is not None:
        poses, swing = with_rigid_bones(read.skeleton, poses, found.body_map)
        if swing:
            reason = (
                f"Joints move in their parents by up to {np.degrees(swing):.0f} degrees; bones point where they are."
            )
            guesses.append(Guess("moving offsets", "followed", reason, Confidence.SURE))
        read = cleaned_joints(replace(read, poses=poses), found.body_map, options, guesses)
        poses = read.poses
    first_frame, guess = guess_first_frame(read.positions, read.frame_rate)
    guesses += [guess] if guess else []
    floor = floor_of(read, first_frame, found.body_map, options, guesses)
    reference = reference_of(read, found.body_map, options, guesses)
    return Capture(
        name=readable_name(read.path.stem),
        source=read.path.name,
        skeleton=read.skeleton,
        poses=poses,
        frame_rate=read.frame_rate,
        body_map=found.body_map,
        reference_rotations=reference,
        floor=floor,
        unit=read.unit,
        up_axis=read.up_axis,
        first_frame=first_frame,
        guesses=tuple(guesses),
        repairs=read.repairs,
    )


def cleaned_joints(read: ReadJoints, body_map: BodyMap, options: ImportOptions, guesses: list[Guess]) -> ReadJoints:
    """Joints of the cleaned motion, with the cleaning among their repairs, if ``options.clean`` is True.

    Otherwise the joints are unchanged, and a guess that offers the cleaning is added to ``guesses``.
    """
    poses, faults = clean_motion(read.poses, read.positions, body_map, read.frame_rate)
    if not faults.any:
        return read
    if not options.clean:
        reason = f"It has {faults.words}. Clean up motion (--clean) takes that off, as from poses estimated in images."
        guesses.append(Guess("cleaning", "none", reason, Confidence.LIKELY))
        return read
    repair = f"{read.path.name} was cleaned. It had {faults.words}."
    return replace(read, poses=poses, positions=joint_positions(read.skeleton, poses), repairs=(*read.repairs, repair))


def floor_of(
    read: ReadJoints, first_frame: int, body_map: BodyMap | None, options: ImportOptions, guesses: list[Guess]
) -> float:
    """Height of the ground in metres, given by the user or found from the feet after ``first_frame``."""
    if options.floor is not None:
        return options.floor
    if body_map is None:
        guesses.append(Guess("floor", "0 m", "Without feet nothing tells where the ground is.", Confidence.DOUBTFUL))
        return 0.0
    guesses.append(guess_floor(read.skeleton, read.positions[first_frame:], body_map, read.frame_rate))
    return float(guesses[-1].value.split()[0])


def reference_of(
    read: ReadJoints, body_map: BodyMap | None, options: ImportOptions, guesses: list[Guess]
) -> FloatArray:
    """Local rotations (J, 4) of the reference pose, chosen by the user or found.

    Raises StudioError for an unknown choice.
    """
    if options.reference is not None:
        return reference_by_option(read.skeleton, read.poses, body_map, options.reference)
    if body_map is None:
        zero = np.tile(IDENTITY_QUATERNION, (read.skeleton.joint_count, 1))
        reason = "Without a human body no other pose is known to be upright."
        reference = ReferencePose(zero, ZERO_POSE, reason, Confidence.DOUBTFUL)
    else:
        reference = find_reference_pose(read.skeleton, read.poses, body_map)
        if reference.source == ALL_FRAMES:
            reference = _surest_reference(reference, read, body_map)
    guesses.append(Guess("reference pose", reference.source, reference.reason, reference.confidence))
    return reference.rotations


def _surest_reference(own: ReferencePose, read: ReadJoints, body_map: BodyMap) -> ReferencePose:
    """Reference pose kept for the skeleton if it is more certain than ``own``, else ``own``."""
    try:
        kept = kept_reference(read.skeleton, body_map)
    except StudioError as error:
        return replace(own, reason=f"{own.reason} {error}")
    seconds = seconds_at_ease(read.skeleton, read.poses, body_map, read.frame_rate)
    if kept is None or kept.certainty <= certainty(own.confidence, seconds):
        return own
    reason = f"{kept.pose.reason} It is kept from {kept.take}, which shows this skeleton at ease more surely."
    return replace(kept.pose, source=f"{ALL_FRAMES} of {kept.take}", reason=reason)


def reference_by_option(
    skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap | None, chosen: str | Mapping[str, Sequence[float]]
) -> FloatArray:
    """Local rotations (J, 4) of the pose that ``ImportOptions.reference`` names. Raises StudioError if
    there is none.
    """
    zero = np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    if not isinstance(chosen, str):
        return _pose_by_joint(skeleton, chosen, zero)
    if chosen == "zero":
        stood = upright_pose(skeleton, zero, body_map) if body_map else None
        return zero if stood is None else stood
    if not (chosen.isdecimal() and float(chosen) < poses.frame_count):
        raise StudioError(
            f"'{chosen[:40]}' is not a reference pose. Choose 'zero' or a frame from 0 to {poses.frame_count - 1}."
        )
    rotations: FloatArray = poses.local_rotations[int(chosen)]
    return rotations


def _pose_by_joint(skeleton: Skeleton, turns: Mapping[str, Sequence[float]], zero: FloatArray) -> FloatArray:
    pose = zero.copy()
    for name, turn in turns.items():
        if name not in skeleton.names:
            raise StudioError(f"The reference pose turns a joint '{name}' that the file does not have.")
        if len(turn) != 4 or not 0.5 < float(np.linalg.norm(turn)) < 2.0:
            raise StudioError(f"The reference pose turns '{name}' by something that is not a quaternion (x, y, z, w).")
        pose[skeleton.names.index(name)] = normalized(np.array(turn, dtype=np.float64))
    return pose
