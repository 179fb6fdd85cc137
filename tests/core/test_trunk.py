"""The trunk step: levers against brute force, and what one step does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.kernels import trunk as kernel
from studio.core.normalized.realize import realize
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.core.twins import body as body_twin
from tests.core.twins import trunk as twin

seeds = st.integers(0, 2**32 - 1)
BODY = make_morphology(spine_count=4)
LAYOUT, K = BODY.layout, BODY.layout.spine_count
POSITIONS, ROTATIONS = (array[11] for array in realize(walk(20)[0], BODY))
CARRIERS = {
    **{k: (k, k) for k in range(K)},
    K: (K + 2, LAYOUT.collar(0) + 1),
    K + 1: (K + 6, LAYOUT.collar(1) + 1),
    K + 2: (K, LAYOUT.head_joint),
    K + 3: (K + 1, LAYOUT.head_end),
}
"""For each carrier that is not a leg, its segment and a point that goes with it."""


@given(seeds, st.integers(1, 12))
@settings(max_examples=40)
def test_elimination_solves_what_can_be_solved(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    factor = random.normal(size=(count, count))
    matrix, right = factor @ factor.T + count * np.eye(count), random.normal(size=count)
    work = np.column_stack([matrix, right])
    assert kernel.eliminate(work, count, 0.0)
    assert np.allclose(work[:, -1], np.linalg.solve(matrix, right), atol=1e-6)


def test_a_row_that_asks_what_a_higher_one_has_settled_gives_in() -> None:
    work = np.array([[1.0, 1.0, 0.5], [1.0, 1.0, -0.3]])
    assert kernel.eliminate(work, 2, 0.0)
    assert np.allclose([[1.0, 1.0]] @ work[:, -1], [0.5], atol=1e-6)
    assert np.isfinite(work).all()


def test_nothing_movable_is_said_to_be_so() -> None:
    assert not kernel.eliminate(np.zeros((3, 4)), 3, 0.1)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_a_joint_carries_what_hangs_on_it(carrier: int) -> None:
    segment, _ = CARRIERS[carrier]
    for joint, turned in enumerate(twin.joints(LAYOUT), 1):
        assert kernel.pivot_of(joint, K) == (LAYOUT.proximal_points()[turned], turned)
        expected = twin.carries(LAYOUT, turned, segment)
        assert kernel.carries(joint, carrier, K) == expected
    assert not any(kernel.carries(joint, K + 4, K) for joint in range(K + 4))


class _Step:
    """Rows of a few constraints on random carriers with random chains."""

    def __init__(self, seed: int, count: int = 3) -> None:
        random = np.random.default_rng(seed)
        carriers = random.choice(np.array(list(CARRIERS)), size=count)
        self.points = [CARRIERS[int(carrier)][1] for carrier in carriers]
        directions = random.normal(size=(count, 3))
        self.directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        self.rows = np.column_stack([POSITIONS[self.points], self.directions, random.uniform(-0.02, 0.02, count)])
        self.codes = np.stack([np.arange(count), carriers], axis=1)
        self.chains = random.uniform(0.2, 1.0, (count, 5))
        self.positions, self.rotations = POSITIONS.copy(), ROTATIONS.copy()
        self.turned = np.zeros((K + 4, 3))

    def take(self, damping: float = 0.0) -> bool:
        count = len(self.rows)
        return kernel.trunk_step(
            self.rows, self.codes, count, self.chains, damping, np.empty((count, count + 1)), self.turned,
            np.empty((3, 3)), (self.positions, self.rotations),
        )  # fmt: skip

    @property
    def gained(self) -> np.ndarray:
        """How far each point has gone along its direction."""
        return np.sum((self.positions[self.points] - POSITIONS[self.points]) * self.directions, axis=1)


@given(seeds)
@settings(max_examples=25)
def test_how_constraints_move_each_other_is_what_small_turns_show(seed: int) -> None:
    step = _Step(seed)
    for j in range(3):
        for i in range(3):
            found = kernel.coupling(step.rows, step.codes, j, i, step.chains, K, POSITIONS)
            pair = (step.points[j], step.points[i]), step.directions[[j, i]]
            assert found == pytest.approx(twin.coupling(LAYOUT, *pair, step.chains[i], POSITIONS, ROTATIONS), abs=1e-4)


@given(seeds)
@settings(max_examples=25)
def test_one_step_for_one_constraint_closes_nearly_all_of_a_small_error(seed: int) -> None:
    step = _Step(seed, count=1)
    step.chains[:] = 1.0
    step.take()
    assert step.gained == pytest.approx(step.rows[:, 6], abs=0.1 * abs(step.rows[0, 6]) + 1e-4)


@given(seeds)
@settings(max_examples=25)
def test_a_step_keeps_every_bone_of_the_trunk_and_the_arms(seed: int) -> None:
    step = _Step(seed)
    step.take(0.01)
    assert np.allclose(
        body_twin.bone_lengths(LAYOUT, step.positions), body_twin.bone_lengths(LAYOUT, POSITIONS), atol=1e-12
    )


@given(seeds)
@settings(max_examples=25)
def test_more_damping_makes_a_shorter_step(seed: int) -> None:
    moved = []
    for damping in (0.0, 0.1, 10.0):
        step = _Step(seed, count=1)
        step.take(damping)
        moved.append(np.linalg.norm(step.positions - POSITIONS))
    assert moved[0] >= moved[1] >= moved[2]


@given(seeds)
@settings(max_examples=25)
def test_joints_never_turn_beyond_their_limits(seed: int) -> None:
    step = _Step(seed)
    step.rows[:, 6] *= 50
    for _ in range(20):
        step.take()
    turned = np.linalg.norm(step.turned, axis=1)
    assert turned[:K].max() <= kernel.VERTEBRA_LIMIT + 1e-9
    assert turned[K:].max() <= kernel.CLAVICLE_LIMIT + 1e-9
    assert turned[0] == 0.0


def test_parts_of_weight_0_do_not_turn() -> None:
    step = _Step(4)
    step.chains[:] = [0.0, 0.0, 0.0, 0.0, 1.0]
    assert step.take()
    assert np.array_equal(step.rotations, ROTATIONS)
    assert not np.array_equal(step.positions, POSITIONS)
    step.chains[:] = 0.0
    before = step.positions.copy()
    assert not step.take()
    assert np.array_equal(step.positions, before)
