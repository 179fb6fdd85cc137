"""Signed distance fields of the smooth solids of which a mannequin is made."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

from studio.core.body.morphology import FloatArray

_TINY = 1e-7


@dataclass(frozen=True, eq=False)
class Loft:
    """Solid around the z axis of ``frame`` with elliptical cross-sections and rounded ends, for limbs.

    Rows of ``stations``: position along z, centre x, centre y, half-width x, half-width y, in metres. ``power`` 2 gives
    ellipses, above 2 boxier sections; ``caps`` are the lengths of the two rounded ends.
    """

    origin: FloatArray
    frame: FloatArray
    stations: FloatArray
    power: float = 2.0
    caps: tuple[float, float] | None = None

    @cached_property
    def _profile(self) -> PchipInterpolator:
        return PchipInterpolator(self.stations[:, 0], self.stations[:, 1:])

    def distance(self, points: FloatArray) -> FloatArray:
        """Signed distances (N,) of world ``points`` (N, 3), negative inside; accurate near the surface only."""
        local = (points - self.origin) @ self.frame + _TINY
        first, last = self.stations[0], self.stations[-1]
        along = np.clip(local[:, 2], first[0], last[0])
        centre_x, centre_y, half_x, half_y = self._profile(along).T
        x, y, beyond = local[:, 0] - centre_x, local[:, 1] - centre_y, local[:, 2] - along
        caps = self.caps or (float(first[3:].mean()), float(last[3:].mean()))
        cap = np.where(beyond < 0, *caps)
        section = (np.abs(x / half_x) ** self.power + np.abs(y / half_y) ** self.power) ** (1 / self.power)
        level = np.hypot(section, beyond / cap)
        return np.asarray(np.sqrt(x * x + y * y + beyond * beyond) * (1 - 1 / level))


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """Ellipsoid with half-axes ``radii`` along the columns of ``frame``."""

    centre: FloatArray
    radii: FloatArray
    frame: FloatArray

    def distance(self, points: FloatArray) -> FloatArray:
        """Approximate signed distances (N,), first-order exact at the surface (Quilez, "Ellipsoid SDF")."""
        local = (points - self.centre) @ self.frame + _TINY
        level = np.linalg.norm(local / self.radii, axis=1)
        slope = np.linalg.norm(local / self.radii**2, axis=1)
        return np.asarray(level * (level - 1) / slope)


Solid = Loft | Ellipsoid


def smooth_union(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    """Signed distances of the union of two solids with distances ``a`` and ``b``, with a fillet of ``width``."""
    overlap = np.maximum(width - np.abs(a - b), 0) / width
    return np.asarray(np.minimum(a, b) - overlap**3 * width / 6)


@dataclass(frozen=True, eq=False)
class BlendedSolid:
    """Solid that is added to the previous ones or, if ``carved``, subtracted from them, with a fillet of width
    ``fillet``.
    """

    solid: Solid
    fillet: float = 0.0
    carved: bool = False


def union(parts: list[BlendedSolid], points: FloatArray) -> FloatArray:
    """Signed distances of ``points`` from the solid made of all ``parts``, added or subtracted in their order."""
    distance = parts[0].solid.distance(points)
    for part in parts[1:]:
        other = part.solid.distance(points)
        if part.carved:
            distance = -smooth_union(-distance, other, part.fillet)
        else:
            distance = smooth_union(distance, other, part.fillet)
    return distance
