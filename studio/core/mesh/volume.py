"""Collision volume of a body: tapered capsules for trunk, head and thighs, and spheres along the arms.

Self-collision needs a shape of the body that is evaluated in nanoseconds. Every body has the same capsules in the same
order, so that those of two bodies can be compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.mesh.outline import outline_at
from studio.core.mesh.skin import SkinnedMesh, bound_pose, fit_vertices
from studio.core.project_cache import project_cache

TRUNK_LEVELS = (0.03, 0.30, 0.58, 0.80)
"""Heights at which the trunk is measured, as fractions of the distance from the hips to the neck base."""
ARM_PROBES = ((0, 0.0), (0, 0.5), (0, 1.0), (1, 0.45), (1, 0.85))
"""Positions of the spheres of an arm: bone (0 forearm, 1 hand) and fraction of its length."""
PALM_SURFACE_PROBE = ARM_PROBES[3][1]
"""Position of the palm's sphere, as a fraction of the hand's length."""
PART_CAPSULES = {"hips": (0, 1), "trunk": (2, 3, 4, 5), "head": (6,), "thigh": (7, 8)}
"""Indices of the capsules that represent each part of the body."""
_BAND = 0.015
"""Half height of the band in which the trunk is measured at a level, as a fraction of leg plus spine length."""
_FEWEST, _THINNEST = 8, 0.4
"""Least number of points of an outline, and least fraction of the typical breadth and depth of a trunk; below them, the
mesh has only a rod or a gap there.
"""
_HEAD_LEVELS, _LOWEST_HEAD = (0.25, 0.5), -0.6
"""Heights at which the head is measured, and its lowest, parts of its length: brims and long hair do not count."""
_THIGH = (0.2, 0.9)
_ARM_BANDS = ((0.0, 0.15), (0.4, 0.6), (0.85, 1.0), (0.3, 0.6), (0.7, 1.0))
"""Places at which ``ARM_PROBES`` are measured, in parts of its bone's length."""
_ARM_SHARES = (0.5, 0.5, 0.5, 0.25, 0.25)
"""Quantile of the distances of a band's vertices from the bone that is taken as its radius."""
_USUAL_TRUNK_SECTIONS = ((0.123, 0.071, -0.096), (0.100, 0.069, -0.060), (0.118, 0.095, -0.057), (0.122, 0.090, -0.051))
_THIGH_GIRTH, _HEAD, _ARM_GIRTH = (0.065, 0.036), (0.066, 0.018, 0.27, 0.50), (0.024, 0.022, 0.016, 0.015, 0.011)
"""An ordinary body's sections (half width, front, back), thigh, head (radius, forward, from, to in head lengths) and
arm, in parts of the length of leg and spine together: means of two bundled characters."""


@dataclass(frozen=True, eq=False)
class BodyVolume:
    """Collision volume of one body: capsules and spheres fixed to its segments.

    ``segments`` (N, 2) are the segments that carry the two ends of each capsule, ``places`` (N, 2, 3) the positions of
    the ends relative to the segment's origin, in its axes, and ``radii`` (N, 2) the radii there, all in metres.
    ``girths`` (P,) are the radii of the spheres along each arm, at ``ARM_PROBES``.
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


@project_cache(maxsize=64)
def fitted_volume(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> BodyVolume:
    """Collision volume of a skin of ``build`` fitted to ``morphology``, in its bind pose (``skin.bound_pose``).

    Where the mesh has no vertices, or is only a rod, typical values for the body's proportions are used.
    """
    positions, rotations = bound_pose(mesh, morphology)
    vertices = np.asarray(fit_vertices(mesh, build, morphology), dtype=np.float64)
    return _assembled(
        morphology, positions, rotations, _MeasuredGirths(morphology, mesh, vertices, positions, rotations)
    )


@lru_cache(maxsize=64)
def usual_volume(morphology: Morphology) -> BodyVolume:
    """Typical collision volume of a body of which only the measures are known."""
    return _assembled(morphology, *rest_pose(morphology), _TypicalGirths(morphology))


class _Girths(Protocol):
    """Thickness of the parts of a body in metres."""

    def section(self, level: int, height: float) -> tuple[float, float, float]:
        """Half width, front and back of the trunk at one of ``TRUNK_LEVELS``, which lies at ``height`` metres."""

    def thigh(self, end: int) -> float: ...

    def head(self) -> tuple[float, float, float, float]:
        """Radius, forward offset, and begin and end of the head's capsule in head lengths."""

    def arm(self, probe: int) -> float: ...


