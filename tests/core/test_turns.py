"""Turns as tuples against scipy and numpy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.kernels.algebra import rotation_tuples as kernel
from studio.core.rotations import frame_along
from tests.core.motions import random_rotations
from tests.core.twins import rotation as twin

seeds = st.integers(0, 2**32 - 1)


def _matrix(turn: tuple[float, ...]) -> np.ndarray:
    matrix = np.empty((3, 3))
    kernel.write_rotation(turn, matrix)
    return matrix


def _unit(random: np.random.Generator, count: int = 3) -> np.ndarray:
    vector = random.normal(size=count)
    return vector / np.linalg.norm(vector)


@given(seeds)
def test_turns_of_quaternions_are_scipys(seed: int) -> None:
    quaternions = np.concatenate([[9.0, 9.0], _unit(np.random.default_rng(seed), 4)])
    assert np.allclose(
        _matrix(kernel.rotation_from_quaternion(quaternions, 2)), twin.from_quaternion(quaternions[2:]), atol=1e-14
    )


@given(seeds)
def test_products_are_numpys(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second = random.normal(size=(2, 3, 3))
    a, b = kernel.rotation_from_matrix(first), kernel.rotation_from_matrix(second)
    assert np.allclose(_matrix(kernel.compose(a, b)), first @ second, atol=1e-13)
    assert np.array_equal(_matrix(kernel.inverse_rotation(a)), first.T)
    origin, vector, point = *random.normal(size=(2, 3)), np.empty(3)
    assert np.array_equal(kernel.write_transformed_point(origin, a, *vector, point), point)
    assert np.allclose(point, origin + first @ vector, atol=1e-13)


@given(st.floats(-1e7, 1e7))
def test_sine_and_cosine_are_numpys(angle: float) -> None:
    assert np.allclose(kernel.sine_and_cosine(angle), (np.sin(angle), np.cos(angle)), rtol=0.0, atol=3e-16)


@given(seeds, st.floats(-10, 10))
def test_twisting_is_turning_about_the_own_z_axis(seed: int, angle: float) -> None:
    matrix = random_rotations(np.random.default_rng(seed))
    twisted = _matrix(kernel.twist_about_z(kernel.rotation_from_matrix(matrix), angle))
    assert np.allclose(twisted, matrix @ twin.about_z(angle), atol=1e-14)


@given(seeds, st.floats(-15, 0))
def test_aiming_is_the_shortest_arc_of_the_z_axis_and_always_a_rotation(seed: int, nearness: float) -> None:
    random = np.random.default_rng(seed)
    matrix = random_rotations(random)
    for centre in (np.zeros(3), matrix[:, 2], -matrix[:, 2]):
        aim = centre + 10.0**nearness * _unit(random)
        aim /= np.linalg.norm(aim)
        aimed = _matrix(kernel.aim_z_axis(kernel.rotation_from_matrix(matrix), *aim))
        assert np.allclose(aimed[:, 2], aim, atol=1e-15)
        assert np.allclose(aimed.T @ aimed, np.eye(3), atol=1e-9)
        assert np.linalg.det(aimed) == pytest.approx(1.0)
        if aim @ matrix[:, 2] > -0.99:
            assert np.allclose(aimed, twin.shortest_arc(matrix[:, 2], aim) @ matrix, atol=1e-9)


@given(seeds)
def test_the_shortest_turn_is_about_the_common_perpendicular(seed: int) -> None:
    random = np.random.default_rng(seed)
    start, end = _unit(random), _unit(random)
    matrix = _matrix(kernel.shortest_rotation(*start, *end))
    assert np.allclose(matrix, twin.shortest_arc(start, end), atol=1e-9)
    assert np.allclose(matrix @ start, end, atol=1e-12)


@pytest.mark.parametrize("start", [*np.eye(3), *-np.eye(3), [0.6, 0.0, -0.8], [0.0, 0.1, 0.99498743710662]])
def test_opposite_directions_are_half_a_turn_apart(start: np.ndarray) -> None:
    matrix = _matrix(kernel.shortest_rotation(*start, *-np.asarray(start)))
    assert np.allclose(matrix @ start, -np.asarray(start))
    assert np.allclose(matrix @ matrix.T, np.eye(3))
    assert np.linalg.det(matrix) == pytest.approx(1.0)


@given(seeds, st.floats(-4, 4))
def test_turns_by_a_vector_and_about_an_axis_are_scipys(seed: int, angle: float) -> None:
    axis = _unit(np.random.default_rng(seed))
    expected = twin.from_vector(angle * axis)
    assert np.allclose(_matrix(kernel.rotation_from_vector(*(angle * axis))), expected, atol=1e-14)
    assert np.allclose(_matrix(kernel.rotation_about_axis(axis, np.cos(angle), np.sin(angle))), expected, atol=1e-14)


@given(seeds)
def test_a_turn_along_a_line_keeps_x_as_near_to_world_x_as_it_can(seed: int) -> None:
    bone = _unit(np.random.default_rng(seed))
    assert np.allclose(
        _matrix(kernel.rotation_with_z_axis(*bone)), frame_along(bone, np.array([1.0, 0.0, 0.0])), atol=1e-9
    )


@pytest.mark.parametrize("bone", [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
def test_a_turn_along_world_x_is_a_rotation(bone: list[float]) -> None:
    matrix = _matrix(kernel.rotation_with_z_axis(*bone))
    assert np.allclose(matrix @ matrix.T, np.eye(3))
    assert np.allclose(matrix[:, 2], bone)
