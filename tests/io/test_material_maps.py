"""Maps of materials beside the base colour: read, kept in projects, and written again as they came."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.mesh.appearance import Appearance, Material
from studio.core.mesh.character import Character
from studio.io.export import take_of_standing, write_take
from studio.io.importing import load_character
from studio.io.png import png_bytes
from studio.io.project.character_file import bundled_characters, read_character, write_character
from tests.io.khronos import issues_of


def picture(shade: int) -> np.ndarray:
    """The bytes of a small picture."""
    return np.frombuffer(png_bytes(np.full((4, 4, 4), shade, np.uint8)), np.uint8)


def dressed(*maps: str) -> Character:
    """A character of one material with these maps."""
    character = bundled_characters()["child"]
    mesh = character.skin
    material = Material(
        "cloth", "#FFFFFF", picture(200), metallic=0.25, roughness=0.5, emission=(0.5, 0.25, 1.0),
        maps={name: picture(10 * index) for index, name in enumerate(maps)},
    )  # fmt: skip
    look = Appearance((material,), np.zeros(len(mesh.triangles), int), np.full((len(mesh.vertices), 2), 0.25))
    return replace(character, skin=replace(mesh, appearance=look))


def assert_same_maps(one: Material, other: Material) -> None:
    assert dict(one.maps).keys() == dict(other.maps).keys()
    for name, content in one.maps.items():
        assert content.tobytes() == other.maps[name].tobytes()
    assert one.emission == pytest.approx(other.emission)


@pytest.mark.parametrize(
    ("suffix", "maps"),
    [
        (".glb", ("normal", "emissive", "occlusion", "metallic_roughness")),
        (".fbx", ("normal", "emissive", "metallic", "roughness")),
    ],
)
def test_maps_of_a_material_are_written_and_read_as_they_came(tmp_path: Path, suffix: str, maps) -> None:
    character, path = dressed(*maps), tmp_path / f"out{suffix}"
    write_take(take_of_standing(character), path)
    [read] = load_character(path).character.skin.appearance.materials
    [given] = character.skin.appearance.materials
    assert_same_maps(given, read)
    if suffix == ".glb":
        assert (read.metallic, read.roughness) == (0.25, 0.5)
        assert issues_of(path)["numErrors"] == 0


def test_maps_of_a_material_are_kept_with_its_character(tmp_path: Path) -> None:
    character, path = dressed("normal", "emissive"), tmp_path / "child.json"
    write_character(character, path)
    [given], [read] = (each.skin.appearance.materials for each in (character, read_character(path)))
    assert_same_maps(given, read)
    assert (read.metallic, read.roughness) == (0.25, 0.5)


def test_a_map_of_another_name_is_refused() -> None:
    with pytest.raises(ValueError, match="no map 'shine'"):
        Material("cloth", "#FFFFFF", maps={"shine": picture(0)})
