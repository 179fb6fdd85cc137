"""Positions of the canonical points on a capture's own skeleton, in its reference pose and in every frame."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.hand_end import USUAL_HAND_FRACTION, hand_reach, has_hand_length
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world, joint_world_in, rest_poses
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.threads import do_over_frames

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SIDES = ("left", "right")
_ENOUGH = 4096
_NECK = 0.15
"""The neck of a body without a head, in parts of its trunk."""


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Canonical points of one capture, and the joints that move its segments.

    ``points`` (F, P, 3) are in metres in capture space, ``reference`` (P, 3) the same points in the reference pose.
    ``segment_joints`` (S,) are as in ``SourceRig``. ``rotations`` (F, S, 3, 3) are world rotations of the joint that
    moves each segment, its own or its parent's, and ``reference_rotations`` (S, 3, 3) those in the reference pose.
    ``reference_is_rest`` is True if the reference pose is the skeleton's own zero pose, not a frame of its motion.
    """

    layout: BodyLayout
    segment_joints: IntArray
    points: FloatArray
    reference: FloatArray
    rotations: FloatArray
    reference_rotations: FloatArray
    reference_is_rest: bool

    def align_rotations(self, alignments: FloatArray) -> FloatArray:
        """Convert ``rotations`` in place to canonical ones R_joint A, and return them; A is from ``find_alignments``.

        The conversion is in place because the rotations of a long capture need much memory, and nothing uses those of
        the joints afterwards.
        """
        from studio.core.kernels.body.encode_channels import align_segments  # late: it loads numba

        segments = np.arange(self.layout.segment_count)

        def align(run: slice) -> None:
            align_segments(self.rotations[run].copy(), segments, alignments, self.rotations[run])

        do_over_frames(align, len(self.rotations))
        return self.rotations


