"""Tracks of props on the stage: fixed, keyed, procedural, or held by a performer."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowProp
from studio.core.curves.activation import QUINTIC_PEAK_SLOPE, EaseShape, ease
from studio.core.curves.keyed import KeyedNumber, KeyedTurn
from studio.core.rotations import rotations_about_z, to_matrix
from studio.core.solver.performers.followed_tracks import performer_track, point_track
from studio.core.solver.request import AdaptedMotion, UnconstrainedPoses
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.tracks import Track
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Carried, InHand, Prop
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]

CARRYING_HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)
"""Parts that carry a prop."""
LEAST_HAND_OVER_SECONDS, MAX_HAND_OVER_SPEED = 0.3, 1.2
"""Least seconds in which a prop moves into a hand, or to where it is put down, and its greatest speed meanwhile,
m/s.
"""


class Hands(Protocol):
    """Hands of a performer that may hold a prop, at given times."""

    def track(self, hold: InHand | Carried) -> Track:
        """Track on the stage of a prop held by these hands, one frame for each time."""

    def pose_at(self, time: float) -> "Hands":
        """The same hands at one ``time`` of the stage, seconds."""


@dataclass(frozen=True, eq=False)
class Holder:
    """Hands of a performer with an adapted motion."""

    motion: AdaptedMotion
    rows: ArrayLike
    """(F,) fractional frame indices of ``motion``."""
    placement: Placement
    whole: AdaptedMotion | None = None
    """All frames of the performer's motion, for a prop that is picked up or put down."""
    timing: Timing | None = None
    """Times of all frames, for a prop that is picked up or put down."""

    def pose_at(self, time: float) -> "Holder":
        """The same hands at one ``time`` of the stage, seconds."""
        passed = self.motion.passed_constraints.get(time)
        whole = passed or self.whole or self.motion
        timing = passed.composite.timing if passed and passed.composite else self.timing
        rows = timing.frames_at([time]) - whole.first_frame if timing else np.zeros(1)
        return replace(self, motion=whole, rows=rows)

    def track(self, hold: InHand | Carried) -> Track:
        """Track on the stage of a prop held by these hands, one frame for each time."""
        motion, placement = self.motion, self.placement
        if isinstance(hold, InHand):
            return performer_track(hold.point, hold.turn, motion, self.rows, placement, Placement())
        if motion.unconstrained is None:
            return Track(np.array([[0.0, 0.0, 0.0]]), np.eye(3)[None])
        frames = np.rint(np.asarray(self.rows)).astype(np.int64) + motion.first_frame
        return OwnHands(motion.unconstrained, motion.body, placement, frames).track(hold)


@dataclass(frozen=True, eq=False)
class OwnHands:
    """Hands of the grounded body, before constraints; those that keep hands on the prop so do not move it."""

    unconstrained: UnconstrainedPoses
    body: AnyMorphology
    placement: Placement
    rows: NDArray[np.int64]
    """(F,) frame indices of the motion."""
    timing: Timing | None = None

    def pose_at(self, time: float) -> "OwnHands":
        """The same hands at one ``time`` of the stage, seconds."""
        rows = np.rint(self.timing.frames_at([time])).astype(np.int64) if self.timing else np.zeros(1, dtype=np.int64)
        return replace(self, rows=rows)

    def track(self, hold: InHand | Carried) -> Track:
        """Track on the stage of a prop held by these hands, one frame for each time."""
        rows = self.rows.clip(0, len(self.unconstrained.positions) - 1)
        positions, rotations = self.unconstrained.positions[rows], self.unconstrained.rotations[rows]
        if isinstance(hold, Carried):
            track = carried_track(hold, positions, rotations, self.body)
        else:
            track = point_track(hold.point, hold.turn, positions, rotations, self.body.first_frame_body)
        return Track(self.placement.to_stage(track.positions), self.placement.rotation @ track.rotations)


def stage_track(prop: Prop, seconds: ArrayLike, hands: Mapping[str, Hands] = MappingProxyType({})) -> Track:
    """Track of a prop on the stage at ``seconds`` (F,); one frame for all if it is fixed.

    ``hands`` are those of its holders at these seconds. A holder that is missing does not play yet, and does not hold
    the prop.
    """
    times = np.atleast_1d(np.asarray(seconds, dtype=np.float64))
    return _left_by([index for index, each in enumerate(prop.holds) if each.performer_id in hands], prop, times, hands)


