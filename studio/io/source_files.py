"""Search for source files that have moved, by their content, else by their name."""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.io.referenced_files import LARGEST_REFERENCED_BYTES
from studio.io.registry import Progress, known_formats

MOST_SEARCHED_FILES = 2000
"""Maximum number of files of one search; known folders are the user's own, and may be large."""


class SourceMissing(StudioError):  # noqa: N818 - it names what is the case
    """Error: the source file of a capture was not found."""


@dataclass(frozen=True)
class SourceFile:
    """File with the name and the content of a capture's source, or with only one of them."""

    path: Path
    digest: str
    """SHA-256 of the content in hexadecimal digits."""


def digest_of(path: Path) -> str:
    """SHA-256 of a file's content. Raises StudioError if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise StudioError(f"{path.name} could not be read: {error.strerror}. Check the file and try again.") from error


def find_source(capture: Capture, known: Path | None, folders: Iterable[Path], progress: Progress) -> SourceFile:
    """File with the content of a capture's source, else one with its name.

    The search covers ``known``, its former path, then ``folders`` and their subfolders: files with its name first, then
    other captures. Raises SourceMissing if there is none.
    """
    name, digest = capture.source, capture.digest
    files = list(dict.fromkeys(_files(folders)))[:MOST_SEARCHED_FILES]
    called = [
        *([known] if known is not None and known.is_file() else ()),
        *(each for each in files if each.name == name),
    ]
    alike = sorted(files, key=lambda path: path.suffix.lower() != Path(name).suffix.lower())
    for index, path in enumerate(dict.fromkeys([*called, *alike]) if digest else ()):
        progress(index / (len(called) + len(files)), f"Looking for {name}")
        try:
            if path.stat().st_size <= LARGEST_REFERENCED_BYTES and digest_of(path) == digest:
                return SourceFile(path, digest)
        except (OSError, StudioError):
            continue  # what cannot be read is not what is looked for
    if called:
        return SourceFile(called[0], digest_of(called[0]))
    raise SourceMissing(f"The source file of {capture.name} cannot be found. Relink it with File > Relink source…")


def _files(folders: Iterable[Path]) -> Iterator[Path]:
    """Files that may be captures, those in a folder before those in its subfolders."""
    suffixes = known_formats().suffixes("capture_reader")
    for folder in folders:
        try:
            inside = sorted(folder.iterdir())
            yield from (each for each in inside if each.suffix.lower() in suffixes and each.is_file())
            for each in inside:
                if each.is_dir() and not each.name.startswith("."):
                    yield from (file for file in sorted(each.iterdir()) if file.suffix.lower() in suffixes)
        except OSError:
            continue  # a folder that is gone or closed holds nothing