def measured_frames(frame_count: int, first: int = 0) -> slice:
    """Frames from ``first`` on in which bones are measured: evenly spread, and at most a fixed number in a long
    capture.
    """
    return slice(first, None, max(1, (frame_count - first) // _ENOUGH))


def find_landmarks(capture: Capture, body_map: BodyMap) -> Landmarks:
    """Landmarks of a mapped capture; points that a skeleton lacks are derived from neighbouring ones."""
    layout = BodyLayout(len(body_map.spine))
    joints = _segment_joints(layout, body_map)
    moving, skeleton = _carried(layout, joints), capture.skeleton
    points = np.empty((capture.frame_count, layout.point_count, 3))
    rotations = np.empty((capture.frame_count, layout.segment_count, 3, 3))

    def read(run: slice) -> None:
        positions, turned = joint_world_in(skeleton, capture.poses, run)
        points[run] = _points(layout, skeleton, body_map, joints, positions)
        rotations[run] = turned[:, moving]

    do_over_frames(read, capture.frame_count)
    ref_positions, ref_rotations = joint_world(skeleton, rest_poses(skeleton, capture.reference_rotations))
    return Landmarks(
        layout,
        joints,
        points,
        _points(layout, skeleton, body_map, joints, ref_positions)[0],
        rotations,
        ref_rotations[0, moving],
        bool((np.abs(capture.reference_rotations[1:, 3]) > 1.0 - 1e-9).all()),
    )


def _segment_joints(layout: BodyLayout, body_map: BodyMap) -> IntArray:
    joints = np.full(layout.segment_count, -1, dtype=np.int64)
    joints[: layout.spine_count] = body_map.spine
    for segment in range(layout.spine_count, layout.segment_count):
        joints[segment] = body_map.parts.get(layout.part_of_segment(segment), -1)
    return joints


def _carried(layout: BodyLayout, joints: IntArray) -> IntArray:
    """Index (S,) of the joint that moves each segment, its own or its parent's."""
    moving = joints.copy()
    for segment, parent in enumerate(layout.parent_segments()):
        if moving[segment] < 0:
            moving[segment] = moving[parent]
    return moving


def _points(
    layout: BodyLayout,
    skeleton: Skeleton,
    body_map: BodyMap,
    joints: IntArray,
    positions: FloatArray,
) -> FloatArray:
    points = np.empty((len(positions), layout.point_count, 3))
    for segment, point in enumerate(layout.proximal_points()):
        if joints[segment] >= 0:
            points[:, point] = positions[:, joints[segment]]
    _place_neck(layout, skeleton, body_map, positions, points)
    for side, name in enumerate(_SIDES):
        _place_arm_ends(layout, skeleton, body_map, side, name, positions, points)
        _place_foot_end(layout, skeleton, body_map, side, name, positions, points)
    return points


def _place_neck(
    layout: BodyLayout, skeleton: Skeleton, body_map: BodyMap, positions: FloatArray, points: FloatArray
) -> None:
    head = body_map.parts.get(BodyPart.HEAD)
    neck = body_map.parts.get(BodyPart.NECK)
    if neck is None:
        shoulders = [positions[:, body_map.parts[BodyPart(f"{side}_upper_arm")]] for side in _SIDES]
        points[:, layout.neck_base] = 0.5 * (shoulders[0] + shoulders[1])
    if head is None:
        carrier = neck if neck is not None else body_map.spine[-1]
        arms = {body_map.parts[BodyPart(f"{side}_upper_arm")] for side in _SIDES}
        end = _far_child(skeleton, carrier, carries_none_of=arms)
        base = points[:, layout.neck_base]
        points[:, layout.head_joint] = base + _NECK * (base - points[:, 0]) if end is None else positions[:, end]
        points[:, layout.head_end] = points[:, layout.head_joint]
    else:
        end = _far_child(skeleton, head)
        points[:, layout.head_end] = positions[:, head if end is None else end]


def _place_arm_ends(
    layout: BodyLayout,
    skeleton: Skeleton,
    body_map: BodyMap,
    side: int,
    name: str,
    positions: FloatArray,
    points: FloatArray,
) -> None:
    if BodyPart(f"{name}_clavicle") not in body_map.parts:
        shoulder = points[:, layout.collar_point(side) + 1]
        points[:, layout.collar_point(side)] = points[:, layout.neck_base] + 0.2 * (
            shoulder - points[:, layout.neck_base]
        )
    wrist, forearm = body_map.parts.get(BodyPart(f"{name}_hand")), body_map.parts[BodyPart(f"{name}_forearm")]
    if wrist is None:
        end = _far_child(skeleton, forearm)
        points[:, layout.wrist_point(side)] = positions[:, forearm if end is None else end]
    along = points[:, layout.wrist_point(side)] - positions[:, forearm]
    reach = np.zeros_like(along) if wrist is None else hand_reach(skeleton, wrist, positions)
    odd = ~has_hand_length(reach, along)
    reach[odd] = USUAL_HAND_FRACTION * along[odd]
    points[:, layout.wrist_point(side) + 1] = points[:, layout.wrist_point(side)] + reach


def _place_foot_end(
    layout: BodyLayout,
    skeleton: Skeleton,
    body_map: BodyMap,
    side: int,
    name: str,
    positions: FloatArray,
    points: FloatArray,
) -> None:
    foot, toe = body_map.parts[BodyPart(f"{name}_foot")], body_map.parts.get(BodyPart(f"{name}_toe"))
    if toe is None:
        end = _far_child(skeleton, foot)
        points[:, layout.toe_point(side)] = positions[:, foot if end is None else end]
    end = None if toe is None else _far_child(skeleton, toe)
    tip = points[:, layout.toe_point(side)] if end is None else positions[:, end]
    along = points[:, layout.toe_point(side)] - positions[:, foot]
    short = np.linalg.norm(tip - points[:, layout.toe_point(side)], axis=1) < 0.01
    points[:, layout.toe_point(side) + 1] = np.where(
        short[:, None], points[:, layout.toe_point(side)] + 0.35 * along, tip
    )


def _far_child(skeleton: Skeleton, joint: int, carries_none_of: Collection[int] = ()) -> int | None:
    """Child joint that is farthest from ``joint``, as the end of its bone; None without any."""
    children = [
        child for child in skeleton.children[joint] if not {child, *skeleton.descendants(child)} & set(carries_none_of)
    ]
    if not children:
        return None
    lengths = np.linalg.norm(skeleton.offsets[children], axis=1)
    return children[int(np.argmax(lengths))] if lengths.max() > 1e-6 else None
