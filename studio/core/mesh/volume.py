"""The room that a body takes up: tapered capsules for trunk, head and thighs, spheres along its arms.

What keeps an arm out of its own body needs a form of the body that is measured in nanoseconds. Every body has the
same capsules in the same order, so that one body's can be set beside another's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.skin import SkinnedMesh, bound_pose, fit_vertices

LEVELS = (0.03, 0.30, 0.58, 0.80)
"""Heights at which the trunk is measured, parts of the way from the hips to the neck base."""
PROBES = ((0, 0.0), (0, 0.5), (0, 1.0), (1, 0.45), (1, 0.85))
"""Where the spheres of an arm lie: bone (0 forearm, 1 hand) and part of its length."""
PALM = PROBES[3][1]
"""The same of the palm."""
CAPSULES_OF = {"hips": (0, 1), "trunk": (2, 3, 4, 5), "head": (6,), "thigh": (7, 8)}
"""The capsules of a body by the part that they stand for."""
_THIGH = (0.2, 0.9)
_SECTIONS = ((0.123, 0.071, -0.096), (0.100, 0.069, -0.060), (0.118, 0.095, -0.057), (0.122, 0.090, -0.051))
_THIGH_GIRTH, _HEAD, _ARM_GIRTH = (0.065, 0.036), (0.066, 0.018, 0.27, 0.50), (0.024, 0.022, 0.016, 0.015, 0.011)
"""An ordinary body's sections (half width, front, back), thigh, head (radius, forward, from, to in head lengths) and
arm, in parts of the length of leg and spine together: means of two bundled characters."""


@dataclass(frozen=True, eq=False)
class BodyVolume:
    """Capsules and spheres of one body, fixed to its segments.

    ``segments`` (N, 2) carry the two ends of each capsule, ``places`` (N, 2, 3) say where in the segment's axes
    from its origin, ``radii`` (N, 2) how thick it is there, all metres. ``girths`` (P,) are the radii of the spheres
    along each arm, at ``PROBES``.
    """

    segments: NDArray[np.int64]
    places: FloatArray
    radii: FloatArray
    girths: FloatArray

    def __post_init__(self) -> None:
        for name in ("segments", "places", "radii", "girths"):
            array = np.ascontiguousarray(getattr(self, name))
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, BodyVolume) and all(
            np.array_equal(getattr(self, name), getattr(other, name))
            for name in ("segments", "places", "radii", "girths")
        )

    def __hash__(self) -> int:
        return hash((self.places.tobytes(), self.radii.tobytes(), self.girths.tobytes()))


@lru_cache(maxsize=64)
def fitted_volume(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> BodyVolume:
    """The volume of a skin of ``build`` fitted to ``morphology``, as it is bound there (``skin.bound_pose``).

    Where the mesh has no vertices to measure, the body's proportions say what is usual.
    """
    usual, girth_unit = _Usual(morphology), _girth_unit(morphology)
    positions, rotations = bound_pose(mesh, morphology)
    layout, main, vertices = morphology.layout, mesh.segments[:, 0], fit_vertices(mesh, build, morphology)
    of_trunk = np.where(mesh.segments < layout.spine_count, mesh.weights, 0.0).sum(axis=1) > 0.5
    origins = positions[list(layout.proximal_points())]

    def in_bone(segment: int) -> tuple[FloatArray, FloatArray]:
        """Vertices of a segment in its axes, z in parts of its length; and their distances from it."""
        local = (vertices[main == segment] - origins[segment]) @ rotations[segment]
        length = float(np.linalg.norm(positions[layout.distal_points()[segment]] - origins[segment]))
        return local / [1.0, 1.0, length], np.hypot(local[:, 0], local[:, 1])

    def section(level: int, height: float) -> tuple[float, float, float]:
        near = of_trunk & (np.abs(vertices[:, 2] - height) < 0.025 * girth_unit)
        if near.sum() < 8:
            return usual.section(level, height)
        x, y = vertices[near, 0].astype(np.float64), vertices[near, 1].astype(np.float64)
        return float(np.abs(y).max()), float(x.max()), float(x.min())

    def girth(segment: int, begin: float, end: float, share: float, otherwise: float) -> float:
        local, away = in_bone(segment)
        near = (local[:, 2] >= begin) & (local[:, 2] <= end)
        return float(np.quantile(away[near], share)) if near.sum() >= 4 else otherwise

    def head() -> tuple[float, float, float, float]:
        local, _ = in_bone(layout.segment(BodyPart.HEAD))
        if len(local) < 8:
            return usual.head()
        low, high = local.min(axis=0), local.max(axis=0)
        radius = 0.25 * (high[0] - low[0] + high[1] - low[1])
        inset = radius / morphology.head
        middle = 0.5 * (low[2] + high[2])
        return radius, 0.5 * (low[0] + high[0]), min(low[2] + inset, middle), max(high[2] - inset, middle)

    thigh, forearm, hand = (
        layout.segment(part) for part in (BodyPart.LEFT_THIGH, BodyPart.LEFT_FOREARM, BodyPart.LEFT_HAND)
    )
    thighs = [girth(thigh, t - 0.1, t + 0.1, 0.5, usual.thigh(k)) for k, t in enumerate(_THIGH)]
    # Of a flat hand what lies between palm and back counts, not its width.
    bands = (
        (forearm, 0.0, 0.15, 0.5), (forearm, 0.4, 0.6, 0.5), (forearm, 0.85, 1.0, 0.5),
        (hand, 0.3, 0.6, 0.25), (hand, 0.7, 1.0, 0.25),
    )  # fmt: skip
    arms = [girth(*band, usual.arm(k)) for k, band in enumerate(bands)]
    return _assembled(morphology, positions, rotations, section, thighs, head(), arms)


@lru_cache(maxsize=64)
def usual_volume(morphology: Morphology) -> BodyVolume:
    """The volume of a body of which only the measures are known: as thick as bodies of its length usually are."""
    usual = _Usual(morphology)
    arms = [usual.arm(k) for k in range(len(PROBES))]
    thighs = [usual.thigh(0), usual.thigh(1)]
    return _assembled(morphology, *rest_pose(morphology), usual.section, thighs, usual.head(), arms)


@dataclass(frozen=True)
class _Usual:
    """Girths of an ordinary body with these measures."""

    morphology: Morphology

    def section(self, level: int, height: float) -> tuple[float, float, float]:
        unit, middle = _girth_unit(self.morphology), _spine_at(self.morphology, height)
        width, front, back = _SECTIONS[level]
        return width * unit, middle + front * unit, middle + back * unit

    def thigh(self, end: int) -> float:
        return _THIGH_GIRTH[end] * _girth_unit(self.morphology)

    def head(self) -> tuple[float, float, float, float]:
        radius, forward, begin, end = _HEAD
        return radius * _girth_unit(self.morphology), forward * _girth_unit(self.morphology), begin, end

    def arm(self, probe: int) -> float:
        return _ARM_GIRTH[probe] * _girth_unit(self.morphology)


def _girth_unit(morphology: Morphology) -> float:
    return morphology.leg_length + morphology.spine_length


def _spine_at(morphology: Morphology, height: float) -> float:
    """How far forward the spine lies at a height of the rest pose."""
    positions, _ = rest_pose(morphology)
    spine = positions[: morphology.layout.neck_base + 1]
    return float(np.interp(height, spine[:, 2], spine[:, 0]))


def _assembled(
    morphology: Morphology,
    positions: FloatArray,
    rotations: FloatArray,
    section: Callable[[int, float], tuple[float, float, float]],
    thighs: list[float],
    head: tuple[float, float, float, float],
    arms: list[float],
) -> BodyVolume:
    """Two capsules side by side from each level of the trunk to the next, then the head and both thighs.

    ``positions`` and ``rotations`` are those in which the trunk's sections were measured.
    """
    layout = morphology.layout
    spine, hips = positions[: layout.neck_base + 1], positions[layout.hip(0), 2]
    ends = []
    for level, share in enumerate(LEVELS):
        height = hips + share * (spine[-1, 2] - hips)
        width, front, back = section(level, height)
        radius = min(width, 0.5 * (front - back))
        segment = int(np.clip(np.searchsorted(spine[:, 2], height) - 1, 0, layout.spine_count - 1))
        # A belly deeper than it is wide is measured from its front: that is where hands meet it.
        sides = [np.array([front - radius, y, height]) for y in (width - radius, radius - width)]
        local = [rotations[segment].T @ (place - positions[segment]) for place in sides]
        ends.append((segment, local, radius))
    segments, places, radii = [], [], []
    for low, high in pairwise(ends):
        for side in range(2):
            segments.append([low[0], high[0]])
            places.append([low[1][side], high[1][side]])
            radii.append([low[2], high[2]])
    radius, forward, begin, end = head
    segments.append([layout.segment(BodyPart.HEAD)] * 2)
    places.append([np.array([forward, 0.0, share * morphology.head]) for share in (begin, end)])
    radii.append([radius] * 2)
    for side in range(2):
        length = morphology.leg[side, 0]
        segments.append([layout.segment(BodyPart.LEFT_THIGH) + 4 * side] * 2)
        places.append([np.array([0.0, 0.0, 0.12 * length]), np.array([0.0, 0.0, length])])
        radii.append(thighs)
    return BodyVolume(np.array(segments), np.array(places), np.array(radii), np.array(arms))
