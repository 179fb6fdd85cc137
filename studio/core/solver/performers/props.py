"""Where props are: fixed, keyed, moving by a rule, or with a performer; on the stage, as arrays over time."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.activation import EaseShape, ease
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.keyed import KeyedNumber
from studio.core.rotations import to_matrix
from studio.core.solver.asking.packing import point_indices
from studio.core.solver.asking.tracks import Track
from studio.core.solver.performers.following import performer_track, point_track
from studio.core.solver.request import AdaptedMotion, Unasked
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Carried, Prop
from studio.core.stage.timing import Timing

FloatArray = NDArray[np.float64]

HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)


HANDING = 0.3
"""Seconds in which a prop comes to where it is held, from where it was picked up, and to where it is put."""


@dataclass(frozen=True, eq=False)
class Holder:
    """The performer with whom a prop goes: its motion, which frames (F,) of it, not rounded, and where it stands.

    ``whole`` are all frames of it, ``timing`` is when they play: of a prop that is picked up or put down.
    """

    motion: AdaptedMotion
    rows: ArrayLike
    placement: Placement
    whole: AdaptedMotion | None = None
    timing: Timing | None = None

    def at(self, time: float) -> "Holder":
        """The same at one second of the stage."""
        whole, timing = self.whole or self.motion, self.timing
        rows = timing.frames_at([time]) - whole.first_frame if timing else np.zeros(1)
        return replace(self, motion=whole, rows=rows)


def stage_track(prop: Prop, seconds: ArrayLike, holder: Holder | None) -> Track:
    """A prop's centre and axes on the stage at ``seconds`` (F,); one frame for all where it stays.

    Without its ``holder``, who may not play yet, it is where it would be unheld.
    """
    times = np.atleast_1d(np.asarray(seconds, dtype=np.float64))
    if prop.held is None or holder is None:
        return _unheld(prop, times)
    return handed(prop, times, _held(prop, holder), lambda time: _held(prop, holder.at(time)))


def handed(prop: Prop, times: FloatArray, held: Track, held_at: Callable[[float], Track]) -> Track:
    """A prop at ``times`` (F,) that is at ``held`` while it is held, and ``held_at`` a second.

    What it is away from there as it is picked up goes with the hands and dies away.
    """
    hold = prop.held
    if hold is None or hold.is_always:
        return held
    count = len(times)
    places, axes = (
        np.array(np.broadcast_to(held.places, (count, 3))),
        np.array(np.broadcast_to(held.rotations, (count, 3, 3))),
    )
    lasting = np.inf if hold.begin is None or hold.end is None else hold.end - hold.begin
    for moment, way in ((hold.begin, 1.0), (hold.end if prop.is_put else None, -1.0)):
        if moment is not None:
            shares = 1.0 - ease(way * (times - moment) / max(min(HANDING, lasting / 2), 1e-6), EaseShape.QUINTIC)
            there, here = _unheld(prop, np.array([moment])), held_at(moment)
            places += shares[:, None] * (there.places - here.places)
            axes = _part_of(there.rotations[0] @ here.rotations[0].T, shares) @ axes
    before = np.zeros(count, dtype=bool) if hold.begin is None else times < hold.begin
    after = np.zeros(count, dtype=bool) if hold.end is None else times > hold.end
    own = _unheld(prop, times)
    unheld = before | (after & prop.is_put)
    places[unheld], axes[unheld] = (
        np.broadcast_to(part, (count, *part.shape[1:]))[unheld] for part in (own.places, own.rotations)
    )
    if hold.end is not None and not prop.is_put and after.any():
        left = handed(prop, np.array([hold.end]), held_at(hold.end), held_at)
        places[after], axes[after] = left.places[0], left.rotations[0]
    return Track(places, axes)


def _unheld(prop: Prop, times: FloatArray) -> Track:
    position, heading = prop.position, prop.heading
    places = np.array(position)[None] if isinstance(position, tuple) else position.at(times)
    angles = heading.at(times)[:, 0] if isinstance(heading, KeyedNumber) else np.array([heading])
    count = max(len(places), len(angles))
    return Track(np.broadcast_to(places, (count, 3)), np.broadcast_to(turned_by(angles), (count, 3, 3)))


def _part_of(turn: FloatArray, shares: FloatArray) -> FloatArray:
    """(F, 3, 3) so much of a turn (3, 3) as ``shares`` (F,) say."""
    from scipy.spatial.transform import Rotation  # late: it takes longer than a window

    return np.asarray(Rotation.from_rotvec(shares[:, None] * Rotation.from_matrix(turn).as_rotvec()).as_matrix())


def seen_from(follow: FollowProp, prop: Prop, track: Track, own: Placement) -> Track:
    """What is followed of a prop that is at ``track`` on the stage, as who stands at ``own`` sees it."""
    offset = np.array(follow.offset) + np.array(follow.share) * np.array(prop.size) / 2
    places = track.places + track.rotations @ offset
    return Track(own.to_motion(places), own.rotation.T @ track.rotations @ to_matrix(np.array(follow.turn)))


def own_hold(prop: Prop, unasked: Unasked, body: AnyMorphology, timing: Timing, own: Placement) -> Track:
    """A prop on the stage at every frame of who holds it, standing at ``own``, as its motion has the hands.

    Hands that constraints hold on the prop do not move it.
    """
    if isinstance(prop.held, Carried):
        track = carried_track(prop.held, unasked, body)
    else:
        assert prop.held is not None
        track = point_track(prop.held.point, prop.held.turn, unasked.positions[:], unasked.rotations[:], body.still)
    whole = Track(own.to_stage(track.places), own.rotation @ track.rotations)

    def held_at(time: float) -> Track:
        row = min(max(round(timing.frame_at(time)), 0), len(whole.places) - 1)
        return Track(whole.places[row : row + 1], whole.rotations[row : row + 1])

    times = timing.begin + np.arange(len(whole.places)) / timing.frame_rate
    return handed(prop, times, whole, held_at)


def carried_track(held: Carried, unasked: Unasked, body: AnyMorphology) -> Track:
    """What is carried by a body that moves as ``unasked`` has it, in the space of its motion, at every frame."""
    layout = body.still.layout
    ends = [point_indices(BodyPoint(part, at_end=end), layout)[0] for part in HANDS for end in (False, True)]
    chest = unasked.rotations[:, layout.segment(BodyPart.THORAX), :, 0]
    axes = turned_by(np.unwrap(np.arctan2(chest[:, 1], chest[:, 0])))
    middle = unasked.positions[:, ends].mean(axis=1)
    return Track(middle + body.leg_length * axes @ np.array(held.offset), axes)


def turned_by(angles: FloatArray) -> FloatArray:
    """(F, 3, 3) turns about Z by ``angles`` (F,)."""
    turns = np.zeros((len(angles), 3, 3))
    turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
    turns[:, 1, 0], turns[:, 0, 1], turns[:, 2, 2] = np.sin(angles), -np.sin(angles), 1.0
    return turns


def _held(prop: Prop, holder: Holder) -> Track:
    motion, placement = holder.motion, holder.placement
    if isinstance(prop.held, Carried):
        if motion.unasked is None:
            return Track(np.array([[0.0, 0.0, 0.0]]), np.eye(3)[None])
        whole = carried_track(prop.held, motion.unasked, motion.body)
        frames = np.rint(np.asarray(holder.rows)).astype(np.int64) + motion.first_frame
        rows = frames.clip(0, len(whole.places) - 1)
        return Track(placement.to_stage(whole.places[rows]), placement.rotation @ whole.rotations[rows])
    assert prop.held is not None
    return performer_track(prop.held.point, prop.held.turn, motion, holder.rows, placement, Placement())
