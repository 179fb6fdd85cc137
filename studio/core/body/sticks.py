"""Stick figure of a body: pairs of points that are connected by a line."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout


@lru_cache
def bone_pairs(layout: BodyLayout) -> NDArray[np.intp]:
    """Indices (B, 2) of the proximal and distal point of every bone, and of the lines from the spine to collars and
    hips.
    """
    segments = list(zip(layout.proximal_points(), layout.distal_points(), strict=True))
    joins = [(layout.neck_base, layout.collar_point(side)) for side in (0, 1)]
    joins += [(0, layout.hip_point(side)) for side in (0, 1)]
    return np.array(segments + joins)
