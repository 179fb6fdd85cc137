"""How far the floor of a capture drifts, as its footprints show it: told, for an adaptation takes it off (METHOD 4)."""

from dataclasses import replace

from studio.core.captures.capture import Capture, Guess
from studio.core.normalized.normalize import sole_heights

REPORTED_DRIFT = 0.01
"""Metres of drift from which on it is told."""
REASON = "As far apart lie the footprints of one foot. It is taken off when the motion is set on the ground."


def floor_drift(capture: Capture) -> float:
    """Metres between the lowest and the highest floor that footprints of one foot show; 0 where there are not two."""
    if capture.body_map is None:
        return 0.0
    return max((max(heights) - min(heights) for heights in sole_heights(capture) if heights), default=0.0)


def with_drift_told(capture: Capture) -> Capture:
    """The capture with the drift of its floor among its guesses, where that is worth telling."""
    drift = floor_drift(capture)
    if drift < REPORTED_DRIFT:
        return capture
    return replace(capture, guesses=(*capture.guesses, Guess("floor drift", f"{100.0 * drift:.1f} cm", REASON)))
