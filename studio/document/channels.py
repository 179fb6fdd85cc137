"""Channels: the components of keyed fields as scalar animation curves with tangents, and their edits."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import LEAST_PROPORTION_FACTOR, MOST_PROPORTION_FACTOR, Proportions
from studio.core.changed_records import with_fields
from studio.core.constraints.own_place import KeyedOwnPlace
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn, Keys
from studio.core.curves.retiming import FASTEST_CLIP_SPEED, SLOWEST_CLIP_SPEED
from studio.core.curves.tangents import (
    LEAST_TANGENT_WEIGHT,
    MOST_TANGENT_WEIGHT,
    Tangent,
    TangentMode,
    Tangents,
    tangents_of,
)
from studio.core.plausible import PLACE_RANGE, WEIGHT_RANGE
from studio.core.rotations import from_euler, from_matrix, to_euler
from studio.document.keyed_fields import Keyed, KeyedField
from studio.document.length_units import shown_unit

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

FloatArray = NDArray[np.float64]

SHOWN_EULER_ORDER = "ZYX"
"""Euler order in which rotations are shown: heading, then pitch, then roll."""
ANGLE_NAMES = ("heading", "pitch", "roll")
AXIS_NAMES = ("x", "y", "z")
DEGREES_PER_RADIAN = 180.0 / np.pi
RATE_STEP_SECONDS = 1e-5
"""Step in seconds of the finite differences for rates of angles."""
ANGLE_SAMPLES = 24
"""Samples from one key to the next, dense enough to follow angles beyond half a turn."""
HANDLE_DIVISOR = 3.0
"""Divisor of a handle's length: a tangent of weight 1 reaches a third of the way to the next key."""


class TangentSide(IntEnum):
    """Side of a key: of its in tangent or its out tangent."""

    IN = 0
    OUT = 1


@dataclass(frozen=True)
class Channel:
    """Scalar component of a keyed field, shown in ``unit``; shown values are stored values times ``factor``."""

    field: KeyedField
    component: int
    name: str
    unit: str
    factor: float = 1.0
    baseline: float | None = None
    """Shown value that is included when the curves are framed; None if there is none."""
    limits: tuple[float, float] = (-PLACE_RANGE.most, PLACE_RANGE.most)
    """Minimum and maximum of the stored value."""


def channels_of(field: KeyedField, keyed: Keyed) -> tuple[Channel, ...]:
    """Channels of a field. Of keyed proportions, only those that change, or the stature if none does."""
    match keyed:
        case KeyedPlace():
            metre = shown_unit("m")
            return tuple(
                Channel(field, place, name, metre.symbol, metre.factor) for place, name in enumerate(AXIS_NAMES)
            )
        case KeyedOwnPlace():
            return tuple(Channel(field, place, name, "leg lengths") for place, name in enumerate(AXIS_NAMES))
        case KeyedTurn():
            return tuple(Channel(field, place, name, "°", DEGREES_PER_RADIAN) for place, name in enumerate(ANGLE_NAMES))
        case KeyedNumber():
            if field.name == "heading":
                return (Channel(field, 0, field.name, "°", DEGREES_PER_RADIAN),)
            if field.collection == "clips":
                return (
                    Channel(field, 0, field.name, "×", baseline=0.0, limits=(SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED)),
                )
            if field.name == "weight":
                return (Channel(field, 0, field.name, "", baseline=0.0, limits=(0.0, WEIGHT_RANGE.most)),)
            metre = shown_unit("m")
            return (Channel(field, 0, field.name, metre.symbol, metre.factor, limits=(0.0, PLACE_RANGE.most)),)
        case KeyedProportions():
            changing = np.flatnonzero(np.ptp(keyed.points, axis=0) > 0.0).tolist() or [0]
            names = [each.name.replace("_", " ") for each in fields(Proportions)]
            limits = LEAST_PROPORTION_FACTOR, MOST_PROPORTION_FACTOR
            return tuple(Channel(field, place, names[place], "×", limits=limits) for place in changing)
        case ActivationCurve():
            return (Channel(field, 0, "activation", ""),)
    return ()


def values_at(channel: Channel, keyed: Keyed, times: ArrayLike) -> FloatArray:
    """(N,) shown values of the channel at ``times`` (N,), seconds of the field's own time."""
    return np.asarray(components_at(keyed, times)[:, channel.component] * channel.factor)


def components_at(keyed: Keyed, times: ArrayLike) -> FloatArray:
    """(N, D) stored values of all components at ``times`` (N,), seconds; of a rotation, its Euler angles in radians."""
    seconds = np.asarray(times, dtype=np.float64)
    if isinstance(keyed, ActivationCurve):
        return keyed.at(seconds)[:, None]
    return _angles(keyed, seconds) if isinstance(keyed, KeyedTurn) else np.asarray(keyed.at(seconds))


