"""Two eyes and a tracked head look through one window: what lies in it stays, what is nearer moves the other way."""

import math

import numpy as np
import pytest

from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.engine.prop_places import props_at
from studio.viewport.camera import OrbitCamera
from studio.viewport.eyes import (
    EYE_SEPARATION_FRACTION,
    EyePosition,
    Stereo,
    StereoScene,
    StereoView,
    anaglyph,
    side_by_side,
)
from studio.viewport.stage_picture import StageScene
from studio.viewport.stills import AveragedPicture

SIZE = (320, 240)
CAMERA = OrbitCamera(target=(0.0, 0.0, 1.0), distance=4.0, azimuth=0.0, elevation=0.0)


@pytest.fixture(scope="module")
def scene():
    made = StageScene()
    yield made
    made.close()


def seen(scene, place, eye):
    """(2,) pixels of the middle of a box at a place, right and down."""
    pictures = []
    for props in ({}, {"box": Prop("Box", (0.1, 0.1, 0.1), place)}):
        project = Project(props=props)
        scene.sync(project, {}, props_at(project, {}, 0.0))
        pictures.append(np.array(scene.render(CAMERA, SIZE, eye=eye)).astype(int))
    rows, columns = np.nonzero(np.abs(pictures[1] - pictures[0])[..., :3].sum(axis=2) > 30)
    assert len(rows)
    return np.array([columns.mean(), rows.mean()])


@pytest.mark.parametrize(
    "eye",
    [EyePosition(right=0.2), EyePosition(up=0.3), EyePosition(right=-0.3, up=0.1, back=1.0), EyePosition(back=-1.5)],
)
def test_what_lies_in_the_window_is_in_one_place_for_every_eye(scene, eye):
    there = seen(scene, (0.0, 0.2, 1.2), eye)
    assert there == pytest.approx(seen(scene, (0.0, 0.2, 1.2), EyePosition()), abs=2.0)


def test_what_is_nearer_is_farther_to_the_right_for_the_left_eye(scene):
    near, far = (1.5, 0.0, 1.0), (-2.0, 0.0, 1.0)
    left, right = EyePosition(right=-0.07), EyePosition(right=0.07)
    assert seen(scene, near, left)[0] > seen(scene, near, right)[0] + 1.0
    assert seen(scene, far, left)[0] < seen(scene, far, right)[0] - 1.0


class Painted:
    """A scene that paints which eye looked, for how wide a picture."""

    def __init__(self):
        self.looked = []

    def render(self, camera, size, offset=(0.0, 0.0), eye=None):
        self.looked.append((size, eye))
        return np.full((size[1], size[0], 4), 200 if eye.right < 0 else 100, dtype=np.uint8)


@pytest.mark.parametrize("width", [320, 321])
def test_side_by_side_has_the_left_eye_at_the_left(width):
    scene = Painted()
    picture = StereoView(Stereo.SIDE_BY_SIDE).render(scene, CAMERA, (width, 240))
    assert picture.shape == (240, width, 4)
    assert picture[120, 0, 0] == 200
    assert picture[120, 319, 0] == 100
    assert scene.looked[0][0] == (160, 120)  # all that one eye would see
    apart = scene.looked[1][1].right - scene.looked[0][1].right
    assert apart == pytest.approx(EYE_SEPARATION_FRACTION * CAMERA.distance)


def test_an_anaglyph_has_the_left_eye_in_red_and_the_right_one_in_green_and_blue():
    picture = StereoScene(Painted(), StereoView(Stereo.ANAGLYPH)).render(CAMERA, SIZE)
    assert picture[5, 5, :3].tolist() == pytest.approx([200, 100, 100], abs=1)


def test_a_head_that_moves_moves_the_eye_as_far_as_the_window_is_larger_than_the_screen():
    scene = Painted()
    StereoView(head=EyePosition(0.1, 0.05, -100.0)).render(scene, CAMERA, SIZE)
    [(_, eye)] = scene.looked
    tall = 2.0 * CAMERA.distance * math.tan(math.radians(15.0))
    assert eye.right == pytest.approx(0.1 * tall / 0.34)
    assert eye.right == pytest.approx(2.0 * eye.up)
    assert CAMERA.distance + eye.back > 0.0  # never through the window


def test_a_still_is_of_both_eyes():
    scene = Painted()
    still = AveragedPicture(StereoScene(scene, StereoView(Stereo.ANAGLYPH)), CAMERA, SIZE)
    still.refine()
    assert len(scene.looked) == 4
    assert side_by_side(still.pixels, still.pixels, (2 * SIZE[0], 500)).shape == (500, 2 * SIZE[0], 4)
    assert anaglyph(still.pixels, still.pixels).shape == still.pixels.shape
