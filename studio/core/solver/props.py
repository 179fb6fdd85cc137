"""Where props are: fixed, keyed, or with a performer; on the stage, as arrays over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.keyed import KeyedNumber, KeyedPlace
from studio.core.morphology import AnyMorphology
from studio.core.placement import Placement
from studio.core.prop import Carried, Prop
from studio.core.rotations import to_matrix
from studio.core.solver.following import performer_track
from studio.core.solver.packing import point_indices
from studio.core.solver.request import AdaptedMotion, Unasked
from studio.core.solver.tracks import Track

FloatArray = NDArray[np.float64]

HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)


@dataclass(frozen=True, eq=False)
class Holder:
    """The performer with whom a prop goes: its motion, which frames (F,) of it, not rounded, and where it stands."""

    motion: AdaptedMotion
    rows: ArrayLike
    placement: Placement


def stage_track(prop: Prop, seconds: ArrayLike, holder: Holder | None) -> Track:
    """A prop's centre and axes on the stage at ``seconds`` (F,); one frame for all where it stays.

    Without its ``holder``, who may not play yet, it is where it would be unheld.
    """
    if prop.held is not None and holder is not None:
        return _held(prop, holder)
    times = np.atleast_1d(np.asarray(seconds, dtype=np.float64))
    position, heading = prop.position, prop.heading
    places = position.at(times) if isinstance(position, KeyedPlace) else np.array(position)[None]
    angles = heading.at(times)[:, 0] if isinstance(heading, KeyedNumber) else np.array([heading])
    count = max(len(places), len(angles))
    return Track(np.broadcast_to(places, (count, 3)), np.broadcast_to(turned_by(angles), (count, 3, 3)))


def seen_from(follow: FollowProp, prop: Prop, track: Track, own: Placement) -> Track:
    """What is followed of a prop that is at ``track`` on the stage, as who stands at ``own`` sees it."""
    offset = np.array(follow.offset) + np.array(follow.share) * np.array(prop.size) / 2
    places = track.places + track.rotations @ offset
    return Track(own.to_motion(places), own.rotation.T @ track.rotations @ to_matrix(np.array(follow.turn)))


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
