"""Clusters of the poses of a library, as in P09 (3.3.2): a map to look at, which the search does not use.

The method is K-centres (farthest point first) over features of a pose that are invariant to rotation about Z and
horizontal translation: the distance of each joint from the middle, and its height. K-means would put most clusters
where most poses are, in a library of strikes nearly all in the guard.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.clip_search import SearchTable, pose_distances
from studio.core.kernels import pose_search as at

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

NEIGHBOURS_PER_CLUSTER = 4
"""Number of most similar clusters that are linked to each cluster."""
LEAST_CLUSTER_DISTANCE = 0.08
"""Least distance in metres between the features of two representatives; poses that are nearer look alike."""


@dataclass(frozen=True, eq=False)
class PoseMap:
    """Map of the poses of a table: ``clusters`` (F,) is the index of the cluster of each row.

    For G clusters, ``representatives`` (G,) are the rows in their middle, ``centres`` (G, 40) the features of these
    rows, and ``links`` (G, L) the clusters with the most similar representatives, the nearest first.
    """

    clusters: IntArray
    centres: FloatArray
    representatives: IntArray
    links: IntArray

    def places(self, rows: ArrayLike) -> FloatArray:
        """Positions (G, 2) of the clusters in the plane that best preserves the distances of their poses.

        The first axis is that of the greatest extent (classical scaling). ``rows`` (F, 64) are the pose rows of the
        table.
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
        """Indices of the clips with poses in ``cluster``, the clip with the most poses first."""
        rows = np.flatnonzero(self.clusters == cluster)
        counts = np.bincount(np.searchsorted(table.first_rows, rows, "right") - 1, minlength=table.clip_count)
        order = np.argsort(-counts, kind="stable")
        return np.asarray(order[counts[order] > 0])


def rotation_free_features(rows: ArrayLike) -> FloatArray:
    """Features (F, 40) of pose rows (F, 64) that are invariant to rotation about Z and horizontal translation.

    The Euclidean distance of two features is a lower bound of the distance of the poses.
    """
    poses = np.asarray(rows, dtype=np.float64)
    return np.concatenate([np.hypot(poses[:, : at.Y], poses[:, at.Y : at.Z]), poses[:, at.Z : at.SQUARE]], axis=1)


def map_of(table: SearchTable, count: int) -> PoseMap:
    """Map of the poses of ``table`` with at most ``count`` clusters, whose representatives differ."""
    features = rotation_free_features(table.rows)
    if count == 0 or not len(features):
        none = np.empty(0, dtype=np.int64)
        return PoseMap(none, np.empty((0, 2 * at.POSE_JOINTS)), none, np.empty((0, 0), dtype=np.int64))
    found = [int(np.argmin(np.linalg.norm(features - features.mean(axis=0), axis=1)))]
    clusters, apart = np.zeros(len(features), dtype=np.int64), np.linalg.norm(features - features[found[0]], axis=1)
    while len(found) < count and apart.max() > LEAST_CLUSTER_DISTANCE:
        found.append(int(np.argmax(apart)))
        from_new = np.linalg.norm(features - features[found[-1]], axis=1)
        clusters[from_new < apart] = len(found) - 1
        apart = np.minimum(apart, from_new)
    representatives = np.array(found)
    poses = table.rows[representatives]
    between = np.array([pose_distances(pose, poses)[0] for pose in poses])
    np.fill_diagonal(between, np.inf)
    links = np.argsort(between, axis=1)[:, : min(NEIGHBOURS_PER_CLUSTER, len(found) - 1)]
    return PoseMap(clusters, features[representatives], representatives, links)