def _left_by(indices: Sequence[int], prop: Prop, times: FloatArray, hands: Mapping[str, Hands]) -> Track:
    """Track of a prop after the holds at ``indices``, in order, as if there were no later ones.

    When taken, it blends from its position, or from the giver's hands, into the holder's hands; when put down, from
    there to its position.
    """
    if not indices:
        return _unheld(prop, times)
    hold, put = prop.holds[indices[-1]], prop.release_is_keyed(indices[-1])
    theirs = hands[hold.performer_id]
    if hold.is_always:
        return theirs.track(hold)
    track = _spread(theirs.track(hold), len(times))
    lasting = np.inf if hold.begin is None or hold.end is None else hold.end - hold.begin
    for moment, sign, before in ((hold.begin, 1.0, indices[:-1]), (hold.end if put else None, -1.0, ())):
        if moment is None:
            continue
        there, here = _at(moment, before, prop, hands), theirs.pose_at(moment).track(hold)
        far = float(np.linalg.norm(there.positions[0] - here.positions[0]))
        seconds = min(hand_over_seconds(far), lasting / 2)
        weights = ease(sign * (times - moment) / max(seconds, 1e-6), EaseShape.QUINTIC)
        giver = prop.holds[before[-1]] if before else None
        gone_on = hands[giver.performer_id].track(giver) if giver is not None and giver.end == moment else there
        other = _spread(gone_on, len(times))
        track.positions[:] = other.positions + weights[:, None] * (track.positions - other.positions)
        turns = _part_of(other.rotations.transpose(0, 2, 1) @ track.rotations, weights)
        track.rotations[:] = other.rotations @ turns
    if hold.begin is not None:
        _put(track, times < hold.begin, _left_by(indices[:-1], prop, times, hands))
    if hold.end is not None and (times > hold.end).any():
        _put(track, times > hold.end, _unheld(prop, times) if put else _at(hold.end, indices, prop, hands))
    return track


def hand_over_seconds(distance: float) -> float:
    """Seconds in which a prop is moved ``distance`` metres into the hands."""
    return max(LEAST_HAND_OVER_SECONDS, QUINTIC_PEAK_SLOPE * distance / MAX_HAND_OVER_SPEED)


def _at(moment: float, indices: Sequence[int], prop: Prop, hands: Mapping[str, Hands]) -> Track:
    """Track of one frame, at the second ``moment``, of a prop after the holds ``indices``."""
    return _left_by(indices, prop, np.array([moment]), {key: each.pose_at(moment) for key, each in hands.items()})


def _spread(track: Track, count: int) -> Track:
    """Copy of a track with ``count`` frames, from one with as many or with one."""
    places, rotations = np.broadcast_to(track.positions, (count, 3)), np.broadcast_to(track.rotations, (count, 3, 3))
    return Track(places.copy(), rotations.copy())


def _put(track: Track, chosen: NDArray[np.bool_], other: Track) -> None:
    """Copy another track into the ``chosen`` (F,) frames of a track, in place."""
    other = _spread(other, len(chosen))
    track.positions[chosen], track.rotations[chosen] = other.positions[chosen], other.rotations[chosen]


def _unheld(prop: Prop, times: FloatArray) -> Track:
    """Track of a prop that nobody holds at ``times`` (F,)."""
    position, heading, tilt = prop.position, prop.heading, prop.tilt
    places = np.array(position)[None] if isinstance(position, tuple) else position.at(times)
    angles = heading.at(times)[:, 0] if isinstance(heading, KeyedNumber) else np.array([heading])
    tilts = tilt.at(times) if isinstance(tilt, KeyedTurn) else to_matrix(np.array(tilt))[None]
    rotations = rotations_about_z(angles) @ tilts
    count = max(len(places), len(rotations))
    return Track(np.broadcast_to(places, (count, 3)), np.broadcast_to(rotations, (count, 3, 3)))


def _part_of(rotations: FloatArray, weights: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) by the fractions ``weights`` (F,) of the angles of ``rotations`` (F, 3, 3)."""
    from scipy.spatial.transform import Rotation  # late: it takes longer than a window

    vectors = Rotation.from_matrix(rotations).as_rotvec()
    return np.asarray(Rotation.from_rotvec(weights[:, None] * vectors).as_matrix())


def track_in_motion_space(follow: FollowProp, prop: Prop, track: Track, own: Placement) -> Track:
    """Track of the followed point of a prop, in the space of a performer at ``own``.

    ``track`` is that of the prop on the stage. A point followed along the arms is without its offset, which is added
    later.
    """
    offset = np.array(follow.share) * np.array(prop.size) / 2 + (0.0 if follow.along_arms else np.array(follow.offset))
    places = track.positions + track.rotations @ offset
    return Track(own.to_motion(places), own.rotation.T @ track.rotations @ to_matrix(np.array(follow.turn)))


def own_hands(unasked: UnconstrainedPoses, body: AnyMorphology, timing: Timing, own: Placement) -> OwnHands:
    """Hands of a grounded body in every frame of its motion."""
    return OwnHands(unasked, body, own, np.arange(len(unasked.positions)), timing)


def carried_track(held: Carried, positions: FloatArray, rotations: FloatArray, body: AnyMorphology) -> Track:
    """Track of a prop carried by a body with ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3), in the motion's
    space.
    """
    layout = body.first_frame_body.layout
    ends = [point_indices(BodyPoint(part, at_end=end), layout)[0] for part in CARRYING_HANDS for end in (False, True)]
    heading = chest_headings(rotations[:, layout.segment_of_part(BodyPart.THORAX)])
    origin = positions[:, 0] if held.steady else positions[:, ends].mean(axis=1)
    places = origin + body.leg_length * rotations_about_z(heading) @ np.array(held.offset)
    return Track(places, rotations_about_z(heading + held.heading) @ to_matrix(np.array(held.tilt)))


def chest_headings(chests: FloatArray) -> FloatArray:
    """Headings (F,) of chests (F, 3, 3), radians about Z.

    They are computed from the axis to the left, because the axis ahead reverses its heading as a body bends down beyond
    level.
    """
    return np.asarray(np.arctan2(-chests[:, 0, 1], chests[:, 1, 1]))
