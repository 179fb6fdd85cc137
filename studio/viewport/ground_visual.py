"""Uneven ground: a shaded surface with metre lines, rebuilt only when the ground changes."""

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from studio.core.grounds import Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.grounds.slope import direction_vector
from studio.viewport.floor import (
    FLOOR_COLOUR,
    GRID_LINE_COLOUR,
    GRID_REACH_METRES,
    HORIZON_COLOUR,
    LINE_LIFT_METRES,
    as_bytes,
    line_fade,
    line_tints,
)
from studio.viewport.live_mesh import flat_actor

FloatArray = NDArray[np.float64]

SURFACE_CELL = 0.125
"""Distance in metres between points of the surface; metre lines run along points."""
LINE_STEP = 0.02
"""Distance in metres between points of a line that crosses edges."""
SURFACE_DISTANCES = np.array([18.0, 24.0, 34.0, 50.0, 80.0])
LAMP_DIRECTION = np.array([-0.45, 0.35, 0.82])
LAMP_STRENGTH = 0.75
"""Change in brightness, relative to the level floor, per unit of the cosine between normal and light."""

MIN_BRIGHTNESS = 0.66
"""Brightness relative to the level floor of a riser that faces away from the light."""

FaceArray = NDArray[np.int64]


class GroundVisual:
    """VTK objects of a ground's surface and lines."""

    def __init__(self) -> None:
        self._surface, self._lines = pv.PolyData(), pv.PolyData()
        self.surface, self.lines = flat_actor(self._surface), flat_actor(self._lines)
        self._shown: Ground | None = None
        for actor in (self.surface, self.lines):
            actor.SetVisibility(False)

    def show(self, ground: Ground) -> bool:
        """Show ``ground``; nothing for a level one, which the floor draws. Returns True if anything was rebuilt."""
        if ground == self._shown:
            return False
        self._shown = ground
        for actor in (self.surface, self.lines):
            actor.SetVisibility(not ground.is_level)
        if not ground.is_level:
            points, normals, faces = surface_of(ground)
            self._surface.points = np.array(points, dtype=np.float32)
            self._surface.faces = faces.ravel()
            self._surface.point_data["colour"] = lighting_factors(points, normals)
            self._surface.point_data.active_scalars_name = "colour"
            ends, tints, pairs = lines_of(ground)
            self._lines.points = ends.astype(np.float32)
            self._lines.lines = np.column_stack([np.full(len(pairs), 2), pairs]).ravel()
            self._lines.point_data["colour"] = tints
            self._lines.point_data.active_scalars_name = "colour"
        return True

    def place_shadow(self, centre: FloatArray, reach: float) -> None:
        """Project the shadow texture from above onto the square of ``reach`` metres to each side of ``centre`` (2,)."""
        places = (np.asarray(self._surface.points)[:, :2] - centre) / (2 * reach) + 0.5
        self._surface.active_texture_coordinates = places.astype(np.float64)


def surface_of(ground: Ground) -> tuple[FloatArray, FloatArray, FaceArray]:
    """Points (V, 3), normals (V, 3), and faces of a ground up to about 80 m from the centre."""
    if isinstance(ground, Steps):
        return _flight(ground)
    near = np.arange(-GRID_REACH_METRES, GRID_REACH_METRES + SURFACE_CELL / 2, SURFACE_CELL)
    axis = np.concatenate([-SURFACE_DISTANCES[::-1], near, SURFACE_DISTANCES])
    xy = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    faces = _quads(len(axis), len(axis))
    if not isinstance(ground, SurfaceMesh):
        return np.column_stack([xy, ground.height_at(xy)]), ground.normal_at(xy), faces
    floor = np.column_stack([xy, np.full(len(xy), ground.height)])
    mesh = ground.vertices + np.array([0.0, 0.0, ground.height])
    corners = mesh[ground.triangles].reshape(-1, 3)
    across = np.cross(corners[1::3] - corners[::3], corners[2::3] - corners[::3])
    across *= np.where(across[:, 2:] < 0.0, -1.0, 1.0) / np.maximum(
        np.linalg.norm(across, axis=1, keepdims=True), 1e-12
    )
    # Each triangle twice over, as a quadrilateral whose last two corners are one: one table of faces.
    own = len(floor) + np.arange(len(corners)).reshape(-1, 3)
    more = np.column_stack([np.full(len(own), 4), own, own[:, 2]])
    normals = np.concatenate([np.tile([0.0, 0.0, 1.0], (len(floor), 1)), np.repeat(across, 3, axis=0)])
    return np.concatenate([floor, corners]), normals, np.concatenate([faces, more])


def lighting_factors(points: FloatArray, normals: FloatArray) -> NDArray[np.uint8]:
    """(V, 3) grey of the surface, lit from one side, fading to the colour of the horizon."""
    light = np.maximum(1.0 + LAMP_STRENGTH * (normals @ LAMP_DIRECTION - LAMP_DIRECTION[2]), MIN_BRIGHTNESS)
    away = np.clip((np.linalg.norm(points[:, :2], axis=1) - 12.0) / 60.0, 0, 1)[:, None]
    return as_bytes(np.clip(FLOOR_COLOUR * light[:, None], 0, 255) * (1 - away) + HORIZON_COLOUR * away)


