"""Conversion of a morphology-independent motion to the poses of a body, and back to the capture it was taken from."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.body.pose import PoseSequence
from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.motion import Girdle, NormalizedMotion
from studio.core.rotations import from_matrix, to_matrix

FloatArray = NDArray[np.float64]


def realize_motion(
    motion: NormalizedMotion, morphology: AnyMorphology, *, play: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Positions (F, K + 23, 3) and rotations (F, K + 18, 3, 3) of ``motion`` on a body, in the motion's space.

    ``play`` keeps the actor's own displacements of hips and head (those of the capture's extra joints); a character
    with rigid bones drops them.
    """
    from studio.core.kernels.body import pose_from_channels as kernel  # late: it takes longer than a window

    layout = morphology.layout
    positions = np.empty((motion.frame_count, layout.point_count, 3))
    rotations = np.empty((motion.frame_count, layout.segment_count, 3, 3))
    girdle = motion.girdle or girdle_of(morphology.first_frame_body)
    lengths, hips = girdle.length / clavicle_proportions(morphology), girdle.hips / hip_breadths(morphology)
    actor = kernel.ActorProportions(
        np.minimum(lengths, 1.0), girdle.rest, np.minimum(hips, 1.0), motion.across, girdle.limbs
    )
    kernel.realize_frames(
        motion.channels, motion.spine_places, morphology.rows, actor, float(play), positions, rotations
    )
    if len(morphology.rows) > 1:
        positions[..., :2] -= _drift(motion.channels[:, channel.HIPS : channel.HIPS + 2], morphology)[:, None]
    return positions, rotations


def girdle_of(body: Morphology) -> Girdle:
    """Proportions of shoulders, hips and limbs of ``body``, which stands for the actor."""
    bones = np.concatenate([body.arm, body.leg])
    limbs = bones[:, 0] / bones.sum(axis=1)
    return Girdle(float(clavicle_proportions(body)[0]), body.clavicle_rest, float(hip_breadths(body)[0]), limbs)


def clavicle_proportions(body: AnyMorphology) -> FloatArray:
    """Lengths (F or 1,) of the clavicles relative to half the breadth of the shoulders, which scale their rotations."""
    rows = body.rows
    lengths = rows[:, measure.CLAVICLE : measure.CLAVICLE + 2]
    bases, rests = (np.abs(rows[:, [m + 1, m + 4]]) for m in (measure.COLLAR_BASE, measure.CLAVICLE_REST))
    return np.asarray(lengths.sum(axis=1) / np.maximum((bases + lengths * rests).sum(axis=1), 1e-9))


def hip_breadths(body: AnyMorphology) -> FloatArray:
    """Distances (F or 1,) between the hip joints in leg lengths."""
    rows = body.rows
    apart = np.abs(rows[:, measure.HIP_OFFSET + 1] - rows[:, measure.HIP_OFFSET + 4])
    return np.asarray(np.maximum(apart, 1e-9) / (rows[:, measure.LEG : measure.FOOT].sum(axis=1) / 2.0))


def _drift(hips: FloatArray, morphology: AnyMorphology) -> FloatArray:
    """Error (F, 2) in metres of the scaled position ``hips`` (F, 2), in leg lengths, caused by a changing leg length.

    A growing body moves by L dx and not d(L x), or its position would depend on its distance from the origin.
    """
    legs = morphology.rows[:, measure.LEG : measure.FOOT].sum(axis=1) / 2
    steps = (hips[1:] + hips[:-1]) / 2 * np.diff(legs)[:, None]
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


def spine_fractions(spine: FloatArray) -> FloatArray:
    """Begin (K,) of each spine segment of ``spine`` (K, 3) along the trunk: 0 for the pelvis, 1 for the thorax."""
    places = np.concatenate([[0.0], np.cumsum(np.linalg.norm(spine[:-1], axis=1))])
    return np.asarray(places / places[-1])


def restore_joint_poses(motion: NormalizedMotion, actor: SourceRig) -> PoseSequence:
    """Poses of the capture's own joints, restored from its normalised motion; exact within rounding."""
    return actor_joint_poses(actor, *realize_motion(motion, actor.morphology, play=True))


def actor_joint_poses(
    actor: SourceRig, positions: FloatArray, rotations: FloatArray, first_frame: int = 0
) -> PoseSequence:
    """Poses of the actor's own joints for segments at ``positions`` and ``rotations``, such as those of
    ``realize_motion``.

    They begin with ``first_frame`` of the capture; joints without a segment keep their captured poses.
    """
    skeleton, frames = actor.skeleton, slice(first_frame, first_frame + len(positions))
    local = to_matrix(actor.pass_through.local_rotations[frames])
    translations = np.array(actor.pass_through.local_translations[frames])
    world = np.empty_like(local)
    segment_of = {int(joint): segment for segment, joint in enumerate(actor.segment_joints) if joint >= 0}
    root = int(actor.segment_joints[0])
    places = np.empty(local.shape[:3])
    for joint, parent in enumerate(skeleton.parents.tolist()):
        carrier = world[:, parent] if parent >= 0 else np.broadcast_to(np.eye(3), local[:, joint].shape)
        from_origin = places[:, parent] if parent >= 0 else np.zeros((len(local), 3))
        if joint in segment_of:
            segment = segment_of[joint]
            world[:, joint] = rotations[:, segment] @ actor.alignments[segment].T
            local[:, joint] = np.swapaxes(carrier, 1, 2) @ world[:, joint]
        else:
            world[:, joint] = carrier @ local[:, joint]
        if joint == root:
            offset = positions[:, 0] + actor.origin - from_origin
            translations[:, joint] = np.einsum("fji,fj->fi", carrier, offset)
        places[:, joint] = from_origin + np.einsum("fij,fj->fi", carrier, translations[:, joint])
    turns = np.array(actor.pass_through.local_rotations[frames])
    mapped = sorted(segment_of)
    turns[:, mapped] = from_matrix(local[:, mapped])
    return PoseSequence(turns, translations, own=True)
