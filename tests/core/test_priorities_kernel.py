"""One step of all joints: levers against brute force, elimination in order, limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.constraints.base import Chain
from studio.core.kernels.joints import ROOT, add_point_row
from studio.core.kernels.priorities import eliminate, take_step
from studio.core.normalized.realize import realize
from studio.core.solver.chains import CLAVICLE_LIMIT, VERTEBRA_LIMIT, free_joints
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.core.twins import body as body_twin
from tests.core.twins.levers import lever

seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
LAYOUT, K = BODY.layout, BODY.layout.spine_count
POSITIONS, ROTATIONS = (array[11] for array in realize(walk(20)[0], BODY))
ENDS = {2: 3, K - 1: K, K: K + 1, K + 1: K + 2, K + 2: LAYOUT.collar(0) + 1, K + 6: LAYOUT.collar(1) + 1}
"""Segments of the trunk, each with a point that goes with it."""


@given(seeds, st.integers(1, 12))
@settings(max_examples=40)
def test_elimination_solves_what_can_be_solved(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    factor = random.normal(size=(count, count))
    matrix, right = factor @ factor.T + count * np.eye(count), random.normal(size=count)
    work = np.column_stack([matrix, right])
    eliminate(work, 0, count, 0.0)
    assert np.allclose(work[:, -1], np.linalg.solve(matrix, right), atol=1e-6)


def test_a_row_that_asks_what_a_higher_one_has_settled_gives_in() -> None:
    work = np.array([[1.0, 1.0, 0.5], [1.0, 1.0, -0.3]])
    eliminate(work, 1, 2, 0.0)
    assert np.allclose([[1.0, 1.0]] @ work[:, -1], [0.5], atol=1e-6)
    assert np.isfinite(work).all()


@pytest.mark.parametrize("segment", ENDS)
def test_levers_are_what_small_turns_show(segment: int) -> None:
    free = free_joints([Chain(1.0, 1.0, 1.0, 1.0, 1.0)], LAYOUT)
    direction = np.array([0.36, -0.48, 0.8])
    row, point = np.zeros((len(free.joints), 3)), ENDS[segment]
    add_point_row(POSITIONS[point], *direction, segment, free.joints, POSITIONS, row)
    for joint, found in zip(free.joints, row, strict=True):
        if joint[0] == ROOT:
            assert found == pytest.approx(direction)
        else:
            expected = lever(LAYOUT, int(joint[0]), point, direction, POSITIONS, ROTATIONS)
            assert found == pytest.approx(expected, abs=1e-5)


class _Step:
    """Rows of a few constraints on random segments of the trunk."""

    def __init__(self, seed: int, count: int = 3, chain: Chain | None = None) -> None:
        random = np.random.default_rng(seed)
        self.free = free_joints([chain or Chain(1.0, 1.0, 1.0, 1.0, 0.5)] * count, LAYOUT)
        segments = random.choice(np.array(list(ENDS)), size=count)
        self.points = [ENDS[int(segment)] for segment in segments]
        directions = random.normal(size=(count, 3))
        self.directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        self.rows, self.errors = np.zeros((count, len(self.free.joints), 3)), random.uniform(-0.02, 0.02, count)
        for row, segment, point, direction in zip(self.rows, segments, self.points, self.directions, strict=True):
            add_point_row(POSITIONS[point], *direction, segment, self.free.joints, POSITIONS, row)
        self.pose = POSITIONS.copy(), ROTATIONS.copy()
        self.turned = np.zeros((len(self.free.joints), 3))

    def take(self, damping: float = 0.0) -> bool:
        count = len(self.rows)
        scratch = np.empty((count, count + 1)), np.empty((3, 3))
        return take_step(
            self.rows, self.errors, np.arange(count), 0, count, self.free.mobilities, self.free.joints, damping,
            self.free.limits, self.turned, scratch, self.pose,
        )  # fmt: skip

    @property
    def gained(self) -> np.ndarray:
        """How far each point has gone along its direction."""
        return np.sum((self.pose[0][self.points] - POSITIONS[self.points]) * self.directions, axis=1)


@given(seeds)
@settings(max_examples=25)
def test_one_step_for_one_constraint_closes_nearly_all_of_a_small_error(seed: int) -> None:
    step = _Step(seed, count=1)
    step.take()
    assert step.gained == pytest.approx(step.errors, abs=0.1 * abs(step.errors[0]) + 1e-4)


@given(seeds)
@settings(max_examples=25)
def test_a_step_keeps_every_bone_of_the_trunk_and_the_arms(seed: int) -> None:
    step = _Step(seed)
    step.take(0.01)
    assert np.allclose(
        body_twin.bone_lengths(LAYOUT, step.pose[0]), body_twin.bone_lengths(LAYOUT, POSITIONS), atol=1e-12
    )


@given(seeds)
@settings(max_examples=25)
def test_more_damping_makes_a_shorter_step(seed: int) -> None:
    moved = []
    for damping in (0.0, 0.1, 10.0):
        step = _Step(seed, count=1)
        step.take(damping)
        moved.append(np.linalg.norm(step.pose[0] - POSITIONS))
    assert moved[0] >= moved[1] >= moved[2]


@given(seeds)
@settings(max_examples=25)
def test_joints_never_turn_beyond_their_limits(seed: int) -> None:
    step = _Step(seed)
    step.errors *= 50
    for _ in range(20):
        step.take()
    turned = np.linalg.norm(step.turned, axis=1)
    segments = step.free.joints[:, 0]
    assert turned[(segments > 0) & (segments < K)].max() <= VERTEBRA_LIMIT + 1e-9
    assert turned[(segments == K + 2) | (segments == K + 6)].max() <= CLAVICLE_LIMIT + 1e-9


def test_only_the_root_moves_where_only_the_root_is_free() -> None:
    step = _Step(4, chain=Chain(0.0, 0.0, 0.0, 0.0, 1.0))
    assert step.take()
    assert np.array_equal(step.pose[1], ROTATIONS)
    assert not np.array_equal(step.pose[0], POSITIONS)
