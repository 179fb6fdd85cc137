"""Interpretation of a TRC file as a capture."""

from pathlib import Path

from studio.core.captures.annotations import Annotations
from studio.io.importing import ImportOptions
from studio.io.markers.trial_capture import read_capture_of_trial
from studio.io.registry import Progress, ReadCapture
from studio.io.trc.reader import read_trc


def load_trc(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture of the body solved from the markers of the TRC file at ``path``, or of its markers alone if their labels
    are unknown.
    """
    file = read_trc(path, lambda share: progress(0.4 * share, f"Reading {path.name}"))
    return read_capture_of_trial(file.trial, file.repairs, Annotations(), options, progress)
