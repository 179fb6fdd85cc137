"""The kinds of files that hold characters, and which one a file is."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from studio.core.errors import StudioError

if TYPE_CHECKING:
    from studio.io.figure_body import ReadCharacter

_SNIFFED = 4096


@dataclass(frozen=True)
class CharacterFormat:
    """A kind of file; its reader is imported when the first such file is read."""

    name: str
    suffixes: tuple[str, ...]
    sniff: Callable[[bytes], bool]
    reader: str
    """``module:function``."""

    def read(self, path: Path) -> "ReadCharacter":
        """The character in the file; raises StudioError."""
        module, function = self.reader.split(":")
        reader: Callable[[Path], ReadCharacter] = getattr(import_module(module), function)
        return reader(path)


def _plain(head: bytes) -> bytes:
    return head.lstrip(b"\xef\xbb\xbf \t\r\n")


CHARACTER_FORMATS = (
    CharacterFormat(
        "glTF, GLB, VRM",
        (".gltf", ".glb", ".vrm"),
        lambda head: head[:4] == b"glTF" or (b'"asset"' in head and _plain(head)[:1] == b"{"),
        "studio.io.gltf.character:read_gltf_character",
    ),
    CharacterFormat(
        "X3D H-Anim",
        (".x3d",),
        lambda head: _plain(head)[:1] == b"<" and b"<X3D" in head,
        "studio.io.hanim.character:read_x3d_character",
    ),
    CharacterFormat(
        "VRML H-Anim",
        (".wrl", ".x3dv", ".vrml"),
        lambda head: _plain(head)[:5] in (b"#VRML", b"#X3D "),
        "studio.io.hanim.character:read_vrml_character",
    ),
    CharacterFormat(
        "Morpho Studio character",
        (".json",),
        lambda head: b'"morpho-studio character"' in head,
        "studio.io.character_file:read_own_character",
    ),
)


def load_character(path: Path) -> "ReadCharacter":
    """The character in the file at ``path``. Raises StudioError with what is damaged and what to do."""
    return character_format_of(path).read(path)


def holds_character(path: Path) -> bool:
    """Whether a file's suffix is that of a character file."""
    return any(path.suffix.lower() in known.suffixes for known in CHARACTER_FORMATS)


def character_format_of(path: Path) -> CharacterFormat:
    """The format of the file by its first bytes, else by its suffix; StudioError if neither tells."""
    try:
        with path.open("rb") as file:
            head = file.read(_SNIFFED)
    except OSError as error:
        raise StudioError(f"{path.name} could not be read: {error.strerror}. Check the file and try again.") from error
    by_content = [known for known in CHARACTER_FORMATS if known.sniff(head)]
    by_suffix = [known for known in CHARACTER_FORMATS if path.suffix.lower() in known.suffixes]
    if not by_content and not by_suffix:
        names = ", ".join(known.name for known in CHARACTER_FORMATS)
        raise StudioError(f"{path.name} is no character the studio reads. It reads {names}.")
    return (by_content or by_suffix)[0]
