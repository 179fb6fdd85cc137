"""The rotation algebra of the kernels against scipy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.kernels.algebra import rotation_matrices as kernel
from studio.core.kernels.algebra import rotation_tuples
from tests.core.twins import rotation as twin

seeds = st.integers(0, 2**32 - 1)


def _unit(random: np.random.Generator) -> np.ndarray:
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


@given(seeds)
def test_matrices_of_rotation_vectors_are_scipys(seed: int) -> None:
    random, matrix = np.random.default_rng(seed), np.empty((3, 3))
    vector = random.normal(size=3) * 10.0 ** random.uniform(-12, 1)
    kernel.rotation_vector_to_matrix(*vector, matrix)
    assert np.allclose(matrix, twin.from_vector(vector), atol=1e-14)


@given(seeds)
def test_products_are_numpys(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second, out = *random.normal(size=(2, 3, 3)), np.empty((3, 3))
    kernel.matrix_product(first, second, out)
    assert np.allclose(out, first @ second, atol=1e-13)
    origin, vector = random.normal(size=(2, 3))
    assert np.allclose(
        rotation_tuples.transform_point(origin, tuple(first.flat), *vector), origin + first @ vector, atol=1e-13
    )


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
