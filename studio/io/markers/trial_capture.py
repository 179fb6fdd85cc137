"""Interpretation of a marker trial, of any format, as a capture that can be interpreted again with other options."""

from collections.abc import Sequence

from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.markers.cleaning import USUAL_STEPS
from studio.core.markers.take import MarkerTake
from studio.core.markers.trial import Trial
from studio.io.importing import ImportOptions
from studio.io.markers.capture import capture_of_take
from studio.io.markers.maps import find_subject, unreadable_maps
from studio.io.markers.unit import with_plausible_unit
from studio.io.registry import Progress, ReadCapture

_FILE_READ = 0.4
"""Fraction of the work that is done after the file has been read."""


def read_capture_of_trial(
    trial: Trial,
    repairs: Sequence[str],
    annotations: Annotations,
    options: ImportOptions,
    progress: Progress,
) -> ReadCapture:
    """Capture of the body solved from ``trial``, or of its markers alone if their labels are unknown. Raises
    StudioError.

    ``repairs`` are those made while reading the file.
    """

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        progress(_FILE_READ, f"Finding the body in {trial.source}")
        subject = find_subject(trial)
        in_unit, marker_map, guesses = with_plausible_unit(trial, options.marker_map, subject, options.unit)
        steps = USUAL_STEPS if options.marker_steps is None else options.marker_steps
        take = MarkerTake(in_unit, marker_map, steps, subject)
        told = lambda share, text: progress(_FILE_READ + (1.0 - _FILE_READ) * share, text)  # noqa: E731
        capture = capture_of_take(take, options, (*repairs, *unreadable_maps()), told)
        for guess in guesses:
            capture = capture.with_guess(guess)
        return capture

    read = ReadCapture(interpret(options, progress), annotations, interpret)
    progress(1.0, f"Loaded {trial.source}")
    return read
