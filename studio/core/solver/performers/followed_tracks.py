"""Tracks of followed targets: position and rotation at every frame, in the space of the follower's motion."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import AnyMorphology, Morphology
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.own_place import OwnPlace
from studio.core.curves.keyed import Quaternion
from studio.core.normalized.compose import Composite
from studio.core.rotations import to_matrix
from studio.core.solver.performers.rows import clip_transform
from studio.core.solver.request import AdaptedMotion, UnconstrainedPoses
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.tracks import Track
from studio.core.stage.placement import Placement

FloatArray = NDArray[np.float64]

_UNTURNED = np.eye(3)[None]


def point_track(
    point: BodyPoint, turn: Quaternion, positions: FloatArray, rotations: FloatArray, body: Morphology
) -> Track:
    """Track of a point of a body in frames with ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3)."""
    origin, segment = point_indices(point, body.layout)
    axes = rotations[:, segment]
    return Track(positions[:, origin] + axes @ np.array(point.offset), axes @ to_matrix(np.array(turn)))


def own_track(place: OwnPlace, unasked: UnconstrainedPoses, body: AnyMorphology, frame_rate: float) -> Track:
    """Track, of one frame, of a point of the unconstrained motion at ``place.time``, moved by the offset in leg
    lengths.
    """
    row = min(max(round(place.time * frame_rate), 0), len(unasked.positions) - 1)
    origin, segment = point_indices(place.point, body.first_frame_body.layout)
    there = unasked.positions[row, origin] + unasked.rotations[row, segment] @ np.array(place.point.offset)
    return Track((there + body.leg_length * np.array(place.offset))[None], _UNTURNED)


def performer_track(
    point: BodyPoint,
    turn: Quaternion,
    adapted: AdaptedMotion,
    rows: ArrayLike,
    placement: Placement,
    own: Placement,
) -> Track:
    """Track of a point of another performer at ``placement``, in the space of a performer at ``own``.

    ``adapted`` is the other performer's whole motion, ``rows`` (F,) its fractional frame index for each frame of the
    result.
    """
    t = np.clip(np.asarray(rows, dtype=np.float64), 0.0, adapted.frame_count - 1.0)
    before = np.minimum(t.astype(np.int64), max(adapted.frame_count - 2, 0))
    after, fraction = np.minimum(before + 1, adapted.frame_count - 1), (t - before)[:, None]
    earlier, later = (
        point_track(point, turn, adapted.positions[each], adapted.rotations[each], adapted.morphology)
        for each in (before, after)
    )
    places = earlier.positions + fraction * (later.positions - earlier.positions)
    begin, end = Rotation.from_matrix(earlier.rotations), Rotation.from_matrix(later.rotations)
    axes = (begin * Rotation.from_rotvec(fraction * (begin.inv() * end).as_rotvec())).as_matrix()
    return Track(own.to_motion(placement.to_stage(places)), own.rotation.T @ placement.rotation @ axes)


def captured_joint_track(follow: FollowTracked, capture: Capture, frames: NDArray[np.int64] | None = None) -> Track:
    """Track of a captured joint in the space of the capture's motion, in some ``frames`` (N,) or in all.

    Raises StudioError if there is no such joint.
    """
    joint = capture.skeleton.index(follow.joint)
    frames = np.arange(capture.frame_count) if frames is None else frames
    rows = np.append(frames, capture.first_frame)
    poses = PoseSequence(capture.poses.local_rotations[rows], capture.poses.local_translations[rows])
    places, rotations = joint_world(capture.skeleton, poses)
    root = 0 if capture.body_map is None else capture.body_map.spine[0]
    origin = np.array([*places[-1, root, :2], capture.floor])
    places, axes = places[:-1], rotations[:-1, joint]
    return Track(places[:, joint] + axes @ np.array(follow.offset) - origin, axes @ to_matrix(np.array(follow.turn)))


def tracked_in_row(
    follow: FollowTracked, captures: Sequence[Capture], composite: Composite, leg_length: float
) -> Track:
    """Track of a captured joint in the space of a performer's motion, from the capture of the clip that plays at each
    frame.

    Where two clips are blended, the newer one counts. ``captures`` are those of the performer's clips.
    """
    count = composite.motion.frame_count
    places, axes = np.zeros((count, 3)), np.tile(np.eye(3), (count, 1, 1))
    for played in composite.played:
        capture = captures[played.piece.origin[0]]
        if composite.is_plain:
            return captured_joint_track(follow, capture)
        frames = np.arange(max(played.first, 0), count)
        rows = np.rint(played.motion_frames(frames, composite.timing)).astype(np.int64).clip(0, capture.frame_count - 1)
        own = captured_joint_track(follow, capture, rows)
        carry = clip_transform(played, composite.timing, leg_length)
        c, s = np.cos(carry.turn), np.sin(carry.turn)
        places[frames] = carry.positions(own.positions)
        axes[frames] = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ own.rotations
    return Track(places, axes)
