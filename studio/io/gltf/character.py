"""The character in a glTF, GLB or VRM file."""

from pathlib import Path

from studio.io.figure_body import ReadCharacter, character_of
from studio.io.gltf.figure import read_figure


def read_gltf_character(path: Path) -> ReadCharacter:
    """Read joints, meshes and materials, and find the body. Raises StudioError."""
    return character_of(read_figure(path))
