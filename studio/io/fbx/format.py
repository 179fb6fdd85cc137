"""Registration of FBX files: a file is read once, and its content decides if it is a character."""

from pathlib import Path

from studio.io.fbx.reading import FBX_READER
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture, ReadCharacter
from studio.io.scene.capture import capture_in
from studio.io.scene.character import character_in


def load_capture(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture in the FBX file at ``path``: its longest animation. Raises StudioError with what to do."""
    return capture_in(FBX_READER.read(path, "motion", progress), path, options, progress)


def load_character(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character in the FBX file at ``path``: joints, meshes, materials and the body. Raises StudioError with what to
    do.
    """
    return character_in(FBX_READER.read(path, "figure", progress), path, options, progress)


def load_either(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture | ReadCharacter:
    """Character if a skin of the file is bound to joints, else the capture. Raises StudioError."""
    arrays = FBX_READER.read(path, "either", progress)
    return (capture_in if "frames" in arrays else character_in)(arrays, path, options, progress)
