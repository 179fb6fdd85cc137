"""The materials of a character: an actor for each, with its base colour and its texture."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.appearance import Appearance, Material
from studio.io.textures import shown_picture
from studio.viewport.live_mesh import LiveMesh
from studio.viewport.surfaces import actor_of, put_coordinates, texture_of

_HOLES = """//VTK::TCoord::Impl
  if (fragOutput0.a < 0.5) { discard; }
"""


def material_actors(mesh: LiveMesh, triangles: NDArray[np.int32], look: Appearance) -> list[Any]:
    """An actor for every material that some triangles of ``mesh`` have."""
    pictures: dict[tuple[int, bool], Any] = {}
    actors = []
    for index in np.unique(look.triangle_materials):
        material = look.materials[index]
        polydata = mesh.part(triangles[look.triangle_materials == index])
        actor = actor_of(polydata, material.colour)  # clothes and hair of single sheets are seen from both sides
        picture = _picture(material, pictures)
        if picture is not None:
            put_coordinates(polydata, look.coordinates)
            actor.SetTexture(picture)
            if material.cut_out:
                actor.ForceOpaqueOn()  # holes need no sorting
                actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::TCoord::Impl", True, _HOLES, False)
        actors.append(actor)
    return actors


def _picture(material: Material, known: dict[tuple[int, bool], Any]) -> Any:
    if material.texture is None:
        return None
    key = id(material.texture), material.cut_out
    if key not in known:
        try:
            pixels = shown_picture(material.texture.tobytes())
        except ValueError:  # said when it was imported; the base colour stays
            known[key] = None
        else:
            channels = 4 if material.cut_out else 3
            texture = texture_of(pixels[..., :channels])
            texture.RepeatOn()
            texture.InterpolateOn()
            texture.MipmapOn()
            known[key] = texture
    return known[key]
