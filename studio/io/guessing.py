"""Guesses of values that a file does not state: unit, floor, frame rate, first frame of the motion."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.plausible import UNIT_RANGE
from studio.core.runs import runs_of
from studio.io.numbers import number

FloatArray = NDArray[np.float64]

METRES_PER_UNIT = {
    "m": 1.0,
    "dm": 0.1,
    "cm": 0.01,
    "mm": 0.001,
    "inch": 0.0254,
    "foot": 0.3048,
    "cmu": 0.0254 / 0.45,
}
"""Length in metres of each unit; ``cmu`` is that of the raw CMU files, 1 / 0.45 inch."""
_USUAL_LEG = 0.85
_ANY_LEG, _ADULT_LEG, _SAID_LEG = (0.25, 2.0), (0.7, 1.0), (0.12, 2.2)
"""Metres of a leg from a small child to a giant of four metres, of a usual adult, and of a body, be it a toy's, whose
file says its unit."""
_RARE = ("inch", "foot", "cmu")
"""Units that only a usual adult makes plausible."""
_ADULT_SLENDER = 1.4
"""Length of an adult's legs in that of its trunk, from hips to shoulders, at least; a toddler's are 1.0 to 1.3."""
_USUAL_LEGS = (0.35, 1.15)
"""Metres of the legs of most people: a unit that makes others is likely at most."""
_FARTHER = 0.35, 0.7
"""Logarithms of the ratio by which the legs in the second best unit are farther from a usual adult's, from which the
best one is likely, and sure."""
_SCATTERED = 0.06, 0.02
"""Metres by which the heights of standing feet may scatter about the ground that is likely, and sure."""
_ALIASES = {"in": "inch", "inches": "inch", "ft": "foot", "feet": "foot"}

_SAME_UNIT = 1e-4
_USUAL_RATE = 30.0
_FOOT_HEIGHT = 0.08
"""Ankle above the ground where a skeleton has nothing below it."""
SOLE_THICKNESS_METRES = 0.02
"""Usual distance in metres from the lowest joint of a foot to the ground."""
_CALIBRATED = 0.035
"""Up to this height the lowest joints of the feet speak for a floor at zero: they lie inside the foot."""
_STEP = 0.14
"""Parts of a leg's length by which one level that is stood on lies above another at least."""
_RESTING, _REST, _SHOWN = 0.25, 0.08, 4
"""Metres a second of a foot that stands, seconds for which it does, and levels that a sentence names."""
_LONGEST_SNAP = 0.1
"""Seconds over which a filter may have smeared the snap out of a calibration pose."""


class Scale(NamedTuple):
    """Unit of length: its name and its length in metres."""

    unit: str
    metres: float


def leg_and_trunk(positions: FloatArray, body_map: BodyMap | None) -> tuple[float, float] | tuple[None, None]:
    """Mean length of the legs (thigh and shank together), and mean distance from the middle of the shoulders to that of
    the hips.

    Both are in the unit of ``positions`` (F, J, 3); None if there is no body.
    """
    if body_map is None:
        return None, None
    shoulders, hips, knees, ankles = (
        positions[:, [body_map[BodyPart[f"{side}_{part}"]] for side in ("LEFT", "RIGHT")]]
        for part in ("UPPER_ARM", "THIGH", "SHANK", "FOOT")
    )
    leg = np.linalg.norm(knees - hips, axis=-1) + np.linalg.norm(ankles - knees, axis=-1)
    trunk = np.linalg.norm(shoulders.mean(axis=1) - hips.mean(axis=1), axis=-1)
    return float(leg.mean()), float(trunk.mean())


def choose_unit(
    leg: float | None, said: Scale | None = None, chosen: str | None = None, trunk: float | None = None
) -> tuple[Scale, Guess | None]:
    """Unit of a file: ``chosen`` by the user, else ``said`` by the file or format if it is plausible, else guessed.

    A stated unit is plausible if it is in ``UNIT_RANGE`` and its legs have the length of a body. ``leg`` is the length
    of the legs in file units, None without a known body, and ``trunk`` that from hips to shoulders. The second value is
    None if nothing was guessed.
    """
    if chosen is not None:
        return parse_unit(chosen, leg), None
    fits = said is None or leg is None or _SAID_LEG[0] <= leg * said.metres <= _SAID_LEG[1]
    if said is not None and fits and UNIT_RANGE.least <= said.metres <= UNIT_RANGE.most:
        return said, None
    if leg is None:
        reason = "Without a human body nothing tells the unit; most files are in cm."
        if said is not None:
            reason = f"The file says {said.metres:g} m, which is not plausible. {reason}"
        return Scale("cm", 0.01), Guess("unit", "cm", reason, Confidence.DOUBTFUL)
    scale, guess = guess_unit(leg, trunk)
    if said is not None:
        words = f"In {said.unit}, as the file says, the legs would be {leg * said.metres:.3g} m long. {guess.reason}"
        guess = replace(guess, reason=words)
    return scale, guess