@dataclass(frozen=True)
class _TypicalGirths(_Girths):
    """Thickness of the parts of an average body with these measures."""

    morphology: Morphology

    def section(self, level: int, height: float) -> tuple[float, float, float]:
        unit, middle = _girth_unit(self.morphology), _spine_at(self.morphology, height)
        width, front, back = _USUAL_TRUNK_SECTIONS[level]
        return width * unit, middle + front * unit, middle + back * unit

    def thigh(self, end: int) -> float:
        return _THIGH_GIRTH[end] * _girth_unit(self.morphology)

    def head(self) -> tuple[float, float, float, float]:
        radius, forward, begin, end = _HEAD
        return radius * _girth_unit(self.morphology), forward * _girth_unit(self.morphology), begin, end

    def arm(self, probe: int) -> float:
        return _ARM_GIRTH[probe] * _girth_unit(self.morphology)


@dataclass(frozen=True, eq=False)
class _MeasuredGirths(_Girths):
    """Thickness of the parts of a mesh with ``vertices`` (V, 3) around a posed body; typical for parts without
    vertices.
    """

    morphology: Morphology
    mesh: SkinnedMesh
    vertices: FloatArray
    positions: FloatArray
    rotations: FloatArray

    def section(self, level: int, height: float) -> tuple[float, float, float]:
        band = _BAND * _girth_unit(self.morphology)
        shares = self._shares(self.mesh.segments < self.morphology.layout.spine_count)
        around = [outline_at(height + way * band, self.mesh, self.vertices, shares) for way in (-1.0, 1.0)]
        x, y = np.concatenate(around).T
        width, front, back = _TypicalGirths(self.morphology).section(level, height)
        if len(y) < _FEWEST or np.abs(y).max() < _THINNEST * width or np.ptp(x) < _THINNEST * (front - back):
            return width, front, back
        return float(np.abs(y).max()), float(x.max()), float(x.min())

    def thigh(self, end: int) -> float:
        around = _THIGH[end] - 0.1, _THIGH[end] + 0.1
        return self._girth(BodyPart.LEFT_THIGH, around, 0.5, _TypicalGirths(self.morphology).thigh(end))

    def head(self) -> tuple[float, float, float, float]:
        low, high = self._rings(BodyPart.HEAD, _HEAD_LEVELS)
        if np.isnan(low).any():
            return _TypicalGirths(self.morphology).head()
        radius = 0.25 * float((high - low).sum())
        own = self._in_bone(BodyPart.HEAD, self._main(BodyPart.HEAD))[:, 2]
        bottom, inset = max(float(own.min()), _LOWEST_HEAD), radius / self.morphology.head
        middle = 0.5 * (bottom + 1.0)
        return radius, 0.5 * float(low[0] + high[0]), min(bottom + inset, middle), max(1.0 - inset, middle)

    def arm(self, probe: int) -> float:
        """Radius at a probe in metres; for a flat hand, half the thickness from palm to back and not half the width.

        A fist is as thick as it is wide.
        """
        part = BodyPart.LEFT_HAND if ARM_PROBES[probe][0] else BodyPart.LEFT_FOREARM
        least = self._girth(part, _ARM_BANDS[probe], _ARM_SHARES[probe], _TypicalGirths(self.morphology).arm(probe))
        if part is BodyPart.LEFT_FOREARM:
            return least
        return float(np.fmax(least, 0.5 * np.ptp(self._rings(part, (ARM_PROBES[probe][1],)), axis=0).min()))

    def _girth(self, part: BodyPart, band: tuple[float, float], share: float, otherwise: float) -> float:
        """Radius around the bone of ``part`` that contains the fraction ``share`` of the vertices in ``band``.

        The band is in fractions of the bone's length. The radius is ``otherwise`` if the band has fewer than four
        vertices.
        """
        own = self._in_bone(part, self._main(part))
        near = own[(own[:, 2] >= band[0]) & (own[:, 2] <= band[1])]
        return float(np.quantile(np.hypot(near[:, 0], near[:, 1]), share)) if len(near) >= 4 else otherwise

    def _rings(self, part: BodyPart, heights: Sequence[float]) -> FloatArray:
        """Least and greatest x, y (2, 2) of the outlines across ``part`` at ``heights``, fractions of its length; NaN
        if there are none.
        """
        own, shares = (
            self._in_bone(part),
            self._shares(self.mesh.segments == self.morphology.layout.segment_of_part(part)),
        )
        found = np.concatenate([outline_at(height, self.mesh, own, shares) for height in heights])
        return np.stack([found.min(axis=0), found.max(axis=0)]) if len(found) >= _FEWEST else np.full((2, 2), np.nan)

    def _in_bone(self, part: BodyPart, rows: slice | NDArray[np.intp] = slice(None)) -> FloatArray:
        """Vertices (N, 3) in the axes of a segment, z as a fraction of its length."""
        layout = self.morphology.layout
        segment = layout.segment_of_part(part)
        begin, end = (self.positions[points[segment]] for points in (layout.proximal_points(), layout.distal_points()))
        local = (self.vertices[rows] - begin) @ self.rotations[segment]
        return np.asarray(local / [1.0, 1.0, float(np.linalg.norm(end - begin))])

    def _main(self, part: BodyPart) -> NDArray[np.intp]:
        """Indices of the vertices whose greatest weight is that of ``part``."""
        return np.flatnonzero(self.mesh.segments[:, 0] == self.morphology.layout.segment_of_part(part))

    def _shares(self, counted: NDArray[np.bool_]) -> FloatArray:
        return np.asarray(np.einsum("vw,vw->v", counted, self.mesh.weights), dtype=np.float64)


