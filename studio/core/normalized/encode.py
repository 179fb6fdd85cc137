"""Encoding of a posed body of known measures as channels, so that a solved pose can be moved to another body."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.body.encode_channels import ActorSizes, encode_frames, unwrap_channels
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import spine_fractions
from studio.core.rotations import frame_along, from_matrix, sign_continuous

FloatArray = NDArray[np.float64]
BODY_FORWARD = np.array([1.0, 0.0, 0.0])


def encode_motion(
    positions: FloatArray, rotations: FloatArray, body: Morphology, frame_rate: float, name: str = ""
) -> NormalizedMotion:
    """Motion whose ``realize_motion`` on ``body`` returns positions (F, K+23, 3) and rotations (F, K+18, 3, 3).

    It is exact if the bones have the body's lengths; other displacements (of the hips) are kept as those of the actor.
    """
    layout = body.layout
    actor = actor_sizes(body, np.concatenate([body.arm.sum(axis=1), body.leg.sum(axis=1)]))
    turns = sign_continuous(from_matrix(np.asarray(rotations[:, 0])))
    yaw = np.unwrap(2.0 * np.arctan2(turns[:, 2], turns[:, 3]))
    channels = np.zeros((len(positions), channel.SPINE + 4 * (layout.spine_count - 1)))
    encode_frames(np.array(positions), np.array(rotations), yaw, actor, channels)
    unwrap_channels(np.array([*channel.QUATERNION_COLUMNS, *range(channel.SPINE, channels.shape[1], 4)]), channels)
    return NormalizedMotion(name, frame_rate, channels, spine_fractions(body.spine))


def actor_sizes(body: Morphology, limbs: FloatArray) -> ActorSizes:
    """Sizes of a body that channels do not contain, for arms and legs with the lengths ``limbs`` (4,) in metres."""
    rests = np.array([frame_along(rest, BODY_FORWARD) for rest in (body.neck_rest, *body.clavicle_rest)])
    ankle_height, leg, neck = float(body.ankle_height.mean()), float(body.leg_length), float(body.neck)
    return ActorSizes(rests, body.hip_offset, limbs, ankle_height, leg, neck)
