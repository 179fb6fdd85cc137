"""Reports as JSON files, whole or not at all."""

import json
from pathlib import Path

from studio.io.replacing import write_whole


def write_json(path: Path, value: object) -> None:
    """Write ``value`` as JSON. Raises StudioError when it cannot be written."""
    write_whole(path, (json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode())
