"""The character in an H-Anim file."""

from pathlib import Path

from studio.io.figure_body import ReadCharacter, character_of
from studio.io.hanim.humanoid import figure_of
from studio.io.hanim.vrml import read_vrml
from studio.io.hanim.x3d import read_x3d


def read_x3d_character(path: Path) -> ReadCharacter:
    """The humanoid of an .x3d file. Raises StudioError."""
    return character_of([figure_of(read_x3d(path), path)])


def read_vrml_character(path: Path) -> ReadCharacter:
    """The humanoid of a .wrl or .x3dv file. Raises StudioError."""
    return character_of([figure_of(read_vrml(path), path)])
