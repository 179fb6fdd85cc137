"""ZIP files written in pieces, so that long ones can be followed and cancelled."""

import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.io.registry import Progress
from studio.io.replacing import replacing

_PIECE = 1 << 20


def write_zip(path: Path, members: Mapping[str, bytes], level: int, progress: Progress) -> None:
    """Write ``members``, deflated at ``level`` (0 to 9), whole or not at all; equal members give equal bytes.

    Raises StudioError when it cannot be written; ``progress`` may raise to cancel.
    """
    total, done = sum(map(len, members.values())) or 1, 0
    with replacing(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=level) as archive:
        for name, content in members.items():
            with archive.open(name, "w") as stream:
                for first in range(0, len(content), _PIECE):
                    progress(done / total, f"Writing {path.name}")
                    stream.write(memoryview(content)[first : first + _PIECE])
                    done += min(_PIECE, len(content) - first)


def npy(array: NDArray[Any]) -> bytes:
    """An array as a ``.npy`` file."""
    stream = BytesIO()
    np.lib.format.write_array(stream, array, version=(1, 0), allow_pickle=False)
    return stream.getvalue()
