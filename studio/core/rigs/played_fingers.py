"""Finger poses of both hands over time, from captures and from the grips of the clips of a row, for any skeleton."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_joints import Digit, FingerJoint, find_fingers
from studio.core.body.finger_poses import FingerPoses
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.pose_sampling import poses_at
from studio.core.captures.capture import Capture
from studio.core.normalized.compose import Composite
from studio.core.normalized.pieces import PlayedPiece
from studio.core.project_cache import project_cache
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.rigs.driven_fingers import FingerDrive, gripping_rotations
from studio.core.rigs.finger_rest import (
    FINGER_CELLS,
    HAND_PARTS,
    T_POSE_HANDS,
    FingerRest,
    bend,
    finger_rest,
    relative_rotations,
    rotations_in_hand,
)
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix, inverse, multiply, slerp
from studio.core.stage.clip import Clip
from studio.core.stage.holding import GRIP_CHANGE_SECONDS, grips_on_props
from studio.core.stage.project import Performer, Project

FloatArray = NDArray[np.float64]

_MIRRORED = np.array([-1.0, 1.0, -1.0, 1.0])
"""Signs of a quaternion's members in a mirror that reverses y."""


def fingers_of_capture(capture: Capture, first: int, count: int) -> FingerPoses:
    """Captured finger poses in ``count`` frames from ``first`` on."""
    frames, nothing = np.arange(first, first + count, dtype=np.float64), np.zeros(count)
    return FingerPoses(captured_rotations(capture, frames), nothing + has_fingers(capture), nothing, nothing)


def fingers_of_performer(
    project: Project, performer_id: str, composite: Composite, frames: NDArray[np.int64]
) -> FingerPoses | None:
    """Finger poses in ``frames`` (N,) of the row of a performer; None if one of its motions has been removed."""
    performer, timing = project.performers[performer_id], composite.timing
    if project.missing_references(performer):
        return None
    held = grips_on_props(project.props.values(), performer_id, timing.begin + frames / timing.frame_rate)
    return fingers_of_row(composite, performer.clips, captures_of_clips(project, performer), frames, held)


def captures_of_clips(project: Project, performer: Performer) -> tuple[Capture, ...]:
    """Captures of the clips of a performer, in the order of the clips."""
    return tuple(project.captures[project.motions[clip.motion_id].capture_id] for clip in performer.clips)


def fingers_of_row(
    composite: Composite,
    clips: Sequence[Clip],
    captures: Sequence[Capture],
    frames: NDArray[np.int64],
    held: tuple[FloatArray, FloatArray],
) -> FingerPoses:
    """Finger poses in ``frames`` (N,) of a row of ``clips`` of these ``captures``.

    The hands have the grip of the clip, else that of a held prop (its weights and grips (N,) are ``held``), else the
    fingers of the clip's capture. From one clip to the next they change within ``GRIP_CHANGE_SECONDS``.
    """
    rotations = np.tile(IDENTITY_QUATERNION, (len(frames), *FINGER_CELLS, 1))
    captured, own, asked, grips = (np.zeros(len(frames)) for _ in range(4))
    before = composite.fingers_before
    for piece, weight in weighted_pieces(composite, frames):
        place = min(piece.piece.origin[0], len(clips) - 1)
        if place < 0:
            if before is not None:
                rotations = np.where(weight[:, None, None, None, None] > 0.0, before.rotations, rotations)
                captured = captured + weight * before.captured * (1.0 - before.asked)
                asked, grips = asked + weight * before.asked, grips + weight * before.asked * before.grips
                own = own + weight * (1.0 - before.captured) * (1.0 - before.asked)
            continue
        clip, capture, plays = clips[place], captures[place], np.flatnonzero(weight > 0.0)
        if clip.grip is not None:
            asked, grips = asked + weight, grips + weight * clip.grip
        elif has_fingers(capture) and len(plays):
            captured = captured + weight
            seen = captured_rotations(
                capture, piece.motion_frames(frames[plays], composite.timing), mirrored=clip.mirrored
            )
            part = (weight[plays] / captured[plays])[:, None, None, None]
            rotations[plays] = slerp(rotations[plays], seen, part)
        else:
            own = own + weight
    free = captured + own
    asked, grips = asked + free * held[0], grips + free * held[0] * held[1]
    return FingerPoses(rotations, _ratio(captured, free), _ratio(grips, asked), asked)


