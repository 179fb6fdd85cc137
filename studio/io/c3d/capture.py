"""A C3D file as a capture, and its events."""

from pathlib import Path

from studio.core.captures.annotations import Annotations, Label
from studio.core.captures.capture import Capture
from studio.core.markers.cleaning import USUAL_STEPS
from studio.core.markers.take import MarkerTake
from studio.io.c3d.reader import read_c3d
from studio.io.importing import ImportOptions
from studio.io.markers.capture import capture_of_take
from studio.io.markers.maps import find_map, find_subject, unreadable_maps
from studio.io.registry import Progress


def load_c3d(path: Path, options: ImportOptions, progress: Progress) -> Capture:
    """The body that moves in the C3D file at ``path``, or its bare markers where nobody knows which is which."""
    file = read_c3d(path, lambda share, text: progress(0.4 * share, text))
    progress(0.4, f"Finding the body in {path.name}")
    subject = find_subject(file.trial)
    marker_map = options.marker_map or find_map(file.trial, subject)
    steps = USUAL_STEPS if options.marker_steps is None else options.marker_steps
    take = MarkerTake(file.trial, marker_map, steps, subject)
    repairs = (*file.repairs, *unreadable_maps())
    capture = capture_of_take(take, options, repairs, lambda share, text: progress(0.4 + 0.6 * share, text))
    progress(1.0, f"Loaded {path.name}")
    return capture


def load_events(path: Path, motion_id: str) -> Annotations:
    """The events of the C3D file at ``path`` as labels of one frame; contacts are for the feet to tell."""
    trial = read_c3d(path).trial
    labels = []
    for event in trial.events:
        frame = round(trial.event_frame(event))
        if 0 <= frame < trial.frame_count:
            labels.append(Label(f"{event.context} {event.label}".strip(), frame, frame))
    return Annotations(labels=tuple(labels)).of_motion(motion_id)
