"""Reports as JSON files, whole or not at all."""

import json
from pathlib import Path

from studio.core.errors import StudioError


def write_json(path: Path, value: object) -> None:
    """Write ``value`` beside ``path``, then rename. Raises StudioError when it cannot be written."""
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_text(json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise StudioError(f"{path} could not be written: {error.strerror}. Choose another folder.") from error
