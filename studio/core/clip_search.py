"""Search in a motion library for the clip, and its start frame, that hits a target best (P09 section 3.3).

Poses are compared modulo a rotation about Z and a horizontal translation (Kovar et al. 2002), hits by the distance from
the target to the path of the hit point. The result is exact, as if every frame were tried. METHOD (39) has the
equations.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.kernels import pose_search as at

FloatArray = NDArray[np.float64]
Rows = NDArray[np.float32]
IntArray = NDArray[np.int64]

BLOCK_FRAMES = 8
"""Number of frames in a block; the cost of the middle frame bounds that of the others."""
BYTES_A_FRAME = 4 * at.POSE_WIDTH + (4 * at.POSE_WIDTH + 8 * (1 + 4 + 3 + 1)) // BLOCK_FRAMES
"""Bytes of one frame in the table of poses (on disk until they are read) and in the blocks (in memory)."""


def compared_points(layout: BodyLayout) -> IntArray:
    """Indices (20,) of the canonical points by which poses are compared."""
    arms = [layout.collar_point(side) + k for side in (0, 1) for k in (1, 2, 3, 4)]
    legs = [layout.hip_point(side) + k for side in (0, 1) for k in (0, 1, 2, 3)]
    return np.array([0, layout.neck_base, layout.head_joint, layout.head_end, *arms, *legs])


def pose_rows(positions: FloatArray, layout: BodyLayout) -> Rows:
    """Rows (F, 64) that represent poses in the search, with equal weights of all compared points.

    ``positions`` (F, P, 3) are points of bodies, in metres above the ground.
    """
    points = positions[:, compared_points(layout)]
    rows = np.zeros((len(points), at.POSE_WIDTH), dtype=np.float32)
    middle = points[..., :2].mean(axis=1)
    rows[:, at.POSE_CENTRE : at.POSE_CENTRE + 2] = middle
    weight = np.sqrt(1.0 / at.POSE_JOINTS)
    rows[:, : at.Y] = weight * (points[..., 0] - middle[:, :1])
    rows[:, at.Y : at.Z] = weight * (points[..., 1] - middle[:, 1:])
    rows[:, at.Z : at.SQUARE] = weight * points[..., 2]
    rows[:, at.SQUARE] = np.square(rows[:, : at.SQUARE], dtype=np.float64).sum(axis=1)
    return rows


def row_points(rows: ArrayLike) -> FloatArray:
    """Points (..., 20, 3) in metres of pose rows (..., 64): horizontally relative to their centroid, vertically above
    the ground.
    """
    poses = np.asarray(rows, dtype=np.float64) / np.sqrt(1.0 / at.POSE_JOINTS)
    return np.stack([poses[..., : at.Y], poses[..., at.Y : at.Z], poses[..., at.Z : at.SQUARE]], axis=-1)


def pose_distances(query: ArrayLike, rows: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Distances (F,) in metres of the pose rows ``rows`` (F, 64) from ``query`` (64,), and the angles (F,) about Z in
    radians that bring them nearest.
    """
    one, all_rows = np.asarray(query, dtype=np.float64), np.asarray(rows, dtype=np.float64)
    planar = (all_rows[:, : at.Y] - 1j * all_rows[:, at.Y : at.Z]) @ (one[: at.Y] + 1j * one[at.Y : at.Z])
    rest = np.square(all_rows[:, : at.Z]).sum(axis=1) + np.square(one[: at.Z]).sum()
    rest = rest + np.square(all_rows[:, at.Z : at.SQUARE] - one[at.Z : at.SQUARE]).sum(axis=1)
    return np.sqrt(np.maximum(rest - 2.0 * np.abs(planar), 0.0)), np.angle(planar)


