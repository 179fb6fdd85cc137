"""Up direction of a file: one of six axes, or a direction between them for a tilted camera."""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.captures.capture import Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.rotations import normalized, shortest_arc

FloatArray = NDArray[np.float64]

_Y = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
_Z = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
_X = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
_ABOUT_X, _ABOUT_Y = np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0])
FILE_AXES = MappingProxyType({"Y": _Y, "Z": _Z, "X": _X, "-Y": _Y @ _ABOUT_X, "-Z": _Z @ _ABOUT_X, "-X": _X @ _ABOUT_Y})
"""Rotation from file axes to world axes by up axis; the file's usual front (+Z, -Y, +Y) becomes +X, or is half a turn
about a level axis from it.
"""
BVH_UP_PRIOR = MappingProxyType({"Y": 0.2, "Z": 0.15, "-Y": -0.1, "-Z": -0.05, "-X": -0.05})
"""Prior of each up axis in the score, for BVH files."""
C3D_UP_PRIOR = MappingProxyType({"Z": 0.2, "Y": 0.15})
"""Prior of each up axis in the score, for marker files that do not state theirs."""
_SAID = 0.6
"""The same for the axis that the format, or the file, says."""
_AT_REST, _SUPPORTED = 0.4, 2.0
_STILL = 0.25
"""A point that moves so much as the median of all, in a frame, counts half as much as one that rests."""
_MOVING, _TRAVELS = 3e-3, 0.01
"""Leg lengths in a frame, and in the take, from which points and the root move."""
_STRAIGHT = 0.9
"""Cosine of trunk and legs from which a body stands in one line."""
_LEAST_TILT, _AGREED = np.radians(12.0), np.radians(10.0)
"""Lean from every axis that nobody who stands in one line keeps up, so it is a camera's; and how far it may be from
square to the floor."""
_LEAST_FLOOR_TILT, _NEARER = np.radians(5.0), 0.5
"""Lean of the floor of a walk from which a camera is tilted, and greatest angle of the body to the floor's normal, as a
fraction of that to the axis: on a ramp or on stairs the body stands along the axis."""
_WALKS, _CARRIED = 0.3, 0.25
"""Leg lengths of a path that tells the floor, and of the body over what carries it where it stands."""
_FEWEST, _SWAY = 24, np.radians(7.0)
"""Frames that tell a lean from a pose, and the median sway about it of one who leans no more than a camera does."""
_FLOOR_NOISE, _OFF_PLANE, _UNSURE = 0.03, 0.06, 5.0
"""Leg lengths by which standing feet lie off one plane, and from which they stand on no level floor; and how many times
as far as they do in a take its path must lead to tell the slope of the floor along it."""
_DOUBTFUL = 0.3


@dataclass(frozen=True, eq=False)
class BodyPoints:
    """Pairs of points (2, F, 2, 3), left and right, of a body in F frames and in the frames that follow them.

    ``everything`` (2, F, P, 3) has all points.
    """

    shoulders: FloatArray
    hips: FloatArray
    knees: FloatArray
    ankles: FloatArray
    toes: FloatArray | None
    everything: FloatArray

    @classmethod
    def of_joints(cls, positions: FloatArray, body_map: BodyMap) -> Self:
        """Points of the joints in a body map; ``positions`` (2, F, J, 3) are in some frames and the frames that follow
        them.
        """

        def pair(part: str) -> FloatArray:
            return positions[:, :, [body_map[BodyPart[f"{side}_{part}"]] for side in ("LEFT", "RIGHT")]]

        toes = all(BodyPart[f"{side}_TOE"] in body_map.parts for side in ("LEFT", "RIGHT"))
        every = sorted({*body_map.parts.values(), *body_map.spine})
        limbs = pair("UPPER_ARM"), pair("THIGH"), pair("SHANK"), pair("FOOT"), pair("TOE") if toes else None
        return cls(*limbs, positions[:, :, every])

    @property
    def leg(self) -> float:
        """Mean length of thigh and shank together."""
        bones = np.linalg.norm(self.knees - self.hips, axis=-1) + np.linalg.norm(self.ankles - self.knees, axis=-1)
        return max(float(np.nanmean(bones)), 1e-9)


