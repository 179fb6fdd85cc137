"""What a file does not say: its unit, its up axis, its floor, its frame rate, where the motion begins."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Guess
from studio.core.errors import StudioError
from studio.io.numbers import number

FloatArray = NDArray[np.float64]

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254, "cmu": 0.0254 / 0.45}
"""Metres a unit; ``cmu`` is that of the raw CMU files, 1 / 0.45 inch."""
_USUAL_LEG = 0.85
_LEGS = {"m": (0.42, 1.2), "cm": (0.42, 1.2), "mm": (0.42, 1.2), "inch": (0.7, 1.05), "cmu": (0.7, 1.0)}
"""Lengths of a leg in metres that make a unit plausible: rare units only for usual adults."""

AXES: dict[str, FloatArray] = {
    "Y": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "Z": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "X": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
}
"""File axes to world axes by the axis that is up; the file's usual front (+Z, -Y, +Y) becomes +X."""

_USUAL_RATE = 30.0
_FOOT_HEIGHT = 0.08
"""Ankle above the ground where a skeleton has nothing below it."""
_SOLE = 0.02
"""Metres of foot usual below its lowest joint."""
_CALIBRATED = 0.035
"""Up to this height the lowest joints of the feet speak for a floor at zero: they lie inside the foot."""
_LONGEST_SNAP = 0.1
"""Seconds over which a filter may have smeared the snap out of a calibration pose."""


class Scale(NamedTuple):
    """A unit by name, and metres a unit."""

    unit: str
    metres: float


def leg_length(positions: FloatArray, body_map: BodyMap) -> float:
    """Mean of thigh and shank together over frames and sides, in the unit of ``positions`` (F, J, 3)."""
    total = 0.0
    for side in ("LEFT", "RIGHT"):
        hip, knee, ankle = (positions[:, body_map[BodyPart[f"{side}_{part}"]]] for part in ("THIGH", "SHANK", "FOOT"))
        total += np.linalg.norm(knee - hip, axis=1).mean() + np.linalg.norm(ankle - knee, axis=1).mean()
    return float(total / 2)


def guess_unit(leg: float) -> tuple[Scale, Guess]:
    """The unit in which a leg of ``leg`` units is most like a human's."""
    fits = {name: abs(np.log(leg * UNITS[name] / _USUAL_LEG)) for name in UNITS if _fits(name, leg)}
    if not fits:
        metres = _USUAL_LEG / leg
        reason = f"No unit makes its legs of {leg:.4g} units plausible; they were made {_USUAL_LEG} m long."
        return Scale("unknown", metres), Guess("unit", f"unknown, taken as {metres * 100:.4g} cm", reason)
    name = min(fits, key=lambda unit: fits[unit])
    reason = f"The legs are {leg:.4g} units long, in {name} {leg * UNITS[name]:.2f} m."
    return Scale(name, UNITS[name]), Guess("unit", name, reason)


def _fits(name: str, leg: float) -> bool:
    shortest, longest = _LEGS[name]
    return shortest <= leg * UNITS[name] <= longest


def unit_called(text: str, leg: float | None) -> Scale:
    """The unit the user names: one of ``UNITS``, metres a unit as a number, or ``unknown``."""
    name = {"in": "inch", "inches": "inch"}.get(text.lower(), text.lower())
    if name in UNITS:
        return Scale(name, UNITS[name])
    if name == "unknown" and leg:
        return Scale(name, _USUAL_LEG / leg)
    metres = number(text, f"The unit (one of {', '.join(UNITS)}, or metres a unit)")
    if metres <= 0.0:
        raise StudioError(f"The unit must be longer than {text} m.")
    return Scale(text, metres)


