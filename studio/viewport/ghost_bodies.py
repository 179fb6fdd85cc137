"""Translucent characters in one colour: onion skins and added ghosts."""

from collections.abc import Callable, Sequence

import pyvista as pv

from studio.core.mesh.character import Character
from studio.core.mesh.skin import with_grip
from studio.core.stage.project import Project
from studio.viewport.bodies import make_actor, pose_skin, set_actor_placement
from studio.viewport.coarse import coarse_skin
from studio.viewport.live_mesh import LiveMesh
from studio.viewport.onion_skins import Ghost


class GhostBody:
    """Coarse skin of a character at one moment."""

    def __init__(self, character: Character) -> None:
        self.character = character
        self._skin = coarse_skin(character.skin)
        self._mesh = LiveMesh(len(self._skin.vertices), self._skin.triangles)
        self.actor = make_actor(self._mesh, character.colour)
        self._posing: tuple[object, ...] = ()

    def show(self, ghost: Ghost, character: Character) -> None:
        """Show a ghost of a character that has the same skin as before."""
        posed, self.character = ghost.pose, character
        motion, row = posed.motion, posed.row
        self.actor.prop.color, self.actor.prop.opacity = ghost.colour, ghost.opacity
        self.actor.SetVisibility(True)
        set_actor_placement(self.actor, posed.placement)
        shown = with_grip(self._skin, posed.grip(character.grip))
        posing = shown, character.blending, motion, row, posed.shape_of_hands
        if posing != self._posing:
            self._posing = posing
            pose_skin(shown, character, posed, self._mesh.points, self._mesh.normals)
            self._mesh.touch()


class GhostBodies:
    """Ghosts in the 3D view; ``sync`` updates them and reuses their meshes."""

    def __init__(self, add: Callable[[pv.Actor], None], remove: Callable[[pv.Actor], None]) -> None:
        self._add, self._remove = add, remove
        self._bodies: list[GhostBody] = []

    def sync(self, project: Project, ghosts: Sequence[Ghost]) -> None:
        """Show exactly these ghosts."""
        for number, ghost in enumerate(ghosts):
            character = project.characters[ghost.pose.performer.character_id]
            self._body(number, character).show(ghost, character)
        for body in self._bodies[len(ghosts) :]:
            body.actor.SetVisibility(False)

    def _body(self, number: int, character: Character) -> GhostBody:
        known = self._bodies[number] if number < len(self._bodies) else None
        if known is not None and known.character.skin is character.skin and known.character.build is character.build:
            return known
        body = GhostBody(character)
        self._add(body.actor)
        if known is None:
            self._bodies.append(body)
        else:
            self._remove(known.actor)
            self._bodies[number] = body
        return body
