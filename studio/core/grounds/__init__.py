"""Ground under the performers: kinds other than the level one, each in its own file."""

from collections.abc import Mapping
from types import MappingProxyType

from studio.core.grounds.bumps import Bumps
from studio.core.grounds.ground import Ground
from studio.core.grounds.height_map import HeightMap
from studio.core.grounds.slope import Slope
from studio.core.grounds.steps import Steps
from studio.core.grounds.surface_mesh import SurfaceMesh

GROUND_KINDS: Mapping[str, type[Ground]] = MappingProxyType(
    {kind.kind: kind for kind in (Ground, Slope, Steps, Bumps, HeightMap, SurfaceMesh)}
)

__all__ = ["GROUND_KINDS", "Bumps", "HeightMap", "Slope", "Steps", "SurfaceMesh"]
