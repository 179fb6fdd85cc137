"""Actors for the materials of a character, with base colour and texture."""

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from studio.core.mesh.appearance import Appearance, Material
from studio.io.figure.textures import shown_picture
from studio.viewport.live_mesh import LiveMesh

_HOLES = """//VTK::TCoord::Impl
  if (fragOutput0.a < 0.5) { discard; }
"""


def material_actors(mesh: LiveMesh, triangles: NDArray[np.int32], look: Appearance) -> list[pv.Actor]:
    """One VTK actor for each material that is used by triangles of ``mesh``."""
    pictures: dict[tuple[int, bool], pv.Texture | None] = {}
    actors = []
    for index in np.unique(look.triangle_materials):
        material = look.materials[index]
        polydata = mesh.part(triangles[look.triangle_materials == index])
        actor = pv.Actor(mapper=pv.DataSetMapper(polydata))
        actor.mapper.scalar_visibility = False
        actor.prop.color = material.colour
        actor.prop.culling = "none"  # clothes and hair of single sheets are seen from both sides
        picture = _picture(material, pictures)
        if picture is not None:
            polydata.active_texture_coordinates = look.coordinates.astype(np.float64)
            actor.texture = picture
            if material.cut_out:
                actor.ForceOpaqueOn()  # holes need no sorting
                actor.GetShaderProperty().AddFragmentShaderReplacement("//VTK::TCoord::Impl", True, _HOLES, False)
        actors.append(actor)
    return actors


def _picture(material: Material, known: dict[tuple[int, bool], pv.Texture | None]) -> pv.Texture | None:
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
            texture = pv.Texture(np.ascontiguousarray(pixels[..., :channels]))
            texture.repeat = True
            texture.interpolate = True
            texture.mipmap = True
            known[key] = texture
    return known[key]