def _girth_unit(morphology: Morphology) -> float:
    return morphology.leg_length + morphology.spine_length


def _spine_at(morphology: Morphology, height: float) -> float:
    """Forward position of the spine, in metres, at a height of the rest pose."""
    positions, _ = rest_pose(morphology)
    spine = positions[: morphology.layout.neck_base + 1]
    return float(np.interp(height, spine[:, 2], spine[:, 0]))


def _assembled(
    morphology: Morphology,
    positions: FloatArray,
    rotations: FloatArray,
    girths: _Girths,
) -> BodyVolume:
    """Volume of a body: two capsules side by side between neighbouring levels of the trunk, then the head and both
    thighs.

    ``positions`` and ``rotations`` are the pose in which the sections of the trunk were measured.
    """
    layout = morphology.layout
    spine, hips = positions[: layout.neck_base + 1], positions[layout.hip_point(0), 2]
    ends = []
    for level, share in enumerate(TRUNK_LEVELS):
        height = hips + share * (spine[-1, 2] - hips)
        width, front, back = girths.section(level, height)
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
    radius, forward, begin, end = girths.head()
    segments.append([layout.segment_of_part(BodyPart.HEAD)] * 2)
    places.append([np.array([forward, 0.0, share * morphology.head]) for share in (begin, end)])
    radii.append([radius] * 2)
    for side in range(2):
        length = morphology.leg[side, 0]
        segments.append([layout.segment_of_part(BodyPart.LEFT_THIGH) + 4 * side] * 2)
        places.append([np.array([0.0, 0.0, 0.12 * length]), np.array([0.0, 0.0, length])])
        radii.append([girths.thigh(0), girths.thigh(1)])
    return BodyVolume(
        np.array(segments), np.array(places), np.array(radii), np.array([girths.arm(k) for k in range(len(ARM_PROBES))])
    )
