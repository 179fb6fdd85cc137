"""Rotations: laws of whole arrays, kernels and tuples, against scipy and numpy."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from studio.core import rotations
from studio.core.kernels.algebra import rotation_matrices, rotation_tuples
from studio.core.rotations import frame_along
from tests.core.motions import random_rotations
from tests.core.twins import rotation as twin

# Laws of rotations.


ORDERS = ["".join(axes) for axes in permutations("XYZ")]
angles = arrays(np.float64, (5, 3), elements=st.floats(-np.pi, np.pi))
vectors = arrays(np.float64, 3, elements=st.floats(-10, 10)).filter(lambda v: np.linalg.norm(v) > 1e-3)
quaternions = arrays(np.float64, (7, 4), elements=st.floats(-1, 1)).filter(
    lambda q: (np.linalg.norm(q, axis=1) > 0.1).all()
)


def _axis_matrix(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return {
        "X": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "Y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "Z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


@pytest.mark.parametrize("order", [*ORDERS, "X", "ZY"])
def test_euler_angles_multiply_in_the_order_they_are_named(order: str) -> None:
    chosen = np.array([0.3, -1.1, 2.0])[: len(order)]
    product = np.eye(3)
    for axis, angle in zip(order, chosen, strict=True):
        product = product @ _axis_matrix(axis, angle)
    assert np.allclose(rotations.to_matrix(rotations.from_euler(order, chosen)), product)


@pytest.mark.parametrize("order", ORDERS)
@given(angles=angles)
def test_euler_angles_come_back_as_the_same_rotation(order: str, angles: np.ndarray) -> None:
    turned = rotations.from_euler(order, angles)
    again = rotations.from_euler(order, rotations.to_euler(order, turned))
    assert rotations.angle_between(turned, again).max() < 1e-7


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [-np.pi / 2, np.pi / 2])
def test_gimbal_lock_loses_no_rotation(order: str, middle: float) -> None:
    turned = rotations.from_euler(order, np.array([[0.7, middle, -0.4]]))
    again = rotations.from_euler(order, rotations.to_euler(order, turned))
    assert rotations.angle_between(turned, again).max() < 1e-7


@given(quaternions)
def test_matrices_and_quaternions_say_the_same(raw: np.ndarray) -> None:
    unit = rotations.normalized(raw)
    again = rotations.from_matrix(rotations.to_matrix(unit))
    assert rotations.angle_between(unit, again).max() < 1e-7


@given(quaternions, quaternions, vectors)
def test_a_product_turns_by_the_second_first(first: np.ndarray, second: np.ndarray, vector: np.ndarray) -> None:
    first, second = rotations.normalized(first), rotations.normalized(second)
    one_by_one = rotations.rotate(first, rotations.rotate(second, vector))
    assert np.allclose(rotations.rotate(rotations.multiply(first, second), vector), one_by_one, atol=1e-9)
    assert np.allclose(rotations.to_matrix(second) @ vector, rotations.rotate(second, vector), atol=1e-9)


@given(quaternions)
def test_a_rotation_and_its_inverse_cancel(raw: np.ndarray) -> None:
    unit = rotations.normalized(raw)
    identity = rotations.multiply(unit, rotations.inverse(unit))
    assert rotations.angle_between(identity, rotations.IDENTITY_QUATERNION).max() < 1e-9


@given(quaternions)
def test_continuous_signs_keep_the_rotation_and_never_jump(raw: np.ndarray) -> None:
    unit = rotations.normalized(raw)
    smooth = rotations.sign_continuous(unit)
    assert rotations.angle_between(unit, smooth).max() < 1e-7
    assert (np.sum(smooth[1:] * smooth[:-1], axis=-1) >= 0).all()


@given(vectors, vectors)
@example(np.array([1.0, 1e-5, 1e-5]), np.array([-1.0, 0.0, 0.0]))
def test_the_shortest_arc_reaches_the_end_without_detour(start: np.ndarray, end: np.ndarray) -> None:
    start, end = rotations.normalized(start), rotations.normalized(end)
    arc = rotations.shortest_arc(start, end)
    assert np.allclose(arc @ start, end, atol=1e-6)
    assert np.allclose(arc @ arc.T, np.eye(3), atol=1e-9)
    turn = np.arccos(np.clip((np.trace(arc) - 1) / 2, -1, 1))
    assert turn == pytest.approx(np.arccos(np.clip(start @ end, -1, 1)), abs=1e-5)


@pytest.mark.parametrize("axis", np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.0, 0.8]]]))
def test_opposite_vectors_are_half_a_turn_apart(axis: np.ndarray) -> None:
    arc = rotations.shortest_arc(axis, -axis)
    assert np.allclose(arc @ axis, -axis)
    assert np.isclose(np.linalg.det(arc), 1.0)


@given(quaternions, quaternions, st.floats(0, 1))
def test_slerp_goes_the_share_of_the_way(first: np.ndarray, second: np.ndarray, share: float) -> None:
    first, second = rotations.normalized(first), rotations.normalized(second)
    between = rotations.slerp(first, second, share)
    whole = rotations.angle_between(first, second)
    assert np.allclose(rotations.angle_between(first, between), share * whole, atol=1e-6)


def test_the_angle_between_neighbours_is_exact_for_tiny_turns() -> None:
    tiny = rotations.from_euler("X", np.array([1e-9]))
    assert rotations.angle_between(rotations.IDENTITY_QUATERNION, tiny) == pytest.approx(1e-9)


@given(st.integers(0, 10_000))
@example(2837)  # a sheared matrix whose quaternion has the length of a rotation's
def test_a_matrix_gives_the_quaternion_that_scipy_gives(seed):
    """Half turns about every axis too, where the largest component changes; a sheared matrix gives the nearest one."""
    generator = np.random.default_rng(seed)
    axes = np.concatenate([np.eye(3), generator.normal(size=(5, 3))])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = np.concatenate([np.full(3, np.pi), generator.uniform(-np.pi, np.pi, 5)])
    matrices = Rotation.from_rotvec(axes * angles[:, None]).as_matrix()
    for given_ in (matrices, matrices + 1e-3 * generator.normal(size=(8, 3, 3))):
        between = rotations.angle_between(rotations.from_matrix(given_), Rotation.from_matrix(given_).as_quat())
        assert between.max() < 1e-9


def test_no_matrices_give_no_quaternions():
    assert rotations.from_matrix(np.empty((0, 3, 3))).shape == (0, 4)


# The rotation algebra of the kernels against scipy.


seeds = st.integers(0, 2**32 - 1)


def _unit(random: np.random.Generator) -> np.ndarray:
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


@given(seeds)
def test_matrices_of_rotation_vectors_are_scipys(seed: int) -> None:
    random, matrix = np.random.default_rng(seed), np.empty((3, 3))
    vector = random.normal(size=3) * 10.0 ** random.uniform(-12, 1)
    rotation_matrices.rotation_vector_to_matrix(*vector, matrix)
    assert np.allclose(matrix, twin.from_vector(vector), atol=1e-14)


@given(seeds)
def test_products_are_numpys(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second, out = *random.normal(size=(2, 3, 3)), np.empty((3, 3))
    rotation_matrices.matrix_product(first, second, out)
    assert np.allclose(out, first @ second, atol=1e-13)
    origin, vector = random.normal(size=(2, 3))
    assert np.allclose(
        rotation_tuples.transform_point(origin, tuple(first.flat), *vector), origin + first @ vector, atol=1e-13
    )


@given(seeds, st.floats(0, np.pi))
def test_a_rotation_vector_comes_back_from_its_matrix(seed: int, angle: float) -> None:
    axis, matrix, vector = _unit(np.random.default_rng(seed)), np.empty((3, 3)), np.empty(3)
    rotation_matrices.rotation_vector_to_matrix(*(angle * axis), matrix)
    rotation_matrices.matrix_to_rotation_vector(matrix, vector)
    assert np.linalg.norm(vector) == pytest.approx(angle, abs=1e-7)
    assert np.allclose(twin.from_vector(vector), matrix, atol=1e-7)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3), np.full(3, 3**-0.5)])
def test_half_a_turn_has_a_rotation_vector(axis: np.ndarray) -> None:
    matrix, vector = 2 * np.outer(axis, axis) - np.eye(3), np.empty(3)
    rotation_matrices.matrix_to_rotation_vector(matrix, vector)
    assert np.allclose(twin.from_vector(vector), matrix, atol=1e-12)


# Turns as tuples against scipy and numpy.


def _matrix(turn: tuple[float, ...]) -> np.ndarray:
    matrix = np.empty((3, 3))
    rotation_tuples.write_rotation(turn, matrix)
    return matrix


def _units(random: np.random.Generator, count: int = 3) -> np.ndarray:
    vector = random.normal(size=count)
    return vector / np.linalg.norm(vector)


@given(seeds)
def test_turns_of_quaternions_are_scipys(seed: int) -> None:
    quaternions = np.concatenate([[9.0, 9.0], _units(np.random.default_rng(seed), 4)])
    assert np.allclose(
        _matrix(rotation_tuples.rotation_from_quaternion(quaternions, 2)),
        twin.from_quaternion(quaternions[2:]),
        atol=1e-14,
    )


@given(seeds)
def test_products_of_tuples_are_numpys(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second = random.normal(size=(2, 3, 3))
    a, b = rotation_tuples.rotation_from_matrix(first), rotation_tuples.rotation_from_matrix(second)
    assert np.allclose(_matrix(rotation_tuples.compose(a, b)), first @ second, atol=1e-13)
    assert np.array_equal(_matrix(rotation_tuples.inverse_rotation(a)), first.T)
    origin, vector, point = *random.normal(size=(2, 3)), np.empty(3)
    assert np.array_equal(rotation_tuples.write_transformed_point(origin, a, *vector, point), point)
    assert np.allclose(point, origin + first @ vector, atol=1e-13)


@given(st.floats(-1e7, 1e7))
def test_sine_and_cosine_are_numpys(angle: float) -> None:
    assert np.allclose(rotation_tuples.sine_and_cosine(angle), (np.sin(angle), np.cos(angle)), rtol=0.0, atol=3e-16)


@given(seeds, st.floats(-10, 10))
def test_twisting_is_turning_about_the_own_z_axis(seed: int, angle: float) -> None:
    matrix = random_rotations(np.random.default_rng(seed))
    twisted = _matrix(rotation_tuples.twist_about_z(rotation_tuples.rotation_from_matrix(matrix), angle))
    assert np.allclose(twisted, matrix @ twin.about_z(angle), atol=1e-14)


@given(seeds, st.floats(-15, 0))
def test_aiming_is_the_shortest_arc_of_the_z_axis_and_always_a_rotation(seed: int, nearness: float) -> None:
    random = np.random.default_rng(seed)
    matrix = random_rotations(random)
    for centre in (np.zeros(3), matrix[:, 2], -matrix[:, 2]):
        aim = centre + 10.0**nearness * _units(random)
        aim /= np.linalg.norm(aim)
        aimed = _matrix(rotation_tuples.aim_z_axis(rotation_tuples.rotation_from_matrix(matrix), *aim))
        assert np.allclose(aimed[:, 2], aim, atol=1e-15)
        assert np.allclose(aimed.T @ aimed, np.eye(3), atol=1e-9)
        assert np.linalg.det(aimed) == pytest.approx(1.0)
        if aim @ matrix[:, 2] > -0.99:
            assert np.allclose(aimed, twin.shortest_arc(matrix[:, 2], aim) @ matrix, atol=1e-9)


@given(seeds)
def test_the_shortest_turn_is_about_the_common_perpendicular(seed: int) -> None:
    random = np.random.default_rng(seed)
    start, end = _units(random), _units(random)
    matrix = _matrix(rotation_tuples.shortest_rotation(*start, *end))
    assert np.allclose(matrix, twin.shortest_arc(start, end), atol=1e-9)
    assert np.allclose(matrix @ start, end, atol=1e-12)


@pytest.mark.parametrize("start", [*np.eye(3), *-np.eye(3), [0.6, 0.0, -0.8], [0.0, 0.1, 0.99498743710662]])
def test_opposite_directions_are_half_a_turn_apart(start: np.ndarray) -> None:
    matrix = _matrix(rotation_tuples.shortest_rotation(*start, *-np.asarray(start)))
    assert np.allclose(matrix @ start, -np.asarray(start))
    assert np.allclose(matrix @ matrix.T, np.eye(3))
    assert np.linalg.det(matrix) == pytest.approx(1.0)


@given(seeds, st.floats(-4, 4))
def test_turns_by_a_vector_and_about_an_axis_are_scipys(seed: int, angle: float) -> None:
    axis = _units(np.random.default_rng(seed))
    expected = twin.from_vector(angle * axis)
    assert np.allclose(_matrix(rotation_tuples.rotation_from_vector(*(angle * axis))), expected, atol=1e-14)
    assert np.allclose(
        _matrix(rotation_tuples.rotation_about_axis(axis, np.cos(angle), np.sin(angle))), expected, atol=1e-14
    )


@given(seeds)
def test_a_turn_along_a_line_keeps_x_as_near_to_world_x_as_it_can(seed: int) -> None:
    bone = _units(np.random.default_rng(seed))
    assert np.allclose(
        _matrix(rotation_tuples.rotation_with_z_axis(*bone)), frame_along(bone, np.array([1.0, 0.0, 0.0])), atol=1e-9
    )


@pytest.mark.parametrize("bone", [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
def test_a_turn_along_world_x_is_a_rotation(bone: list[float]) -> None:
    matrix = _matrix(rotation_tuples.rotation_with_z_axis(*bone))
    assert np.allclose(matrix @ matrix.T, np.eye(3))
    assert np.allclose(matrix[:, 2], bone)
