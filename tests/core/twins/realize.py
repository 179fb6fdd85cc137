"""Channels put on a body by walking from segment to segment with named measures."""

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import frame_along
from tests.core.twins.limb import place_limb
from tests.core.twins.rotation import about_z, from_quaternion


def realize(motion: NormalizedMotion, body: Morphology, play: bool) -> tuple[np.ndarray, np.ndarray]:
    frames = [realize_frame(row, motion.spine_places, body, play) for row in motion.channels]
    return np.array([positions for positions, _ in frames]), np.array([rotations for _, rotations in frames])


def realize_frame(row: np.ndarray, places: np.ndarray, body: Morphology, play: bool) -> tuple[np.ndarray, np.ndarray]:
    layout = body.layout
    positions, rotations = np.empty((layout.point_count, 3)), np.empty((layout.segment_count, 3, 3))

    def quaternion(column: int) -> np.ndarray:
        return from_quaternion(row[column : column + 4])

    pelvis = about_z(row[channel.YAW]) @ quaternion(channel.PELVIS)
    hips = body.leg_length * row[channel.HIPS : channel.HIPS + 3] + [0.0, 0.0, body.ankle_height.mean()]
    positions[0] = hips - pelvis @ body.hip_offset.mean(axis=0)
    for k, relative in enumerate(spine_rotations(row, places, body.spine)):
        rotations[k] = pelvis @ relative
        positions[k + 1] = positions[k] + rotations[k] @ body.spine[k]
    thorax, neck, head = layout.spine_count - 1, layout.neck_base, layout.head_joint
    carried = rotations[thorax] @ quaternion(channel.NECK)
    rotations[neck] = carried @ frame_along(body.neck_rest, np.array([1.0, 0.0, 0.0]))
    stray = play * row[channel.HEAD_SHIFT : channel.HEAD_SHIFT + 3]
    positions[head] = positions[neck] + body.neck * rotations[neck] @ (np.array([0.0, 0.0, 1.0]) + stray)
    rotations[head] = carried @ quaternion(channel.HEAD)
    positions[head + 1] = positions[head] + rotations[head] @ [0.0, 0.0, body.head]
    for side in range(2):
        arm, collar = layout.spine_count + 2 + 4 * side, layout.collar_point(side)
        positions[collar] = positions[neck] + rotations[thorax] @ body.collar_base[side]
        carried = rotations[thorax] @ quaternion(channel.CLAVICLE + 4 * side)
        rotations[arm] = carried @ frame_along(body.clavicle_rest[side], np.array([1.0, 0.0, 0.0]))
        positions[collar + 1] = positions[collar] + rotations[arm] @ [0.0, 0.0, body.clavicle[side]]
        _limb(row, side, carried, body.arm[side], collar + 1, arm + 1, positions, rotations)
        rotations[arm + 3] = rotations[arm + 2] @ quaternion(channel.HAND + 4 * side)
        positions[collar + 4] = positions[collar + 3] + rotations[arm + 3] @ body.hand[side]
        leg, hip = layout.spine_count + 10 + 4 * side, layout.hip_point(side)
        stray = play * body.leg_length * row[channel.HIP_SHIFT + 3 * side : channel.HIP_SHIFT + 3 * side + 3]
        positions[hip] = positions[0] + pelvis @ (body.hip_offset[side] + stray)
        _limb(row, 2 + side, pelvis, body.leg[side], hip, leg, positions, rotations)
        rotations[leg + 2] = pelvis @ quaternion(channel.FOOT + 4 * side)
        rotations[leg + 3] = rotations[leg + 2] @ quaternion(channel.TOE + 4 * side)
        positions[hip + 3] = positions[hip + 2] + rotations[leg + 2] @ body.foot[side]
        positions[hip + 4] = positions[hip + 3] + rotations[leg + 3] @ body.toe[side]
    return positions, rotations


def spine_rotations(row: np.ndarray, places: np.ndarray, spine: np.ndarray) -> list[np.ndarray]:
    """Relative to the pelvis: quaternions mixed in line with where each vertebra begins along the trunk."""
    own = np.concatenate([[0.0], np.cumsum(np.linalg.norm(spine[:-1], axis=1))])
    quaternions = np.array([[0.0, 0.0, 0.0, 1.0], *row[channel.SPINE :].reshape(-1, 4)])
    for k in range(1, len(quaternions)):
        quaternions[k] *= 1.0 if quaternions[k] @ quaternions[k - 1] >= 0.0 else -1.0
    mixed = [[np.interp(place, places, quaternions[:, axis]) for axis in range(4)] for place in own / own[-1]]
    return [from_quaternion(np.array(each)) for each in mixed]


def _limb(
    row: np.ndarray,
    limb: int,
    carrier: np.ndarray,
    bones: np.ndarray,
    root: int,
    upper: int,
    positions: np.ndarray,
    rotations: np.ndarray,
) -> None:
    frame = carrier @ from_quaternion(row[channel.LIMB_FRAME + 4 * limb : channel.LIMB_FRAME + 4 * limb + 4])
    reach, apart = (1.0 - row[channel.LIMB_SLACK + limb]) * bones.sum(), abs(bones[0] - bones[1])
    if reach < 2.0 * apart:
        reach = apart * (1.0 + np.exp(reach / apart - 2.0))
    positions[root + 1], positions[root + 2], rotations[upper], rotations[upper + 1] = place_limb(
        positions[root],
        frame,
        reach,
        (bones[0], bones[1]),
        row[channel.LIMB_OFF_PLANE + limb] * bones.sum(),
        row[channel.LIMB_BEND + limb],
        row[channel.LIMB_TWIST + 2 * limb : channel.LIMB_TWIST + 2 * limb + 2],
    )
