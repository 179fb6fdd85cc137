"""Images of the stage over a time range, rendered without a window."""

from collections.abc import Callable, Generator, Mapping
from dataclasses import replace

from PySide6.QtGui import QImage, QPainter

from studio.core.body.sticks import bone_pairs
from studio.core.errors import StudioError
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.engine.live_adaptation import as_recorded
from studio.engine.posed_performer import PosedPerformer, pose_of, posed_performers, resting_performers
from studio.engine.prop_places import props_at
from studio.jobs.performances import stage_performances
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.follow_camera import smoothed_root, translated_camera
from studio.viewport.overlay import Overlay
from studio.viewport.paths import trails
from studio.viewport.shots import Shots, View
from studio.viewport.stage_picture import Pixels, StageScene
from studio.viewport.stills import FILM_PICTURE_SAMPLES, smooth_picture


def render_shots(shots: Shots) -> Generator[Pixels, None, None]:
    """Images of the stage at each of the times, with all performers adapted again. Raises StudioError if no character
    has a clip.
    """
    project, view = shots.project, shots.view
    made = stage_performances(project).performances
    if not made:
        raise StudioError("No visible character has a clip: there is nothing to render.")
    results = {key: each.adapted for key, each in made.items()}
    source = None
    if view.ghost_of is not None and view.ghost_of in made:
        asked = made[view.ghost_of].request
        assert asked.actor is not None
        source = as_recorded(asked.motion, asked.actor)
    cameras = _cameras(project, results, view)
    scene = StageScene()
    try:
        for time in shots.times:
            posed = posed_performers(project, results.get, time)
            seen = posed | resting_performers(project, posed)
            props = props_at(project, posed, time)
            scene.sync(project, seen, props, view.bones, trails(project, posed, view.trail))
            camera = cameras(time)
            azimuth = camera.azimuth + view.turning * (time - view.time)
            own = replace(view, camera=replace(camera, azimuth=azimuth))
            picture = smooth_picture(scene, own.camera, shots.size, FILM_PICTURE_SAMPLES)
            if source is not None and view.ghost_of in posed:
                _paint_ghost(picture, pose_of(project, view.ghost_of, source, time), own)
            yield picture
    finally:
        scene.close()


def _cameras(project: Project, results: Mapping[str, AdaptedMotion], view: View) -> Callable[[float], OrbitCamera]:
    """Function from stage time in seconds to the camera, which follows a performer if the view does."""
    motion = results.get(view.followed or "")
    if motion is None:
        return lambda time: view.camera

    def place(time: float) -> FloatArray:
        return smoothed_root(pose_of(project, view.followed or "", motion, time))

    begin = place(view.time)
    return lambda time: translated_camera(view.camera, place(time) - begin)


def _paint_ghost(picture: Pixels, ghost: PosedPerformer, view: View) -> None:
    """Paint the ghost of the source, with lines of the same relative width as in the 3D view."""
    height, width = picture.shape[:2]
    scale = height / view.height
    image = QImage(picture.data, width, height, 4 * width, QImage.Format.Format_RGBX8888)  # these very bytes
    with QPainter(image) as painter:
        painter.scale(scale, scale)
        overlay = Overlay(painter, view.camera, (width / scale, view.height))
        overlay.ghost(ghost.points, bone_pairs(ghost.motion.morphology.layout))
