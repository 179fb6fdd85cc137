"""One step of all joints: levers against brute force, elimination in order, limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.constraints.base import Chain
from studio.core.kernels.records import Pose
from studio.core.kernels.search.joints import (
    ROOT_TRANSLATION,
    add_point_jacobian,
    pose_arm,
    pose_trunk,
    update_joint_damping,
)
from studio.core.kernels.search.null_space_step import eliminate, move_joints, null_space_step
from studio.core.kernels.solve_clip import make_search
from studio.core.kernels.tasks.second_order import EQUALITY_ROW, OBJECTIVE_ROW
from studio.core.normalized.realize import realize_motion
from studio.core.solver.asking.chains import CLAVICLE_LIMIT, VERTEBRA_LIMIT, joints_of_chains
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.core.twins import body as body_twin
from tests.core.twins.levers import lever

seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
LAYOUT, K = BODY.layout, BODY.layout.spine_count
POSITIONS, ROTATIONS = (array[11] for array in realize_motion(walk(20)[0], BODY))
ENDS = {2: 3, K - 1: K, K: K + 1, K + 1: K + 2, K + 2: LAYOUT.collar_point(0) + 1, K + 6: LAYOUT.collar_point(1) + 1}
"""Segments of the trunk, each with a point that goes with it."""


@given(seeds, st.integers(1, 8), st.integers(1, 4))
@settings(max_examples=40)
def test_elimination_solves_what_can_be_solved(seed: int, count: int, sides: int) -> None:
    random = np.random.default_rng(seed)
    factor = random.normal(size=(count, count))
    matrix, right = factor @ factor.T + count * np.eye(count), random.normal(size=(count, sides))
    work = np.column_stack([matrix, right, np.diag(matrix)])
    eliminate(work, count, count + sides)
    assert np.allclose(work[:, count:-1], np.linalg.solve(matrix, right), atol=1e-3)


def test_a_held_row_that_says_what_a_higher_one_has_settled_gives_in() -> None:
    work = np.array([[1.0, 1.0, 0.5, 1.0], [1.0, 1.0, -0.3, 1.0]])
    eliminate(work, 2, 3)
    assert np.allclose([1.0, 1.0] @ work[:, 2], 0.5, atol=1e-4)
    assert np.isfinite(work).all()


@pytest.mark.parametrize("segment", ENDS)
def test_levers_are_what_small_turns_show(segment: int) -> None:
    free = joints_of_chains((Chain(1.0, 1.0, 1.0, 1.0, 1.0),), (0,), LAYOUT)
    direction = np.array([0.36, -0.48, 0.8])
    row, point = np.zeros((len(free.joints), 3)), ENDS[segment]
    add_point_jacobian(POSITIONS[point], *direction, segment, free.joints, POSITIONS, row)
    for joint, found in zip(free.joints, row, strict=True):
        if joint[0] == ROOT_TRANSLATION:
            assert found == pytest.approx(direction)
        else:
            expected = lever(LAYOUT, int(joint[0]), point, direction, POSITIONS, ROTATIONS)
            assert found == pytest.approx(expected, abs=1e-5)


class _Search:
    """Points of random segments of the trunk that are to go a little way, each along its direction; no feet."""

    def __init__(self, seed: int, count: int = 2, held: int = 0, chain: Chain | None = None) -> None:
        random = np.random.default_rng(seed)
        chain = chain or Chain(1.0, 1.0, 1.0, 1.0, 0.5)
        self.held, self.count = held, count + held
        self.free = joints_of_chains((chain,) * self.count, (0,) * self.count, LAYOUT)
        segments = random.choice(np.array(list(ENDS)), size=self.count, replace=False)
        self.segments = [int(segment) for segment in segments]
        self.points = [ENDS[segment] for segment in self.segments]
        directions = random.normal(size=(self.count, 3))
        self.directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        self.goals = np.where(np.arange(self.count) < held, 0.0, random.uniform(-0.01, 0.01, self.count))
        self.pose = Pose(POSITIONS.copy(), ROTATIONS.copy())
        self.search = make_search(self.count, len(self.free.joints), len(POSITIONS))

    def step(self) -> float:
        """Ask for what is left of the goals; how far anything moves."""
        search, chain, rows = self.search, self.free.kernel_weights, self.search.rows
        rows.jacobian[:], rows.errors[: self.count] = 0.0, self.goals - self.gained
        for row, (segment, point) in enumerate(zip(self.segments, self.points, strict=True)):
            rows.weight_rows[row], rows.roles[row], rows.point_errors["segment"][row] = (
                row,
                EQUALITY_ROW if row < self.held else OBJECTIVE_ROW,
                -1,
            )
            place, jacobian = self.pose.positions[point], rows.jacobian[row]
            add_point_jacobian(place, *self.directions[row], segment, chain.joints, self.pose.positions, jacobian)
        update_joint_damping(search.state, chain.joints, chain.limits, search.segment_rotations, rows.damping)
        null_space_step(self.held, self.count, 1.0, rows, chain, search.equations, self.pose.positions)
        steps, start = search.equations.directions, Pose(POSITIONS, ROTATIONS)
        moved = move_joints(0.0, chain, search.segment_rotations, steps[-2] + steps[-1], search.state)
        pose_trunk(search.state, chain.joint_of_segment, start, search.segment_rotations, self.pose)
        for side in range(2):
            pose_arm(side, search.state, chain.joint_of_segment, start, search.segment_rotations, self.pose)
        return float(moved)

    @property
    def gained(self) -> np.ndarray:
        """Displacement of each point along its direction."""
        return np.sum((self.pose.positions[self.points] - POSITIONS[self.points]) * self.directions, axis=1)


@given(seeds)
@settings(max_examples=25, deadline=None)
def test_steps_for_one_constraint_close_a_small_error(seed: int) -> None:
    search = _Search(seed, count=1)
    for _ in range(5):
        search.step()
    assert search.gained == pytest.approx(search.goals, abs=1e-4)


@given(seeds)
@settings(max_examples=25, deadline=None)
def test_what_is_held_stays_while_others_ask(seed: int) -> None:
    search = _Search(seed, count=2, held=1)
    for _ in range(8):
        search.step()
    assert abs(search.gained[0]) < 2e-4


@given(seeds)
@settings(max_examples=25, deadline=None)
def test_a_step_keeps_every_bone_of_the_trunk_and_the_arms(seed: int) -> None:
    search = _Search(seed)
    search.step()
    lengths = [body_twin.bone_lengths(LAYOUT, points)[: K + 10] for points in (search.pose.positions, POSITIONS)]
    assert np.allclose(*lengths, atol=1e-12)


@given(seeds)
@settings(max_examples=25, deadline=None)
def test_joints_never_turn_beyond_their_limits(seed: int) -> None:
    search = _Search(seed)
    search.goals *= 50
    for _ in range(20):
        search.step()
    turned = 2.0 * np.arctan(np.linalg.norm(search.search.state, axis=1))
    segments = search.free.joints["segment"]
    assert turned[(segments > 0) & (segments < K)].max() <= VERTEBRA_LIMIT + 1e-9
    assert turned[(segments == K + 2) | (segments == K + 6)].max() <= CLAVICLE_LIMIT + 1e-9


def test_only_the_root_moves_where_only_the_root_is_free() -> None:
    search = _Search(4, chain=Chain(0.0, 0.0, 0.0, 0.0, 1.0))
    assert search.step() > 0.0
    assert np.allclose(search.pose.rotations[: K + 10], ROTATIONS[: K + 10], atol=1e-12)
    assert not np.allclose(search.pose.positions[: K + 3], POSITIONS[: K + 3], atol=1e-6)
