"""Search for the clip that hits a position best, for a body in a given pose (P09 section 3.3), with reasons in words.

The performer's pose is transferred to every actor, and the target position is scaled by the size of the limbs (P09
equation 1), so that every clip is judged on the body that performed it. Another body may find another clip.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.morphology import Morphology
from studio.core.clip_search import PoseQuery, SearchMatch, pose_distances, pose_rows, search
from studio.core.kernels import channel_columns as channel
from studio.core.kernels import pose_search as at
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import realize_motion
from studio.library.clip_labels import Kind, Limb
from studio.library.hit_paths import limb_size
from studio.library.library import Library, LibraryClip

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StrikeQuery:
    """Query of a search: hit ``place`` (3,), metres, from ``pose``, the performer's motion of one frame on ``body``.

    ``place`` is in the space of the pose. ``limbs``, ``kinds``, ``tags`` and ``numbers`` each restrict the search to
    clips with one of these; an empty collection does not restrict it.
    """

    pose: NormalizedMotion
    body: Morphology
    place: ArrayLike
    limbs: Collection[Limb] = ()
    kinds: Collection[Kind] = ()
    tags: Collection[str] = ()
    numbers: Collection[int] = ()
    posture_weight: float = 1.0
    reach_weight: float = 1.0
    in_box: bool = False
    """True to exclude clips whose box around the hit path does not contain the place, as in P09."""


@dataclass(frozen=True, eq=False)
class Result:
    """Clip found by a search, played from frame ``start`` of its take and hitting at frame ``hit``.

    ``turn`` (radians about Z) rotates the take onto the performer. ``posture`` and ``reach`` are the distances from the
    query, in metres on the actor's body; ``cost`` is their weighted sum.
    """

    clip: LibraryClip
    start: int
    hit: int
    turn: float
    posture: float
    reach: float
    cost: float

    @property
    def seconds_to_hit(self) -> float:
        """Seconds from the start to the hit."""
        return (self.hit - self.start) / self.clip.take.motion.frame_rate

    @property
    def reasons(self) -> tuple[str, str, str]:
        """Posture, reach and time to the hit, each in words."""
        return (
            f"posture {length_in_words(self.posture)} off",
            f"passes {length_in_words(self.reach)} from the target",
            f"hits in {self.seconds_to_hit:.2f} s",
        )


def length_in_words(length: float) -> str:
    """Text of a length in metres, written in cm or m."""
    return f"{100.0 * length:.0f} cm" if length < 1.0 else f"{length:.2f} m"


def search_strikes(library: Library, asked: StrikeQuery, count: int = 8) -> list[Result]:
    """The ``count`` clips with the least cost, best first, each from its best frame; the search is exact."""
    query, allowed = pose_query(library, asked), allowed_clip_mask(library, asked)
    if asked.in_box and len(library.clips):
        allowed &= _boxes_hold(library, query)
    return [_result(library, each) for each in search(library.table, query, count, allowed)]


def pose_query(library: Library, asked: StrikeQuery) -> PoseQuery:
    """Query of the table: the performer's pose on every actor, and the target position scaled to each."""
    place = np.asarray(asked.place, dtype=np.float64)
    away = place - realize_motion(asked.pose, asked.body)[0][0, 0]
    poses = np.empty((len(library.actors), at.POSE_WIDTH), dtype=np.float32)
    targets = np.empty((len(library.actors), len(Limb), 3))
    for row, actor in enumerate(library.actors):
        points = realize_motion(asked.pose, actor.body)[0]
        poses[row] = pose_rows(points, actor.body.layout)[0]
        middle = np.array([*poses[row, at.POSE_CENTRE : at.POSE_CENTRE + 2], 0.0])
        for limb in Limb:
            scale = limb_size(actor.body, limb) / limb_size(asked.body, limb)
            targets[row, limb] = points[0, 0] + scale * away - middle
    return PoseQuery(poses, targets, asked.posture_weight, asked.reach_weight)


