"""Search for files of sounds and footage that have moved, by their name in known folders."""

import os
from collections.abc import Iterable
from pathlib import Path

from studio.core.errors import StudioError


class MediaMissing(StudioError):  # noqa: N818 - it names what is the case
    """Error: the file of a sound or of footage was not found."""


def find_media(source: str, name: str, folders: Iterable[Path]) -> Path:
    """Path of the sound or footage ``name``: ``source``, or a file with its name in ``folders``.

    Raises MediaMissing if there is neither.
    """
    path = Path(source)
    # Unlike those of Path, this takes a name that no file can have, or a closed folder, for no file.
    found = next((each for each in (path, *(folder / path.name for folder in folders)) if os.path.exists(each)), None)
    if found is None:
        raise MediaMissing(f"The file {path.name} of {name} cannot be found. Relink it.")
    return found
