"""Stereo and head tracking: the position of each eye, and the combination of their pictures.

The screen is a window at the camera's target: points there are in the same place for every eye.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.viewport.camera import OrbitCamera

Pixels = NDArray[np.uint8]

EYE_SEPARATION = 1 / 30
"""Distance of the eyes, in parts of that to the screen: more than that tires."""
SCREEN = 0.34
"""Metres of a usual screen's height: as the head moves before it, so does the eye before the stage's window."""
NEAREST = 0.3
"""Least distance of a head, in parts of the camera's."""
_GREY = np.array([0.299, 0.587, 0.114])


class Stereo(StrEnum):
    """Combination of the pictures of two eyes."""

    OFF = "off"
    SIDE_BY_SIDE = "side by side"
    ANAGLYPH = "anaglyph"


@dataclass(frozen=True)
class EyePosition:
    """Position of an eye, in metres from the camera: to the right, up, away from the stage."""

    right: float = 0.0
    up: float = 0.0
    back: float = 0.0


CENTRE_EYE = EyePosition()


class RenderableScene(Protocol):
    """Scene that can be rendered for an eye."""

    def render(
        self,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
        eye: EyePosition = CENTRE_EYE,
    ) -> Pixels:
        """(height, width, 4) RGBA; ``offset`` shifts it by fractions of a pixel."""


@dataclass(frozen=True)
class StereoView:
    """Eyes of the view: one or two, and the position of the ``head``, in metres before the screen."""

    stereo: Stereo = Stereo.OFF
    head: EyePosition = CENTRE_EYE

    @property
    def is_plain(self) -> bool:
        """True if the projection depends on the camera alone: one eye, no tracked head."""
        return self == ONE_EYE

    def with_camera(self, camera: OrbitCamera, tall: float) -> EyePosition:
        """Eye midway between both, of a head before a window ``tall`` metres high."""
        scale = tall / SCREEN
        back = max(scale * self.head.back, (NEAREST - 1.0) * camera.distance)
        return EyePosition(scale * self.head.right, scale * self.head.up, back)

    def render(
        self,
        scene: RenderableScene,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
    ) -> Pixels:
        """Picture of a scene."""
        middle = self.with_camera(camera, camera.metres_per_pixel(1.0))
        if self.stereo is Stereo.OFF:
            return scene.render(camera, size, offset, middle)
        half = 0.5 * EYE_SEPARATION * (camera.distance + middle.back)
        own = (max(size[0] // 2, 1), max(size[1] // 2, 1)) if self.stereo is Stereo.SIDE_BY_SIDE else size
        left, right = (
            np.array(scene.render(camera, own, offset, replace(middle, right=middle.right + way)))
            for way in (-half, half)
        )
        return side_by_side(left, right, size) if self.stereo is Stereo.SIDE_BY_SIDE else anaglyph(left, right)


ONE_EYE = StereoView()


@dataclass(frozen=True, eq=False)
class StereoScene:
    """Scene for a stereo view; it renders like the scene itself."""

    scene: RenderableScene
    sight: StereoView

    def render(
        self,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
        _: EyePosition = CENTRE_EYE,
    ) -> Pixels:
        """As ``RenderableScene.render``."""
        return self.sight.render(self.scene, camera, size, offset)


def side_by_side(left: Pixels, right: Pixels, size: tuple[int, int]) -> Pixels:
    """Both pictures side by side in the middle of one of ``size`` (width, height), with black borders."""
    height, width = left.shape[:2]
    made = np.zeros((size[1], size[0], 4), dtype=np.uint8)
    above = (size[1] - height) // 2
    made[above : above + height, :width] = left
    made[above : above + height, width : 2 * width] = right
    return made


def anaglyph(left: Pixels, right: Pixels) -> Pixels:
    """Picture for red and cyan glasses: the left eye's luminance in red, the right eye's own green and blue."""
    made = np.array(right)
    made[..., 0] = (left[..., :3] @ _GREY).astype(np.uint8)
    return made
