"""The kinds of files that hold captures, and which one a file is."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from studio.core.errors import StudioError

if TYPE_CHECKING:
    from studio.core.capture import Capture
    from studio.io.importing import ImportOptions

Progress = Callable[[float, str], None]
Reader = Callable[[Path, "ImportOptions", Progress], "Capture"]

_SNIFFED = 4096


@dataclass(frozen=True)
class CaptureFormat:
    """A kind of file; its reader is imported when the first such file is read."""

    name: str
    suffixes: tuple[str, ...]
    sniff: Callable[[bytes], bool]
    reader: str
    """``module:function``."""

    def read(self, path: Path, options: "ImportOptions", progress: Progress) -> "Capture":
        """The capture in the file; raises StudioError."""
        module, function = self.reader.split(":")
        reader: Reader = getattr(import_module(module), function)
        return reader(path, options, progress)


def _is_bvh(head: bytes) -> bool:
    return head.lstrip(b"\xef\xbb\xbf \t\r\n")[:9].upper() == b"HIERARCHY"


CAPTURE_FORMATS = (CaptureFormat("BVH", (".bvh",), _is_bvh, "studio.io.bvh_capture:load_bvh"),)


def format_of(path: Path) -> CaptureFormat:
    """The format of the file by its first bytes, else by its suffix; StudioError if neither tells."""
    try:
        with path.open("rb") as file:
            head = file.read(_SNIFFED)
    except OSError as error:
        raise StudioError(f"{path.name} could not be read: {error.strerror}. Check the file and try again.") from error
    by_content = [known for known in CAPTURE_FORMATS if known.sniff(head)]
    by_suffix = [known for known in CAPTURE_FORMATS if path.suffix.lower() in known.suffixes]
    if not by_content and not by_suffix:
        names = ", ".join(known.name for known in CAPTURE_FORMATS)
        raise StudioError(f"{path.name} is no capture the studio reads. It reads {names}.")
    return (by_content or by_suffix)[0]
