"""USD as a format of the registry: text, crate and package; a file with a skinned mesh is a character."""

from pathlib import Path

from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture, ReadCharacter
from studio.io.scene.capture import capture_in
from studio.io.scene.character import character_in
from studio.io.scene.scene_reader import SceneReader

USD_READER = SceneReader("USD", "studio.io.usd.child", "pxr", "usd-core")


def is_usd(head: bytes) -> bool:
    """True if a file that begins with ``head`` is USD: text, a crate, or a package whose first file is one of these."""
    size = int.from_bytes(head[26:28], "little")
    first = head[30 : 30 + size].lower()
    packed = head.startswith(b"PK\x03\x04") and first.endswith((b".usd", b".usda", b".usdc"))
    return packed or head.startswith((b"#usda ", b"PXR-USDC"))


def load_capture(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture in the USD file at ``path``: its longest animation of a skeleton. Raises StudioError."""
    return capture_in(USD_READER.read(path, "motion", progress), path, options, progress)


def load_character(path: Path, options: ImportOptions, progress: Progress) -> ReadCharacter:
    """Character in the USD file at ``path``: skeleton, meshes, materials and the body. Raises StudioError."""
    return character_in(USD_READER.read(path, "figure", progress), path, options, progress)


def load_either(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture | ReadCharacter:
    """Character if a mesh of the file is bound to a skeleton, else the capture. Raises StudioError."""
    arrays = USD_READER.read(path, "either", progress)
    return (capture_in if "frames" in arrays else character_in)(arrays, path, options, progress)