def allowed_value_at(field: KeyedField, keyed: Keys, time: float) -> Any:
    """Value of a field at ``time``. Numbers are clamped to their limits, which a curve may overshoot between keys."""
    value = keyed.value_at(time)
    if isinstance(keyed, KeyedNumber):
        least, most = channels_of(field, keyed)[0].limits
        return min(max(value, least), most)
    return value


def key_values(channel: Channel, keyed: Keyed) -> FloatArray:
    """(K,) shown values of the channel at its keys."""
    if isinstance(keyed, ActivationCurve):
        return np.array([0.0, 1.0, 1.0, 0.0])
    if isinstance(keyed, KeyedTurn):
        return values_at(channel, keyed, keyed.times)
    points: FloatArray = keyed.points  # type: ignore[attr-defined]
    return np.asarray(points[:, channel.component] * channel.factor)


def handle_of(channel: Channel, keyed: Keyed, index: int, side: TangentSide) -> tuple[float, float] | None:
    """Offset (seconds, shown value) from a key to the end of its tangent handle; None if that side has no handle."""
    other = index + (1 if side is TangentSide.OUT else -1)
    if not 0 <= other < len(keyed.times):
        return None
    gap = keyed.times[other] - keyed.times[index]
    if isinstance(keyed, ActivationCurve):
        if (index, side) not in _EASES or gap == 0.0:
            return None
        return keyed.weights[index] * gap / HANDLE_DIVISOR, 0.0
    own = keyed.tangents[index] if keyed.tangents else None
    if side is TangentSide.OUT and own is not None and own.is_stepped:
        return None
    weight = own.weights[side] if own is not None else 1.0
    seconds = weight * gap / HANDLE_DIVISOR
    return seconds, seconds * _rate(channel, keyed, index, side)


_EASES = ((0, TangentSide.OUT), (1, TangentSide.IN), (2, TangentSide.OUT), (3, TangentSide.IN))
"""Sides of the four times of an activation on which its curve rises or falls, and which have a handle."""


def with_values(channel: Channel, keyed: Keyed, values: Mapping[int, float]) -> Keyed:
    """Copy with the shown ``values`` of some keys, by index, clamped to the channel's limits; those of an activation
    are unchanged.
    """
    if not isinstance(keyed, Keys):
        return keyed
    numbers = list(keyed.values)
    for place, value in values.items():
        stored = min(max(value / channel.factor, channel.limits[0]), channel.limits[1])
        numbers[place] = _with_component(keyed, place, channel.component, stored)
    return replace(keyed, values=tuple(numbers))


def with_handle(
    channel: Channel, keyed: Keyed, index: int, side: TangentSide, seconds: float, value: float, broken: bool = False
) -> Keyed:
    """Copy with the end of a tangent handle at the offset (``seconds``, ``value``) from its key.

    The other tangent rotates with it unless it is ``broken``. Of an activation only the tangent weight changes.
    """
    other = index + (1 if side is TangentSide.OUT else -1)
    gap = keyed.times[other] - keyed.times[index]
    weight = min(max(HANDLE_DIVISOR * seconds / gap, LEAST_TANGENT_WEIGHT), MOST_TANGENT_WEIGHT)
    if isinstance(keyed, ActivationCurve):
        return keyed.with_weight(index, weight)
    least = LEAST_TANGENT_WEIGHT * gap / HANDLE_DIVISOR
    seconds = seconds if seconds / gap > least / gap else least
    rate = _stored_rate(channel, keyed, index, side, value / seconds / channel.factor)
    own = (keyed.tangents[index] if keyed.tangents else None) or Tangents()
    sides = [own.arriving, own.leaving]
    broken = broken or own.broken
    sides[side] = Tangent(TangentMode.FREE, rate, weight)
    if not broken:
        sides[1 - side] = Tangent(TangentMode.FREE, rate, sides[1 - side].weight)
    return keyed.with_tangents(index, Tangents(sides[0], sides[1], broken))


def with_mode(keyed: Keyed, index: int, mode: TangentMode) -> Keyed:
    """Copy with another tangent mode on both sides of a key; a free tangent keeps its present slope.

    An activation is unchanged.
    """
    if not isinstance(keyed, Keys):
        return keyed
    own = (keyed.tangents[index] if keyed.tangents else None) or Tangents()
    if mode is not TangentMode.FREE:
        return keyed.with_tangents(index, tangents_of(mode, own.weights))
    arriving, leaving = keyed.rates()
    rate = tuple(((arriving[index] + leaving[index]) / 2.0).tolist())
    return keyed.with_tangents(
        index, Tangents(Tangent(mode, rate, own.weights[0]), Tangent(mode, rate, own.weights[1]))
    )


