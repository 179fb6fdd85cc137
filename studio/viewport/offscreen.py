"""Pictures and films of a project without a window: for the command line, thumbnails and the user guide."""

from collections.abc import Generator, Iterable, Mapping

from studio.core.project import Project
from studio.core.solver.request import AdaptedMotion
from studio.engine.performance import posed_performers
from studio.engine.props import props_at
from studio.viewport.opening import opening_camera
from studio.viewport.scene import Pixels, StageScene
from studio.viewport.stills import FILM_SAMPLES, SAMPLES, smooth_picture

Results = Mapping[str, AdaptedMotion]


def render_frame(project: Project, results: Results, time: float, size: tuple[int, int]) -> Pixels:
    """The stage at ``time`` (seconds) as (height, width, 4) RGBA bytes; ``size`` is width and height.

    ``results`` has an adapted motion for each performer id that is to be seen. The camera is the one the viewport
    opens with.
    """
    return next(_frames(project, results, (time,), size, SAMPLES))


def render_video(
    project: Project, results: Results, times: Iterable[float], size: tuple[int, int]
) -> Generator[Pixels, None, None]:
    """One picture as ``render_frame``'s for each of ``times`` (seconds), all with the camera of the first."""
    return _frames(project, results, times, size, FILM_SAMPLES)


def _frames(
    project: Project, results: Results, times: Iterable[float], size: tuple[int, int], samples: int
) -> Generator[Pixels, None, None]:
    scene, camera = StageScene(), None
    try:
        for time in times:
            posed = posed_performers(project, results.get, time)
            camera = camera or opening_camera(posed, size)
            scene.sync(project, posed, props_at(project, posed, time))
            yield smooth_picture(scene, camera, size, samples)
    finally:
        scene.close()
