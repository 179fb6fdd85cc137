"""Floor drift of a capture, measured from its footprints: reported, because adaptation removes it (METHOD 5)."""

from dataclasses import replace

from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.normalized.normalize import sole_heights

REPORTED_DRIFT = 0.01
"""Least drift in metres that is reported."""
REASON = "As far apart lie the footprints of one foot. It is taken off when the motion is set on the ground."


def floor_drift(capture: Capture) -> float:
    """Metres between the lowest and the highest floor in the footprints of one foot; 0 if there are not two."""
    if capture.body_map is None:
        return 0.0
    return max((max(heights) - min(heights) for heights in sole_heights(capture) if heights), default=0.0)


def with_drift_reported(capture: Capture) -> Capture:
    """Capture with the drift of its floor among its guesses, if it is large enough to report."""
    drift = floor_drift(capture)
    if drift < REPORTED_DRIFT:
        return capture
    guess = Guess("floor drift", f"{100.0 * drift:.1f} cm", REASON, Confidence.SURE)
    return replace(capture, guesses=(*capture.guesses, guess))
