"""Characters on disk come back as they were, and damage is told in a sentence."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.morphology import Proportions
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.io.project.character_file import (
    bundled_characters,
    mesh_bytes,
    read_character,
    read_mesh,
    write_character,
)


@pytest.fixture
def character() -> Character:
    return replace(bundled_characters()["child"], proportions=Proportions(thighs=1.2))


@pytest.fixture
def path(character: Character, tmp_path: Path) -> Path:
    path = tmp_path / "dancer.json"
    write_character(character, path)
    return path


def test_a_character_written_and_read_is_the_same(character: Character, path: Path):
    again = read_character(path)
    assert (again.name, again.colour, again.proportions) == (
        character.name,
        character.colour,
        character.proportions,
    )
    assert again.build == character.build
    for member in ("vertices", "normals", "centres", "triangles", "segments", "weights"):
        assert np.array_equal(getattr(again.skin, member), getattr(character.skin, member))


def test_the_same_mesh_gives_the_same_bytes(character: Character):
    assert mesh_bytes(character.skin) == mesh_bytes(character.skin)


def test_a_bundled_character_takes_less_than_300_kb(path: Path):
    assert path.stat().st_size + path.with_suffix(".npz").stat().st_size < 300_000


@pytest.mark.parametrize("keep", [0, 10, 5_000])
def test_a_cut_mesh_is_refused(character: Character, keep: int):
    with pytest.raises(StudioError, match="the mesh is damaged"):
        read_mesh(mesh_bytes(character.skin)[:keep], "cut.npz")