def weighted_pieces(composite: Composite, frames: NDArray[np.int64]) -> Iterator[tuple[PlayedPiece, FloatArray]]:
    """Pieces that shape the hands, each with its weights (N,) in ``frames`` (N,) of the row; the weights sum to 1."""
    closing = GRIP_CHANGE_SECONDS * composite.timing.frame_rate
    begins = np.array([each.first for each in composite.played], dtype=np.float64)
    if composite.played[0].piece.origin[0] < 0:  # a clip that takes over without warning was not seen coming
        begins[1] += closing / 2.0
    begun = np.clip((frames - begins[:, None]) / closing + 0.5, 0.0, 1.0)
    begun[0] = 1.0
    weights = begun - np.concatenate([begun[1:], np.zeros((1, len(frames)))])
    for piece, weight in zip(composite.played, np.maximum(weights, 0.0), strict=True):
        if weight.any():
            yield piece, weight


def _ratio(part: FloatArray, whole: FloatArray) -> FloatArray:
    return np.divide(part, whole, out=np.zeros(len(part)), where=whole > 0.0)


def has_fingers(capture: Capture) -> bool:
    """True if the capture has finger joints."""
    return _captured(_Recorded(capture)) is not None


def captured_rotations(capture: Capture, frames: FloatArray, *, mirrored: bool = False) -> FloatArray:
    """Rotations (N, 2, 5, 3, 4), as in ``FingerPoses.rotations``, at ``frames`` (N,) of a capture, clamped at its ends.

    A missing joint rotates with the previous joint, a missing finger with its neighbour.
    """
    source = _captured(_Recorded(capture))
    if source is None:
        return np.broadcast_to(IDENTITY_QUATERNION, (len(frames), *FINGER_CELLS, 4))
    within = np.clip(frames, 0.0, capture.frame_count - 1.0)
    first, last = int(within.min()), int(np.ceil(within.max()))
    local = capture.poses.local_rotations[first : last + 1, source.joints]
    still = np.zeros((len(local), len(source.joints), 3))
    sampled = poses_at(PoseSequence(local, still), within - first).local_rotations
    in_hand = multiply(multiply(source.before, _along_chains(sampled, source.chains)), source.after)
    rotations = relative_rotations(in_hand)
    return rotations[:, ::-1] * _MIRRORED if mirrored else rotations


def on_captured_joints(capture: Capture, poses: FingerPoses, others: PoseSequence | None = None) -> PoseSequence:
    """Poses of the skeleton of a capture with these fingers; the other joints are as in ``others``, or in the reference
    pose.
    """
    source, skeleton = _captured(_Recorded(capture)), capture.skeleton
    if source is None:
        raise ValueError("The capture has no fingers.")
    rest, frames = source.rest, len(poses.captured)
    in_hand = rotations_in_hand(FingerDrive(rest, gripping_rotations(rest.directions)).relative(poses))
    from_hand = multiply(multiply(inverse(source.before), in_hand), inverse(source.after))
    if others is None:
        resting = np.tile(capture.reference_rotations, (frames, 1, 1))
        others = PoseSequence(resting, np.tile(skeleton.offsets, (frames, 1, 1)))
    local = np.array(others.local_rotations)
    for finger, joint in rest.joints.items():
        above = np.tile(IDENTITY_QUATERNION, (frames, 1))
        for each in skeleton.path(rest.hands[finger.side], joint)[1:-1]:
            above = multiply(above, local[:, each])
        local[:, joint] = multiply(inverse(above), from_hand[(slice(None), *finger.cell)])
    return replace(others, local_rotations=local)


