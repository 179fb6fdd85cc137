"""The character in a glTF, GLB or VRM file."""

from pathlib import Path

from studio.io.figure.body import character_of
from studio.io.gltf.figure import read_figure
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCharacter


def load_character(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Read joints, meshes and materials, and find the body. Raises StudioError."""
    progress(0.0, f"Reading {path.name}")
    figures = read_figure(path)
    progress(0.5, f"Finding the body in {path.name}")
    return character_of(figures, options)