_ARMS, _LEGS = (4, 8), (12, 16)
ROW_STICKS: IntArray = np.array(
    [(0, 1), (1, 2), (2, 3)]
    + [(begin, limb) for begin, limbs in ((1, _ARMS), (0, _LEGS)) for limb in limbs]
    + [(limb + k, limb + k + 1) for limb in (*_ARMS, *_LEGS) for k in range(3)]
)
"""Pairs (S, 2) of indices of compared points that are joined by a line in a picture."""
STICK_SIDES: IntArray = np.array([-1, -1, -1, *((end - _ARMS[0]) // 4 % 2 for _, end in ROW_STICKS[3:].tolist())])
"""Side (S,) of each line of ``ROW_STICKS``: -1 for the middle, 0 left, 1 right."""


@dataclass(frozen=True, eq=False)
class SearchTable:
    """Data of the searched clips, C in number with F frames together.

    ``rows`` (F, 64) are pose rows of all clips in succession, and may be memory-mapped; ``frame_counts`` (C,) are their
    numbers. ``paths`` (T, 3) are the paths of the hit points in the frames that can hit, metres in the space of the
    clip, and ``path_counts`` (C,) their lengths. ``actors`` and ``limbs`` (C,) are the index of a clip's actor and of
    the limb that hits.
    """

    rows: Rows
    frame_counts: IntArray
    paths: FloatArray
    path_counts: IntArray
    actors: IntArray
    limbs: IntArray

    def __post_init__(self) -> None:
        rows = np.asarray(self.rows).view()
        rows.flags.writeable = False  # what is mapped from disk cannot be written; a kernel is compiled for one of both
        object.__setattr__(self, "rows", rows)

    @property
    def clip_count(self) -> int:
        return len(self.frame_counts)

    @cached_property
    def clips(self) -> IntArray:
        """Table (C, 4) of each clip's actor, limb, first row in ``paths`` and number of rows there."""
        begins = np.cumsum(self.path_counts) - self.path_counts
        return np.column_stack([self.actors, self.limbs, begins, self.path_counts]).astype(np.int64)

    @cached_property
    def first_rows(self) -> IntArray:
        """Index (C,) of each clip's first row."""
        return np.asarray(np.cumsum(self.frame_counts) - self.frame_counts, dtype=np.int64)

    @cached_property
    def blocks(self) -> "FrameBlocks":
        """Blocks of frames with bounds of their cost, which are searched before single frames."""
        return FrameBlocks.of(self)

    @cached_property
    def frame_table(self) -> at.FrameTable:
        """Frames of all clips as the record that the kernels of ``pose_search`` take."""
        blocks = self.blocks
        return at.FrameTable(
            self.rows, self.paths, self.clips, blocks.spans, blocks.middles, blocks.radii, blocks.rings
        )


@dataclass(frozen=True, eq=False)
class FrameBlocks:
    """Blocks of consecutive frames of one clip, with bounds of the cost of their frames.

    ``spans`` (B, 3) are clip, first row and number of rows of each block. ``middles`` (B, 64) are the rows of the
    middle frames, ``radii`` (B,) the distance in metres to the block's farthest frame. ``rings`` (B, 4) are the least
    and greatest distance of the hit from the middle of a pose, and the lowest and highest hit.
    """

    spans: IntArray
    middles: Rows
    radii: FloatArray
    rings: FloatArray

    @classmethod
    def of(cls, table: SearchTable) -> "FrameBlocks":
        """Blocks of the frames of ``table``, with bounds from the middle frame of each."""
        counts, begins = table.frame_counts, table.first_rows
        spans = np.array(
            [
                (clip, begins[clip] + start, min(BLOCK_FRAMES, count - start))
                for clip, count in enumerate(counts.tolist())
                for start in range(0, count, BLOCK_FRAMES)
            ],
            dtype=np.int64,
        ).reshape(-1, 3)
        middles = np.ascontiguousarray(table.rows[spans[:, 1] + spans[:, 2] // 2])
        radii, rings = np.empty(len(spans)), np.empty((len(spans), 4))
        at.write_block_bounds(spans, table.rows, table.paths, table.clips, middles, radii, rings)
        return cls(spans, middles, radii, rings)


@dataclass(frozen=True, eq=False)
class PoseQuery:
    """Query of a search: the performer's pose on each of A actors, and the target of each limb of each actor.

    ``poses`` are pose rows (A, 64). ``targets`` (A, 4, 3) are in metres, relative to the middle of the actor's pose,
    heights above the ground.
    """

    poses: Rows
    targets: FloatArray
    posture_weight: float = 1.0
    reach_weight: float = 1.0


@dataclass(frozen=True)
class SearchMatch:
    """Clip found by a search; ``posture`` and ``reach`` are distances in metres, ``cost`` is their weighted sum.

    It plays from ``frame`` of the clip on, rotated by ``turn`` (radians) about Z, and hits at index ``contact`` of the
    path of its hit point.
    """

    clip: int
    frame: int
    contact: int
    cost: float
    posture: float
    reach: float
    turn: float


def search(table: SearchTable, query: PoseQuery, count: int = 8, allowed: ArrayLike | None = None) -> list[SearchMatch]:
    """Best frames of the ``count`` clips with the least cost, best clip first; ``allowed`` (C,) masks the clips.

    The result equals that of trying every frame, apart from ties.
    """
    among = np.ones(table.clip_count, dtype=np.bool_) if allowed is None else np.asarray(allowed, dtype=np.bool_)
    bounds = np.empty(len(table.blocks.spans))
    asked = at.SearchQuery(query.poses, query.targets, float(query.posture_weight), float(query.reach_weight))
    if not len(bounds) or count < 1:
        return []
    at.write_block_cost_bounds(table.frame_table, among, asked, bounds)
    begin = min(2 * count, len(bounds))
    first = np.argpartition(bounds, begin - 1)[:begin]
    found = at.SearchHits(np.empty((count, 4)), np.empty((count, 3), dtype=np.int64))
    at.search_blocks(first[np.argsort(bounds[first])], bounds, table.frame_table, asked, found)
    begins = table.first_rows
    return [
        SearchMatch(clip, frame - int(begins[clip]), contact - int(table.clips[clip, 2]), *numbers)
        for (clip, frame, contact), numbers in zip(found.places.tolist(), found.costs.tolist(), strict=True)
        if clip >= 0
    ]
