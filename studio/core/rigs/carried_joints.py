"""Extra joints of a capture that belong to no body part (fingers, eyes, twist bones, props), transferred to a
character. A child of the capture's joint of a segment is given in that joint's axes R A^T, A its alignment. The
character's joint of the same segment has the axes R T^T, T its T-pose. With C = T A^T a captured rotation L thus
becomes C L C^T, the same rotation about the same line of the body, and a translation t becomes s C t, s the ratio of
lengths.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.realize import spine_fractions
from studio.core.rigs.character_skeleton import joint_segments, t_pose_rotations
from studio.core.rotations import from_matrix, inverse, multiply, to_matrix
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def carried_joints(skeleton: Skeleton, body: BodyMap) -> tuple[int, ...]:
    """Extra joints of a capture that are transferred to a character, parents first.

    They are all that belong to no body part, except the ancestors of the body and the ends of its own bones.
    """
    played = {*body.parts.values(), *body.spine, *skeleton.path(0, body.spine[0])}
    carried: list[int] = []
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if joint not in played and (not skeleton.end_sites[joint] or parent in carried):
            carried.append(joint)
    return tuple(carried)


def with_carried_joints(
    skeleton: Skeleton,
    poses: PoseSequence,
    adapted: AdaptedMotion,
    actor: SourceRig,
    carried: Sequence[int],
    captured: PoseSequence | None = None,
) -> tuple[Skeleton, PoseSequence]:
    """Skeleton and poses of the character of ``adapted``, with the ``carried`` joints of the capture appended.

    Each is a child of the joint of its segment, rotated as captured, and its offset is scaled with the segment. Joints
    outside the body stay where they were recorded. ``captured`` are the poses of the capture's joints in each frame of
    ``adapted``; by default those in the same frames of the capture.
    """
    source = actor.skeleton
    if captured is None:
        captured = actor.pass_through.frames(adapted.first_frame, adapted.first_frame + adapted.frame_count - 1)
    carriers, turns, scales = _carriers(adapted.morphology, actor)
    names, parents = list(skeleton.names), skeleton.parents.tolist()
    offsets, rotations, translations = [], [], []
    place: dict[int, int] = {}
    for joint in carried:
        parent = int(source.parents[joint])
        segment = _segment_above(actor, joint)
        place[joint] = len(names)
        names.append(_free(source.names[joint], names))
        parents.append(place.get(parent, carriers[segment] if segment >= 0 else 0))
        if segment < 0 and parent not in place:
            turned, moved = _as_seen_from_the_root(actor, captured, joint, poses)
            offsets.append(moved[0])
        else:
            turn, scale = (turns[segment], scales[segment]) if segment >= 0 else (np.eye(3), 1.0)
            turned = captured.local_rotations[:, joint].copy()
            turned[:, :3] = turned[:, :3] @ turn.T
            moved = scale * captured.local_translations[:, joint] @ turn.T
            offsets.append(scale * turn @ source.offsets[joint])
        rotations.append(turned)
        translations.append(moved)
    whole = Skeleton(
        tuple(names),
        np.array(parents),
        np.concatenate([skeleton.offsets, offsets]),
        np.concatenate([skeleton.end_sites, source.end_sites[list(carried)]]),
    )
    return whole, PoseSequence(
        np.concatenate([poses.local_rotations, np.stack(rotations, axis=1)], axis=1),
        np.concatenate([poses.local_translations, np.stack(translations, axis=1)], axis=1),
        own=True,
    )


def _carriers(body: Morphology, actor: SourceRig) -> tuple[list[int], FloatArray, FloatArray]:
    """For each segment of the actor: the corresponding joint of the character, C (S, 3, 3), and s (S,)."""
    theirs = body.layout
    away = np.abs(spine_fractions(actor.morphology.spine)[:, None] - spine_fractions(body.spine))
    after = range(theirs.spine_count, theirs.segment_count)
    segments = [*np.argmin(away, axis=1).tolist(), *after]
    joint_of = {segment: joint for joint, segment in enumerate(joint_segments(theirs)) if segment >= 0}
    turns = t_pose_rotations(body)[segments] @ np.swapaxes(actor.alignments, 1, 2)
    scales = _lengths(body)[segments] / _lengths(actor.morphology)
    return [joint_of[segment] for segment in segments], turns, scales


def _lengths(body: Morphology) -> FloatArray:
    """Lengths (S,) that scale the children of each segment.

    Hands, feet and heads of captures end at different points (the wrist, the knuckles, the finger tips), so the length
    of the limb or of the trunk is taken for them.
    """
    trunk = body.spine_length + body.neck
    arms = [[trunk, upper, lower, upper + lower] for upper, lower in body.arm.tolist()]
    legs = [[upper, lower, upper + lower, upper + lower] for upper, lower in body.leg.tolist()]
    return np.concatenate([np.full(body.layout.spine_count + 2, trunk), *arms, *legs])


def _segment_above(actor: SourceRig, joint: int) -> int:
    """Segment of the nearest ancestor joint that moves one; -1 if there is none."""
    segments = actor.segment_joints.tolist()
    while joint >= 0 and joint not in segments:
        joint = int(actor.skeleton.parents[joint])
    return segments.index(joint) if joint >= 0 else -1


def _as_seen_from_the_root(
    actor: SourceRig, captured: PoseSequence, joint: int, poses: PoseSequence
) -> tuple[FloatArray, FloatArray]:
    """Rotations (F, 4) and translations (F, 3) relative to the character's root that leave a joint where it was
    recorded.
    """
    positions, rotations = joint_world(actor.skeleton, captured)
    root = poses.local_rotations[:, 0]
    away = positions[:, joint] - actor.origin - poses.local_translations[:, 0]
    turned = multiply(inverse(root), from_matrix(rotations[:, joint]))
    return turned, np.einsum("fji,fj->fi", to_matrix(root), away)


def _free(name: str, taken: list[str]) -> str:
    while name in taken:
        name += "_"
    return name
