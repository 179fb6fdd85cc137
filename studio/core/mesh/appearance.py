"""Appearance of a skin: colours and textures of its materials, and texture coordinates."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

NORMAL_MAP, EMISSIVE_MAP, OCCLUSION_MAP, METALLIC_ROUGHNESS_MAP, METALLIC_MAP, ROUGHNESS_MAP = MATERIAL_MAPS = (
    "normal",
    "emissive",
    "occlusion",
    "metallic_roughness",
    "metallic",
    "roughness",
)
"""glTF has metallic and roughness in one picture, FBX in two."""
_COLOUR = re.compile(r"#[0-9A-Fa-f]{6}")


@dataclass(frozen=True, eq=False)
class Material:
    """Material of a mesh; ``colour`` is ``#RRGGBB`` and tints the texture if there is one.

    Raises ValueError if the colour is invalid or the texture is no byte array.
    """

    name: str
    colour: str
    texture: NDArray[np.uint8] | None = None
    """Bytes (B,) of a PNG or JPEG file, unchanged."""
    two_sided: bool = False
    cut_out: bool = False
    """True if the surface has holes where its texture is transparent: lashes, hair, leaves."""
    metallic: float = 0.0
    roughness: float = 1.0
    """Roughness from 0 to 1; it scales its map, as ``metallic`` does."""
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Emitted linear light; it scales the emissive map."""
    maps: Mapping[str, NDArray[np.uint8]] = field(default_factory=dict)
    """Pictures (B,) by their names in ``MATERIAL_MAPS``, at the same texture coordinates; kept for exports and not
    drawn.
    """

    def __post_init__(self) -> None:
        if not _COLOUR.fullmatch(self.colour):
            raise ValueError(f"colour: expected #RRGGBB, got '{self.colour}'.")
        if self.texture is not None:
            object.__setattr__(self, "texture", _picture(self.texture))
        if unknown := sorted(set(self.maps) - set(MATERIAL_MAPS)):
            raise ValueError(f"maps: a material has no map '{unknown[0]}'.")
        maps = {name: _picture(picture) for name, picture in self.maps.items()}
        object.__setattr__(self, "maps", MappingProxyType(maps))
        if not np.isfinite([self.metallic, self.roughness, *self.emission]).all():
            raise ValueError("metallic, roughness and emission are finite numbers.")

    @property
    def pictures(self) -> tuple[NDArray[np.uint8], ...]:
        """Texture and maps."""
        return (*(() if self.texture is None else (self.texture,)), *self.maps.values())

    @property
    def linear_colour(self) -> tuple[float, float, float]:
        """``colour`` as linear light (IEC 61966-2-1, sRGB), 0 to 1."""
        shares = np.array([int(self.colour[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0
        linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
        red, green, blue = linear.round(6).tolist()
        return red, green, blue


@dataclass(frozen=True, eq=False)
class Appearance:
    """Materials of a mesh of V vertices and T triangles.

    Raises ValueError if a shape is wrong or a triangle's material does not exist.
    """

    materials: tuple[Material, ...]
    triangle_materials: NDArray[np.int32]
    """Index (T,) of the material of each triangle."""
    coordinates: NDArray[np.float32]
    """Texture coordinates (V, 2): 0 to 1 to the right and upwards, repeating beyond."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "triangle_materials", _frozen(self.triangle_materials, np.int32))
        object.__setattr__(self, "coordinates", _frozen(self.coordinates, np.float32))
        if self.triangle_materials.ndim != 1 or self.coordinates.ndim != 2 or self.coordinates.shape[1] != 2:
            raise ValueError("appearance: expected a material for each triangle and two coordinates for each vertex.")
        if not np.isfinite(self.coordinates).all():
            raise ValueError("appearance: a texture coordinate is not finite.")
        indices = self.triangle_materials
        if len(indices) and (indices.min() < 0 or indices.max() >= len(self.materials)):
            raise ValueError("appearance: a triangle names a material that is not there.")


def _picture(content: NDArray[np.uint8]) -> NDArray[np.uint8]:
    picture: NDArray[np.uint8] = content if _is_frozen(content) else _frozen(content, np.uint8)
    if picture.ndim != 1 or not len(picture):
        raise ValueError("texture: expected the bytes of a picture.")
    return picture


def _is_frozen(array: NDArray[Any]) -> bool:
    """True for bytes that cannot be changed: materials may then share one picture."""
    return array.dtype == np.uint8 and array.base is None and not array.flags.writeable


def _frozen(array: Any, kind: type) -> NDArray[Any]:
    frozen: NDArray[Any] = np.array(array, dtype=kind)
    frozen.setflags(write=False)
    return frozen
