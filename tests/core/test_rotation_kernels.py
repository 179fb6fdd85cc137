"""The rotation algebra of the kernels against scipy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.kernels import rotation as kernel
from tests.core.motions import random_rotations
from tests.core.twins import rotation as twin

seeds = st.integers(0, 2**32 - 1)


def _unit(random: np.random.Generator) -> np.ndarray:
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


@given(seeds)
def test_matrices_of_quaternions_and_vectors_are_scipys(seed: int) -> None:
    random, matrix = np.random.default_rng(seed), np.empty((3, 3))
    quaternion, vector = random.normal(size=4), random.normal(size=3) * 10.0 ** random.uniform(-12, 1)
    quaternion /= np.linalg.norm(quaternion)
    kernel.quaternion_to_matrix(quaternion, matrix)
    assert np.allclose(matrix, twin.from_quaternion(quaternion), atol=1e-14)
    kernel.rotation_vector_to_matrix(*vector, matrix)
    assert np.allclose(matrix, twin.from_vector(vector), atol=1e-14)


@given(seeds)
def test_products_are_numpys(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second, out = *random.normal(size=(2, 3, 3)), np.empty((3, 3))
    kernel.multiply(first, second, out)
    assert np.allclose(out, first @ second, atol=1e-13)
    kernel.multiply_transposed(first, second, out)
    assert np.allclose(out, first.T @ second, atol=1e-13)
    origin, vector, point = *random.normal(size=(2, 3)), np.empty(3)
    kernel.add_rotated(origin, first, *vector, point)
    assert np.allclose(point, origin + first @ vector, atol=1e-13)


@given(seeds, st.floats(0, np.pi))
def test_a_rotation_vector_comes_back_from_its_matrix(seed: int, angle: float) -> None:
    axis, matrix, vector = _unit(np.random.default_rng(seed)), np.empty((3, 3)), np.empty(3)
    kernel.rotation_vector_to_matrix(*(angle * axis), matrix)
    kernel.matrix_to_rotation_vector(matrix, vector)
    assert np.linalg.norm(vector) == pytest.approx(angle, abs=1e-7)
    assert np.allclose(twin.from_vector(vector), matrix, atol=1e-7)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), np.full(3, 3**-0.5)])
def test_half_a_turn_has_a_rotation_vector(axis: np.ndarray) -> None:
    matrix, vector = 2 * np.outer(axis, axis) - np.eye(3), np.empty(3)
    kernel.matrix_to_rotation_vector(matrix, vector)
    assert np.allclose(twin.from_vector(vector), matrix, atol=1e-12)


@given(seeds)
def test_the_shortest_arc_is_the_turn_about_the_common_perpendicular(seed: int) -> None:
    random, matrix = np.random.default_rng(seed), np.empty((3, 3))
    start, end = _unit(random), _unit(random)
    kernel.shortest_arc(*start, *end, matrix)
    assert np.allclose(matrix, twin.shortest_arc(start, end), atol=1e-9)
    assert np.allclose(matrix @ start, end, atol=1e-12)


@pytest.mark.parametrize("start", [*np.eye(3), *-np.eye(3), [0.6, 0.0, -0.8], [0.0, 0.1, 0.99498743710662]])
def test_opposite_directions_are_half_a_turn_apart(start: np.ndarray) -> None:
    matrix = np.empty((3, 3))
    kernel.shortest_arc(*start, *-np.asarray(start), matrix)
    assert np.allclose(matrix @ start, -np.asarray(start))
    assert np.allclose(matrix @ matrix.T, np.eye(3))
    assert np.linalg.det(matrix) == pytest.approx(1.0)


@given(seeds, st.floats(-10, 10))
def test_turning_columns_is_turning_about_the_own_z_axis(seed: int, angle: float) -> None:
    matrix = random_rotations(np.random.default_rng(seed))
    expected = matrix @ twin.about_z(angle)
    kernel.turn_columns(matrix, angle)
    assert np.allclose(matrix, expected, atol=1e-14)


@given(seeds)
def test_orthonormalising_keeps_the_direction_of_z_and_the_plane_of_x(seed: int) -> None:
    random = np.random.default_rng(seed)
    rotation = random_rotations(random)
    rough = rotation + 1e-3 * random.normal(size=(3, 3))
    exact = rough.copy()
    kernel.orthonormalize(exact)
    assert np.allclose(exact.T @ exact, np.eye(3), atol=1e-14)
    assert np.linalg.det(exact) == pytest.approx(1.0)
    assert np.allclose(np.cross(exact[:, 2], rough[:, 2]), 0.0, atol=1e-12)
    assert rough[:, 0] @ exact[:, 1] == pytest.approx(0.0, abs=1e-12)
    assert np.allclose(exact, rotation, atol=2e-2)