def unit_of_metres(metres: float) -> Scale:
    """Unit with the length ``metres``, by its name if it has one."""
    named = (unit for unit, length in METRES_PER_UNIT.items() if abs(length - metres) < _SAME_UNIT * metres)
    return Scale(next(named, f"{metres:.9g}"), metres)


def guess_unit(leg: float, trunk: float | None = None) -> tuple[Scale, Guess]:
    """Unit in which legs of ``leg`` units, below a trunk of ``trunk`` units, come nearest to human ones;
    and the guess.
    """
    stout = trunk is not None and leg < _ADULT_SLENDER * trunk
    units = [name for name in METRES_PER_UNIT if _fits(name, leg)]
    fits = [name for name in units if not (stout and name in _RARE)]
    if not fits:
        metres = _USUAL_LEG / leg
        reason = f"No unit makes its legs of {leg:.4g} units plausible; they were made {_USUAL_LEG} m long."
        value = f"unknown, taken as {metres * 100:.4g} cm"
        return Scale("unknown", metres), Guess("unit", value, reason, Confidence.DOUBTFUL)

    def unlike(unit: str) -> float:
        return abs(float(np.log(leg * METRES_PER_UNIT[unit] / _USUAL_LEG)))

    fits.sort(key=unlike)
    reason = f"The legs are {leg:.4g} units long, in {fits[0]} {leg * METRES_PER_UNIT[fits[0]]:.2f} m."
    if len(fits) > 1:
        reason += (
            f" In {fits[1]} they would be {leg * METRES_PER_UNIT[fits[1]]:.2f} m: choose that unit if it is right."
        )
    if len(fits) < len(units):
        reason += " They are as short beside the trunk as a small child's."
    confidence = Confidence.of(unlike(fits[1]) - unlike(fits[0]), *_FARTHER) if len(fits) > 1 else Confidence.SURE
    usual = _USUAL_LEGS[0] <= leg * METRES_PER_UNIT[fits[0]] <= _USUAL_LEGS[1]
    if confidence is Confidence.SURE and ((fits[0] in _RARE and len(fits) > 1) or len(fits) < len(units) or not usual):
        confidence = Confidence.LIKELY
    return Scale(fits[0], METRES_PER_UNIT[fits[0]]), Guess("unit", fits[0], reason, confidence)


def _fits(name: str, leg: float) -> bool:
    shortest, longest = _ADULT_LEG if name in _RARE else _ANY_LEG
    return shortest <= leg * METRES_PER_UNIT[name] <= longest


def parse_unit(text: str, leg: float | None) -> Scale:
    """Unit that the user typed: a name of ``METRES_PER_UNIT``, metres per unit as a number, or ``unknown``.

    ``leg`` is the length of the actor's legs in file units, from which an unknown unit is guessed.
    """
    name = _ALIASES.get(text.lower(), text.lower())
    if name in METRES_PER_UNIT:
        return Scale(name, METRES_PER_UNIT[name])
    if name == "unknown" and leg:
        return Scale(name, _USUAL_LEG / leg)
    metres = number(text, f"The unit (one of {', '.join(METRES_PER_UNIT)}, or metres a unit)")
    if not UNIT_RANGE.least <= metres <= UNIT_RANGE.most:
        raise StudioError(f"A unit is {UNIT_RANGE.least:g} to {UNIT_RANGE.most:g} m long, not {text[:40]} m.")
    return Scale(text, metres)


def guess_frame_rate(frame_time: float | None, digit: float) -> tuple[float, Guess | None]:
    """Frame rate in Hz: a whole number if ``frame_time`` equals that of one within its last ``digit``; and
    the guess.
    """
    if frame_time is None:
        return _USUAL_RATE, Guess(
            "frame rate", "30 fps", "The file does not say a usable frame time.", Confidence.DOUBTFUL
        )
    rate = 1.0 / frame_time
    whole = float(round(rate))
    if whole == rate:
        return whole, None
    if whole > 0 and abs(1.0 / whole - frame_time) <= digit:
        reason = f"The frame time {frame_time:g} s is 1/{whole:g} s, rounded."
        return whole, Guess("frame rate", f"{whole:g} fps", reason, Confidence.SURE)
    return rate, None