def with_broken(keyed: Keyed, index: int, broken: bool) -> Keyed:
    """Copy with the tangents of a key broken, each unchanged, or unified at the mean of both slopes."""
    if not isinstance(keyed, Keys):
        return keyed
    if not broken:
        return with_mode(keyed, index, TangentMode.FREE)
    own = (keyed.tangents[index] if keyed.tangents else None) or Tangents()
    sides = [
        Tangent(TangentMode.FREE, tuple(rates[index].tolist()), weight)
        for rates, weight in zip(keyed.rates(), own.weights, strict=True)
    ]
    return keyed.with_tangents(index, Tangents(sides[0], sides[1], True))


def with_even_weights(keyed: Keyed, index: int) -> Keyed:
    """Copy with both tangent weights of a key set to 1."""
    if isinstance(keyed, ActivationCurve):
        return keyed.with_weight(index, 1.0)
    own = keyed.tangents[index] if keyed.tangents else None
    if own is None:
        return keyed
    return keyed.with_tangents(
        index, replace(own, arriving=replace(own.arriving, weight=1.0), leaving=replace(own.leaving, weight=1.0))
    )


def _with_component(keyed: Keys, index: int, component: int, value: float) -> object:
    old = keyed.values[index]
    if isinstance(keyed, KeyedTurn):
        angles = to_euler(SHOWN_EULER_ORDER, np.array(old))
        angles[component] = value
        return tuple(from_euler(SHOWN_EULER_ORDER, angles).tolist())
    if isinstance(old, Proportions):
        return with_fields(old, **{fields(Proportions)[component].name: value})
    return (*old[:component], value, *old[component + 1 :]) if keyed.size > 1 else value


def _rate(channel: Channel, keyed: Keys, index: int, side: TangentSide) -> float:
    """Slope of a channel on one side of a key, in shown units per second."""
    rate = keyed.rates()[side][index]
    if isinstance(keyed, KeyedTurn):
        rate = _angle_rates(keyed, index, rate)
    return float(rate[channel.component] * channel.factor)


def _stored_rate(channel: Channel, keyed: Keys, index: int, side: TangentSide, rate: float) -> tuple[float, ...]:
    """Slopes of all components in stored units per second, if the channel has the shown slope ``rate``."""
    rates = keyed.rates()[side][index].copy()
    if not isinstance(keyed, KeyedTurn):
        rates[channel.component] = rate
        return tuple(rates.tolist())
    angles = to_euler(SHOWN_EULER_ORDER, np.array(keyed.values[index]))
    turning = _angle_rates(keyed, index, rates)
    turning[channel.component] = rate
    step = RATE_STEP_SECONDS / max(1.0, float(np.abs(turning).max()))
    later = _rotation(from_euler(SHOWN_EULER_ORDER, angles + step * turning))
    return tuple((_rotation(np.array(keyed.values[index])).inv() * later).as_rotvec() / step)


def _angle_rates(keyed: KeyedTurn, index: int, rate: FloatArray) -> FloatArray:
    """(3,) rates of heading, pitch and roll in radians per second at a key with the angular velocity ``rate`` (3,) in
    body axes.
    """
    here = np.array(keyed.values[index])
    step = RATE_STEP_SECONDS / max(1.0, float(np.linalg.norm(rate)))
    later = (_rotation(here) * type(_rotation(here)).from_rotvec(step * rate)).as_quat()
    change = to_euler(SHOWN_EULER_ORDER, later) - to_euler(SHOWN_EULER_ORDER, here)
    return np.asarray((np.mod(change + np.pi, 2.0 * np.pi) - np.pi) / step)


def _rotation(quaternion: FloatArray) -> "Rotation":
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(quaternion)


def _angles(keyed: KeyedTurn, times: FloatArray) -> FloatArray:
    """(N, 3) heading, pitch and roll in radians at ``times`` (N,), continuous from the first key on."""
    keys = keyed.seconds
    between = np.interp(np.arange(ANGLE_SAMPLES * (len(keys) - 1) + 1) / ANGLE_SAMPLES, np.arange(len(keys)), keys)
    grid, places = np.unique(np.concatenate([times, between, keys[:1]]), return_inverse=True)
    angles = np.unwrap(to_euler(SHOWN_EULER_ORDER, from_matrix(keyed.at(grid))), axis=0)
    first = places[-1]
    whole = np.round((angles[first] - to_euler(SHOWN_EULER_ORDER, np.array(keyed.values[0]))) / (2.0 * np.pi))
    return np.asarray((angles - 2.0 * np.pi * whole)[places[: len(times)]])
