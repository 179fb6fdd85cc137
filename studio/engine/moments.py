"""A performer at a moment, and what its constraints ask of it then: where keyed and followed targets are."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import Support
from studio.core.constraints.base import Constraint, Vector
from studio.core.constraints.follow import Follow, FollowBody, FollowPerformer, FollowProp, FollowTracked
from studio.core.constraints.keyed import KeyedPlace, Quaternion
from studio.core.constraints.target import follows_of
from studio.core.project import Project
from studio.core.solver.tracks import Targets, Track, fixed_at, moved_target, turned_target
from studio.engine.performance import Posed

FloatArray = NDArray[np.float64]

HELD_BY = {"position": "target", "look_at": "target", "distance": "other", "area": "centre", "balance": "place"}
"""The value of a kind that is the place by which it is held; other kinds have none."""


@dataclass(frozen=True, eq=False)
class Moment:
    """``pose`` is one of ``posed``, all performers at the same moment of the stage."""

    project: Project
    posed: Mapping[str, Posed]
    pose: Posed

    def fixed(self, constraint: Constraint) -> Constraint | None:
        """The constraint with its targets where they are now; None while what it follows is not there."""
        follows = follows_of(constraint)
        tracks: dict[Follow | Support, Track]
        tracks = {follow: track for follow in follows if (track := self.track(follow)) is not None}
        if len(tracks) < len(set(follows)):
            return None
        return fixed_at(constraint, Targets(np.array([self.pose.seconds]), tracks, lambda: np.zeros((1, 3))))

    def moved(self, constraint: Constraint, place: Vector) -> Constraint:
        """The constraint held at ``place`` now, by a key or another offset; the same where it is held by no place."""
        name = HELD_BY.get(constraint.kind, "")
        target = getattr(constraint, name, None)
        if not isinstance(target, tuple | KeyedPlace | Follow):
            return constraint
        track = self.track(target) if isinstance(target, Follow) else None
        flat = isinstance(target, tuple) and len(target) == 2
        held: dict[str, Any] = {name: place[:2] if flat else moved_target(target, place, self.pose.seconds, track)}
        return replace(constraint, **held)

    def turned(self, constraint: Constraint, turn: Quaternion) -> Constraint:
        """An orientation with its target turned to ``turn`` now, as ``moved``."""
        target = getattr(constraint, "target")  # noqa: B009 - only an orientation comes here
        track = self.track(target) if isinstance(target, Follow) else None
        held: dict[str, Any] = {"target": turned_target(target, turn, self.pose.seconds, track)}
        return replace(constraint, **held)

    def track(self, follow: Follow) -> Track | None:
        """Where a followed thing is now, in the space of this performer's motion."""
        from studio.core.solver.following import performer_track, prop_track, tracked_track  # it loads kernels

        pose, own = self.pose, self.pose.placement
        match follow:
            case FollowBody():
                return performer_track(follow.point, follow.turn, pose.motion, [pose.row], own, own)
            case FollowPerformer():
                other = self.posed.get(follow.performer_id)
                if other is None:
                    return None
                return performer_track(follow.point, follow.turn, other.motion, [other.row], other.placement, own)
            case FollowProp():
                prop = self.project.props.get(follow.prop_id)
                return None if prop is None else prop_track(follow, prop, own)
            case FollowTracked():
                motion = self.project.motions.get(pose.motion_id or "")
                capture = self.project.captures.get(motion.capture_id) if motion else None
                if capture is None or follow.joint not in capture.skeleton.names:
                    return None
                frame = min(pose.row + pose.motion.first_frame, capture.frame_count - 1)
                return tracked_track(follow, capture, frame)
        return None

    def outline(self) -> FloatArray | None:
        """(N, 2) the outline of what stands now, in the motion's space; None where nothing does."""
        from studio.core.solver.support import corners, outlines, standing_points  # as above

        motion, row = self.pose.motion, slice(self.pose.row, self.pose.row + 1)
        contacts = tuple(self.project.contacts_of(self.pose.motion_id or "").values())
        frame = self.pose.row + motion.first_frame
        stands = standing_points(contacts, frame + 1)[:, frame:]
        area = corners(outlines(motion.positions[row], motion.rotations[row], stands, motion.morphology))[0]
        return None if np.isnan(area).any() else area