def guess_up_axis(rest: FloatArray, positions: FloatArray, body_map: BodyMap) -> Guess:
    """Which file axis is up, by the rest pose (J, 3) and by how the body stands and moves (F, J, 3).

    For each axis: how upright the body is on average, how still its lowest point, how near zero the ground,
    and, less trusted, how upright the rest pose is.
    """
    leg = leg_length(positions, body_map)
    upright = _upright(positions, body_map).mean(axis=0)
    at_rest = _upright(rest[None], body_map)[0]
    lowest = positions.min(axis=1)
    ground = np.abs(np.percentile(lowest, 10, axis=0)) / leg
    unsteady = lowest.std(axis=0) / (0.5 * leg)
    scores = upright + 0.4 * at_rest - np.minimum(ground, 1.0) - np.minimum(unsteady, 1.0)
    axis = 2 if scores[2] > scores[1] else 1
    name = "XYZ"[axis]
    reason = f"Through the motion the body stands along {name} and its feet stay at one level."
    if int(np.argmax(np.abs(at_rest))) != axis:
        reason += f" The rest pose would suggest {'XYZ'[int(np.argmax(np.abs(at_rest)))]}."
    return Guess("up axis", name, reason)


def _upright(positions: FloatArray, body_map: BodyMap) -> FloatArray:
    """(F, 3) unit directions from the ankles to the shoulders."""
    ankles = positions[:, [body_map[BodyPart.LEFT_FOOT], body_map[BodyPart.RIGHT_FOOT]]].mean(axis=1)
    shoulders = positions[:, [body_map[BodyPart.LEFT_UPPER_ARM], body_map[BodyPart.RIGHT_UPPER_ARM]]].mean(axis=1)
    direction = shoulders - ankles
    length: FloatArray = np.linalg.norm(direction, axis=1, keepdims=True)
    return np.asarray(direction / np.maximum(length, 1e-9))


def guess_frame_rate(frame_time: float | None, digit: float) -> tuple[float, Guess | None]:
    """Frames a second; a whole number where the frame time is one within its last ``digit``."""
    if frame_time is None:
        return _USUAL_RATE, Guess("frame rate", "30 Hz", "The file does not say a usable frame time.")
    rate = 1.0 / frame_time
    whole = float(round(rate))
    if whole == rate:
        return whole, None
    if whole > 0 and abs(1.0 / whole - frame_time) <= digit:
        reason = f"The frame time {frame_time:g} s is 1/{whole:g} s, rounded."
        return whole, Guess("frame rate", f"{whole:g} Hz", reason)
    return rate, None


def guess_first_frame(positions: FloatArray, frame_rate: float) -> tuple[int, Guess | None]:
    """Where the motion begins when it starts with a calibration pose and a snap; ``positions`` (F, J, 3) m.

    The snap may be smeared over some frames by a filter: the motion begins where the joints are calm again.
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
    return first, Guess("first frame", str(first), reason)


def _steps(positions: FloatArray) -> FloatArray:
    """(F - 1,) metres by which the joint that moves most, seen from the first one, moves from frame to frame."""
    relative = positions - positions[:, :1]
    return np.asarray(np.linalg.norm(np.diff(relative, axis=0), axis=2).max(axis=1))


def guess_floor(skeleton: Skeleton, positions: FloatArray, body_map: BodyMap) -> Guess:
    """Height of the ground by where the feet are lowest; ``positions`` (F, J, 3) metres, world axes."""
    feet = {body_map[BodyPart.LEFT_FOOT], body_map[BodyPart.RIGHT_FOOT]}
    below = {joint for foot in feet for joint in skeleton.descendants(foot)}
    lowest = positions[:, sorted(feet | below), 2].min(axis=1)
    height = float(np.percentile(lowest, 10))
    ankle = float(np.percentile(positions[:, sorted(feet), 2].min(axis=1), 10))
    reason = "The feet are lowest there in a tenth of the frames."
    if ankle - height < 0.01:
        height -= _FOOT_HEIGHT
        reason = f"The ankles are lowest {_FOOT_HEIGHT} m above it; the skeleton has no toes."
    if 0.0 <= height <= _CALIBRATED:
        reason = f"The lowest joints of the feet come to {height:.3f} m, which fits a floor at zero."
        height = 0.0
    elif height > 0.0:
        reason = f"The lowest joints of the feet come to {height:.3f} m; the sole is usually {_SOLE} m below."
        height -= _SOLE
    return Guess("floor", f"{height:.4f} m", reason)
