"""Registration of glTF files: a file is read once, and its content decides if it is a character."""

from pathlib import Path

from studio.io.gltf.capture import capture_in
from studio.io.gltf.character import character_in
from studio.io.gltf.container import read_gltf
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture, ReadCharacter


def load_either(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture | ReadCharacter:
    """Capture of a file that holds animations but no meshes, else the character. Raises StudioError."""
    progress(0.0, f"Reading {path.name}")
    file = read_gltf(path)
    alone = bool(file.root.records("animations")) and not file.root.records("meshes")
    return (capture_in if alone else character_in)(file, options, progress)
