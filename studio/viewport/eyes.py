"""Stereo and head tracking: the position of each eye, and the combination of the images of both.

The screen is a window at the distance of the camera's target: points there have no parallax.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.viewport.camera import OrbitCamera

Pixels = NDArray[np.uint8]

EYE_SEPARATION_FRACTION = 1 / 30
"""Distance of the eyes as a fraction of the distance to the screen; a larger one tires."""
SCREEN_HEIGHT_METRES = 0.34
"""Assumed height of the screen in metres, which relates head motion to camera motion."""
MIN_HEAD_DISTANCE_FRACTION = 0.3
"""Minimum distance of a head from the screen, as a fraction of the camera's distance."""
_GREY = np.array([0.299, 0.587, 0.114])


class Stereo(StrEnum):
    """Stereo mode, the combination of the images of both eyes."""

    OFF = "off"
    SIDE_BY_SIDE = "side by side"
    ANAGLYPH = "anaglyph"


@dataclass(frozen=True)
class EyePosition:
    """Offset of an eye from the camera in metres: right, up, and back from the stage."""

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
        """Image (height, width, 4), RGBA, shifted by the fractions of a pixel ``offset``."""


@dataclass(frozen=True)
class StereoView:
    """Stereo mode of a view, and the position of the ``head`` in metres in front of the screen."""

    stereo: Stereo = Stereo.OFF
    head: EyePosition = CENTRE_EYE

    @property
    def is_plain(self) -> bool:
        """True if the image depends only on the camera: one eye, no tracked head."""
        return self == ONE_EYE

    def with_camera(self, camera: OrbitCamera, tall: float) -> EyePosition:
        """Position midway between both eyes, for a head in front of a window ``tall`` metres high."""
        scale = tall / SCREEN_HEIGHT_METRES
        back = max(scale * self.head.back, (MIN_HEAD_DISTANCE_FRACTION - 1.0) * camera.distance)
        return EyePosition(scale * self.head.right, scale * self.head.up, back)

    def render(
        self,
        scene: RenderableScene,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
    ) -> Pixels:
        """Image (height, width, 4), RGBA, of a scene."""
        middle = self.with_camera(camera, camera.metres_per_pixel(1.0))
        if self.stereo is Stereo.OFF:
            return scene.render(camera, size, offset, middle)
        half = 0.5 * EYE_SEPARATION_FRACTION * (camera.distance + middle.back)
        own = (max(size[0] // 2, 1), max(size[1] // 2, 1)) if self.stereo is Stereo.SIDE_BY_SIDE else size
        left, right = (
            np.array(scene.render(camera, own, offset, replace(middle, right=middle.right + way)))
            for way in (-half, half)
        )
        return side_by_side(left, right, size) if self.stereo is Stereo.SIDE_BY_SIDE else anaglyph(left, right)


ONE_EYE = StereoView()


@dataclass(frozen=True, eq=False)
class StereoScene:
    """Scene seen through a stereo view; it renders like a plain scene."""

    scene: RenderableScene
    sight: StereoView

    def render(
        self,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
        _: EyePosition = CENTRE_EYE,
    ) -> Pixels:
        """Image (height, width, 4), RGBA, shifted by the fractions of a pixel ``offset``."""
        return self.sight.render(self.scene, camera, size, offset)


def side_by_side(left: Pixels, right: Pixels, size: tuple[int, int]) -> Pixels:
    """Both images side by side, centred in an image of ``size`` (width, height), with black borders."""
    height, width = left.shape[:2]
    made = np.zeros((size[1], size[0], 4), dtype=np.uint8)
    above = (size[1] - height) // 2
    made[above : above + height, :width] = left
    made[above : above + height, width : 2 * width] = right
    return made


def anaglyph(left: Pixels, right: Pixels) -> Pixels:
    """Image for red and cyan glasses: luminance of the left eye in red, green and blue of the right eye."""
    made = np.array(right)
    made[..., 0] = (left[..., :3] @ _GREY).astype(np.uint8)
    return made
