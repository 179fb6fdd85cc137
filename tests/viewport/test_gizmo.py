import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.viewport.camera import OrbitCamera
from studio.viewport.gizmo import (
    ARROW_PIXELS,
    BALL_HANDLE,
    GIZMO_AXES,
    MIN_ARROW_PIXELS,
    PLANE_NORMAL_AXES,
    Gizmo,
    arrow_pixels,
    moved_axes,
)

SIZE = (800.0, 600.0)


def make_gizmo(**camera) -> Gizmo:
    return Gizmo(np.array([0.3, -0.2, 1.1]), np.eye(3), OrbitCamera(**camera), SIZE)


@pytest.mark.parametrize("distance", [1.0, 4.0, 25.0])
def test_an_arrow_across_the_sight_is_as_long_on_the_screen_at_any_distance(distance):
    gizmo = make_gizmo(distance=distance, azimuth=0.0, elevation=0.0, target=(0.3, -0.2, 1.1))
    assert np.hypot(*(gizmo.tips[2] - gizmo.centre)) == pytest.approx(ARROW_PIXELS, rel=1e-6)


@given(st.sampled_from(GIZMO_AXES), st.floats(-0.4, 0.4))
def test_the_grip_of_an_arrow_is_the_point_of_its_axis_under_the_mouse(axis, way):
    gizmo = make_gizmo()
    point = gizmo.origin + way * gizmo.axes[GIZMO_AXES.index(axis)]
    x, y = gizmo.camera.project(point, SIZE)[0][0]
    assert gizmo.grip(axis, x, y) == pytest.approx(point, abs=1e-9)


@given(st.sampled_from([*PLANE_NORMAL_AXES, BALL_HANDLE]), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_the_grip_of_a_plane_is_the_point_of_that_plane_under_the_mouse(part, along, across):
    gizmo = make_gizmo()
    first, second = (
        gizmo.camera.axes[:2] if part == BALL_HANDLE else np.delete(np.eye(3), PLANE_NORMAL_AXES[part], axis=0)
    )
    point = gizmo.origin + along * first + across * second
    x, y = gizmo.camera.project(point, SIZE)[0][0]
    assert gizmo.grip(part, x, y) == pytest.approx(point, abs=1e-9)


def test_each_part_is_found_where_it_is_drawn():
    gizmo = make_gizmo()
    assert gizmo.part_at(*gizmo.centre) == BALL_HANDLE
    for axis, tip in zip(GIZMO_AXES, gizmo.tips, strict=True):
        assert gizmo.part_at(*(0.2 * gizmo.centre + 0.8 * tip)) == axis
    for name, corners in gizmo.squares.items():
        assert gizmo.part_at(*corners.mean(axis=0)) == name
    assert gizmo.part_at(5.0, 5.0) is None


def test_an_arrow_seen_end_on_and_planes_seen_edge_on_cannot_be_grabbed():
    gizmo = make_gizmo(azimuth=0.0, elevation=0.0, target=(0.3, -0.2, 1.1))
    assert not gizmo.usable("x")
    assert not gizmo.usable("xy")
    assert gizmo.usable("yz")


def test_a_part_moves_the_axes_it_is_named_after():
    assert moved_axes("y") == [False, True, False]
    assert moved_axes("zx") == [True, False, True]
    assert moved_axes(BALL_HANDLE) == [True, True, True]


def test_arrows_shrink_beside_a_small_body_as_long_as_they_can_be_gripped():
    lengths = [arrow_pixels(height) for height in (10.0, 150.0, 210.0, 400.0)]
    assert lengths == sorted(lengths)
    assert (lengths[0], lengths[-1]) == (MIN_ARROW_PIXELS, ARROW_PIXELS)
    assert lengths[2] == pytest.approx(70.0)
