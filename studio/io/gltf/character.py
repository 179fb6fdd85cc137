"""Conversion of the character in a glTF, GLB or VRM file."""

from pathlib import Path

from studio.io.figure.body import character_of
from studio.io.gltf.container import GltfFile, read_gltf
from studio.io.gltf.figure import figures_in
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCharacter


def load_character(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character in the file at ``path``: joints, meshes, materials and the body. Raises StudioError."""
    progress(0.0, f"Reading {path.name}")
    return character_in(read_gltf(path), options, progress)


def character_in(file: GltfFile, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character in ``file``: joints, meshes, materials and the body found in them. Raises StudioError."""
    figures = figures_in(file)
    progress(0.5, f"Finding the body in {file.path.name}")
    return character_of(figures, options)
