"""Output files of verbs: existing files are replaced only with ``--overwrite``."""

from collections.abc import Iterable
from pathlib import Path

from studio.core.errors import StudioError


def refuse_replacing(paths: Iterable[Path], source: Path, overwrite: bool) -> None:
    """Raise StudioError if a file to write exists already, or is the source; to be called before any work."""
    if overwrite:
        return
    for path in paths:
        if path.exists():
            what = "is the input file" if source.exists() and path.samefile(source) else "already exists"
            raise StudioError(f"'{path}' {what}. Choose another path, or replace it with --overwrite.")
