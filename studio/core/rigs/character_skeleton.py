"""Skeleton of a character for other programs: joints, bones and poses.

The zero pose is a T-pose (arms level, legs straight, soles flat, the axes of every joint those of the world), the names
are those of HumanIK and Mixamo, and bones have the character's own lengths, so that nothing is lost.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.rest_pose import REST_FORWARD
from studio.core.body.skeleton import Skeleton
from studio.core.body.standing import standing_points
from studio.core.rotations import frame_along, from_matrix
from studio.core.solver.request import AdaptedMotion
from studio.core.threads import do_over_frames

FloatArray = NDArray[np.float64]

_SIDES = ("Left", "Right")
_ARM = ("Shoulder", "Arm", "ForeArm", "Hand")
_LEG = ("UpLeg", "Leg", "Foot", "ToeBase")
_DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class _Joints:
    """Joints of a character, depth first: their canonical ``points``, and the ``segments`` they move (-1 for end
    sites).
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    points: tuple[int, ...]
    segments: tuple[int, ...]


def character_skeleton(morphology: Morphology) -> Skeleton:
    """Skeleton of a body; its zero pose is a T-pose that faces +X with the soles on z = 0."""
    joints = _joints(morphology.layout)
    places = standing_points(morphology, t_pose_rotations(morphology))[list(joints.points)]
    offsets = places - places[np.maximum(joints.parents, 0)]
    offsets[0] = places[0]
    return Skeleton(joints.names, np.array(joints.parents), offsets, np.array(joints.segments) < 0)


def character_body_map(layout: BodyLayout) -> BodyMap:
    """Body map of a skeleton from ``character_skeleton``: the joint of each body part."""
    moving = {segment: joint for joint, segment in enumerate(_joints(layout).segments) if segment >= 0}
    inner = (BodyPart.ABDOMEN, BodyPart.THORAX)
    parts = {part: moving[layout.segment_of_part(part)] for part in BodyPart if part not in inner}
    return BodyMap(parts, tuple(moving[segment] for segment in range(layout.spine_count)))


def character_poses(adapted: AdaptedMotion) -> PoseSequence:
    """Adapted motion as exact local rotations and translations of its body's ``character_skeleton``.

    The bones of a body whose measures change are animated by translations.
    """
    joints = _joints(adapted.morphology.layout)
    skeleton = character_skeleton(adapted.morphology)
    rest = t_pose_rotations(adapted.morphology)
    rotations = np.empty((adapted.frame_count, skeleton.joint_count, 4))
    translations = np.empty((adapted.frame_count, skeleton.joint_count, 3))
    translations[:] = skeleton.offsets

    def turn(run: slice) -> None:  # matrices of all frames of a long take would need much memory
        world = adapted.rotations[run] @ np.swapaxes(rest, 1, 2)
        local = np.empty((len(world), skeleton.joint_count, 3, 3))
        local[:] = np.eye(3)
        for joint, (segment, parent) in enumerate(zip(joints.segments, joints.parents, strict=True)):
            if parent < 0:
                local[:, joint] = world[:, segment]
            elif segment >= 0:
                local[:, joint] = np.swapaxes(world[:, joints.segments[parent]], 1, 2) @ world[:, segment]
        rotations[run] = from_matrix(local)
        if adapted.animated is not None:
            places = adapted.positions[run][:, list(joints.points)]
            carriers = [joints.segments[max(parent, 0)] for parent in joints.parents]
            bones = places - places[:, np.maximum(joints.parents, 0)]
            translations[run] = np.einsum("fjki,fjk->fji", world[:, carriers], bones)

    do_over_frames(turn, adapted.frame_count)
    translations[:, 0] = adapted.positions[:, 0]
    translations.setflags(write=False)
    return PoseSequence(rotations, translations, own=True)


def joint_points(layout: BodyLayout) -> tuple[int, ...]:
    """Canonical point of each joint of a skeleton from ``character_skeleton``."""
    return _joints(layout).points


def joint_segments(layout: BodyLayout) -> tuple[int, ...]:
    """Canonical segment that each joint of a skeleton from ``character_skeleton`` moves; -1 for the ends of bones."""
    return _joints(layout).segments


def t_pose_rotations(morphology: Morphology) -> FloatArray:
    """World rotations (S, 3, 3) of the canonical segments in the T-pose; neck and clavicles are as at ease."""
    layout = morphology.layout
    rotations = np.tile(np.eye(3), (layout.segment_count, 1, 1))
    rotations[layout.neck_base] = frame_along(morphology.neck_rest, REST_FORWARD)
    for side in range(2):
        bone = np.array([0.0, 1.0 - 2.0 * side, 0.0])
        arm, leg = layout.clavicle_segment(side), layout.thigh_segment(side)
        rotations[arm] = frame_along(morphology.clavicle_rest[side], REST_FORWARD)
        rotations[arm + 1 : arm + 4] = frame_along(bone, np.cross(bone, REST_FORWARD))
        rotations[leg : leg + 2] = frame_along(_DOWN, np.array([0.0, 1.0, 0.0]))
    return rotations


def _joints(layout: BodyLayout) -> _Joints:
    spine, thorax = layout.spine_count, layout.spine_count - 1
    names = ["Hips", "Spine", *(f"Spine{k}" for k in range(1, thorax)), "Neck", "Head", "HeadEnd"]
    parents = list(range(-1, spine + 2))
    points = list(range(spine + 3))
    segments = [*range(spine + 2), -1]
    for bones, end, carrier, points_from, segments_from in (
        (_ARM, "HandEnd", thorax, layout.collar_point, spine + 2),
        (_LEG, "ToeEnd", 0, layout.hip_point, spine + 10),
    ):
        for side, name in enumerate(_SIDES):
            first = len(names)
            names += [*(f"{name}{bone}" for bone in bones), f"{name}{end}"]
            parents += [carrier, *range(first, first + 4)]
            points += range(points_from(side), points_from(side) + 5)
            segments += [*range(segments_from + 4 * side, segments_from + 4 * side + 4), -1]
    return _Joints(tuple(names), tuple(parents), tuple(points), tuple(segments))