@dataclass(frozen=True, eq=False)
class _CapturedFingers:
    """Finger joints of a capture, and constant rotations from its joint axes to the axes of the hand.

    With L the rotation of a finger joint relative to the joint of the hand, ``before`` L ``after`` is that in the axes
    of the hand, from a straight finger.
    """

    joints: NDArray[np.int64]
    """Joints (K,) from the hands to the last finger joints."""
    chains: NDArray[np.int64]
    """Indices (D, 2, 5, 3) in ``joints`` from the palm to each finger joint; K after the last one."""
    before: FloatArray
    """(2, 1, 1, 4)"""
    after: FloatArray
    """(2, 5, 3, 4)"""
    rest: FingerRest


@dataclass(frozen=True, eq=False)
class _Recorded:
    """Cache key of a capture, equal only to that of the same object."""

    capture: Capture

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Recorded) and other.capture is self.capture

    def __hash__(self) -> int:
        return id(self.capture)


@project_cache(maxsize=64)
def _captured(recorded: _Recorded) -> _CapturedFingers | None:
    capture, body, reference = recorded.capture, recorded.capture.body_map, recorded.capture.reference_rotations
    if body is None or not find_fingers(capture.skeleton, body):
        return None
    from studio.core.normalized.normalize import normalize_capture  # late: what computes is loaded after the window

    actor = normalize_capture(capture)[1]
    segments = [actor.morphology.layout.hand_segment(side) for side in range(len(HAND_PARTS))]
    hands = joint_world(capture.skeleton, rest_poses(capture.skeleton, reference))[1][
        0, [body[part] for part in HAND_PARTS]
    ]
    in_t_pose = np.swapaxes(t_pose_rotations(actor.morphology)[segments], 1, 2) @ T_POSE_HANDS
    rest = finger_rest(capture.skeleton, body, reference, hands @ actor.alignments[segments] @ in_t_pose)
    like = {finger: nearest for finger in np.ndindex(FINGER_CELLS) if (nearest := _nearest(finger, rest.joints))}
    chains = {
        finger: capture.skeleton.path(rest.hands[nearest.side], rest.joints[nearest])[1:]
        for finger, nearest in like.items()
    }
    joints = sorted({joint for chain in chains.values() for joint in chain})
    table, flexions = np.full((max(map(len, chains.values())), *FINGER_CELLS), len(joints)), np.zeros(FINGER_CELLS)
    for finger, chain in chains.items():
        table[(slice(len(chain)), *finger)] = [joints.index(joint) for joint in chain]
        flexions[finger] = rest.flexions[like[finger].cell]
    at_rest = _along_chains(reference[None, joints], table)[0]
    to_joints = from_matrix(np.swapaxes(hands, 1, 2) @ rest.axes)[:, None, None]
    after = multiply(multiply(inverse(at_rest), to_joints), bend(flexions))
    return _CapturedFingers(np.array(joints), table, inverse(to_joints), after, rest)


def _nearest(finger: tuple[int, ...], known: Collection[FingerJoint]) -> FingerJoint | None:
    """Finger joint whose chain contains the index ``finger``, (side, digit, joint), else one of the neighbouring
    finger.
    """
    side, digit, place = finger
    is_thumb = digit == 0
    like = [each for each in known if each.side == side and (each.digit is Digit.THUMB) == is_thumb]
    like = [each for each in like if each.place <= place]
    return min(like, key=lambda each: (abs(each.cell[1] - digit), place - each.place), default=None)


def _along_chains(local: FloatArray, chains: NDArray[np.int64]) -> FloatArray:
    """Products (N, 2, 5, 3, 4) of the rotations ``local`` (N, K, 4) along ``chains`` (D, 2, 5, 3)."""
    padded = np.concatenate([local, np.tile(IDENTITY_QUATERNION, (len(local), 1, 1))], axis=1)
    product = padded[:, chains[0]]
    for joints in chains[1:]:
        product = multiply(product, padded[:, joints])
    return product
