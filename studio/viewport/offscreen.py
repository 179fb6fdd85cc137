"""Images and videos of a project without a window: for the command line, thumbnails and the guide."""

from collections.abc import Generator, Iterable, Mapping

import numpy as np

from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.core.stage.saved_camera import CameraPlacement
from studio.engine.posed_performer import posed_performers
from studio.engine.prop_places import props_at
from studio.viewport.camera import OrbitCamera
from studio.viewport.opening import opening_camera
from studio.viewport.stage_picture import Pixels, StageScene
from studio.viewport.stills import FILM_PICTURE_SAMPLES, STILL_SAMPLES, smooth_picture

Results = Mapping[str, AdaptedMotion]


def render_frame(
    project: Project, results: Results, time: float, size: tuple[int, int], placement: CameraPlacement | None = None
) -> Pixels:
    """Stage at ``time`` seconds as an image (height, width, 4), RGBA; ``size`` is width and height.

    ``results`` has an adapted motion for each visible performer's id. Without a ``placement`` the camera has the
    default direction, and frames the performers at that moment.
    """
    posed = posed_performers(project, results.get, time)
    camera = OrbitCamera.at(placement) if placement else opening_camera(posed, size, ground=project.ground)
    if posed and placement is None:
        camera = camera.framing(np.concatenate([pose.points for pose in posed.values()]), size)
    return next(_frames(project, results, (time,), camera, size, STILL_SAMPLES))


def render_video(
    project: Project,
    results: Results,
    times: Iterable[float],
    size: tuple[int, int],
    placement: CameraPlacement | None = None,
) -> Generator[Pixels, None, None]:
    """One image for each of ``times`` in seconds, all with the camera at ``placement``, or the default one."""
    times = list(times)
    first = posed_performers(project, results.get, times[0] if times else 0.0)
    camera = OrbitCamera.at(placement) if placement else opening_camera(first, size, ground=project.ground)
    return _frames(project, results, times, camera, size, FILM_PICTURE_SAMPLES)


def _frames(
    project: Project,
    results: Results,
    times: Iterable[float],
    camera: OrbitCamera,
    size: tuple[int, int],
    samples: int,
) -> Generator[Pixels, None, None]:
    scene = StageScene()
    try:
        for time in times:
            posed = posed_performers(project, results.get, time)
            scene.sync(project, posed, props_at(project, posed, time))
            yield smooth_picture(scene, camera, size, samples)
    finally:
        scene.close()