def allowed_clip_mask(library: Library, asked: StrikeQuery) -> NDArray[np.bool_]:
    """Mask (C,) of the clips that the query ``asked`` allows."""
    labels = [(clip.number, clip.label) for clip in library.clips]
    return np.array(
        [
            (not asked.limbs or label.limb in asked.limbs)
            and (not asked.kinds or label.kind in asked.kinds)
            and (not asked.tags or not set(asked.tags).isdisjoint(label.tags))
            and (not asked.numbers or number in asked.numbers)
            for number, label in labels
        ],
        dtype=np.bool_,
    )


def _boxes_hold(library: Library, query: PoseQuery) -> NDArray[np.bool_]:
    """Mask (C,) of the clips whose box around the hit path contains the target position, as seen from some frame.

    A clip may be rotated and moved to the performer, so the box is that of distances and heights relative to its poses.
    """
    blocks, table = library.table.blocks, library.table
    targets = query.targets[table.actors, table.limbs][blocks.spans[:, 0]]
    away, height = np.hypot(targets[:, 0], targets[:, 1]), targets[:, 2]
    rings = blocks.rings
    holds = (rings[:, 0] <= away) & (away <= rings[:, 1]) & (rings[:, 2] <= height) & (height <= rings[:, 3])
    return np.asarray(np.bincount(blocks.spans[:, 0], holds, table.clip_count) > 0)


def _result(library: Library, found: SearchMatch) -> Result:
    clip = library.clips[found.clip]
    start, hit = clip.searched_frames.start + found.frame, clip.path.first + found.contact
    return Result(clip, start, hit, found.turn, found.posture, found.reach, found.cost)


def result_at_frame(clip: LibraryClip, frame: int, asked: StrikeQuery) -> Result:
    """Result for ``clip`` from ``frame`` of its take on, as if the search had found this frame."""
    motion, body = clip.take.motion, clip.actor.body
    frame = min(frame, clip.path.first)
    there = realize_motion(replace(motion, channels=motion.channels[frame : frame + 1]), body)[0]
    here = realize_motion(asked.pose, body)[0]
    [posture], [turn] = pose_distances(pose_rows(here, body.layout)[0], pose_rows(there, body.layout))
    return Result(clip, frame, clip.label.hit, float(turn), float(posture), 0.0, float(posture))


def strike_path(found: Result, asked: StrikeQuery) -> FloatArray:
    """Points (T, K+23, 3) of the query's body from the start of a result to its hit, in the space of the query's pose.

    This is a preview without solving, so the hit misses the target by the distance that the reasons give.
    """
    motion, body = found.clip.take.motion, asked.body
    points = realize_motion(replace(motion, channels=motion.channels[found.start : found.hit + 1]), body)[0]
    now = pose_rows(realize_motion(asked.pose, body)[0], body.layout)[0, at.POSE_CENTRE : at.POSE_CENTRE + 2]
    then = pose_rows(points[:1], body.layout)[0, at.POSE_CENTRE : at.POSE_CENTRE + 2]
    c, s = np.cos(found.turn), np.sin(found.turn)
    points[..., :2] = (points[..., :2] - then) @ np.array([[c, s], [-s, c]]) + now
    return points


def position_ahead_of(pose: NormalizedMotion, body: Morphology, position: ArrayLike) -> FloatArray:
    """Position (3,) in the space of ``pose`` of ``position``: metres forward and left of the root, and above the
    ground.

    Forward is the heading of the pelvis.
    """
    root = realize_motion(pose, body)[0][0, 0]
    c, s = np.cos(pose.channels[0, channel.YAW]), np.sin(pose.channels[0, channel.YAW])
    x, y, z = np.asarray(position, dtype=np.float64)
    return np.array([root[0] + c * x - s * y, root[1] + s * x + c * y, z])
