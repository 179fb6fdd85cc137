"""Conversion of the character in an H-Anim file."""

from pathlib import Path

from studio.io.figure.body import character_of
from studio.io.hanim.humanoid import figure_of
from studio.io.hanim.vrml import read_vrml
from studio.io.hanim.x3d import read_x3d
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCharacter


def load_x3d(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character: the humanoid of an .x3d file. Raises StudioError."""
    progress(0.0, f"Reading {path.name}")
    scene = read_x3d(path)
    progress(0.5, f"Finding the body in {path.name}")
    return character_of([figure_of(scene, path)], options)


def load_vrml(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character: the humanoid of a .wrl or .x3dv file. Raises StudioError."""
    progress(0.0, f"Reading {path.name}")
    scene = read_vrml(path)
    progress(0.5, f"Finding the body in {path.name}")
    return character_of([figure_of(scene, path)], options)
