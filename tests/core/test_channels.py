"""Channels of a motion file become the joints that whole-array formulas give."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.kernels.body.file_channels import (
    IGNORED_CHANNEL,
    POSITION_CHANNEL,
    ROTATION_CHANNEL,
    change_axes,
    pose_joints,
)
from studio.core.rotations import from_euler, to_matrix

ORDERS = ["".join(axes) for count in (1, 2, 3) for axes in permutations("XYZ", count)] + ["XYX", "ZXZ"]


@pytest.mark.parametrize("order", ORDERS)
def test_turns_follow_each_other_in_the_order_of_the_file(order: str) -> None:
    degrees = np.random.default_rng(len(order)).uniform(-400.0, 400.0, size=(5, len(order)))
    axes, turning = np.array(["XYZ".index(axis) for axis in order]), np.full(len(order), ROTATION_CHANNEL)
    rotations, translations, still = np.empty((5, 2, 4)), np.empty((5, 2, 3)), np.arange(6.0).reshape(2, 3)
    second = np.ones(len(order), dtype=np.int64)
    pose_joints(degrees, second, turning, axes, still, still, rotations, translations)
    assert rotations[:, 1] == pytest.approx(from_euler(order, np.radians(degrees)), abs=1e-15)
    assert (rotations[:, 0] == [0.0, 0.0, 0.0, 1.0]).all()
    assert (translations == still).all()


def test_a_position_is_added_to_its_start_and_a_scale_does_nothing() -> None:
    rotations, translations = np.empty((1, 2, 4)), np.empty((1, 2, 3))
    starts, offsets = np.array([[0.0, 0.0, 0.0], [7.0, 8.0, 9.0]]), np.ones((2, 3))
    joints, deeds, axes = (
        np.array([0, 1, 1]),
        np.array([POSITION_CHANNEL, POSITION_CHANNEL, IGNORED_CHANNEL]),
        np.array([1, 2, 0]),
    )
    pose_joints(np.array([[5.0, 0.5, 3.0]]), joints, deeds, axes, starts, offsets, rotations, translations)
    assert translations.tolist() == [[[1.0, 5.0, 1.0], [1.0, 1.0, 9.5]]]


@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 10.0))
def test_axes_that_are_turned_turn_what_is_seen_in_them(seed: int, metres: float) -> None:
    random = np.random.default_rng(seed)
    turns, places = random.normal(size=(3, 2, 4)), random.normal(size=(3, 2, 3))
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    axes = to_matrix(from_euler("ZXY", random.uniform(-4.0, 4.0, size=3)))
    out_turns, out_places = np.empty_like(turns), np.empty_like(places)
    change_axes(turns, places, axes, metres, out_turns, out_places)
    assert to_matrix(out_turns) == pytest.approx(axes @ to_matrix(turns) @ axes.T, abs=1e-12)
    assert out_places == pytest.approx(metres * places @ axes.T, abs=1e-12)
