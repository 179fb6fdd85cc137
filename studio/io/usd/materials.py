"""Materials of a skin as preview surfaces of USD, with textures as pictures beside the file."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.appearance import Material

_THRESHOLD = 0.5
"""Below this much of its picture's alpha, a surface with holes has one."""


def bind_materials(
    stage: Any, mesh: Any, materials: Sequence[Material], of_triangles: NDArray[np.int32], stem: str
) -> dict[str, bytes]:
    """Make a surface for each material, bind it to its triangles, and return the pictures by name.

    The surfaces look for pictures under these names beside the file; the names begin with ``stem``.
    """
    from pxr import UsdGeom, UsdShade, Vt

    files: dict[int, str] = {}
    pictures: dict[str, bytes] = {}
    names = identifiers([material.name for material in materials])
    for index, (name, material) in enumerate(zip(names, materials, strict=True)):
        if material.texture is not None and id(material.texture) not in files:
            content = material.texture.tobytes()
            file = f"{stem}_{name}" + (".png" if content.startswith(b"\x89PNG") else ".jpg")
            files[id(material.texture)], pictures[file] = file, content
        made = UsdShade.Material.Define(stage, mesh.GetPath().GetParentPath().AppendPath(f"Materials/{name}"))
        _surface(stage, made, material, files.get(id(material.texture)))
        covered = np.flatnonzero(of_triangles == index).astype(np.int32)
        subset = UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).CreateMaterialBindSubset(
            name, Vt.IntArray.FromNumpy(covered), UsdGeom.Tokens.face
        )
        UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(made)
    return pictures


def identifiers(names: list[str]) -> list[str]:
    """Unique names that USD allows."""
    from pxr import Tf

    allowed: list[str] = []
    for name in names:
        valid, number = Tf.MakeValidIdentifier(name), 2
        while valid in allowed:
            valid, number = f"{Tf.MakeValidIdentifier(name)}_{number}", number + 1
        allowed.append(valid)
    return allowed


def _surface(stage: Any, made: Any, material: Material, picture: str | None) -> None:
    """Set the surface's colour, which tints the picture if there is one, and cut holes where the picture is
    transparent.
    """
    from pxr import Sdf

    surface = _shader(stage, made, "Surface", "UsdPreviewSurface")
    made.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    colour = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    if picture is None:
        colour.Set(material.linear_colour)
        return
    places = _shader(stage, made, "Places", "UsdPrimvarReader_float2")
    places.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture = _shader(stage, made, "Texture", "UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{picture}"))
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
    texture.CreateInput("scale", Sdf.ValueTypeNames.Float4).Set((*material.linear_colour, 1.0))
    for side in ("wrapS", "wrapT"):
        texture.CreateInput(side, Sdf.ValueTypeNames.Token).Set("repeat")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(places.ConnectableAPI(), "result")
    places.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    colour.ConnectToSource(texture.ConnectableAPI(), "rgb")
    if material.cut_out:
        texture.CreateOutput("a", Sdf.ValueTypeNames.Float)
        surface.CreateInput("opacity", Sdf.ValueTypeNames.Float).ConnectToSource(texture.ConnectableAPI(), "a")
        surface.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(_THRESHOLD)


def _shader(stage: Any, made: Any, name: str, kind: str) -> Any:
    from pxr import UsdShade

    shader = UsdShade.Shader.Define(stage, made.GetPath().AppendChild(name))
    shader.CreateIdAttr(kind)
    return shader
