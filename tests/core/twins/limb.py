"""A limb drawn with compasses: two bones, their middle joint on a circle about the line to the extremity."""

import numpy as np

from tests.core.twins.rotation import about_z, shortest_arc

Z = np.array([0.0, 0.0, 1.0])


def place_limb(
    root: np.ndarray,
    frame: np.ndarray,
    distance: float,
    bones: tuple[float, float],
    off_plane: float,
    bend: float,
    twist: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(middle joint, extremity, upper rotation, lower rotation)."""
    upper, lower = bones
    along = (upper**2 + distance**2 - lower**2) / (2 * distance)
    radius = np.sqrt(max(upper**2 - along**2, 0.0))
    x = np.clip(off_plane, -radius, radius)
    middle = np.array([x, bend * np.sqrt(max(radius**2 - x**2, 0.0)), along])
    below = distance * Z - middle
    directions = middle / np.linalg.norm(middle), below / np.linalg.norm(below)
    turned = [frame @ shortest_arc(Z, way) @ about_z(angle) for way, angle in zip(directions, twist, strict=True)]
    return root + frame @ middle, root + frame @ (distance * Z), *turned


def soft_reach(needed: float, comfort: float) -> float:
    room = 1.0 - comfort
    return needed if needed <= comfort else 1.0 - room * np.exp(-(needed - comfort) / room)
