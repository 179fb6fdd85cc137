"""Pictures and films of a project without a window: for the command line, thumbnails and the user guide."""

from collections.abc import Generator, Iterable, Mapping

from studio.core.constraints.base import BodyPoint
from studio.core.project import Project
from studio.core.solver.request import AdaptedMotion
from studio.engine.performance import posed_performers
from studio.viewport.camera import OrbitCamera
from studio.viewport.opening import opening_camera
from studio.viewport.paths import trails
from studio.viewport.scene import Pixels, StageScene
from studio.viewport.stills import SAMPLES, Still

FILM_SAMPLES = 4

Results = Mapping[str, AdaptedMotion]


def render_frame(
    project: Project,
    results: Results,
    time: float,
    size: tuple[int, int],
    camera: OrbitCamera | None = None,
    trail: BodyPoint | None = None,
) -> Pixels:
    """The stage at ``time`` (seconds) as (height, width, 4) RGBA bytes; ``size`` is width and height.

    ``results`` has an adapted motion for each performer id that is to be seen; ``trail`` draws the path of
    that point. Without a camera it is the one the viewport opens with.
    """
    return next(_frames(project, results, (time,), size, camera, trail, SAMPLES))


def render_video(
    project: Project,
    results: Results,
    times: Iterable[float],
    size: tuple[int, int],
    camera: OrbitCamera | None = None,
    trail: BodyPoint | None = None,
) -> Generator[Pixels, None, None]:
    """One picture as ``render_frame``'s for each of ``times`` (seconds), all with the same camera."""
    return _frames(project, results, times, size, camera, trail, FILM_SAMPLES)


def _frames(
    project: Project,
    results: Results,
    times: Iterable[float],
    size: tuple[int, int],
    camera: OrbitCamera | None,
    trail: BodyPoint | None,
    samples: int,
) -> Generator[Pixels, None, None]:
    scene = StageScene()
    try:
        for time in times:
            posed = posed_performers(project, results.get, time)
            camera = camera or opening_camera(posed, size)
            scene.sync(project, posed, paths=trails(project, posed, trail))
            still = Still(scene, camera, size)
            while still.count < samples:
                still.refine()
            yield still.pixels
    finally:
        scene.close()
