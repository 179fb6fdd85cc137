"""Poses of performers at one moment, with reading and moving of the targets of their constraints."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.changed_records import with_fields
from studio.core.constraints.balance import Support
from studio.core.constraints.base import BodyPoint, Constraint, Vector
from studio.core.constraints.follow import Follow, FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.constraints.target import Place, follows_of, own_place_of, own_places_of, with_own_place
from studio.core.curves.keyed import KeyedPlace, Quaternion
from studio.core.solver.performers.rows import clip_transform
from studio.core.solver.request import UnconstrainedPoses
from studio.core.solver.task_assembly.tracks import (
    Targets,
    Track,
    fixed_at,
    moved_target,
    raised_along_arms,
    turned_target,
)
from studio.core.stage.mirrored_props import constraint_as_played
from studio.core.stage.project import Project
from studio.engine.posed_performer import PosedPerformer
from studio.engine.prop_places import prop_at

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TargetContext:
    """Reader and editor of constraint targets at one moment: of the performer ``pose``, among all performers ``posed``
    at that stage time.
    """

    project: Project
    posed: Mapping[str, PosedPerformer]
    pose: PosedPerformer

    def with_targets_fixed(self, constraint: Constraint) -> Constraint | None:
        """Constraint with its targets replaced by their current positions; None while a followed target is missing."""
        moving = {*follows_of(constraint), *own_places_of(constraint)}
        tracks: dict[Follow | OwnPlace | Support, Track]
        tracks = {each: track for each in moving if (track := self.track(each)) is not None}
        if len(tracks) < len(moving):
            return None
        now, leg_length = np.array([self.pose.seconds]), self.pose.motion.body.leg_length
        return fixed_at(constraint, Targets(now, tracks, lambda: np.zeros((1, 3)), leg_length))

    def as_played(self, constraint: Constraint) -> Constraint:
        """Constraint mirrored if the playing clip is; applied twice, it returns the original."""
        clip = self.pose.clip
        return constraint if clip is None else constraint_as_played(self.project, self.performer_id, clip, constraint)

    def with_target_moved(self, constraint: Constraint, position: Vector) -> Constraint:
        """Constraint with its target moved to ``position`` at this moment, by a key, centre or offset; unchanged if it
        has no target.
        """
        name = constraint.shown.held_by
        target: Place | None = getattr(constraint, name, None)
        held: dict[str, object]
        if target is not None and (own := own_place_of(target)) is not None:
            now = self.with_targets_fixed(constraint)
            held = {} if now is None else {name: self._moved_own(target, own, getattr(now, name), position)}
            return with_fields(constraint, **held)
        if not isinstance(target, tuple | KeyedPlace | ProceduralPlace | Follow):
            return constraint
        track = self.track(target) if isinstance(target, Follow) else None
        flat = isinstance(target, tuple) and len(target) == 2
        held = {name: position[:2] if flat else moved_target(target, position, self.pose.seconds, track)}
        return with_fields(constraint, **held)

    def with_target_rotation(self, constraint: Constraint, turn: Quaternion) -> Constraint:
        """Orientation constraint with its target rotated to ``turn`` (x, y, z, w) at this moment, by a key or an
        offset.
        """
        target = getattr(constraint, "target")  # noqa: B009 - only an orientation comes here
        track = self.track(target) if isinstance(target, Follow) else None
        return with_fields(constraint, target=turned_target(target, turn, self.pose.seconds, track))

    def own_place(self, point: BodyPoint, position: Vector, seconds: float) -> OwnPlace | None:
        """``position`` expressed relative to each performer's own ``point`` at ``seconds`` of the motion; None if the
        motion is not grounded yet.
        """
        own = OwnPlace(point, seconds)
        track = self.track(own)
        return None if track is None else own.moved(self.performer_id, self._in_legs(track.positions[0], position))

    def _moved_own(self, target: Place, own: OwnPlace, begin: Vector, position: Vector) -> Place:
        """Per-character target moved from its current position ``begin`` to ``position``."""
        further = self._in_legs(begin, position)
        if isinstance(target, KeyedOwnPlace):
            return target.moved_at(self.pose.seconds, self.performer_id, further)
        return with_own_place(target, own.moved(self.performer_id, further))

    def _in_legs(self, begin: ArrayLike, end: ArrayLike) -> Vector:
        x, y, z = ((np.array(end) - begin) / self.pose.motion.body.leg_length).tolist()
        return x, y, z

    @cached_property
    def time(self) -> float:
        """Stage time in seconds."""
        composite, frame = self.pose.motion.composite, self.pose.row + self.pose.motion.first_frame
        if composite is None:
            return frame / self.pose.motion.frame_rate
        return composite.timing.begin + frame / composite.timing.frame_rate

    @cached_property
    def performer_id(self) -> str:
        """Id of the performer."""
        return next(key for key, pose in self.posed.items() if pose is self.pose)

    def track(self, follow: Follow | OwnPlace) -> Track | None:
        """Current position and rotation of a followed target, in the space of the performer's motion; None if it is
        missing.
        """
        from studio.core.solver.performers.followed_tracks import captured_joint_track, performer_track  # loads kernels
        from studio.core.solver.performers.prop_tracks import track_in_motion_space

        pose, own = self.pose, self.pose.clip_placement
        match follow:
            case OwnPlace():
                adapted, mine = pose.motion, follow.of(self.performer_id)
                if adapted.unconstrained is None:
                    return None
                return self._own_track(mine, adapted.unconstrained)
            case FollowBody():
                return performer_track(follow.point, follow.turn, pose.motion, [pose.row], pose.placement, own)
            case FollowPerformer():
                other = self.posed.get(follow.performer_id)
                if other is None:
                    return None
                return performer_track(follow.point, follow.turn, other.motion, [other.row], other.placement, own)
            case FollowProp():
                if follow.prop_id not in self.project.props:
                    return None
                placed = prop_at(self.project, self.posed, follow.prop_id, self.time)
                track = track_in_motion_space(follow, placed.prop, Track(placed.place[None], placed.axes[None]), own)
                points = own.to_motion(pose.points)[None]
                return raised_along_arms(follow, track, points, pose.motion.morphology.layout)
            case FollowTracked():
                motion = self.project.motions.get(pose.motion_id or "")
                capture = self.project.captures.get(motion.capture_id) if motion else None
                if capture is None or follow.joint not in capture.skeleton.names:
                    return None
                frame = min(round(pose.seconds * capture.frame_rate), capture.frame_count - 1)
                track = captured_joint_track(follow, capture, np.array([max(frame, 0)]))
                return Track(track.positions * [1.0, -1.0 if pose.mirrored else 1.0, 1.0], track.rotations)
        return None

    def _own_track(self, place: OwnPlace, unasked: UnconstrainedPoses) -> Track:
        """Current per-character position, in the space of the playing motion."""
        from studio.core.solver.performers.followed_tracks import own_track  # as above

        pose, body = self.pose, self.pose.motion.body
        composite, played = pose.motion.composite, pose.played
        if composite is None or played is None or composite.is_plain:
            return own_track(place, unasked, body, pose.motion.frame_rate)
        carry = clip_transform(played, composite.timing, body.leg_length)
        there = replace(place, time=float(carry.stage_times(place.time)), offset=(0.0, 0.0, 0.0))
        track = own_track(there, unasked, body, pose.motion.frame_rate)
        places = pose.clip_placement.to_motion(pose.placement.to_stage(track.positions))
        return Track(places + body.leg_length * np.array(place.offset), track.rotations)

    def support_outline(self) -> FloatArray | None:
        """(N, 2) outline of the support polygon, motion space; None without contacts."""
        from studio.core.solver.grounding.support_polygon import corners, standing_mask, support_polygons  # as above

        motion, row = self.pose.motion, slice(self.pose.row, self.pose.row + 1)
        contacts = self.pose.contacts_in(self.project)
        frame = self.pose.row + motion.first_frame
        stands = standing_mask(contacts, frame + 1)[:, frame:]
        area: FloatArray = corners(
            support_polygons(motion.positions[row], motion.rotations[row], stands, motion.morphology)
        )[0]
        if np.isnan(area).any():
            return None
        return self.pose.points_in_clip(np.column_stack([area, np.zeros(len(area))]))[:, :2]