def guess_first_frame(positions: FloatArray, frame_rate: float) -> tuple[int, Guess | None]:
    """First frame of the motion, after a calibration pose and a jump if it begins with these; ``positions`` (F, J, 3)
    metres.

    A filter may have spread the jump over some frames: the motion begins when the joints are calm again.
    """
    if len(positions) < 24:
        return 0, None
    if _steps(positions[:2])[0] * frame_rate < 5.0:
        return 0, None
    steps = _steps(positions)
    usual = np.percentile(steps[16:], 99)
    if steps[0] < 3.0 * usual:
        return 0, None
    calm = max(np.percentile(steps[16:], 80), 0.03 * steps[0])
    first, latest = 1, min(int(_LONGEST_SNAP * frame_rate), 16)
    while first < latest and max(steps[first], steps[first + 1]) > calm:
        first += 1
    reason = f"The body jumps by {steps[0] * 100:.0f} cm after frame 0, a calibration pose."
    return first, Guess("first frame", str(first), reason, Confidence.LIKELY)


def _steps(positions: FloatArray) -> FloatArray:
    """Greatest displacement (F - 1,) in metres of a joint, relative to the first joint, from frame to frame."""
    relative = positions - positions[:, :1]
    return np.asarray(np.linalg.norm(np.diff(relative, axis=0), axis=2).max(axis=1))


def guess_floor(skeleton: Skeleton, positions: FloatArray, body_map: BodyMap, frame_rate: float) -> Guess:
    """Guess of the height of the ground from the lowest positions of the feet; ``positions`` (F, J, 3) metres, world
    axes.

    If the feet stand at several heights, as on stairs or off a stage, the lowest is the floor.
    """
    feet = {body_map[BodyPart.LEFT_FOOT], body_map[BodyPart.RIGHT_FOOT]}
    below = {joint for foot in feet for joint in skeleton.descendants(foot)}
    lowest = positions[:, sorted(feet | below), 2].min(axis=1)
    usual = height = float(np.percentile(lowest, 10))
    ankle = float(np.percentile(positions[:, sorted(feet), 2].min(axis=1), 10))
    step = _STEP * (leg_and_trunk(positions, body_map)[0] or _USUAL_LEG)
    rests = _rests([positions[:, [foot, *skeleton.descendants(foot)]] for foot in sorted(feet)], frame_rate, step)
    levels = _levels(rests, step)
    reason = "The feet are lowest there in a tenth of the frames."
    if levels and levels[0] < usual - step:
        height = levels[0]
        reason = f"The feet stand at {height:.3f} m at the lowest."
    toes = ankle - usual >= 0.01
    if not toes:
        height -= _FOOT_HEIGHT
        reason = f"The ankles are lowest {_FOOT_HEIGHT} m above it; the skeleton has no toes."
    if 0.0 <= height <= _CALIBRATED:
        reason = f"The lowest joints of the feet come to {height:.3f} m, which fits a floor at zero."
        height = 0.0
    elif toes and not -_CALIBRATED <= height < 0.0:
        reason = (
            f"The lowest joints of the feet come to {height:.3f} m; "
            f"the sole is usually {SOLE_THICKNESS_METRES} m below."
        )
        height -= SOLE_THICKNESS_METRES
    if len(levels) > 1:
        over = ", ".join(f"{level - levels[0]:.2f}" for level in levels[1 : _SHOWN + 1])
        reason += (
            f" The take also stands {over} m above it, as on steps; its feet keep those heights over level ground."
        )
    standing = [rest for rest in rests if rest < levels[0] + step]
    scatter = float(np.ptp(np.percentile(standing, [10, 90]))) if len(standing) > 1 else np.inf
    confidence = Confidence.of(-scatter, *(-most for most in _SCATTERED))
    return Guess("floor", f"{height:.4f} m", reason, confidence)


def _rests(feet: list[FloatArray], frame_rate: float, step: float) -> list[float]:
    """Sorted heights at which one of ``feet`` (F, n, 3) rests alone, or together with the other less than a ``step``
    apart.
    """
    rests = []
    lowest = np.min([joints[1:, :, 2].min(axis=1) for joints in feet], axis=0)
    for joints in feet:
        moved = np.linalg.norm(np.diff(joints, axis=0), axis=2).min(axis=1, initial=np.inf)
        height = joints[1:, :, 2].min(axis=1)
        for first, past in runs_of(moved * frame_rate < _RESTING):
            level = float(np.median(height[first:past]))
            if np.count_nonzero(lowest[first:past] > level - step / 2.0) >= max(2.0, _REST * frame_rate):
                rests.append(level)
    return sorted(rests)


def _levels(rests: list[float], step: float) -> list[float]:
    """Levels among the sorted heights ``rests``: the first, and each that is a ``step`` above the previous level."""
    levels: list[float] = []
    for level in rests:
        if not levels or level > levels[-1] + step:
            levels.append(level)
    return levels