def parse_axis(text: str) -> str:
    """Up axis that the user typed: a name in ``FILE_AXES``, or a unit direction ``x y z``. Raises StudioError."""
    name = text.strip().upper().removeprefix("+")
    if name in FILE_AXES:
        return name
    try:
        direction = np.array([float(word) for word in name.replace(",", " ").split()])
    except ValueError:
        direction = np.zeros(0)
    if direction.shape != (3,) or not 1e-6 < np.linalg.norm(direction) < 1e6:
        raise StudioError(
            f"'{text}' is not an up axis. Choose {', '.join(FILE_AXES)}, or a direction as three numbers 'x y z'."
        )
    return _named(direction / np.linalg.norm(direction))


def turn_to_world(up_axis: str) -> FloatArray:
    """Rotation (3, 3) from file axes to world axes, by a name in ``FILE_AXES`` or a direction ``x y z``. Raises
    StudioError.
    """
    name = parse_axis(up_axis)
    if name in FILE_AXES:
        return FILE_AXES[name]
    direction = normalized(np.array([float(word) for word in name.split()]))
    nearest = max(FILE_AXES, key=lambda axis: float(FILE_AXES[axis][2] @ direction))
    return FILE_AXES[nearest] @ shortest_arc(direction, FILE_AXES[nearest][2])


def guess_up_axis(
    body: BodyPoints, usual: dict[str, float] | MappingProxyType[str, float], rest: FloatArray | None = None
) -> Guess:
    """Guess of the up direction of a file, by the standing and moving body, the priors ``usual`` and the rest pose.

    ``rest`` (3,) is the direction from ankles to shoulders at rest. The axis with the highest score wins: along it the
    body stands upright and is above the parts that rest on the ground, and these keep their height, near zero.
    """
    names, axes = list(FILE_AXES), np.array([turn[2] for turn in FILE_AXES.values()])
    along, straight = _standing(body)
    support = _supported(body)
    lowest = np.stack([(body.everything[0] @ axis).min(axis=1) for axis in axes])
    unsteady = np.minimum(lowest.std(axis=1) / (0.5 * body.leg), 1.0)
    away = np.minimum(np.abs(np.percentile(lowest, 10, axis=1)) / body.leg, 1.0) if support is not None else 0.0
    above = axes @ support if support is not None else 0.0
    upright = axes @ (along * straight[:, None]).mean(axis=0)
    at_rest = axes @ (rest if rest is not None else np.zeros(3))
    score = upright + _AT_REST * at_rest + _SUPPORTED * above - unsteady - away
    score += np.array([usual.get(name, 0.0) for name in names])
    best, second = np.argsort(score)[::-1][:2]
    name = names[best]
    tilted = _tilted(body, along, straight > _STRAIGHT)
    if tilted is not None:
        near = int(np.argmax(axes @ tilted))
        if near == best or (support is not None and support @ tilted > _CARRIED):
            degrees = np.degrees(np.arccos(np.clip(tilted @ axes[near], -1.0, 1.0)))
            words = f"Standing, the body leans by {degrees:.0f} degrees from {names[near]} all the time, as a tilted "
            words += "camera sees it."
            if degrees > np.degrees(_LEAST_TILT):
                return Guess("up axis", _named(tilted), words, Confidence.LIKELY)
            words += f" So does the floor it walks on; choose {names[near]} if it is a ramp."
            return Guess("up axis", _named(tilted), words, Confidence.DOUBTFUL)
    stands = upright[best] > 0.5
    words = f"Through the take the body {'stands along' if stands else 'is above what it rests on, towards'} {name}."
    if rest is not None and at_rest[best] < 0.7:
        words += f" The rest pose would suggest {names[int(np.argmax(at_rest))]}."
    margin = float(score[best] - score[second]) if stands else 0.0
    confidence = Confidence.of(margin, _DOUBTFUL, 2.0 * _DOUBTFUL)
    if confidence is Confidence.DOUBTFUL:
        words += f" That is not certain: it may be {names[second]}."
    return Guess("up axis", name, words, confidence)


