"""A C3D file as a capture, and its events."""

from pathlib import Path

from studio.core.captures.annotations import Annotations, Label
from studio.core.captures.capture import Capture
from studio.core.markers.cleaning import USUAL_STEPS
from studio.core.markers.take import MarkerTake
from studio.core.markers.trial import Trial
from studio.io.c3d.reader import read_c3d
from studio.io.importing import ImportOptions
from studio.io.markers.capture import capture_of_take
from studio.io.markers.maps import find_subject, unreadable_maps
from studio.io.markers.unit import in_believable_unit
from studio.io.registry import Progress, ReadCapture


def load_c3d(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """The body that moves in the C3D file at ``path``, or its bare markers where nobody knows which is which.

    Its events are labels of one frame.
    """
    file = read_c3d(path, lambda share, text: progress(0.4 * share, text))

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        progress(0.4, f"Finding the body in {path.name}")
        subject = find_subject(file.trial)
        trial, marker_map, guesses = in_believable_unit(file.trial, options.marker_map, subject, options.unit)
        steps = USUAL_STEPS if options.marker_steps is None else options.marker_steps
        take = MarkerTake(trial, marker_map, steps, subject)
        repairs = (*file.repairs, *unreadable_maps())
        capture = capture_of_take(take, options, repairs, lambda share, text: progress(0.4 + 0.6 * share, text))
        for guess in guesses:
            capture = capture.with_guess(guess)
        return capture

    read = ReadCapture(interpret(options, progress), _events(file.trial), interpret)
    progress(1.0, f"Loaded {path.name}")
    return read


def _events(trial: Trial) -> Annotations:
    """The events of a trial as labels of one frame; contacts are for the feet to tell."""
    frames = [round(trial.event_frame(event)) for event in trial.events]
    labels = (
        Label(event.label if event.context == "General" else f"{event.context} {event.label}".strip(), frame, frame)
        for event, frame in zip(trial.events, frames, strict=True)
        if 0 <= frame < trial.frame_count
    )
    return Annotations(labels=tuple(labels))
