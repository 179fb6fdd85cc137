import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from studio.viewport.camera import NAMED_VIEWS, OrbitCamera

SIZE = (1200.0, 700.0)
angles = st.floats(-math.pi, math.pi)
lengths = st.floats(-5.0, 5.0)
cameras = st.builds(
    OrbitCamera,
    target=st.tuples(lengths, lengths, lengths),
    distance=st.floats(0.5, 30.0),
    azimuth=angles,
    elevation=st.floats(-0.1, math.pi / 2),
    parallel=st.booleans(),
)


@given(cameras, st.floats(0, 1200), st.floats(0, 700), st.floats(0.3, 40.0))
def test_a_point_on_the_ray_of_sight_through_a_pixel_is_seen_at_that_pixel(camera, x, y, way):
    origin, sight = camera.ray(x, y, SIZE)
    pixels, depth = camera.project(origin + way * sight, SIZE)
    assert depth[0] > 0
    assert pixels[0] == pytest.approx([x, y], abs=1e-6)


@given(cameras, st.lists(st.tuples(lengths, lengths, lengths), min_size=2, max_size=12, unique=True))
@example(OrbitCamera((0.0, 0.0, 0.0), 1.0, 0.0, 0.0), [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
def test_framing_brings_every_point_into_the_picture(camera, points):
    framed = camera.framing(points, SIZE)
    pixels, depth = framed.project(points, SIZE)
    assert (pixels >= -1e-6).all()
    assert (pixels <= np.array(SIZE) + 1e-6).all()
    assert framed.parallel or (depth > 0).all()


@given(cameras)
def test_the_axes_of_a_camera_are_a_rotation(camera):
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)


@given(cameras, cameras)
def test_a_glide_begins_at_one_camera_and_ends_at_the_other(begin, end):
    assert begin.towards(end, 0.0).eye == pytest.approx(begin.eye, abs=1e-6)
    assert begin.towards(end, 1.0).eye == pytest.approx(end.eye, abs=1e-6)


def test_panning_by_one_pixel_moves_the_target_by_one_pixel():
    camera = OrbitCamera()
    moved = camera.panned(camera.metres_per_pixel(SIZE[1]), 0.0)
    assert moved.project(camera.target, SIZE)[0][0] == pytest.approx([599.0, 350.0], abs=1e-9)


def test_the_side_view_shows_forward_to_the_right_and_the_top_view_left_upwards():
    side = OrbitCamera(azimuth=NAMED_VIEWS["side"][0], elevation=NAMED_VIEWS["side"][1])
    top = OrbitCamera(azimuth=NAMED_VIEWS["top"][0], elevation=NAMED_VIEWS["top"][1])
    assert side.axes[0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert top.axes[1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
