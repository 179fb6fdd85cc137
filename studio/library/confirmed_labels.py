"""Labels confirmed by a person, stored in two equal files beside the catalogue because they cannot be recomputed."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from studio.core.errors import StudioError
from studio.io.atomic_write import atomic_replacements
from studio.io.json_text import json_of
from studio.io.referenced_files import read_bytes
from studio.library.clip_labels import ClipLabel

CONFIRMED_LABELS, LABELS_COPY = LABEL_FILES = "labels.json", "labels-copy.json"
LABELS_VERSION = 1

Labels = dict[str, tuple[ClipLabel, ...]]
"""Labels of each capture, by the path of its file."""


class NewerLabels(StudioError):  # noqa: N818 - it names the matter
    """Error: the file of labels was written by a newer version."""


def read_labels(path: Path) -> Labels | None:
    """Confirmed labels in the file ``path``, by the path of their capture; None if there is no such file.

    Raises StudioError if the file cannot be read, NewerLabels if a newer version wrote it, and ValueError if its digest
    differs from that of its content.
    """
    if not path.exists():
        return None
    record = json_of(read_bytes(path))
    try:
        version, text, digest = record["version"], json.dumps(record["labels"], sort_keys=True), record["digest"]
        if _digest(text) != digest:
            raise ValueError("its digest is wrong")
        if version > LABELS_VERSION:
            raise NewerLabels(f"its labels are of version {version}")
        return {path: tuple(map(ClipLabel.from_json, labels)) for path, labels in record["labels"].items()}
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError("it is not a record of labels") from error


def write_labels(folder: Path, labels: Mapping[str, Sequence[ClipLabel]]) -> None:
    """Replace the labels in both files of ``folder``, each completely or not at all. Raises StudioError."""
    records = {path: [label.to_json() for label in found] for path, found in labels.items() if found}
    digest = _digest(json.dumps(records, sort_keys=True))
    content = {"version": LABELS_VERSION, "digest": digest, "labels": records}
    with atomic_replacements(*(folder / name for name in LABEL_FILES)) as parts:
        for part in parts:
            part.write_text(json.dumps(content, sort_keys=True, indent=1))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
