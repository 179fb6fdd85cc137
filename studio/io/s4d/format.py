"""Registration of S4D files, their recognition, and writing of takes."""

from dataclasses import replace
from pathlib import Path

from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.normalized.normalize import detected_contacts, normalize_capture
from studio.io.export import Take
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture

_FIRST_MEMBER = b"s4d.json"
_NORMALISED = 0.3
"""The share of writing one after which the motion is normalised."""


def is_s4d(head: bytes) -> bool:
    """True if a file that begins with ``head`` is an S4D file: a ZIP whose first member is the record."""
    return head.startswith(b"PK\x03\x04") and head[30 : 30 + len(_FIRST_MEMBER)] == _FIRST_MEMBER


def load_s4d(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture from which the file was made, within 0.1 mm and 0.01 degrees, and its stored annotations."""
    from studio.io.s4d.reader import read_s4d

    progress(0.0, f"Reading {path.name}")
    stored = read_s4d(path)

    def interpret(options: ImportOptions, _progress: Progress) -> Capture:
        return _as_said(stored.capture, path, options)

    read = ReadCapture(interpret(options, progress), stored.annotations, interpret)
    progress(1.0, f"Loaded {path.name}")
    return read


def _as_said(capture: Capture, path: Path, options: ImportOptions) -> Capture:
    for name in ("unit", "up_axis", "reference"):
        if getattr(options, name) not in (None, getattr(capture, name, None)):
            raise StudioError(
                f"{path.name} is in metres with Z up and has its reference pose: {name.replace('_', ' ')} cannot be"
                f" chosen. Read {capture.source or 'the file it was made from'} again for that."
            )
    if options.frame_rate is not None:
        capture = capture.with_frame_rate(options.frame_rate)
    if options.floor is not None:
        capture = capture.with_floor(options.floor)
    return capture if options.body_map is None else capture.with_body_map(options.body_map)


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write the morphology-independent motion of ``take`` with its actor. Raises StudioError for a body that is not
    human.
    """
    from studio.io.s4d.writer import S4d, write_s4d

    def normalising(share: float) -> None:
        progress(_NORMALISED * share, f"Normalising {take.name}")

    normalising(0.0)
    annotations = take.annotations
    if annotations.contacts is None:
        annotations = replace(annotations, contacts=detected_contacts(take.capture, ""))
    motion, actor = normalize_capture(take.capture, normalising)
    s4d = S4d(take.capture, motion, actor, annotations)
    write_s4d(path, s4d, lambda share, text: progress(_NORMALISED + (1.0 - _NORMALISED) * share, text))
