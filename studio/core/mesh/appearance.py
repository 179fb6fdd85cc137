"""Appearance of a skin: colours and textures of its materials, and texture coordinates."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

_COLOUR = re.compile(r"#[0-9A-Fa-f]{6}")


@dataclass(frozen=True, eq=False)
class Material:
    """Material: ``colour`` is ``#RRGGBB`` and tints the texture if there is one.

    Raises ValueError if the colour is invalid or the texture is not a row of bytes.
    """

    name: str
    colour: str
    texture: NDArray[np.uint8] | None = None
    """(B,) bytes of a PNG or JPEG file, as they came."""
    two_sided: bool = False
    cut_out: bool = False
    """True if the surface has holes where its texture is transparent: lashes, hair, leaves."""

    def __post_init__(self) -> None:
        if not _COLOUR.fullmatch(self.colour):
            raise ValueError(f"colour: expected #RRGGBB, got '{self.colour}'.")
        if self.texture is not None:
            texture = self.texture if _is_frozen(self.texture) else _frozen(self.texture, np.uint8)
            if texture.ndim != 1 or not len(texture):
                raise ValueError("texture: expected the bytes of a picture.")
            object.__setattr__(self, "texture", texture)

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
    """(T,) index of each triangle's material."""
    coordinates: NDArray[np.float32]
    """(V, 2) place in the texture: 0 to 1 to the right and upwards, repeating beyond."""

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


def _is_frozen(array: NDArray[Any]) -> bool:
    """True for bytes that nobody can change: one picture may be shared by materials."""
    return array.dtype == np.uint8 and array.base is None and not array.flags.writeable


def _frozen(array: Any, kind: type) -> NDArray[Any]:
    frozen: NDArray[Any] = np.array(array, dtype=kind)
    frozen.setflags(write=False)
    return frozen
