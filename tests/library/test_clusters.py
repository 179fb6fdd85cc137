"""Groups of poses for browsing."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studio.core.clip_search import SearchTable, pose_distances
from studio.core.kernels import pose_search as at
from studio.library.clusters import LEAST_CLUSTER_DISTANCE, map_of, rotation_free_features
from tests.core.test_retrieval import made_table


@given(st.integers(0, 1000), st.integers(1, 40))
def test_every_pose_is_in_a_group_and_each_group_has_a_pose_of_its_own(seed, count):
    table = made_table(seed)
    made = map_of(table, count)
    groups = len(made.representatives)
    assert len(made.clusters) == len(table.rows)
    assert 1 <= groups <= min(count, len(table.rows))
    assert set(made.clusters) == set(range(groups))
    assert made.clusters[made.representatives].tolist() == list(range(groups))
    assert all(group not in links for group, links in enumerate(made.links))
    assert all(len(made.clips_of(group, table)) for group in range(groups))


@given(st.integers(0, 1000))
def test_what_is_grouped_by_is_never_farther_apart_than_the_poses(seed):
    table = made_table(seed, clips=3)
    apart = np.linalg.norm(rotation_free_features(table.rows) - rotation_free_features(table.rows[:1]), axis=1)
    assert (apart <= pose_distances(table.rows[0], table.rows)[0] + 1e-6).all()


@given(st.integers(0, 1000), st.integers(1, 30))
def test_no_two_groups_look_alike_however_often_one_pose_comes(seed, often):
    table = made_table(seed)
    guards = np.repeat(table.rows[:1], 20 * often, axis=0)
    rows = np.concatenate([guards, table.rows])
    made = map_of(replace(table, rows=rows, frame_counts=np.array([len(rows)])), 12)
    features = rotation_free_features(rows[made.representatives])
    apart = np.linalg.norm(features[:, None] - features, axis=2) + np.diag(np.full(len(features), np.inf))
    assert apart.min() > LEAST_CLUSTER_DISTANCE
    farthest = np.linalg.norm(rotation_free_features(rows)[:, None] - features, axis=2).min(axis=1).max()
    assert farthest <= apart.min() or len(features) < 2


def test_links_lead_to_the_most_similar_groups():
    table = made_table(3)
    made = map_of(table, 8)
    poses = table.rows[made.representatives]
    for group, links in enumerate(made.links):
        apart = pose_distances(poses[group], poses)[0]
        apart[group] = np.inf
        assert apart[links[0]] == apart.min()


def test_an_empty_table_has_an_empty_map():
    none = np.empty(0, dtype=np.int64)
    table = SearchTable(np.empty((0, at.POSE_WIDTH), np.float32), none, np.empty((0, 3)), none, none, none)
    assert len(map_of(table, 5).representatives) == 0
