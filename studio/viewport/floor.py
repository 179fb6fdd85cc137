"""Floor: a plane that fades into the distance, metre lines, coloured first metres of the axes, and soft shadows."""

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk

from studio.core.body.morphology import Morphology
from studio.core.grounds.ground import Ground

FLOOR_COLOUR = np.array([0x20, 0x24, 0x2A], dtype=np.float64)
GRID_LINE_COLOUR = np.array([0x3A, 0x42, 0x4B], dtype=np.float64)
X_AXIS_COLOUR, Y_AXIS_COLOUR = (
    np.array([0x8A, 0x46, 0x48], dtype=np.float64),
    np.array([0x4C, 0x7A, 0x52], dtype=np.float64),
)
ZENITH_COLOUR = np.array([0x2F, 0x36, 0x3F], dtype=np.float64)
HORIZON_COLOUR = np.array([0x27, 0x2C, 0x33], dtype=np.float64)
GRID_REACH_METRES = 14
"""Length in metres of the metre lines from the centre."""
SHADOW_CELLS, SHADOW_REACH = 192, 8.0
"""Cells per side of the shadow texture, and its reach in metres from the centre."""
SHADOW_LIFT_METRES, LINE_LIFT_METRES = 0.0015, 0.003
"""Heights in metres of the shadow texture and of the lines above the floor."""


def make_plane() -> pv.PolyData:
    """Round floor of 120 m that fades to the colour of the horizon."""
    radii = np.array([0.0, 12.0, 30.0, 60.0, 120.0])
    angles = np.linspace(0, 2 * np.pi, 49)[:-1]
    points = [np.zeros(3)]
    for radius in radii[1:]:
        points += [np.array([radius * np.cos(a), radius * np.sin(a), 0.0]) for a in angles]
    count, faces = len(angles), []
    for k in range(count):
        following = (k + 1) % count
        faces.append([3, 0, 1 + k, 1 + following])
        for ring in range(len(radii) - 2):
            inner, outer = 1 + ring * count, 1 + (ring + 1) * count
            faces.append([3, inner + k, outer + k, outer + following])
            faces.append([3, inner + k, outer + following, inner + following])
    plane = pv.PolyData(np.array(points, dtype=np.float32), np.ravel(faces))
    share = np.clip((np.linalg.norm(plane.points[:, :2], axis=1) - 12.0) / 60.0, 0, 1)[:, None]
    plane.point_data["colour"] = as_bytes(FLOOR_COLOUR * (1 - share) + HORIZON_COLOUR * share)
    return plane


def make_sky() -> pv.PolyData:
    """Sphere of 150 m seen from inside: the floor's far colour at the horizon, lighter above."""
    sky = pv.Sphere(radius=150.0, theta_resolution=24, phi_resolution=24)
    height = np.clip(sky.points[:, 2] / 150.0 / 0.35, 0, 1)[:, None]
    sky.point_data.clear()
    sky.point_data["colour"] = as_bytes(HORIZON_COLOUR * (1 - height) + ZENITH_COLOUR * height)
    return sky


def make_lines() -> pv.PolyData:
    """Metre lines in pieces of one metre that fade towards the rim; X and Y are coloured along the axes."""
    reach = np.arange(-GRID_REACH_METRES, GRID_REACH_METRES + 1)
    pieces, tints = [], []
    for place in reach:
        for begin in reach[:-1]:
            pieces += [[[begin, place], [begin + 1, place]], [[place, begin], [place, begin + 1]]]
            tints += [
                X_AXIS_COLOUR if place == 0 and begin >= 0 else GRID_LINE_COLOUR,
                Y_AXIS_COLOUR if place == 0 and begin >= 0 else GRID_LINE_COLOUR,
            ]
    ends = np.array(pieces, dtype=np.float64).reshape(-1, 2)
    lines = pv.PolyData()
    lines.points = np.column_stack([ends, np.full(len(ends), LINE_LIFT_METRES)]).astype(np.float32)
    pairs = np.arange(len(ends)).reshape(-1, 2)
    lines.lines = np.column_stack([np.full(len(pairs), 2), pairs]).ravel()
    fade = line_fade(ends)
    lines.point_data["colour"] = as_bytes(FLOOR_COLOUR * (1 - fade) + np.repeat(tints, 2, axis=0) * fade)
    return lines


