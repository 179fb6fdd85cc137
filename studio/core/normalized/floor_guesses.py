"""Guesses about the floor of a capture that need its normalised motion: its drift, and steps on it."""

from dataclasses import replace

from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.normalized.normalize import captured_steps, sole_heights

REPORTED_DRIFT_METRES = 0.01
"""Least drift in metres that is reported."""
DRIFT_REASON = (
    "Height between the highest and the lowest footprint of one foot. It is removed when the motion is retargeted."
)
STEPS_REASON = (
    "Its feet stand at several heights. Use steps as ground (--on-steps): every body then stands on these steps;"
    " until then only feet on the floor are contacts."
)


def floor_drift(capture: Capture) -> float:
    """Height difference in metres of the lowest and highest footprints of one foot; 0 if there are not two.

    It is reported to the user because adaptation removes it (METHOD 5).
    """
    if capture.body_map is None:
        return 0.0
    return max((max(heights) - min(heights) for heights in sole_heights(capture) if heights), default=0.0)


def steps_guess(capture: Capture) -> Guess | None:
    """Guess that the capture was recorded on steps, which the user may accept; None if there are none."""
    steps = captured_steps(capture)
    if steps is None:
        return None
    sizes = f"{steps.count} of {100.0 * steps.rise:.0f} cm, {100.0 * steps.tread:.0f} cm deep, not used"
    return Guess("steps", sizes, STEPS_REASON, Confidence.LIKELY)


def with_floor_reported(capture: Capture) -> Capture:
    """Capture whose guesses include the drift of its floor, if it is large enough to report, and steps on it."""
    guesses, drift, steps = [], floor_drift(capture), steps_guess(capture)
    if drift >= REPORTED_DRIFT_METRES:
        guesses.append(Guess("floor drift", f"{100.0 * drift:.1f} cm", DRIFT_REASON, Confidence.SURE))
    if steps is not None:
        guesses.append(steps)
    return replace(capture, guesses=(*capture.guesses, *guesses)) if guesses else capture
