"""Files that another file refers to: only those in the folder of that file are ever opened."""

import base64
import binascii
import re
from collections.abc import Set
from pathlib import Path, PureWindowsPath
from stat import S_ISREG
from urllib.parse import unquote

from studio.core.errors import StudioError

LARGEST_REFERENCED_BYTES = 500_000_000
"""Maximum size of a file in bytes; a larger one is refused unread."""
SNIFFED_BYTES = 4096
"""Number of bytes at the begin of a file by which its format is recognised."""


_POINTERS = (b"version https://git-lfs.github.com/spec/", b"/annex/objects/")
_PAGE = re.compile(
    rb"(\xef\xbb\xbf)?\s*(<\?xml[^>]*>\s*)?(<!--.*?-->\s*)*<(!doctype\s+html|html|head|body|error)\b|40[34]: ",
    re.DOTALL | re.IGNORECASE,
)
"""A page of the web, or the sentence of a server that has no such file."""
_NOTHING = b"\0 \t\r\n\f\v\x1a"
"""Bytes that are no content."""

_ARCHIVES = {
    "ZIP": b"PK\x03\x04",
    "7z": b"7z\xbc\xaf\x27\x1c",
    "RAR": b"Rar!\x1a\x07",
    "gzip": b"\x1f\x8b\x08",
    "bzip2": b"BZh",
    "xz": b"\xfd7zXZ\x00",
}
"""First bytes of archives and compressed files, by the name of their kind."""
_OTHER_KINDS = {
    "a PNG picture": b"\x89PNG\r\n",
    "a JPEG picture": b"\xff\xd8\xff",
    "a PDF document": b"%PDF-",
    "a Blender scene": b"BLENDER",
    "a Maya scene": b"//Maya ASCII",
    "a Unity asset": b"%YAML 1.1\n%TAG !u!",
    "a note of macOS about another file": b"\x00\x05\x16\x07",
}
"""First bytes of files that are taken for captures and characters, by what they are."""
_TAR_AT = 257
"""Byte at which a tar archive says that it is one."""


def refuse_archive(name: str, head: bytes, own: Set[str]) -> None:
    """Raise StudioError if the file ``name``, which begins with ``head``, is an archive of other files.

    Kinds in ``own`` are accepted, for a format whose files may be such archives.
    """
    kinds = [kind for kind, begin in _ARCHIVES.items() if head.startswith(begin)]
    if head[_TAR_AT:].startswith(b"ustar"):
        kinds = ["tar"]
    if kinds and kinds[0] not in own:
        raise StudioError(f"{name} is a packed file ({kinds[0]}). Unpack it, then open the files that were in it.")


def refuse_other_kind(name: str, head: bytes) -> None:
    """Raise StudioError if the file ``name``, which begins with ``head``, is of a known kind that holds no motion and
    no character for the studio.
    """
    kind = next((kind for kind, begin in _OTHER_KINDS.items() if head.startswith(begin)), None)
    if kind is not None:
        raise StudioError(
            f"{name} is {kind}, whatever its name says. Choose another file, or export it as BVH, FBX or GLB."
        )


def refuse_stand_in(name: str, head: bytes) -> None:
    """Raise StudioError if the file ``name``, which begins with ``head``, is only a placeholder for another one."""
    if head.startswith(_POINTERS):
        raise StudioError(f"{name} is a Git LFS pointer, not the file itself. Fetch it with 'git lfs pull'.")
    if _PAGE.match(head):
        raise StudioError(f"{name} is a web page, not the file itself. Download the file again, not the page about it.")
    if not head:
        raise StudioError(f"{name} is empty. Copy or export it again.")
    if not head.strip(_NOTHING):
        raise StudioError(f"{name} is empty: it begins with nothing but blanks or zeros. Copy or export it again.")


def refuse_devices(path: Path) -> None:
    """Raise StudioError if ``path`` is a pipe, a device, a folder or no valid name; reading might never end."""
    try:
        ordinary = S_ISREG(path.stat().st_mode)
    except FileNotFoundError:
        return  # whoever opens it says so
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise StudioError(f"{path.name[:80]!r} could not be read: {reason}. Check its name and try again.") from error
    if not ordinary:
        raise StudioError(f"{path.name} could not be read: it is not an ordinary file. Choose another.")


def read_bytes(path: Path, largest: int = LARGEST_REFERENCED_BYTES) -> bytes:
    """Content of an ordinary file. Raises StudioError if it is none, is too large or cannot be read."""
    refuse_devices(path)
    try:
        if not path.is_file():
            raise StudioError(f"{path.name} could not be read: there is no such file. Check the name and try again.")
        size = path.stat().st_size
        if size > largest:
            raise StudioError(f"{path.name} has {size / 1e6:.0f} MB; the studio reads up to {largest / 1e6:.0f} MB.")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise StudioError(f"{path.name} could not be read: {reason}. Check the file and try again.") from error


def content_of(uri: str, beside: Path, where: str) -> bytes:
    """Bytes at ``uri``, which contains them (``data:``), or names a file in the folder of ``beside``.

    Raises StudioError, which begins with ``where``, if it leads out of the folder or is not readable.
    """
    if uri.startswith("data:"):
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            raise StudioError(f"{where}: its data are not in base64. Export the file again.")
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError) as error:
            raise StudioError(f"{where}: its base64 data are damaged. Export the file again.") from error
    path = path_beside(uri, beside, where)
    content = read_bytes(path)
    refuse_stand_in(path.name, content[:SNIFFED_BYTES])
    return content


def path_beside(uri: str, beside: Path, where: str) -> Path:
    """Path of the file ``uri`` in the folder of ``beside``, or below it. Raises StudioError if it leads elsewhere."""
    name = unquote(uri)
    shown = name if len(name) < 80 else f"{name[:80]}…"
    windows = PureWindowsPath(name)
    if "://" in name or "\0" in name or windows.is_absolute() or windows.drive or name.startswith(("/", "\\")):
        raise StudioError(
            f"{where}: it names '{shown}', which is not in its folder. Put it there and name it by its file name alone."
        )
    folder = beside.resolve().parent
    try:
        path = (folder / name.replace("\\", "/")).resolve()
    except (OSError, RuntimeError) as error:
        raise StudioError(f"{where}: '{shown}' is not the name of a file.") from error
    if folder not in path.parents:
        raise StudioError(
            f"{where}: it names '{shown}', which leads out of its folder. Put it there and name it by its file name"
            " alone."
        )
    return path