class SoftShadows:
    """Texture of the floor, darkened below bodies."""

    def __init__(self) -> None:
        self._dark = np.zeros((SHADOW_CELLS, SHADOW_CELLS), dtype=np.float32)
        picture = pv.ImageData(dimensions=(SHADOW_CELLS, SHADOW_CELLS, 1))
        self._bytes = np.tile(as_bytes(FLOOR_COLOUR), (SHADOW_CELLS**2, 1))
        self._picture = picture
        self._scalars = numpy_to_vtk(self._bytes, deep=False)
        picture.GetPointData().SetScalars(self._scalars)
        self.texture = pv.Texture(picture)
        self.texture.InterpolateOn()
        self.texture.RepeatOff()
        self.texture.EdgeClampOn()
        self.centre = np.zeros(2)
        reach = 2 * SHADOW_REACH
        quad = pv.Plane(i_size=reach, j_size=reach, i_resolution=1, j_resolution=1)
        self.actor = pv.Actor(mapper=pv.DataSetMapper(quad))
        self.actor.mapper.scalar_visibility = False
        self.actor.prop.lighting = False
        self.actor.prop.culling = "back"
        self.actor.prop.color = "white"
        self.actor.texture = self.texture

    def cast(self, bodies: list[tuple[NDArray[np.float64], Morphology]], ground: Ground) -> None:
        """Darken the ground under each body, from its stage points (N, 3) and its morphology.

        A level floor is drawn with the texture; any other ground receives it as ``texture`` around ``centre``.
        """
        cell = 2 * SHADOW_REACH / SHADOW_CELLS
        middle = np.mean([points[0, :2] for points, _ in bodies], axis=0) if bodies else np.zeros(2)
        centre = np.round(middle / cell) * cell
        self._dark[:] = 0
        spots = [spot for points, morphology in bodies for spot in _spots(points, morphology, ground)]
        if spots:
            places, radii, strengths = (np.array(each) for each in zip(*spots, strict=True))
            self._darken((places - centre + SHADOW_REACH) / cell, radii / cell, strengths)
        shade = (1.0 - self._dark).reshape(-1, 1)
        tone = FLOOR_COLOUR if ground.is_level else np.full(3, 255.0)
        np.multiply(shade, tone.astype(np.float32), out=self._bytes, casting="unsafe")
        self._scalars.Modified()
        self._picture.Modified()
        self.actor.SetOrigin(0.0, 0.0, 0.0)
        self.centre = centre
        self.actor.SetVisibility(ground.is_level)
        self.actor.SetPosition(centre[0], centre[1], ground.height + SHADOW_LIFT_METRES)

    def _darken(
        self, positions: NDArray[np.float64], radii: NDArray[np.float64], strengths: NDArray[np.float64]
    ) -> None:
        """Add soft spots at ``positions`` (S, 2) of the texture; overlapping spots multiply."""
        away = np.arange(SHADOW_CELLS) - positions[:, :, None]
        fades = np.exp(-((away / radii[:, None, None]) ** 2)).astype(np.float32)
        reach = 2.2 * radii[:, None]
        firsts = np.maximum(np.floor(positions - reach), 0).astype(int).tolist()
        ends = np.minimum(np.ceil(positions + reach) + 1, SHADOW_CELLS).astype(int).tolist()
        for fade, strength, first, end in zip(fades, strengths.tolist(), firsts, ends, strict=True):
            across, along = (fade[axis, first[axis] : max(end[axis], 0)] for axis in (0, 1))
            window = self._dark[first[1] : max(end[1], 0), first[0] : max(end[0], 0)]
            window += strength * along[:, None] * across * (1 - window)


def _spots(
    points: NDArray[np.float64], morphology: Morphology, ground: Ground
) -> list[tuple[NDArray[np.float64], float, float]]:
    """Position, radius and strength of the soft spots of a body: sharp ones near the feet, wide and faint ones of the
    trunk.
    """
    layout, size = morphology.layout, morphology.leg_length
    parts = [(layout.ankle_point(side) + k, 0.13, 0.62) for side in (0, 1) for k in (0, 1)]
    parts += [(layout.wrist_point(side), 0.12, 0.30) for side in (0, 1)]
    parts += [(0, 0.42, 0.42), (layout.neck_base, 0.34, 0.20)]
    places = points[[place for place, _, _ in parts]]
    heights = np.maximum(places[:, 2] - ground.height_at(places), 0.0)
    spots = []
    for place, far, (_, radius, strength) in zip(places, (heights / size).tolist(), parts, strict=True):
        spread = radius * size * (1 + 0.5 * far)
        spots.append((place[:2], spread, strength / (1 + (2.2 * far if radius < 0.2 else 0.25 * far) ** 2)))
    return spots


def line_tints(run: NDArray[np.float64], position: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """(N, 3) colours of metre lines along ``axis`` at positions ``run`` (N,) of the lines ``position`` (N,); only the
    first metre of an axis is coloured.
    """
    first = (position == 0.0) & (run >= 0.0)
    return np.where(first[:, None], (X_AXIS_COLOUR, Y_AXIS_COLOUR)[axis], GRID_LINE_COLOUR)


def line_fade(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 1) opacity of metre lines at ``positions`` (N, 2), which decreases towards the rim."""
    near: NDArray[np.float64] = np.clip(1.15 - np.linalg.norm(positions, axis=1) / GRID_REACH_METRES, 0, 1)[:, None]
    return near**1.2


def as_bytes(colours: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Colours (N, 3) rounded to 0 to 255."""
    return np.round(colours).astype(np.uint8)
