"""Characters in the 3D view: the skin or the bones of a performer."""

import math
from concurrent.futures import Future
from functools import partial
from typing import NamedTuple

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.mesh.character import Character
from studio.core.mesh.skin import SkinnedMesh, skin_vertices, with_grip
from studio.core.rigs.driven_fingers import bound_hands
from studio.core.stage.placement import Placement
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.bone_figure import BoneFigure
from studio.viewport.character_materials import material_actors
from studio.viewport.coarse import coarse_skin_beside
from studio.viewport.live_mesh import LiveMesh
from studio.viewport.seams import PANEL_FIELD, draw_seams, panel_field


def make_actor(mesh: LiveMesh, colour: str) -> pv.Actor:
    """VTK actor that draws ``mesh`` in one colour."""
    actor = pv.Actor(mapper=pv.DataSetMapper(mesh.polydata))
    actor.mapper.scalar_visibility = False
    actor.prop.color = colour
    actor.prop.culling = "back"  # half the work where a processor draws
    return actor


def set_actor_placement(actor: pv.Actor, placement: Placement) -> None:
    """Set the placement on the stage of an actor whose mesh is in motion space."""
    actor.SetPosition(placement.position[0], placement.position[1], 0.0)
    actor.SetOrientation(0.0, 0.0, math.degrees(placement.heading))


def pose_skin(
    skin: SkinnedMesh,
    character: Character,
    posed: PosedPerformer,
    vertices: NDArray[np.float32] | None = None,
    normals: NDArray[np.float32] | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Vertices and normals (V, 3) in motion space of ``skin``, a skin of ``character``, in a pose with its fingers.

    They are written in place if arrays are given.
    """
    motion, row = posed.motion, posed.row
    body, fingers = motion.morphology_at(row), posed.fingers if skin.rig is not None else None
    hands = bound_hands(skin, character.build, body) if fingers and not fingers.is_at_rest else None
    return skin_vertices(
        skin, character.build, body, motion.positions[row], motion.rotations[row],
        vertices, normals, character.blending,
        partial(hands.shaped, poses=fingers) if hands and fingers else None,
    )  # fmt: skip


class DrawnSkin(NamedTuple):
    """Skin, and the mesh that draws it."""

    mesh: LiveMesh
    skin: SkinnedMesh

    @classmethod
    def of(cls, skin: SkinnedMesh) -> "DrawnSkin":
        """``skin`` with a new mesh."""
        return cls(LiveMesh(len(skin.vertices), skin.triangles), skin)


class BodyVisual:
    """VTK objects of a character, as skin and as bones; only one of the two is posed and visible at a time."""

    def __init__(self, character: Character) -> None:
        self._character = character
        self._drawn = self._whole = DrawnSkin.of(character.skin)
        self._bones: BoneFigure | None = None
        look = character.skin.appearance
        if look is None:
            self.skin_actors = [make_actor(self._whole.mesh, character.colour)]
            self._give_panels(self._whole)
            draw_seams(self.skin_actors[0], character.colour)
        else:
            self.skin_actors = material_actors(self._whole.mesh, character.skin.triangles, look)
        self.bones_actor: pv.Actor | None = None
        self._coarse: DrawnSkin | None = None
        self._coarse_skin: Future[SkinnedMesh] | None = None
        self._posing: tuple[object, ...] = ()
        """Pose and motion that were drawn last; the same ones again cost nothing."""

    def coarsen(self, coarse: bool) -> None:
        """Draw the next poses with fewer vertices (``coarse``) or with all; a skin with materials is always drawn in
        full.

        The coarse skin is computed in the background, and the full one is drawn until then.
        """
        if self._character.skin.appearance is not None:
            return
        drawn = self._coarse_or_whole() if coarse else self._whole
        if drawn is not self._drawn:
            self._drawn = drawn
            self.skin_actors[0].mapper.SetInputData(drawn.mesh.polydata)

    def _coarse_or_whole(self) -> DrawnSkin:
        if self._coarse_skin is None:
            self._coarse_skin = coarse_skin_beside(self._character.skin)
        if self._coarse is None and self._coarse_skin.done():
            self._coarse = DrawnSkin.of(self._coarse_skin.result())
            self._give_panels(self._coarse)
        return self._coarse or self._whole

    def _give_panels(self, drawn: DrawnSkin) -> None:
        data = drawn.mesh.polydata.point_data
        data[PANEL_FIELD] = panel_field(drawn.skin, self._character.build.layout)
        data.active_scalars_name = PANEL_FIELD

    def can_show(self, character: Character) -> bool:
        """True if these objects can show ``character``: its proportions and colour may differ, but not its skin."""
        return character.skin is self._character.skin and character.build is self._character.build

    def take_skin(self, character: Character) -> None:
        """Show a changed version of the same character; materials keep their colours."""
        if character.colour != self._character.colour:
            if character.skin.appearance is None:
                draw_seams(self.skin_actors[0], character.colour)
            if self.bones_actor is not None:
                self.bones_actor.prop.color = character.colour
        self._character = character

    @property
    def actors(self) -> list[pv.Actor]:
        return [*self.skin_actors, *([self.bones_actor] if self.bones_actor is not None else [])]

    def make_bones(self, layout: BodyLayout) -> pv.Actor:
        """Actor of the bones, made on first use."""
        self._bones = BoneFigure(layout)
        self.bones_actor = make_actor(self._bones.mesh, self._character.colour)
        return self.bones_actor

    def pose(self, posed: PosedPerformer, bones: bool) -> None:
        """Show a pose at its placement on the stage, as ``bones`` or as skin."""
        motion, row = posed.motion, posed.row
        for actor in self.skin_actors:
            actor.SetVisibility(not bones)
            set_actor_placement(actor, posed.placement)
        if self.bones_actor is not None:
            self.bones_actor.SetVisibility(bones)
        if bones and self._bones is not None and self.bones_actor is not None:
            self._bones.pose(motion.positions[row])
            set_actor_placement(self.bones_actor, posed.placement)
            return
        mesh, shown = self._drawn.mesh, with_grip(self._drawn.skin, posed.grip(self._character.grip))
        posing = mesh, shown, self._character.blending, motion, row, posed.shape_of_hands
        if posing == self._posing:
            return
        self._posing = posing
        if posed.resting and motion.morphology == self._character.build:
            # As it was bound: needs no kernel, which may not be compiled yet.
            mesh.points[:], mesh.normals[:] = shown.vertices, shown.normals
        else:
            pose_skin(shown, self._character, posed, mesh.points, mesh.normals)
        mesh.touch()
