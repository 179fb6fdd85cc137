"""The search of a motion library finds what trying every frame finds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout
from studio.core.clip_search import (
    BLOCK_FRAMES,
    PoseQuery,
    SearchTable,
    compared_points,
    pose_distances,
    pose_rows,
    search,
)
from studio.core.kernels import pose_search as at
from tests.core.twins.retrieval import brute_force, kovar_distance

LAYOUT = BodyLayout(3)


def made_table(seed: int, clips: int = 12, actors: int = 3) -> SearchTable:
    """Smooth random bodies that walk through each other's poses."""
    random = np.random.default_rng(seed)
    basis = random.normal(size=(4, LAYOUT.point_count, 3)) * 0.25
    counts = random.integers(1, 3 * BLOCK_FRAMES, clips)
    rows, paths, lengths = [], [], random.integers(1, 9, clips)
    for count, length in zip(counts, lengths, strict=True):
        steps = np.cumsum(random.normal(size=(count, 4)) * 0.05, axis=0) + random.normal(size=4)
        bodies = np.einsum("fk,kpc->fpc", steps, basis) + random.normal(size=3) * [1.0, 1.0, 0.1]
        rows.append(pose_rows(bodies, LAYOUT))
        paths.append(bodies[-1].mean(axis=0) + np.cumsum(random.normal(size=(length, 3)) * 0.1, axis=0))
    limbs, who = random.integers(0, 4, clips), random.integers(0, actors, clips)
    return SearchTable(np.concatenate(rows), counts, np.concatenate(paths), lengths, who, limbs)


def made_query(seed: int, table: SearchTable, actors: int = 3) -> PoseQuery:
    random = np.random.default_rng(seed)
    near = np.asarray(table.rows[random.integers(0, len(table.rows), actors)])
    rows = (near + random.normal(size=near.shape) * random.choice([0.0, 0.01, 0.2])).astype(np.float32)
    rows[:, at.SQUARE] = np.square(rows[:, : at.SQUARE], dtype=np.float64).sum(axis=1)
    weights = random.choice([0.0, 0.1, 1.0, 30.0], 2)
    return PoseQuery(rows, random.normal(size=(actors, 4, 3)), *(float(weight) for weight in weights))


TABLES = [made_table(seed) for seed in range(4)]


@given(st.integers(0, 3), st.integers(0, 2**31), st.integers(1, 14))
def test_the_answer_is_that_of_trying_every_frame(which, seed, count):
    table = TABLES[which]
    for query_seed in range(seed, seed + 25):
        query = made_query(query_seed, table)
        allowed = np.random.default_rng(query_seed).random(table.clip_count) < 0.8
        found, tried = search(table, query, count, allowed), brute_force(table, query, count, allowed)
        assert [each.cost for each in found] == pytest.approx(
            [each.cost for each in tried], abs=3e-6
        )  # a root of what rounding leaves, times 30
        for one, other in zip(found, tried, strict=True):
            if one.clip == other.clip and one.frame == other.frame:
                assert (one.posture, one.reach) == pytest.approx((other.posture, other.reach), abs=1e-6)


@given(st.integers(0, 2**31))
def test_poses_turned_and_shifted_are_the_same_pose(seed):
    random = np.random.default_rng(seed)
    body = random.normal(size=(1, LAYOUT.point_count, 3))
    angle = random.uniform(-3.0, 3.0)
    c, s = np.cos(angle), np.sin(angle)
    moved = body @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T + [*random.normal(size=2), 0.0]
    distance, turn = pose_distances(pose_rows(moved, LAYOUT)[0], pose_rows(body, LAYOUT))
    assert distance[0] < 2e-3
    assert np.cos(turn[0] - angle) == pytest.approx(1.0, abs=1e-5)


@given(st.integers(0, 2**31))
def test_the_distance_is_the_least_over_all_turns_and_shifts(seed):
    random = np.random.default_rng(seed)
    one, other = random.normal(size=(2, 1, LAYOUT.point_count, 3))
    distance, _ = pose_distances(pose_rows(one, LAYOUT)[0], pose_rows(other, LAYOUT))
    points = compared_points(LAYOUT)
    assert distance[0] == pytest.approx(kovar_distance(one[0, points], other[0, points]), abs=1e-4)


@given(st.integers(0, 2**31))
def test_the_distance_keeps_the_triangle_inequality(seed):
    bodies = np.random.default_rng(seed).normal(size=(3, LAYOUT.point_count, 3))
    rows = pose_rows(bodies, LAYOUT)
    (_, ab, ac), (_, _, bc) = (pose_distances(rows[k], rows)[0] for k in (0, 1))
    assert ac <= ab + bc + 1e-6


def test_a_table_of_nothing_finds_nothing():
    none = np.empty(0, dtype=np.int64)
    table = SearchTable(np.empty((0, at.POSE_WIDTH), np.float32), none, np.empty((0, 3)), none, none, none)
    assert search(table, PoseQuery(np.zeros((1, at.POSE_WIDTH), np.float32), np.zeros((1, 4, 3)))) == []


def test_clips_that_are_not_allowed_are_never_found():
    table = TABLES[0]
    allowed = np.arange(table.clip_count) == 5
    assert [each.clip for each in search(table, made_query(1, table), 8, allowed)] == [5]


def test_no_frame_costs_less_than_the_bound_of_its_block():
    for table in TABLES:
        blocks, query = table.blocks, made_query(7, table)
        bounds, every = np.empty(len(blocks.spans)), np.ones(table.clip_count, dtype=np.bool_)
        asked = at.SearchQuery(query.poses, query.targets, query.posture_weight, query.reach_weight)
        at.write_block_cost_bounds(table.frame_table, every, asked, bounds)
        for (clip, first, count), bound in zip(blocks.spans, bounds, strict=True):
            part = SearchTable(
                table.rows[first : first + count],
                np.array([count]),
                *(table.paths[slice(*np.cumsum(table.clips[clip, 2:]))], table.clips[clip, 3:]),
                *(table.actors[clip, None], table.limbs[clip, None]),
            )
            assert brute_force(part, query, 1, every)[0].cost >= bound - 1e-9
