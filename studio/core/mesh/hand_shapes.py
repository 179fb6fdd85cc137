"""Hand shapes of a mesh other than at ease: open, half closed, and fists."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

OPEN_GRIP, RELAXED_GRIP, HALF_CLOSED_GRIP, FIST_GRIP = -1.0, 0.0, 0.5, 1.0
GRIPS = (OPEN_GRIP, RELAXED_GRIP, HALF_CLOSED_GRIP, FIST_GRIP)
FINGER_BENDS = np.radians([[0.0, 0.0, 0.0], [15.0, 40.0, 55.0], [35.0, 85.0, 115.0], [90.0, 190.0, 260.0]])
"""Angles (4, 3) in radians of the three bones of a finger to the palm in each of ``GRIPS``."""
FINGER_LENGTH, FINGER_RADIUS = 0.08, 0.008
"""Length and radius in metres of an adult's finger that closes around an object."""
STORED_GRIPS = (OPEN_GRIP, HALF_CLOSED_GRIP, FIST_GRIP)
"""Grips of the stored shapes; the mesh itself has its hands at ease."""


@dataclass(frozen=True, eq=False)
class HandShapes:
    """Positions and normals (3, G, 3) of the last G vertices of a mesh: with open, half closed and fist hands.

    Raises ValueError if the arrays do not fit each other.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]

    def __post_init__(self) -> None:
        for name in ("vertices", "normals"):
            array = np.array(getattr(self, name), dtype=np.float32)
            if (
                array.ndim != 3
                or array.shape[0] != len(STORED_GRIPS)
                or array.shape[2] != 3
                or not np.isfinite(array).all()
            ):
                raise ValueError(f"hands: {name} of shape (3, G, 3) expected.")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.vertices.shape != self.normals.shape:
            raise ValueError("hands: as many normals as vertices expected.")

    @property
    def count(self) -> int:
        """Number G of vertices that change with the shape of the hands."""
        return len(self.vertices[0])

    def shaped_vertices(
        self, vertices: NDArray[np.float32], normals: NDArray[np.float32], grip: float
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Vertices and normals (V, 3) of the mesh with its hands shaped by ``grip``: -1 open, 0 at ease, 1 fists."""
        found = []
        for eased, stored in ((vertices, self.vertices), (normals, self.normals)):
            shapes = np.stack([stored[0], eased[-self.count :], stored[1], stored[2]])
            below = int(np.clip(np.searchsorted(GRIPS, grip) - 1, 0, len(GRIPS) - 2))
            share = np.clip((grip - GRIPS[below]) / (GRIPS[below + 1] - GRIPS[below]), 0.0, 1.0)
            hands = shapes[below] + np.float32(share) * (shapes[below + 1] - shapes[below])
            found.append(np.concatenate([eased[: -self.count], hands]))
        found[1] /= np.linalg.norm(found[1], axis=1, keepdims=True)
        return found[0], found[1]


def grip_round(thickness: float) -> float:
    """Grip, from open (-1) to fists (1), of fingers that close around a rod of ``thickness`` metres."""
    bend = FINGER_LENGTH / (thickness / 2.0 + FINGER_RADIUS)
    return float(np.interp(bend, FINGER_BENDS[:, -1], GRIPS))