def lines_of(ground: Ground) -> tuple[FloatArray, NDArray[np.uint8], FaceArray]:
    """Metre lines over the ground: points (N, 3), colours (N, 3), and pairs of point indices (M, 2)."""
    spacing = LINE_STEP if isinstance(ground, Steps | SurfaceMesh) else SURFACE_CELL
    along = np.linspace(-GRID_REACH_METRES, GRID_REACH_METRES, round(2 * GRID_REACH_METRES / spacing) + 1)
    places = np.arange(-GRID_REACH_METRES, GRID_REACH_METRES + 1.0)
    run, place = (grid.ravel() for grid in np.meshgrid(along, places, indexing="xy"))
    xy = np.concatenate([np.column_stack([run, place]), np.column_stack([place, run])])
    tints = np.concatenate([line_tints(run, place, 0), line_tints(run, place, 1)])
    index = np.arange(len(xy)).reshape(-1, len(along))
    pairs = np.stack([index[:, :-1], index[:, 1:]], axis=-1).reshape(-1, 2)
    heights = ground.height_at(xy)
    if isinstance(ground, Steps):
        edges = _edges(ground)
        pairs = np.concatenate([pairs, len(xy) + np.arange(len(edges)).reshape(-1, 2)])
        xy, heights = np.concatenate([xy, edges[:, :2]]), np.concatenate([heights, edges[:, 2]])
        tints = np.concatenate([tints, np.tile(GRID_LINE_COLOUR, (len(edges), 1))])
    points = np.column_stack([xy, heights + LINE_LIFT_METRES])
    fade = line_fade(xy)
    under = lighting_factors(points, ground.normal_at(xy)).astype(np.float64)
    return points, as_bytes(under * (1 - fade) + tints * fade), pairs


def _edges(ground: Steps) -> FloatArray:
    """(2 * pieces, 3) ends of pieces of the edges of steps, one metre long so that they can fade."""
    ahead, across = direction_vector(ground.direction), direction_vector(ground.direction + np.pi / 2)
    risers = np.arange(ground.count)
    heights = ground.height + ground.rise * (risers + (1 if ground.rise > 0 else 0))
    begins = np.arange(-GRID_REACH_METRES, GRID_REACH_METRES)
    sides = np.stack([begins, begins + 1.0], axis=-1).ravel()
    xy = np.array(ground.start) + (risers[:, None] * ground.tread)[..., None] * ahead + sides[:, None] * across
    return np.column_stack([xy.reshape(-1, 2), np.repeat(heights, len(sides))])


def _flight(ground: Steps) -> tuple[FloatArray, FloatArray, FaceArray]:
    """Treads and risers with separate vertices, so that edges are sharp, and the floor before and after them."""
    ahead, across = direction_vector(ground.direction), direction_vector(ground.direction + np.pi / 2)
    risers = np.arange(ground.count) * ground.tread
    end = risers[-1]
    along = np.concatenate(
        [
            -SURFACE_DISTANCES[::-1],
            [-GRID_REACH_METRES],
            np.repeat(risers, 4),
            [end + GRID_REACH_METRES],
            end + SURFACE_DISTANCES,
        ]
    )
    level = np.concatenate(
        [
            np.zeros(len(SURFACE_DISTANCES) + 1),
            np.repeat(np.arange(ground.count), 4),
            np.zeros(len(SURFACE_DISTANCES) + 1),
        ]
    )
    level[len(SURFACE_DISTANCES) + 1 : -len(SURFACE_DISTANCES) - 1] += np.tile([0, 0, 1, 1], ground.count)
    level[-len(SURFACE_DISTANCES) - 1 :] = ground.count
    upright = np.zeros(len(along), dtype=bool)
    upright[len(SURFACE_DISTANCES) + 1 : -len(SURFACE_DISTANCES) - 1] = np.tile(
        [False, True, True, False], ground.count
    )
    sides = np.concatenate(
        [-SURFACE_DISTANCES[::-1], np.arange(-GRID_REACH_METRES, GRID_REACH_METRES + 0.5, 2.0), SURFACE_DISTANCES]
    )
    xy = np.array(ground.start) + along[:, None, None] * ahead + sides[:, None] * across
    heights = np.broadcast_to((ground.height + ground.rise * level)[:, None], xy.shape[:2])
    facing = np.append(-np.sign(ground.rise) * ahead, 0.0)
    normals = np.where(upright[:, None, None], facing, np.array([0.0, 0.0, 1.0]))
    normals = np.broadcast_to(normals, (*xy.shape[:2], 3)).reshape(-1, 3)
    points = np.column_stack([xy.reshape(-1, 2), heights.ravel()])
    return points, normals, _quads(len(along), len(sides))


def _quads(rows: int, columns: int) -> FaceArray:
    """(Q, 5) quadrilaterals of a grid of points, in VTK's format."""
    index = np.arange(rows * columns).reshape(rows, columns)
    corners = [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]]
    return np.column_stack([np.full((rows - 1) * (columns - 1), 4), *(corner.ravel() for corner in corners)])