def _standing(body: BodyPoints) -> tuple[FloatArray, FloatArray]:
    """Directions (F, 3) from ankles to shoulders, and straightness (F,) from 0 to 1 of the body standing on its soles.

    A crawling body is bent at its hips; a lying one stretches its feet.
    """
    shoulders, hips, ankles = (pair[0].mean(axis=1) for pair in (body.shoulders, body.hips, body.ankles))
    straight = np.clip(np.einsum("fi,fi->f", normalized(shoulders - hips), normalized(hips - ankles)), 0.0, 1.0) ** 2
    if body.toes is not None:
        shank, foot = normalized(body.knees[0] - body.ankles[0]), normalized(body.toes[0] - body.ankles[0])
        stretched = -np.einsum("fsi,fsi->fs", shank, foot)
        straight = straight * np.clip(1.0 - 2.0 * (stretched - 0.35), 0.0, 1.0).max(axis=1)
    return normalized(shoulders - ankles), straight


def _supported(body: BodyPoints) -> FloatArray | None:
    """Mean vector (3,), in leg lengths, from the parts that rest in a frame to the middle of the body; None if the root
    never moves.
    """
    if np.ptp(body.hips[0].mean(axis=1), axis=0).max() < _TRAVELS * body.leg:
        return None
    moved = np.linalg.norm(body.everything[1] - body.everything[0], axis=-1)
    usual = np.median(moved, axis=1, keepdims=True)
    weight = 1.0 / (moved**2 + (_STILL * usual) ** 2 + (1e-4 * body.leg) ** 2)
    middle = body.everything.mean(axis=0)
    rests = np.einsum("fp,fpi->fi", weight, middle) / weight.sum(axis=1, keepdims=True)
    moves = np.minimum(usual[:, 0] / (_MOVING * body.leg), 1.0)
    way = (middle.mean(axis=1) - rests) * moves[:, None] / body.leg
    return np.asarray(way.sum(axis=0) / max(0.3 * len(way), float(moves.sum())))


def _tilted(body: BodyPoints, along: FloatArray, straight: NDArray[np.bool_]) -> FloatArray | None:
    """Up direction (3,) if no axis is up: that of the standing body, perpendicular to its travel and to its resting
    points as far as these tell a plane.

    The tilt of a camera is constant through the take; that of a leaning body is not. None if there is no such tilt.
    """
    if straight.mean() < 0.5 or len(along) < _FEWEST:
        return None
    lean = normalized(np.median(along[straight], axis=0))
    if np.median(np.arccos(np.clip(along[straight] @ lean, -1.0, 1.0))) > _SWAY:
        return None
    level = [body.hips[0].mean(axis=1)[straight]]
    if np.linalg.norm(level[0].std(axis=0)) < _WALKS * body.leg:
        level = []
    moved = np.median(np.linalg.norm(body.everything[1] - body.everything[0], axis=-1), axis=1)
    for pair in (body.ankles,) if body.toes is None else (body.ankles, body.toes):
        still = np.linalg.norm(pair[1] - pair[0], axis=-1) < _STILL * np.maximum(moved, _MOVING * body.leg)[:, None]
        level += [pair[0, straight & still[:, side], side] for side in (0, 1)]
    path = np.concatenate([np.zeros((3, 3)), *(places - places.mean(axis=0) for places in level if len(places))])
    _, spread, ways = np.linalg.svd(path, full_matrices=False)
    spread = spread / (np.sqrt(len(path)) * body.leg)
    noise = max(_FLOOR_NOISE, _UNSURE * float(spread[2]))
    known = spread[:2] ** 2 / (spread[:2] ** 2 + noise**2)
    up = normalized(lean - (known * (ways[:2] @ lean)) @ ways[:2])
    lean_tilt, up_tilt = np.arccos(np.clip(np.abs(np.stack([lean, up])).max(axis=1), -1.0, 1.0))
    apart = np.arccos(np.clip(up @ lean, -1.0, 1.0))
    stands = min(lean_tilt, up_tilt) > _LEAST_TILT and apart < _AGREED
    walks = (
        spread[0] > _WALKS and spread[2] < _OFF_PLANE and up_tilt > _LEAST_FLOOR_TILT and apart < _NEARER * lean_tilt
    )
    return up if stands or walks else None


def stated_axis_prior(name: str) -> dict[str, float]:
    """Priors ``usual`` for a file that states its up axis."""
    return {name: _SAID}


def _named(direction: FloatArray) -> str:
    return " ".join(f"{value:.4f}" for value in direction)
