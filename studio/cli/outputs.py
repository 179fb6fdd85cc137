"""What a verb writes never takes the place of a file that is there, unless it is told so."""

from argparse import ArgumentParser
from collections.abc import Iterable
from pathlib import Path

from studio.core.errors import StudioError


def add_output_options(parser: ArgumentParser) -> None:
    """How to say that files may be replaced."""
    parser.add_argument("--overwrite", action="store_true", help="replace files that are there already")


def refuse_replacing(paths: Iterable[Path], source: Path, overwrite: bool) -> None:
    """Raise StudioError where a file that is to be written is there, or is the one that is read; before any work."""
    if overwrite:
        return
    for path in paths:
        if path.exists():
            what = "is the file that is read" if source.exists() and path.samefile(source) else "is there already"
            raise StudioError(f"'{path}' {what}. Choose another place, or replace it with --overwrite.")
