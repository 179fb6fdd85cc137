"""Anti-aliased stills: the average of many images, each shifted by a fraction of a pixel."""

import numpy as np

from studio.viewport.camera import OrbitCamera
from studio.viewport.eyes import Pixels, RenderableScene

STILL_SAMPLES, FILM_PICTURE_SAMPLES = 12, 4
_GOLDEN = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of the R2 sequence, whose points fill a square evenly."""


def subpixel_shift(sample: int) -> tuple[float, float]:
    """Shift (x, y) in pixels, within half a pixel, of the image number ``sample``; zero for the first one."""
    x, y = (0.5 + _GOLDEN * sample) % 1.0 - 0.5
    return float(x), float(y)


class AveragedPicture:
    """Image that improves with each ``refine``."""

    def __init__(self, scene: RenderableScene, camera: OrbitCamera, size: tuple[int, int]) -> None:
        self._scene, self._camera, self._size = scene, camera, size
        self._sum = scene.render(camera, size).astype(np.uint16)
        self.count = 1

    def refine(self) -> None:
        """Render one more sample."""
        self._sum += self._scene.render(self._camera, self._size, subpixel_shift(self.count))
        self.count += 1

    @property
    def complete(self) -> bool:
        """True if more samples would make no visible difference."""
        return self.count >= STILL_SAMPLES

    @property
    def pixels(self) -> Pixels:
        """(height, width, 4) RGBA of the current average."""
        return ((self._sum + self.count // 2) // self.count).astype(np.uint8)


def smooth_picture(scene: RenderableScene, camera: OrbitCamera, size: tuple[int, int], samples: int) -> Pixels:
    """Image (height, width, 4), RGBA, averaged over a number of samples."""
    still = AveragedPicture(scene, camera, size)
    while still.count < samples:
        still.refine()
    return still.pixels
