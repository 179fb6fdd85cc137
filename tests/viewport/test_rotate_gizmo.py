import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.viewport.camera import OrbitCamera
from studio.viewport.gizmo import GIZMO_AXES
from studio.viewport.rotate_gizmo import RING_SIDES, SCREEN_PART, TRACKBALL, RotateGizmo, rotation_about
from studio.viewport.scale_gizmo import ScaleGizmo

SIZE = (800.0, 600.0)
ORIGIN = np.array([0.3, -0.2, 1.1])
PARTS = (*GIZMO_AXES, SCREEN_PART)
angles = st.floats(-np.pi, np.pi)
cameras = st.builds(
    OrbitCamera, target=st.just(tuple(ORIGIN.tolist())), azimuth=angles, elevation=st.floats(-0.1, 1.5),
    parallel=st.booleans(),
)  # fmt: skip
rotations = st.builds(
    lambda x, y, angle: rotation_about(np.array([np.cos(x) * np.cos(y), np.sin(x) * np.cos(y), np.sin(y)]), angle),
    angles, angles, angles,
)  # fmt: skip


@given(cameras, rotations, st.sampled_from(PARTS), st.integers(0, RING_SIDES - 1), st.integers(1, 8))
def test_the_thing_follows_the_mouse_round_a_ring_whatever_the_view_and_the_axes(camera, axes, part, first, further):
    gizmo = RotateGizmo(ORIGIN, axes, camera, SIZE)
    if abs(float(gizmo.axis(part) @ gizmo.sight)) < 0.3:
        return  # edge on: the test below
    begin, end = gizmo.ring(part)[first], gizmo.ring(part)[(first + further) % RING_SIDES]
    grip = tuple(begin.tolist())
    angle = gizmo.bearing(part, *end, grip) - gizmo.bearing(part, *begin, grip)
    expected = 2.0 * np.pi * further / RING_SIDES
    assert np.remainder(angle - expected + np.pi, 2.0 * np.pi) - np.pi == pytest.approx(0.0, abs=1e-6)


@given(cameras, rotations, st.sampled_from(GIZMO_AXES))
def test_a_ring_seen_edge_on_turns_as_far_as_the_mouse_goes_along_it(camera, axes, part):
    gizmo = RotateGizmo(ORIGIN, axes, camera, SIZE)
    if abs(float(gizmo.axis(part) @ gizmo.sight)) > 0.15:
        return
    corners, front = gizmo.ring(part), np.flatnonzero(gizmo.in_front(part))
    middle = front[np.argmin(np.hypot(*(corners[front] - gizmo.centre).T))]
    begin, end = corners[middle], corners[(middle + 2) % RING_SIDES]
    angle = gizmo.bearing(part, *end, tuple(begin.tolist()))
    assert angle == pytest.approx(4.0 * np.pi / RING_SIDES, rel=0.15)


@given(cameras, rotations)
def test_rings_are_found_where_their_near_halves_are_drawn_and_the_trackball_between_them(camera, axes):
    gizmo = RotateGizmo(ORIGIN, axes, camera, SIZE)
    for part in PARTS:
        corners = gizmo.ring(part)
        for side in np.flatnonzero(gizmo.in_front(part))[::6]:
            assert gizmo.part_at(*corners[side]) in PARTS  # another ring may cross there
    x, y = gizmo.ring(SCREEN_PART)[np.argmin(gizmo.ring(SCREEN_PART)[:, 0])]
    assert gizmo.part_at(x - 40.0, y) is None
    inside = gizmo.centre + np.stack(np.meshgrid(*[np.linspace(-60, 60, 9)] * 2), axis=-1).reshape(-1, 2)
    assert TRACKBALL in {gizmo.part_at(*pixel) for pixel in inside}


def test_what_has_a_heading_alone_has_one_ring_about_the_vertical():
    gizmo = RotateGizmo(ORIGIN, np.eye(3), OrbitCamera(), SIZE, heading_only=True)
    assert gizmo.parts == ("z",)
    assert gizmo.part_at(*gizmo.centre) is None


def test_a_scale_handle_makes_it_as_much_larger_as_it_is_dragged_out():
    gizmo = ScaleGizmo(ORIGIN, np.eye(3), OrbitCamera(), SIZE)
    begin, end = (gizmo.pixels_of(way * np.eye(3)[1:2])[0] for way in (0.5, 0.75))
    assert gizmo.factor("y", tuple(begin.tolist()), *end) == pytest.approx(1.5)
