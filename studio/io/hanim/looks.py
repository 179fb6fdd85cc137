"""Colours and textures of VRML and X3D shapes."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.io.figure.textures import checked_picture
from studio.io.gltf.materials import hex_colour
from studio.io.hanim.scene import SceneNode
from studio.io.referenced_files import path_beside, read_bytes

_LARGEST_PICTURE = 100_000_000


class ShapeMaterials:
    """Materials of one file, equal ones shared. Missing pictures are reported in ``repairs``."""

    def __init__(self, path: Path) -> None:
        self.repairs: list[str] = []
        self._path = path
        self._pictures: dict[tuple[str, ...], NDArray[np.uint8] | None] = {}
        self._materials: dict[tuple[str, int, bool], Material] = {}

    def material(self, shape: SceneNode, two_sided: bool) -> Material:
        """Material of a Shape."""
        appearance = shape.node("appearance")
        texture = self._texture(appearance.node("texture")) if appearance is not None else None
        colour = "#FFFFFF" if texture is not None else _colour(appearance)
        key = (colour, id(texture), two_sided)
        if key not in self._materials:
            self._materials[key] = Material("", colour, texture, two_sided)
        return self._materials[key]

    def _texture(self, node: SceneNode | None) -> NDArray[np.uint8] | None:
        if node is None or node.kind != "ImageTexture":
            return None
        urls = tuple(node.texts("url"))
        if urls not in self._pictures:
            self._pictures[urls] = self._picture(urls, node.where)
        return self._pictures[urls]

    def _picture(self, urls: tuple[str, ...], where: str) -> NDArray[np.uint8] | None:
        """First of these files that exists."""
        for url in urls:
            try:
                return checked_picture(read_bytes(path_beside(url, self._path, where), _LARGEST_PICTURE))
            except ValueError as error:
                self.repairs.append(f"{where}: the image '{url[:80]}' was left out, {error}.")
                return None
            except StudioError:
                continue
        named = f"'{urls[0][:80]}'" if urls else "that it names"
        self.repairs.append(f"{where}: the image {named} is not beside the file; the plain colour is shown.")
        return None


def _colour(appearance: SceneNode | None) -> str:
    material = appearance.node("material") if appearance is not None else None
    if material is None:
        return "#CCCCCC"
    if material.kind == "PhysicalMaterial":
        return hex_colour(material.vector("baseColor", (1.0, 1.0, 1.0)))
    glow = material.vector("emissiveColor", (0.0, 0.0, 0.0))
    return hex_colour(material.vector("diffuseColor", (0.8, 0.8, 0.8)) + 0.6 * glow)
