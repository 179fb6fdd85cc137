"""Materials of a glTF file: base colour, its texture, and further maps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.mesh.appearance import EMISSIVE_MAP, METALLIC_ROUGHNESS_MAP, NORMAL_MAP, OCCLUSION_MAP, Material
from studio.io.figure.textures import checked_picture
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.container import GltfFile
from studio.io.json_record import Record
from studio.io.referenced_files import content_of


@dataclass(frozen=True, eq=False)
class TexturePlacing:
    """Set of texture coordinates of a texture, and their transform (KHR_texture_transform)."""

    set: int
    form: NDArray[np.float64]
    """(2, 2)"""
    offset: NDArray[np.float64]
    """(2,)"""

    @classmethod
    def of(cls, slot: Record) -> "TexturePlacing":
        """Placing of a texture's record; its ``extensions`` take precedence over the set."""
        moved = slot.inner("extensions").inner("KHR_texture_transform")
        angle = moved.number("rotation", 0.0)
        c, s = np.cos(angle), np.sin(angle)
        form = np.array([[c, s], [-s, c]]) * moved.numbers("scale", (1.0, 1.0))
        offset = np.array(moved.numbers("offset", (0.0, 0.0)))
        return cls(moved.whole("texCoord", slot.whole("texCoord", 0)), form, offset)

    def is_same(self, other: "TexturePlacing") -> bool:
        """True if both place their textures at the same coordinates."""
        return self.set == other.set and np.allclose(self.form, other.form) and np.allclose(self.offset, other.offset)

    def applied_to(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions (V, 2) in the picture, from its lower left, for a file's coordinates, from its upper left."""
        return (coordinates @ self.form.T + self.offset) * [1.0, -1.0] + [0.0, 1.0]


class Materials:
    """Materials of one glTF file by index; pictures that cannot be shown are reported in ``repairs``."""

    def __init__(self, file: GltfFile, accessors: Accessors) -> None:
        self.repairs: list[str] = []
        self._file, self._accessors = file, accessors
        self._pictures: dict[int, NDArray[np.uint8] | None] = {}
        self._images = file.root.records("images")
        self._textures = file.root.records("textures")
        self._materials = [self._material(record) for record in file.root.records("materials")]

    @property
    def count(self) -> int:
        """Number of materials in the file."""
        return len(self._materials)

    def __getitem__(self, index: int) -> tuple[Material, "TexturePlacing"]:
        """Material, and the placing of its texture."""
        return self._materials[index]

    def _material(self, record: Record) -> tuple[Material, "TexturePlacing"]:
        surface = record.inner("pbrMetallicRoughness")
        linear = np.clip(surface.numbers("baseColorFactor", (1.0, 1.0, 1.0, 1.0))[:3], 0.0, 1.0)
        slot = surface.inner("baseColorTexture")
        texture = self._texture(slot) if "index" in slot else None
        slots = {
            NORMAL_MAP: record.inner("normalTexture"),
            EMISSIVE_MAP: record.inner("emissiveTexture"),
            OCCLUSION_MAP: record.inner("occlusionTexture"),
            METALLIC_ROUGHNESS_MAP: surface.inner("metallicRoughnessTexture"),
        }
        given = {name: each for name, each in slots.items() if "index" in each}
        placed_by = slot if texture is not None else next(iter(given.values()), slot)
        placing = TexturePlacing.of(placed_by)
        maps = {name: self._map(each, placing) for name, each in given.items()}
        red, green, blue = np.clip(record.numbers("emissiveFactor", (0.0, 0.0, 0.0)), 0.0, 1.0).tolist()
        material = Material(
            record.text("name"), hex_colour(srgb_of_linear(linear)), texture, record.flag("doubleSided"),
            record.text("alphaMode", "OPAQUE") != "OPAQUE",
            surface.number("metallicFactor", 1.0), surface.number("roughnessFactor", 1.0), (red, green, blue),
            {name: picture for name, picture in maps.items() if picture is not None},
        )  # fmt: skip
        return material, placing

    def _map(self, slot: Record, placing: TexturePlacing) -> NDArray[np.uint8] | None:
        """Picture of a map; None, with a repair, if its coordinates are not those of the base colour."""
        if TexturePlacing.of(slot).is_same(placing):
            return self._texture(slot)
        self.repairs.append(f"{slot.where}: it has other coordinates than the base colour; it was left out.")
        return None

    def _texture(self, slot: Record) -> NDArray[np.uint8] | None:
        texture = slot.index("index", len(self._textures))
        source = self._textures[texture or 0].index("source", len(self._images)) if self._textures else None
        if source is None:
            self.repairs.append(f"{slot.where}: its image has a format the studio does not read; it was left out.")
            return None
        if source not in self._pictures:
            self._pictures[source] = self._picture(self._images[source])
        return self._pictures[source]

    def _picture(self, image: Record) -> NDArray[np.uint8] | None:
        try:
            if "uri" in image:
                content = content_of(image.text("uri"), self._file.path, image.where)
            else:
                content = self._accessors.view_bytes(image.whole("bufferView"))
            return checked_picture(content)
        except ValueError as error:
            self.repairs.append(f"{image.where}: the image was left out, {error}.")
        except StudioError as error:
            self.repairs.append(f"An image was left out. {error}")
        return None


def srgb_of_linear(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """sRGB values of linear light (IEC 61966-2-1)."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def hex_colour(colour: NDArray[np.float64]) -> str:
    """``#RRGGBB`` of three components from 0 to 1."""
    return "#" + "".join(f"{round(255 * float(share)):02X}" for share in np.clip(colour, 0.0, 1.0))
