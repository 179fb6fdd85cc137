"""VTK scene of the stage: floor, characters, trails and props, rendered off screen into an array of pixels."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.stage.project import Project
from studio.core.stage.prop import PropShape
from studio.core.stage.prop_shapes import PROP_COLOUR
from studio.engine.posed_performer import PosedPerformer
from studio.engine.prop_places import PropPose
from studio.viewport.bodies import BodyVisual
from studio.viewport.camera import OrbitCamera
from studio.viewport.eyes import CENTRE_EYE, EyePosition
from studio.viewport.floor import SHADOW_REACH, SoftShadows, make_lines, make_plane, make_sky
from studio.viewport.ghost_bodies import GhostBodies
from studio.viewport.ground_visual import GroundVisual
from studio.viewport.live_mesh import LiveLines, flat_actor
from studio.viewport.material import SkyShading, light_like_a_studio
from studio.viewport.onion_skins import Ghost
from studio.viewport.paths import StagePath
from studio.viewport.prop_figures import unit_mesh

Pixels = NDArray[np.uint8]


class StageScene:
    """All VTK objects. ``sync`` updates them, ``render`` renders them, ``close`` releases them."""

    def __init__(self) -> None:
        self.plotter = pv.Plotter(off_screen=True, lighting="none")
        window: Any = self.plotter.render_window
        self._window = window
        self._window.SetMultiSamples(0)
        light_like_a_studio(self.plotter)
        self._shading = SkyShading()
        self._bodies: dict[str, BodyVisual] = {}
        self._ghosts = GhostBodies(self._add_shaded, self._remove)
        self._props: dict[str, pv.Actor] = {}
        self._looks: dict[str, tuple[PropShape, TriangleMesh | None]] = {}
        self._shadows = SoftShadows()
        self._plane, self._grid = flat_actor(make_plane()), flat_actor(make_lines())
        self._plane.prop.culling = "back"
        self._sky = flat_actor(make_sky())
        self._ground = GroundVisual()
        self._ground.surface.texture = self._shadows.texture
        self._lines = LiveLines()
        self._add(self._lines.actor)
        self._pixels = vtkUnsignedCharArray()

    def sync(
        self,
        project: Project,
        posed: Mapping[str, PosedPerformer],
        props: Mapping[str, PropPose],
        bones: bool = False,
        paths: Sequence[StagePath] = (),
        moving: bool = False,
        ghosts: Sequence[Ghost] = (),
    ) -> None:
        """Update performers as skins or bones, shadows, lines, props and ghosts; coarser while ``moving``."""
        self._drop_bodies(project, posed)
        for performer_id, pose in posed.items():
            body = self._body(performer_id, project.characters[pose.performer.character_id])
            if bones and body.bones_actor is None:
                self._add_shaded(body.make_bones(pose.motion.morphology.layout))
            body.coarsen(moving)
            body.pose(pose, bones)
        self._ghosts.sync(project, ghosts)
        self._lines.show_paths(paths)
        self._shadows.cast([(pose.points, pose.motion.morphology) for pose in posed.values()], project.ground)
        self._sync_ground(project.ground)
        self._sync_props(project, props)

    def render(
        self,
        camera: OrbitCamera,
        size: tuple[int, int],
        offset: tuple[float, float] = (0.0, 0.0),
        eye: EyePosition = CENTRE_EYE,
    ) -> Pixels:
        """Image (height, width, 4), RGBA, shifted by the fractions of a pixel ``offset``.

        For an ``eye`` beside the camera the stage is seen through a window at the camera's target (off-axis
        projection).
        """
        window, lens = self._window, self.plotter.renderer.GetActiveCamera()
        if tuple(window.GetSize()) != size:
            window.SetSize(*size)
        tall = camera.half_height
        away = np.array([eye.right, eye.up, eye.back]) @ camera.axes
        lens.SetPosition(*(camera.eye + away))
        lens.SetFocalPoint(*(camera.eye + away - camera.distance * camera.axes[2]))
        lens.SetViewUp(*camera.axes[1])
        lens.SetViewAngle(math.degrees(2.0 * math.atan(tall / (camera.distance + eye.back))))
        lens.SetParallelProjection(camera.parallel)
        lens.SetParallelScale(tall)
        lens.SetClippingRange(max(0.03 * camera.distance, 0.02), camera.distance + 200.0)
        wide = tall * size[0] / size[1]
        lens.SetWindowCenter(2 * offset[0] / size[0] - eye.right / wide, 2 * offset[1] / size[1] - eye.up / tall)
        self._sky.SetPosition(*camera.target)
        self._shading.turn(tuple(camera.axes[:, 2].tolist()))
        window.Render()
        window.GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, self._pixels)
        pixels: NDArray[np.uint8] = vtk_to_numpy(self._pixels).reshape(size[1], size[0], 4)[::-1]
        return pixels

    def close(self) -> None:
        """Release the render window and all its objects."""
        self._shading.clear()
        self._bodies.clear()
        self._props.clear()
        self._window = None
        self.plotter.close()
        self.plotter.deep_clean()

    def _add(self, actor: pv.Actor) -> None:
        """Add an actor before the backdrop, so that hidden parts of the backdrop are not rendered."""
        backdrop = (
            self._grid,
            self._shadows.actor,
            self._plane,
            self._ground.lines,
            self._ground.surface,
            self._sky,
        )
        renderer = self.plotter.renderer
        for behind in backdrop:
            renderer.RemoveActor(behind)
        for drawn in (actor, *backdrop):
            renderer.AddActor(drawn)

    def _add_shaded(self, actor: pv.Actor) -> None:
        self._shading.give(actor)
        self._add(actor)

    def _remove(self, actor: pv.Actor) -> None:
        self._shading.take(actor)
        self.plotter.renderer.RemoveActor(actor)

    def _drop_bodies(self, project: Project, posed: Mapping[str, PosedPerformer]) -> None:
        for performer_id, body in list(self._bodies.items()):
            pose = posed.get(performer_id)
            if pose is None or not body.can_show(project.characters[pose.performer.character_id]):
                for actor in body.actors:
                    self._remove(actor)
                del self._bodies[performer_id]

    def _body(self, performer_id: str, character: Character) -> BodyVisual:
        body = self._bodies.get(performer_id)
        if body is None:
            body = self._bodies[performer_id] = BodyVisual(character)
            for actor in body.skin_actors:
                self._add_shaded(actor)
        body.take_skin(character)
        return body

    def _sync_ground(self, ground: Ground) -> None:
        self._ground.show(ground)
        if not ground.is_level:
            self._ground.place_shadow(self._shadows.centre, SHADOW_REACH)
        for actor in (self._plane, self._grid):
            actor.SetVisibility(ground.is_level)
            actor.SetPosition(0.0, 0.0, ground.height)

    def _sync_props(self, project: Project, props: Mapping[str, PropPose]) -> None:
        for prop_id in [key for key in self._props if key not in project.props]:
            self._remove(self._props.pop(prop_id))
        for prop_id, prop in project.props.items():
            actor, looks = self._props.get(prop_id), (prop.shape, prop.mesh)
            if actor is None:
                actor = self._props[prop_id] = pv.Actor(mapper=pv.DataSetMapper(unit_mesh(prop)))
                actor.prop.color = PROP_COLOUR
                self._add_shaded(actor)
            elif self._looks.get(prop_id) != looks:
                actor.mapper.dataset = unit_mesh(prop)
            self._looks[prop_id] = looks
            matrix = np.eye(4)
            matrix[:3, :3] = props[prop_id].axes * np.array(prop.size)
            matrix[:3, 3] = props[prop_id].place
            actor.user_matrix = matrix
