"""What a verb writes never takes the place of a file that is there, unless it is told so."""

from collections.abc import Iterable
from pathlib import Path

from studio.core.errors import StudioError


def refuse_replacing(paths: Iterable[Path], source: Path, overwrite: bool) -> None:
    """Raise StudioError where a file that is to be written is there, or is the one that is read; before any work."""
    if overwrite:
        return
    for path in paths:
        if path.exists():
            what = "is the file that is read" if source.exists() and path.samefile(source) else "is there already"
            raise StudioError(f"'{path}' {what}. Choose another place, or replace it with --overwrite.")
