"""Conversion of a C3D file to a capture, with its events."""

from pathlib import Path

from studio.core.captures.annotations import Annotations, Label
from studio.core.markers.trial import Trial
from studio.io.c3d.reader import read_c3d
from studio.io.importing import ImportOptions
from studio.io.markers.trial_capture import read_capture_of_trial
from studio.io.registry import Progress, ReadCapture


def load_c3d(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Body solved from the markers of the C3D file at ``path``, or the markers alone if their labels are unknown.

    Its events are labels of one frame.
    """
    file = read_c3d(path, lambda share, text: progress(0.4 * share, text))
    return read_capture_of_trial(file.trial, file.repairs, _events(file.trial), options, progress)


def _events(trial: Trial) -> Annotations:
    """Events of a trial as labels of one frame; contacts are found from the feet."""
    frames = [round(trial.event_frame(event)) for event in trial.events]
    labels = (
        Label(event.label if event.context == "General" else f"{event.context} {event.label}".strip(), frame, frame)
        for event, frame in zip(trial.events, frames, strict=True)
        if 0 <= frame < trial.frame_count
    )
    return Annotations(labels=tuple(labels))
