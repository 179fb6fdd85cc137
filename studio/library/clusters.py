"""Clusters of a library's poses, as in P09 (3.3.2): a map to look at, not used by the search.

K-means over features of a pose that do not change with a turn or a shift: the distance of each joint from the middle,
and its height.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.cluster.vq import kmeans2

from studio.core.kernels import pose_search as at
from studio.core.retrieval import SearchTable, pose_distances

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

CLUSTER_ROUNDS = 40
CLUSTER_LINKS = 4


@dataclass(frozen=True, eq=False)
class PoseMap:
    """Map of poses: ``clusters`` (F,) has the cluster of each row of a table; of G clusters ``centroids`` (G, 40),
    ``representatives`` (G,) the row nearest to each, ``links`` (G, L) the clusters whose representatives are most
    similar, the nearest first.
    """

    clusters: IntArray
    centroids: FloatArray
    representatives: IntArray
    links: IntArray

    def places(self, rows: ArrayLike) -> FloatArray:
        """Positions (G, 2) of the clusters in the plane that preserves the distances of their poses best (classical
        scaling), the axis of greatest extent first; ``rows`` (F, 64) are those of the table.
        """
        poses = np.asarray(rows)[self.representatives]
        if not len(poses):
            return np.empty((0, 2))
        squares = np.array([pose_distances(pose, poses)[0] for pose in poses]) ** 2
        inner = -0.5 * (squares - squares.mean(axis=0) - squares.mean(axis=1)[:, None] + squares.mean())
        values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
        flat = vectors[:, ::-1] * np.sqrt(np.maximum(values[::-1], 0.0))
        return np.column_stack([flat, np.zeros(len(flat))])[:, :2]

    def clips_of(self, cluster: int, table: SearchTable) -> IntArray:
        """Indices of the clips with poses in a cluster, the clip with most of them first."""
        rows = np.flatnonzero(self.clusters == cluster)
        counts = np.bincount(np.searchsorted(table.first_rows, rows, "right") - 1, minlength=table.clip_count)
        order = np.argsort(-counts, kind="stable")
        return np.asarray(order[counts[order] > 0])


def unturned(rows: ArrayLike) -> FloatArray:
    """Features (F, 40) of pose rows (F, 64) that neither turn nor shift changes; their Euclidean distance is
    at most D.
    """
    poses = np.asarray(rows, dtype=np.float64)
    return np.concatenate([np.hypot(poses[:, : at.Y], poses[:, at.Y : at.Z]), poses[:, at.Z : at.SQUARE]], axis=1)


def map_of(table: SearchTable, count: int, seed: int = 0) -> PoseMap:
    """Map of a table's poses with at most ``count`` clusters; the same seed gives the same clusters."""
    features = unturned(table.rows)
    count = min(count, len(features))
    if count == 0:
        none = np.empty(0, dtype=np.int64)
        return PoseMap(none, np.empty((0, 2 * at.POSE_JOINTS)), none, np.empty((0, 0), dtype=np.int64))
    starts = features[np.random.default_rng(seed).choice(len(features), count, replace=False)]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "One of the clusters is empty")  # where poses are alike; it is left out below
        centroids, found = kmeans2(features, starts, iter=CLUSTER_ROUNDS, minit="matrix")
    groups = np.unique(found)
    representatives = np.array([_nearest(features, found == group, centroids[group]) for group in groups])
    poses = table.rows[representatives]
    apart = np.array([pose_distances(pose, poses)[0] for pose in poses])
    np.fill_diagonal(apart, np.inf)
    links = np.argsort(apart, axis=1)[:, : min(CLUSTER_LINKS, len(groups) - 1)]
    return PoseMap(np.searchsorted(groups, found), centroids[groups], representatives, links)


def _nearest(features: FloatArray, among: NDArray[np.bool_], centroid: FloatArray) -> int:
    rows = np.flatnonzero(among)
    return int(rows[np.argmin(np.linalg.norm(features[rows] - centroid, axis=1))])
